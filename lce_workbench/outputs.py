"""The output folder: it appears whole or not at all, and its manifest says what is in it."""

from __future__ import annotations

import errno
import hashlib
import json
import os
import shutil
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from lce_solver.errors import EnvironmentFault, InputError
from lce_solver.types import Design, Finding, Flattening, Ints, Material, Prediction, Severity, Status, Surface

if TYPE_CHECKING:  # it imports SciPy, which the Python inside FreeCAD may lack
    from lce_solver.compare import Comparison

MANIFEST = "manifest.json"


@contextmanager
def staged(out: Path, *, keep: Path | None = None) -> Iterator[Path]:
    """Give a folder beside ``out`` to write into; at the end it takes the place of ``out`` in one rename.

    On any exception the folder is removed and ``out`` is as it was. With ``keep`` the new folder starts with the
    files of that folder (hard links, so nothing is copied): write anew, never into them.

    Raises
    ------
    InputError
        ``out`` exists and is not an output folder of ours.
    EnvironmentFault
        The disk is full or may not be written.
    """
    out = Path(os.path.abspath(out))  # noqa: PTH100 - resolve() would replace a link by its target
    _refuse_foreign(out)
    made = [parent for parent in out.parents if not parent.exists()]
    with told(out):
        out.parent.mkdir(parents=True, exist_ok=True)
        stage = Path(tempfile.mkdtemp(prefix=f".{out.name}.", suffix=".partial", dir=out.parent))
    try:
        with told(out):
            stage.chmod(0o777 & ~_umask())
            if keep is not None:
                shutil.copytree(keep, stage, copy_function=os.link, dirs_exist_ok=True)
            yield stage
            _exchange(stage, out)
    finally:
        shutil.rmtree(stage, ignore_errors=True)
        with suppress(OSError):  # not empty: it holds the result
            for parent in made:
                parent.rmdir()


def _refuse_foreign(out: Path) -> None:
    if out.is_dir() and any(out.iterdir()) and not (out / MANIFEST).is_file():
        msg = f"{out} holds files that are not ours (no {MANIFEST}); choose another folder with --out"
        raise InputError(msg)
    if out.exists() and not out.is_dir():
        msg = f"{out} is a file; choose a folder with --out"
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
    out.rename(former)
    try:
        stage.rename(out)
    except OSError:
        former.rename(out)
        raise
    shutil.rmtree(former)


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
        manifest: dict[str, Any] = json.loads((folder / MANIFEST).read_text(encoding="utf-8"))
    except (OSError, ValueError):
        msg = (
            f"{folder} is not an output folder (no readable {MANIFEST}); make one with `./lce design` or `./lce build`"
        )
        raise InputError(msg) from None
    return manifest


def digest(path: Path) -> dict[str, Any]:
    """Size [bytes] and SHA-256 of a file."""
    with path.open("rb") as file:
        return {"size": path.stat().st_size, "sha256": hashlib.file_digest(file, "sha256").hexdigest()}


def as_record(finding: Finding, stage: str) -> dict[str, Any]:
    """A finding for the manifest."""
    return {"stage": stage, **asdict(finding), "severity": finding.severity.value}


def has_error(findings: Sequence[Mapping[str, Any]]) -> bool:
    """Whether any record of a finding is an error."""
    return any(record["severity"] == Severity.ERROR.value for record in findings)


def write_design(design: Design, path: Path) -> None:
    """Write `design.npz`; numbers and texts only, it loads without pickle. Same design, same bytes."""
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
        status=design.flattening.status.name,
        energy=design.flattening.energy,
        iterations=design.flattening.iterations,
        flipped=design.flattening.flipped,
        crossings=design.flattening.crossings,
    )


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
    try:
        with np.load(path, allow_pickle=False) as data:
            return _design({name: data[name] for name in data.files})
    except (OSError, ValueError, KeyError) as fault:
        msg = f"{path} is not a readable design ({fault}); run `./lce design` again"
        raise InputError(msg) from None


def _design(data: Mapping[str, Any]) -> Design:
    flat = Flattening(
        uv=data["uv"],
        theta=data["theta"],
        status=Status[str(data["status"])],
        energy=data["energy"],
        iterations=int(data["iterations"]),
        flipped=_ints(data["flipped"]),
        crossings=_ints(data["crossings"]),
    )
    return Design(
        surface=Surface(data["vertices"], data["faces"]),
        uv=data["uv"],
        theta=data["theta"],
        dtheta=data["dtheta"],
        stretch=data["stretch"],
        material=Material(float(data["lambda_"]), float(data["nu"]), str(data["material_source"])),
        thickness=float(data["thickness"]),
        flattening=flat,
        bending_left=float(data["bending_left"]),
    )


def _ints(array: Any) -> Ints:
    return np.asarray(array, dtype=np.int64)
