"""What the steps of the work run in a process of their own: job file, folders, commands."""

from __future__ import annotations

import hashlib
import os
import re
import shutil
import tempfile
import unicodedata
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

from lce_solver.errors import InputError
from lce_workbench.app import cells
from lce_workbench.app.child import Work
from lce_workbench.app.geometry import fields_of
from lce_workbench.app.objects import FILES
from lce_workbench.app.results import CURRENT, difference
from lce_workbench.core import jobfile
from lce_workbench.core.cell import choose, wanted
from lce_workbench.core.job import Job
from lce_workbench.outputs import read_manifest, told

Planned = Callable[[Path, Path, tuple[str, ...]], tuple[tuple[str, ...], ...]]
"""From job file, output folder and the words that name the metric to the commands."""


def design(cell: Any, job: Job) -> Work:
    """Solve the metric and the twist."""
    return _work("design", cell, job, None, lambda toml, out, _: (("design", str(toml), "--out", str(out)),))


def predict(cell: Any, job: Job) -> Work:
    """Simulate the heating."""
    require_current(cell, job)
    return _work(
        "predict", cell, job, None, lambda toml, out, metric: (_designed(toml, out, metric), ("predict", str(out)))
    )


def mask(cell: Any, job: Job, folder: Path) -> Work:
    """Draw the masks below ``folder``, into what is there already of the same job."""
    require_current(cell, job)
    return _work("mask", cell, job, folder, lambda *of: _after_design(*of, "mask"))


def export(cell: Any, job: Job, folder: Path) -> Work:
    """Write all outputs below ``folder``."""
    require_current(cell, job)
    return _work("export", cell, job, folder, _built)


def review(cell: Any, job: Job, folder: Path) -> Work:
    """Write all outputs below ``folder``, unless they are there, and review them."""
    require_current(cell, job)
    return _work("review", cell, job, folder, _reviewed)


def _built(toml: Path, out: Path, metric: tuple[str, ...]) -> tuple[tuple[str, ...], ...]:
    return (("build", str(toml), "--out", str(out), *metric),)


def _reviewed(toml: Path, out: Path, metric: tuple[str, ...]) -> tuple[tuple[str, ...], ...]:
    """The review alone where everything is written already; a build ends with one."""
    whole = is_of(toml, out) and "cad" in read_manifest(out)["stages"]
    return (("review", str(out)),) if whole else _built(toml, out, metric)


def _designed(toml: Path, out: Path, metric: tuple[str, ...]) -> tuple[str, ...]:
    return ("design", str(toml), "--out", str(out), *metric)


def _after_design(toml: Path, out: Path, metric: tuple[str, ...], stage: str) -> tuple[tuple[str, ...], ...]:
    """One stage, after a design if ``out`` is not of this job."""
    return (*(() if is_of(toml, out) else (_designed(toml, out, metric),)), (stage, str(out)))


def is_of(toml: Path, out: Path) -> bool:
    """Whether ``out`` was made from a job file, as it is now."""
    there, job = out / "job.toml", jobfile.load(toml)
    return there.is_file() and there.read_text(encoding="utf-8") == jobfile.dump(_seen_from(job, toml.parent, out))


def _seen_from(job: Job, base: Path, folder: Path) -> Job:
    """The job with its files named relative to ``folder``, as the pipeline writes it there."""
    for section, key in FILES.items():
        name = getattr(getattr(job, section), key)
        moved = os.path.relpath(os.path.realpath(base / name), os.path.realpath(folder)) if name else ""
        job = replace(job, **{section: replace(getattr(job, section), **{key: moved})})
    return job


def require_design(cell: Any) -> None:
    """Refuse a cell that is not designed yet.

    Raises
    ------
    InputError
        There is no design in it.
    """
    if not cells.design_of(cell).File:
        msg = f"{cell.Label} is not designed yet; run Design first"
        raise InputError(msg)


def solids(cell: Any, job: Job) -> int:
    """How many channels the window of a job shows as solids.

    Raises
    ------
    InputError
        There is no design, or one of the domains is not there.
    """
    require_design(cell)
    design = cells.design_of(cell)
    fields = fields_of(Path(design.File), job, cells.made_for(design))
    domains = fields["bottom"].domains
    chosen = list(choose(domains, fields, wanted(domains, job.output)))
    return int(sum(field.counts[chosen].sum() for field in fields.values()))


def bodies(cell: Any) -> list[Any]:
    """Plates, spacer, film and channel windows of a cell."""
    return [obj for obj in cell.OutListRecursive if cells.kind_of(obj) == "Body"]


def require_bodies(cell: Any) -> None:
    """Refuse a cell without plates.

    Raises
    ------
    InputError
        There are none, or a part of them was deleted.
    """
    require_design(cell)
    if not {"bottom_land", "top_land", "sheet"} <= {b.Prisms for b in bodies(cell) if not b.Shape.isNull()}:
        msg = f"{cell.Label} has no plates, or not all of their parts; run Plates and Spacer first"
        raise InputError(msg)


def require_current(cell: Any, job: Job) -> None:
    """Refuse a design that was made for another metric.

    Raises
    ------
    InputError
        There is none, or it is stale.
    """
    require_design(cell)
    obj = cells.design_of(cell)
    if not obj.Status.startswith(CURRENT):
        msg = f"the design of {cell.Label} is {obj.Status}; run Design again, or set the value back"
        raise InputError(msg)
    words = difference(jobfile.metric_values(job), jobfile.metric_values(cells.made_for(obj)))
    if words:
        msg = f"{words}; run Design with the new value first"
        raise InputError(msg)


def _work(kind: str, cell: Any, job: Job, folder: Path | None, planned: Planned) -> Work:
    """Write the job file and the former metric, and plan the commands.

    Raises
    ------
    InputError
        A file that the job names is not there.
    EnvironmentFault
        The folder cannot be written.
    """
    scratch = tempfile.TemporaryDirectory(prefix="lce-")
    base, name = folder or Path(scratch.name), file_name(cell.Label)
    toml = base / f"{name}.toml"
    with told(toml):
        base.mkdir(parents=True, exist_ok=True)
        job = _with_files(cell, job, base, name)
        toml.write_text(jobfile.dump(job, comments=True), encoding="utf-8")
    key = hashlib.sha256(repr((kind, folder, job, [cells.digest(str(base / n)) for n in _named(job)])).encode())
    metric = () if kind == "design" else _former(cell, Path(scratch.name) / "former")
    out = base / "out" / name
    return Work(key.hexdigest(), planned(toml, out, metric), out, scratch)


def file_name(label: str) -> str:
    """A label as the name of a file."""
    plain = unicodedata.normalize("NFKD", label.removesuffix(" (stale)").casefold())  # "Größe" is "grosse"
    return re.sub(r"[^a-z0-9]+", "-", plain.encode("ascii", "ignore").decode()).strip("-") or "cell"


def _named(job: Job) -> list[str]:
    return [getattr(getattr(job, section), key) for section, key in FILES.items()]


def _with_files(cell: Any, job: Job, base: Path, name: str) -> Job:
    """The job with its mesh and curve beside the job file, from the document or from where the user chose them."""
    objects = cells.sections(cell)
    for (section, key), given in zip(FILES.items(), _named(job), strict=True):
        if not given:
            continue
        kept = objects[section].File if given == objects[section].getPropertyByName(key.capitalize()) else ""
        origin = Path(kept or given)
        if not origin.is_file():
            msg = f"{section}.{key}: {given} does not exist and is not kept in the document; choose the file again"
            raise InputError(msg)
        copy = f"{name}{origin.suffix}"
        if (base / copy).resolve() != origin.resolve():
            shutil.copyfile(origin, base / copy)
        job = replace(job, **{section: replace(getattr(job, section), **{key: copy})})
    return job


def _former(cell: Any, folder: Path) -> tuple[str, ...]:
    """The words that name the document's own design as the metric; none when it was not solved here."""
    obj = cells.design_of(cell)
    if not obj.Manifest:
        return ()
    folder.mkdir()
    shutil.copyfile(obj.File, folder / "design.npz")
    (folder / "job.toml").write_text(obj.Job, encoding="utf-8")
    (folder / "manifest.json").write_text(obj.Manifest, encoding="utf-8")
    return ("--metric", str(folder))
