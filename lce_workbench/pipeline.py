"""One job through its stages into a folder that appears whole, with a manifest that says what is in it."""

from __future__ import annotations

import platform
from collections.abc import Mapping, Sequence
from contextlib import suppress
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

from lce_solver.errors import InputError
from lce_solver.types import Progress, Severity, silent
from lce_workbench import __version__
from lce_workbench.cad.step import EXTRAS
from lce_workbench.core.job import Job
from lce_workbench.core.mask import refuse_unwritable
from lce_workbench.export import EXPORTERS
from lce_workbench.export.outlines import OUTLINES
from lce_workbench.freecad_child import freecad
from lce_workbench.outputs import (
    as_record,
    has_error,
    read_design,
    read_manifest,
    require_unchanged,
    staged,
    write_manifest,
)
from lce_workbench.stages import OUTPUTS, STAGES, Run, inputs


def build(
    job: Job,
    base: Path,
    out: Path,
    names: Sequence[str],
    progress: Progress = silent,
    *,
    metric: Path | None = None,
    scheduler: str | None = None,
) -> int:
    """Run the stages ``names`` of one job into ``out``; return the exit code.

    The first stage is ``design``; without it ``out`` must hold one, and its other files are kept. ``metric`` is an
    output folder of a job that differs in nothing the metric depends on: its solution is taken instead of solved anew.
    ``scheduler`` is the address of a Dask scheduler whose workers draw the masks, into the same bytes.

    Raises
    ------
    LceError
        A fault that leaves ``out`` as it was.
    """
    _require_formats(job)
    refuse_unwritable(job)
    if ("cad" in names and job.output.freecad) or ("drawings" in names and job.output.drawings):
        freecad()
    anew = names[0] == "design"
    former: dict[str, Any] = {} if anew else read_manifest(out)
    if not anew:
        require_unchanged(out, "design.npz")
        read_design(out / "design.npz")  # its faults are told here, with the name that the user knows
    gone = {*names, "review"}  # a review of other files would not be true any more
    records = [r for r in former.get("findings", ()) if r["stage"] not in gone]
    stages = [s for s in former.get("stages", ()) if s not in gone]
    with staged(out, replaced=None if anew else [output for name in gone for output in OUTPUTS[name]]) as folder:
        for name in names:
            if name == "review":  # it reads the manifest, as whoever gets the folder does
                _write(folder, stages, records, former.get("inputs") or inputs(job, base))
            findings = STAGES[name](Run(folder, job, base, progress, metric, scheduler, out))
            records += [as_record(finding, name) for finding in findings]
            stages.append(name)
        _write(folder, stages, records, former.get("inputs") or inputs(job, base))
    return exit_code(records)


def _write(folder: Path, stages: list[str], records: list[dict[str, Any]], named: list[dict[str, Any]]) -> None:
    entries = {"versions": versions(), "stages": stages, "inputs": named}
    write_manifest(folder, {**entries, "findings": records, "exit_code": exit_code(records)})


def _require_formats(job: Job) -> None:
    if not job.output.masks:
        msg = f"output.masks is empty; name at least one of {', '.join(EXPORTERS)}"
        raise InputError(msg)
    for key, known in (("masks", tuple(EXPORTERS)), ("cad", ("domains", *EXTRAS, *OUTLINES))):
        for name in getattr(job.output, key):
            if name not in known:
                msg = f"output.{key}: format {name!r} is unknown; known are {', '.join(known)}"
                raise InputError(msg)


def exit_code(records: Sequence[Mapping[str, Any]]) -> int:
    """3 when design or prediction did not reach its tolerance, 1 when another finding is an error, else 0."""
    errors = {r["check"] for r in records if r["severity"] == Severity.ERROR.value}
    return 3 if errors & {"solver", "prediction"} else int(has_error(records))


def versions() -> dict[str, str]:
    """What made the files."""
    found = {"lce-molds": __version__, "python": platform.python_version()}
    for package in ("numpy", "scipy", "trimesh", "ezdxf", "cadquery", "typst"):
        with suppress(PackageNotFoundError):
            found[package] = version(package)
    return found
