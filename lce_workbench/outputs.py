"""The output folder: it appears whole or not at all, and its manifest says what is in it."""

from __future__ import annotations

import errno
import fcntl
import glob
import hashlib
import json
import os
import shutil
import tempfile
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import asdict, fields
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, TypeVar
from zipfile import BadZipFile

import numpy as np

from lce_solver.errors import EnvironmentFault, InputError
from lce_solver.types import Design, Finding, Flattening, Ints, Material, Prediction, Severity, Start, Status, Surface

if TYPE_CHECKING:  # it imports SciPy, which the Python inside FreeCAD may lack
    from lce_solver.compare import Comparison

MANIFEST = "manifest.json"


@contextmanager
def staged(out: Path, *, replaced: Sequence[str] | None = None) -> Iterator[Path]:
    """Give a folder beside ``out`` to write into; at the end it takes the place of ``out`` in one rename.

    On any exception the folder is removed and ``out`` is as it was. With ``replaced`` the new folder starts with the
    files of ``out`` (hard links, so nothing is copied) without those files and folders: write these anew.

    Raises
    ------
    InputError
        What would be replaced is not ours, or was changed by hand.
    EnvironmentFault
        The disk is full or may not be written.
    """
    out = Path(os.path.realpath(out))  # a link stays, what it points to is replaced
    with told(out):
        _recover(out)
    _require_ours(out, replaced)
    made = [parent for parent in out.parents if not parent.exists()]
    with told(out):
        out.parent.mkdir(parents=True, exist_ok=True)
        stage = Path(tempfile.mkdtemp(prefix=f".{out.name}.", suffix=".partial", dir=out.parent))
    claim = _claim(stage)
    try:
        with told(out):
            stage.chmod(0o777 & ~_umask())
            if replaced is not None:
                shutil.copytree(out, stage, copy_function=os.link, dirs_exist_ok=True)
                for name in replaced:
                    _remove(stage / name)
            yield stage
            _exchange(stage, out)
    finally:
        shutil.rmtree(stage, ignore_errors=True)
        os.close(claim)
        with suppress(OSError):  # not empty: it holds the result
            for parent in made:
                parent.rmdir()


def _claim(folder: Path) -> int:
    """Lock a folder for as long as this process lives and the descriptor is open.

    Raises
    ------
    BlockingIOError
        Another process has it.
    """
    descriptor = os.open(folder, os.O_RDONLY)
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError:
        os.close(descriptor)
        raise
    return descriptor


def _recover(out: Path) -> None:
    """Undo what a killed run left beside ``out``: the former folder comes back, half-written ones go."""
    for left in sorted(out.parent.glob(f".{glob.escape(out.name)}.????????.*")):
        with suppress(BlockingIOError):  # its run is alive
            claim = _claim(left)
            if left.suffix == ".former" and not out.exists():
                left.rename(out)
            elif left.suffix in {".former", ".partial"}:
                shutil.rmtree(left)
            os.close(claim)


def _remove(path: Path) -> None:
    if path.is_dir():
        shutil.rmtree(path)
    else:
        path.unlink(missing_ok=True)


def _is_output(folder: Path) -> bool:
    try:
        return bool(read_manifest(folder))
    except InputError:
        return False


def _require_ours(out: Path, replaced: Sequence[str] | None) -> None:
    """Refuse to replace files that we did not write, or that somebody changed since."""
    if out.exists() and not out.is_dir():
        msg = f"{out} is a file; choose a folder with --out"
        raise InputError(msg)
    if out.is_mount():
        msg = f"{out} is a mount point, which cannot be replaced whole; choose a folder in it with --out"
        raise InputError(msg)
    around = next((parent for parent in out.parents if _is_output(parent)), None)
    if around:
        msg = f"{out} lies in the output folder {around}, which would not be whole any more; choose another with --out"
        raise InputError(msg)
    if not out.is_dir() or not any(out.iterdir()):
        return
    if not (out / MANIFEST).is_file():
        msg = f"{out} holds files that are not ours (no {MANIFEST}); choose another folder with --out"
        raise InputError(msg)
    ours = {entry["path"]: entry["sha256"] for entry in read_manifest(out)["files"]}
    for path in sorted(out.rglob("*")):
        name = path.relative_to(out).as_posix()
        goes = replaced is None or any(name == part or name.startswith(f"{part}/") for part in replaced)
        if goes and not path.is_dir() and name != MANIFEST and ours.get(name) != digest(path)["sha256"]:
            what = "was changed since it was written" if name in ours else "is not ours"
            msg = f"{path} {what} and would be lost; move it away, or choose another folder with --out"
            raise InputError(msg)


def _umask() -> int:
    mask = os.umask(0)
    os.umask(mask)
    return mask


def _exchange(stage: Path, out: Path) -> None:
    """Put ``stage`` in the place of ``out``; the former folder comes back if that fails."""
    if not out.exists():
        stage.rename(out)
        return
    former = stage.with_suffix(".former")
    claim = _claim(out)
    try:
        out.rename(former)
        try:
            stage.rename(out)
        except BaseException:
            former.rename(out)
            raise
        shutil.rmtree(former)
    finally:
        os.close(claim)


@contextmanager
def told(path: Path) -> Iterator[None]:
    """Turn faults of the file system into one sentence that names the place."""
    try:
        yield
    except OSError as fault:
        if fault.errno in {errno.ENOSPC, errno.EDQUOT}:
            msg = f"the disk is full while writing {path}; free some space and run again, nothing was changed"
        else:
            where = fault.filename or path
            msg = f"{where} cannot be written ({fault.strerror or fault}); check the place and your rights to it"
        raise EnvironmentFault(msg) from fault


def write_manifest(folder: Path, entries: Mapping[str, Any]) -> None:
    """Write ``manifest.json``: ``entries`` and every file of the folder with its size and SHA-256."""
    files = sorted(p for p in folder.rglob("*") if p.is_file() and p.name != MANIFEST)
    listed = [{"path": p.relative_to(folder).as_posix(), **digest(p)} for p in files]
    text = json.dumps({**entries, "files": listed}, indent=1)
    target = folder / MANIFEST
    target.unlink(missing_ok=True)
    target.write_text(text + "\n", encoding="utf-8")


def read_manifest(folder: Path) -> dict[str, Any]:
    """The manifest of an output folder.

    Raises
    ------
    InputError
        The folder is not one of ours.
    """
    try:
        manifest = json.loads((folder / MANIFEST).read_text(encoding="utf-8"))
        ours = "lce-molds" in manifest["versions"] and all(
            isinstance(record, dict) for key in ("files", "findings") for record in manifest[key]
        )
    except (OSError, ValueError, KeyError, TypeError):
        ours = False
    if not ours:
        msg = f"{folder} is not an output folder (no {MANIFEST} of ours); make one with `./lce design` or `./lce build`"
        raise InputError(msg)
    found: dict[str, Any] = manifest
    return found


def require_unchanged(folder: Path, name: str) -> None:
    """Refuse a file that is not what the manifest says.

    Raises
    ------
    InputError
        It is missing, damaged or changed.
    """
    recorded = {entry["path"]: entry["sha256"] for entry in read_manifest(folder)["files"]}
    path = folder / name
    if not path.is_file() or recorded.get(name) != digest(path)["sha256"]:
        stage = "mask" if name.startswith("mask/") else "design"
        msg = f"{path} is missing or not what {MANIFEST} says; run `./lce {stage}` again"
        raise InputError(msg)


def digest(path: Path) -> dict[str, Any]:
    """Size [bytes] and SHA-256 of a file."""
    with path.open("rb") as file:
        return {"size": path.stat().st_size, "sha256": hashlib.file_digest(file, "sha256").hexdigest()}


def as_record(finding: Finding, stage: str) -> dict[str, Any]:
    """A finding for the manifest."""
    return {"stage": stage, **asdict(finding), "severity": finding.severity.value}


def as_finding(record: Mapping[str, Any]) -> Finding:
    """The finding of a record of the manifest."""
    values = {name: value for name, value in record.items() if name != "stage"}
    return Finding(**{**values, "severity": Severity(record["severity"])})


def has_error(findings: Sequence[Mapping[str, Any]]) -> bool:
    """Whether any record of a finding is an error."""
    return any(record["severity"] == Severity.ERROR.value for record in findings)


def write_design(design: Design, path: Path, more: Mapping[str, Any] = MappingProxyType({})) -> None:
    """Write `design.npz`, with ``more`` arrays; numbers and texts only, loads without pickle. Same design, same bytes.

    Raises
    ------
    OSError
        The file cannot be written.
    """
    competed: Any = {
        f"start_{field.name}": [_plain(getattr(start, field.name)) for start in design.starts] for field in STARTS
    }
    np.savez(
        path,
        vertices=design.surface.vertices,
        faces=design.surface.faces,
        uv=design.uv,
        theta=design.theta,
        dtheta=design.dtheta,
        stretch=design.stretch,
        lambda_=design.material.lambda_,
        nu=design.material.nu,
        thickness=design.thickness,
        material_source=design.material.source,
        bending_left=design.bending_left,
        metric_theta=design.flattening.theta,
        status=design.flattening.status.name,
        energy=design.flattening.energy,
        iterations=design.flattening.iterations,
        flipped=design.flattening.flipped,
        crossings=design.flattening.crossings,
        **competed,
        **more,
    )


STARTS = fields(Start)
"""Columns of the record of the starts that competed, in `design.npz` with ``start_`` before their names."""


def _plain(value: Any) -> Any:
    return value.name if isinstance(value, Status) else value


def write_prediction(found: Prediction, judged: Comparison, folder: Path) -> None:
    """Write `prediction.npz` (shapes) and `prediction.json` (figures)."""
    np.savez(folder / "prediction.npz", vertices=found.vertices, frames=found.frames)
    record = {
        **asdict(judged),
        "verdict": judged.verdict.name.lower(),
        "mirrored": judged.mirrored,
        "status": found.status.name.lower(),
        "iterations": found.iterations,
        "heating": [{**asdict(step), "status": step.status.name.lower()} for step in found.history],
    }
    (folder / "prediction.json").write_text(json.dumps(record, indent=1) + "\n", encoding="utf-8")


def read_design(path: Path) -> Design:
    """Read `design.npz`.

    Raises
    ------
    InputError
        The file is missing, damaged or of another kind.
    """
    return read_arrays(path, _design)


Made = TypeVar("Made")

UNREADABLE = (OSError, ValueError, KeyError, TypeError, EOFError, BadZipFile)
"""What `numpy.load` and the lookup in its arrays raise on damaged files and on files of another kind."""


def read_arrays(path: Path, make: Callable[[Mapping[str, Any]], Made]) -> Made:
    """What ``make`` makes of the arrays of a `design.npz`; errors as for `read_design`."""
    try:
        with path.open("rb") as file, np.load(file, allow_pickle=False) as data:
            return make({name: data[name] for name in data.files})
    except UNREADABLE as fault:
        msg = f"{path} is not a readable design, or one of another version ({fault}); run `./lce design` again"
        raise InputError(msg) from None


def _design(data: Mapping[str, Any]) -> Design:
    flat = Flattening(
        uv=data["uv"],
        theta=data.get("metric_theta", data["theta"]),  # a design from before corrections has one
        status=Status[str(data["status"])],
        energy=data["energy"],
        iterations=int(data["iterations"]),
        flipped=_ints(data["flipped"]),
        crossings=_ints(data["crossings"]),
    )
    plan = Design(
        surface=Surface(data["vertices"], data["faces"]),
        uv=data["uv"],
        theta=data["theta"],
        dtheta=data["dtheta"],
        stretch=data["stretch"],
        material=Material(float(data["lambda_"]), float(data["nu"]), str(data["material_source"])),
        thickness=float(data["thickness"]),
        flattening=flat,
        bending_left=float(data["bending_left"]),
        starts=_starts(data),
    )
    _require_sound(plan)
    return plan


def _require_sound(plan: Design) -> None:
    """Refuse numbers that no design of ours has, with a ValueError."""
    faces = plan.surface.faces
    if len(faces) == 0 or faces.min() < 0 or faces.max() >= len(plan.uv):
        msg = "its triangles name vertices that it does not have"
        raise ValueError(msg)
    for name in ("uv", "theta", "dtheta", "stretch", "thickness"):
        if not np.isfinite(getattr(plan, name)).all():
            msg = f"its {name} is not finite"
            raise ValueError(msg)
    if not np.isfinite(plan.surface.vertices).all():
        msg = "its vertices are not finite"
        raise ValueError(msg)


def _starts(data: Mapping[str, Any]) -> tuple[Start, ...]:
    """The record of the starts; what a former version did not write has its default."""
    columns = {field.name: data[f"start_{field.name}"] for field in STARTS if f"start_{field.name}" in data}
    rows = [dict(zip(columns, row, strict=True)) for row in zip(*(c.tolist() for c in columns.values()), strict=True)]
    return tuple(Start(**{**row, "status": Status[row["status"]]}) for row in rows)


def _ints(array: Any) -> Ints:
    return np.asarray(array, dtype=np.int64)
