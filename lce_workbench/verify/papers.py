"""The files that people read: manifest, table of angles, job sheet, form for the marks, prediction."""

from __future__ import annotations

import csv
import hashlib
import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from lce_solver.types import Finding, Floats
from lce_workbench.verify.finding import Unreadable, error, measured, reading, same
from lce_workbench.verify.reference import Reference, arrays

TABLE_DEG = 1e-6
"""The table's angles have six decimals [degrees]."""

COLUMNS = ("domain", "x_mm", "y_mm", "area_mm2", "theta_deg", "dtheta_deg", "theta_top_deg", "theta_bottom_deg",
           "written_top_deg", "written_bottom_deg", "stretch_along", "stretch_across", "channels_top",
           "channels_bottom")  # fmt: skip

SAME = 1e-9
"""Relative difference between two evaluations of one formula."""


def digests(folder: Path, manifest: dict[str, Any]) -> Iterator[Finding]:
    """Every file is there, is what the manifest says, and no other is."""
    recorded = {str(entry.get("path")): entry.get("sha256") for entry in manifest["files"]}
    found = {p.relative_to(folder).as_posix(): p for p in folder.rglob("*") if p.is_file()}
    found.pop("manifest.json", None)
    for name in sorted(recorded.keys() - found.keys()):
        yield error("verify_files", name, "is missing; build the folder again")
    for name in sorted(found.keys() - recorded.keys()):
        yield error("verify_files", name, "is not in the manifest; it was put here by something else")
    changed = 0
    for name in sorted(recorded.keys() & found.keys()):
        if sha256(found[name]) != recorded[name]:
            changed += 1
            yield error("verify_digest", name, "is not the file that was written: its SHA-256 differs")
    if not changed:
        yield measured("verify_digest", "manifest.json", f"files of {len(recorded)} that changed:", changed, 0)


def sha256(path: Path) -> str:
    """Hexadecimal digest of a file; "" if it cannot be read."""
    try:
        with path.open("rb") as file:
            return hashlib.file_digest(file, "sha256").hexdigest()
    except OSError:
        return ""


def contents(folder: Path, stages: list[str], wanted: dict[str, list[str]]) -> Iterator[Finding]:
    """Every file that the stages which ran have to leave."""
    for stage in stages:
        for name in wanted.get(stage, []):
            if not (folder / name).is_file():
                yield error("verify_files", name, f"is missing although the stage {stage!r} ran")


def sheet(reference: Reference) -> Iterator[Finding]:
    """The design against its job."""
    job = reference.job
    low, high = reference.flat.min(axis=0), reference.flat.max(axis=0)
    width = float((high - low).max())
    quantities = (
        ("the sheet's longest side differs from the job's by", abs(width - job.sheet.width_mm)),
        ("the thickness differs from the job's gap by", abs(reference.thickness - job.sheet.thickness)),
        ("the sheet's middle differs from the origin by", float(np.abs(low + high).max() / 2)),
    )
    for text, off in quantities:
        yield measured("verify_design", DESIGN, text, off * 1e6, 1.0, unit="nm")
    twist = float(np.degrees(np.abs(reference.dtheta).max()))
    yield measured("verify_design", DESIGN, "the largest twist is", twist, job.sheet.twist_limit_deg + 1e-6, unit="deg")
    yield stretches(reference)


DESIGN = "design.npz"


def stretches(reference: Reference) -> Finding:
    """Flat and target triangles, by the law of cosines, against the stretches that are stated: area and Frobenius norm.

    For the map of a triangle with stretches s1, s2: area ratio s1 s2, and tr(J^T J) = s1^2 + s2^2.
    """
    flat, bent = reference.flat[reference.triangles], reference.target[reference.triangles]
    a, b = flat[:, 1] - flat[:, 0], flat[:, 2] - flat[:, 0]
    p, q = bent[:, 1] - bent[:, 0], bent[:, 2] - bent[:, 0]
    area = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
    pp, pq, qq = (np.sum(u * v, axis=1) for u, v in ((p, p), (p, q), (q, q)))
    aa, ab, bb = (np.sum(u * v, axis=1) for u, v in ((a, a), (a, b), (b, b)))
    trace = (pp * bb - 2 * pq * ab + qq * aa) / area**2
    ratio = np.sqrt(np.maximum(pp * qq - pq**2, 0)) / np.abs(area)
    s1, s2 = reference.stretches.T
    off = np.maximum(np.abs(trace / (s1**2 + s2**2) - 1), np.abs(ratio / (s1 * s2) - 1))
    worst = int(np.argmax(off))
    x, y = flat[worst].mean(axis=0)
    where = f"{DESIGN}, triangle {worst} at ({x:.2f}, {y:.2f}) mm"
    text = "the stated stretches miss the map's by the fraction"
    return measured("verify_stretch", where, text, float(off[worst]), SAME)


def table(path: Path) -> dict[str, Floats]:
    """Columns of `domains.csv`.

    Raises
    ------
    Unreadable
        It is missing, or not a table of numbers.
    """
    with reading():
        with path.open(encoding="utf-8", newline="") as file:
            rows = list(csv.reader(file))
        for k, row in enumerate(rows):
            if len(row) != len(rows[0]):
                msg = f"row {k} has {len(row)} of {len(rows[0])} columns"
                raise ValueError(msg)
        values = np.array([[float(cell) for cell in row] for row in rows[1:]]).T
        found = dict(zip(rows[0], values, strict=True))
    lacking = [name for name in COLUMNS if name not in found]
    if lacking:
        msg = f"lacks the columns {', '.join(lacking)}; write it again"
        raise Unreadable(msg)
    for column, row in np.argwhere(~np.isfinite(values))[:1]:
        msg = f"holds {values[column, row]:g} as {rows[0][column]} in row {row + 1}; write it again"
        raise Unreadable(msg)
    return found


def angles(path: Path, reference: Reference) -> Iterator[Finding]:
    """`domains.csv` against the design: mid-plane, both plates, both masters (the top one mirrored, x -> -x)."""
    name, columns = path.name, table(path)
    count = len(reference.theta)
    yield same("verify_table", name, "the number of rows", len(columns["domain"]), count)
    if len(columns["domain"]) != count:
        return
    top, bottom = reference.angle("top"), reference.angle("bottom")
    lines = {
        "theta_deg": reference.theta,
        "theta_top_deg": top,
        "theta_bottom_deg": bottom,
        "written_top_deg": np.pi - top,
        "written_bottom_deg": bottom,
    }
    for column, wanted in lines.items():
        apart = (columns[column] - np.degrees(wanted) + 90) % 180 - 90
        outside = (columns[column] < 0) | (columns[column] >= 180)
        yield _column(column, np.where(outside, np.inf, np.abs(apart)), TABLE_DEG, "deg", reference)
    values = {
        "domain": (np.arange(count), 0.0, ""),
        "dtheta_deg": (np.degrees(reference.dtheta), TABLE_DEG, "deg"),
        "x_mm": (reference.centres[:, 0], 1e-6, "mm"),
        "y_mm": (reference.centres[:, 1], 1e-6, "mm"),
        "area_mm2": (reference.areas, 1e-9, "mm2"),
        "stretch_along": (reference.stretch[:, 0], 1e-6, ""),
        "stretch_across": (reference.stretch[:, 1], 1e-6, ""),
    }
    for column, (wanted, limit, unit) in values.items():
        yield _column(column, np.abs(columns[column] - wanted), limit, unit, reference)


def _column(column: str, off: Floats, limit: float, unit: str, reference: Reference) -> Finding:
    worst = int(np.argmax(np.where(np.isfinite(off), off, np.inf)))
    where = f"domains.csv, {reference.place(worst)}"
    places = int(np.sum(~(off <= limit)))
    text = f"{column} differs from the design by"
    return measured("verify_table", where, text, float(off[worst]), limit, unit=unit, places=places)


def prediction(folder: Path, reference: Reference) -> Iterator[Finding]:
    """`prediction.json` from the shapes in `prediction.npz`: distances after the best rigid motion (Kabsch 1976)."""
    name, shapes = "prediction.json", "prediction.npz"
    with reading():
        record = json.loads((folder / name).read_text(encoding="utf-8"))
        said = {key: float(record[key]) for key in ("rms_pct", "max_pct", "mirror_rms_pct", "mirrored")}
    try:
        found = arrays(folder / shapes, ("vertices", "frames"))
    except Unreadable as fault:
        yield error("verify_prediction", shapes, str(fault))
        return
    points, frames, target = found["vertices"], found["frames"], reference.target
    if points.shape != target.shape or frames.shape[1:] != target.shape or not len(frames):
        text = f"holds {points.shape} and {frames.shape} numbers for a target of {target.shape}"
        yield error("verify_prediction", shapes, text)
        return
    diagonal = float(np.linalg.norm(np.ptp(target, axis=0)))
    corners = target[reference.triangles]
    area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    share = np.bincount(reference.triangles.ravel(), np.repeat(area, 3), minlength=len(target))
    share = share / share.sum()
    distance, mirrored = (kabsch(points, target, share, handed) for handed in (1, -1))
    rms, mirror = (100 / diagonal * float(np.sqrt(share @ d**2)) for d in (distance, mirrored))
    wanted = {"rms_pct": rms, "max_pct": 100 / diagonal * float(distance.max()), "mirror_rms_pct": mirror}
    for key, value in wanted.items():
        off = abs(said[key] - value) / max(abs(value), 1e-6)
        yield measured("verify_prediction", name, f"{key} differs from the shapes' by the fraction", off, 1e-6)
    yield same("verify_prediction", name, "mirrored", bool(said["mirrored"]), bool(mirror < rms * (1 - 1e-6)))
    off = float(np.abs(frames[-1] - points).max())
    yield measured("verify_prediction", shapes, "the last frame differs from the shape by", off, 0.0, unit="mm")


def kabsch(points: Floats, onto: Floats, share: Floats, handed: int) -> Floats:
    """Distances (n,) of points from their goals after the best motion whose determinant is ``handed``."""
    p, q = points - share @ points, onto - share @ onto
    u, _, vt = np.linalg.svd(p.T @ (share[:, None] * q))
    turn = u @ np.diag([1, 1, handed * np.sign(np.linalg.det(u @ vt))]) @ vt
    return np.asarray(np.linalg.norm(p @ turn - q, axis=1))
