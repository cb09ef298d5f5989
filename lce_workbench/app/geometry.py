"""The cell of a stored design: read and closed once for all the bodies that show it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import lru_cache
from pathlib import Path

from lce_solver.errors import InputError
from lce_solver.types import Design
from lce_workbench.core.cell import Cell
from lce_workbench.core.channels import ChannelField
from lce_workbench.core.closed import closed
from lce_workbench.core.domains import PLATES, Domains, Plate, partition
from lce_workbench.core.job import ChannelSpec, Job, PredictionSpec
from lce_workbench.core.jobfile import TWIST_KEYS
from lce_workbench.core.uses import TWIST, values
from lce_workbench.divided import read_domains
from lce_workbench.outputs import read_design
from lce_workbench.packages import needed


def changed_at(path: Path) -> int:
    """When a design's file was changed [ns].

    Raises
    ------
    InputError
        It is not there.
    """
    if not path.is_file():
        msg = f"the design's file {path.name} is not in this document, which is damaged; run Design again"
        raise InputError(msg)
    return path.stat().st_mtime_ns


def stored(path: Path, job: Job | None = None, made_for: Job | None = None) -> Design:
    """The design of a file, with the twist of the ``job`` where it was ``made_for`` another one.

    The metric does not depend on gap, gain and limits of the twist, so this is what solving again would give; but for
    what the simulated heating corrects, see `is_rough`.

    Raises
    ------
    EnvironmentFault
        The twist has to be solved anew, and SciPy is missing.
    """
    changed = changed_at(path)
    if job is None or made_for is None or _same_twist(job, made_for):
        return _read(path, changed)
    return _retwisted(path, changed, _narrowed(job, made_for))


def is_rough(job: Job, made_for: Job) -> bool:
    """Whether the twist is that of the metric alone, where the job asks for one that the heating corrects."""
    return job.prediction.correct != "off" and not _same_twist(job, made_for)


def _same_twist(job: Job, made_for: Job) -> bool:
    return values(job, TWIST) == values(made_for, TWIST)


@lru_cache(maxsize=4)
def _read(path: Path, changed: int) -> Design:  # noqa: ARG001 - a changed file is another design
    return read_design(path)


@lru_cache(maxsize=4)
def _retwisted(path: Path, changed: int, job: Job) -> Design:
    with needed():
        from lce_solver.bounded import retwisted
        from lce_solver.twist import second_form
    plan = _read(path, changed)
    plan = replace(plan, theta=plan.flattening.theta)  # before it was corrected for its own film
    return retwisted(plan, second_form(plan.surface, plan.uv), **job.sheet.twist)


def _narrowed(job: Job, made_for: Job) -> Job:
    """What a design was made for, with the twist and the channels of a job, but for their depth: no domain has one."""
    twist = {key: getattr(job.sheet, key) for key in TWIST_KEYS}
    return Job(
        made_for.target,
        made_for.material,
        replace(made_for.sheet, **twist),
        made_for.domains,
        replace(job.channels, depth_um=ChannelSpec.depth_um),
        solver=made_for.solver,
        prediction=PredictionSpec(correct=job.prediction.correct),
    )


def domains_of(path: Path, job: Job, made_for: Job | None = None) -> Domains:
    """The domains of a file's design, divided anew where the job's twist or phases are not what it was made for."""
    return fields_of(path, job, made_for)["bottom"].domains


def fields_of(path: Path, job: Job, made_for: Job | None = None) -> Mapping[Plate, ChannelField]:
    """The channels of both plates, whatever their depth: the same objects as long as they are the same channels."""
    made_for = made_for or job
    return _fields(path, changed_at(path), _narrowed(job, made_for), made_for)


@lru_cache(maxsize=4)
def _fields(path: Path, changed: int, job: Job, made_for: Job) -> Mapping[Plate, ChannelField]:  # noqa: ARG001
    domains = _divided(path, job, made_for)
    return {plate: ChannelField(domains, plate, job.channels) for plate in PLATES}


def _divided(path: Path, job: Job, made_for: Job) -> Domains:
    phases = job.channels.align_phase or made_for.channels.align_phase
    if _same_twist(job, made_for) and (not phases or values(job, ["channels"]) == values(made_for, ["channels"])):
        return read_domains(path)
    plan = stored(path, job, made_for)
    if job.domains.kind == "triangles" and not job.channels.align_phase:
        return partition(plan)
    with needed():
        from lce_workbench.core.partition import divide
    return divide(plan, job)[0]


def assembled(path: Path, job: Job, made_for: Job | None = None) -> Cell:
    """The cell around the design of a file."""
    return _assembled(path, changed_at(path), job, made_for)


@lru_cache(maxsize=4)
def _assembled(path: Path, changed: int, job: Job, made_for: Job | None) -> Cell:  # noqa: ARG001
    return closed(stored(path, job, made_for), domains_of(path, job, made_for), job)
