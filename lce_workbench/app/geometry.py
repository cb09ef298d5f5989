"""The cell of a stored design: read and closed once for all the bodies that show it."""

from __future__ import annotations

from functools import lru_cache
from pathlib import Path

from lce_solver.types import Design
from lce_workbench.core.cell import Cell
from lce_workbench.core.closed import closed
from lce_workbench.core.domains import Domains, partition
from lce_workbench.core.job import Job, Sheet
from lce_workbench.divided import read_domains
from lce_workbench.outputs import read_design
from lce_workbench.packages import needed


def stored(path: Path, wanted: Sheet | None = None, made_for: Sheet | None = None) -> Design:
    """The design of a file, with the twist of the ``wanted`` sheet where it was ``made_for`` another one.

    The metric does not depend on gap, gain and limits of the twist, so this is what solving again would give.

    Raises
    ------
    EnvironmentFault
        The twist has to be solved anew, and SciPy is missing.
    """
    changed = path.stat().st_mtime_ns
    if wanted is None or made_for is None or wanted.twist == made_for.twist:
        return _read(path, changed)
    return _retwisted(path, changed, wanted)


@lru_cache(maxsize=4)
def _read(path: Path, changed: int) -> Design:  # noqa: ARG001 - a changed file is another design
    return read_design(path)


@lru_cache(maxsize=4)
def _retwisted(path: Path, changed: int, wanted: Sheet) -> Design:
    with needed():
        from lce_solver.bounded import retwisted
        from lce_solver.twist import second_form
    plan = _read(path, changed)
    return retwisted(plan, second_form(plan.surface, plan.uv), **wanted.twist)


def domains_of(path: Path, job: Job, made_for: Job | None = None) -> Domains:
    """The domains of a file's design, divided anew where the job's twist or phases are not what it was made for."""
    return _domains(path, path.stat().st_mtime_ns, job, made_for)


@lru_cache(maxsize=4)
def _domains(path: Path, changed: int, job: Job, made_for: Job | None) -> Domains:  # noqa: ARG001
    if made_for is None or _divides_as(job, made_for):
        return read_domains(path)
    plan = stored(path, job.sheet, made_for.sheet)
    if job.domains.kind == "triangles" and not job.channels.align_phase:
        return partition(plan)
    with needed():
        from lce_workbench.core.partition import divide
    return divide(plan, job)[0]


def _divides_as(job: Job, made_for: Job) -> bool:
    phases = job.channels.align_phase or made_for.channels.align_phase
    return job.sheet.twist == made_for.sheet.twist and (not phases or job.channels == made_for.channels)


def assembled(path: Path, job: Job, made_for: Job | None = None) -> Cell:
    """The cell around the design of a file."""
    return _assembled(path, path.stat().st_mtime_ns, job, made_for)


@lru_cache(maxsize=4)
def _assembled(path: Path, changed: int, job: Job, made_for: Job | None) -> Cell:  # noqa: ARG001
    plan = stored(path, job.sheet, made_for.sheet if made_for else None)
    return closed(plan, domains_of(path, job, made_for), job)
