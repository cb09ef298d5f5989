"""The cell of a stored design: read and closed once for all the bodies that show it."""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache
from pathlib import Path

from lce_solver.types import Design
from lce_workbench.core.cell import Cell
from lce_workbench.core.closed import closed
from lce_workbench.core.job import Job
from lce_workbench.divided import read_domains
from lce_workbench.outputs import read_design


def stored(path: Path, thickness: float) -> Design:
    """The design of a file, for a film of this thickness [mm].

    The twist is linear in the thickness and nothing else depends on it, so this is what solving again would give.
    """
    design = _read(path, path.stat().st_mtime_ns)
    gain = thickness / design.thickness
    return replace(design, dtheta=design.dtheta * gain, thickness=thickness)


@lru_cache(maxsize=4)
def _read(path: Path, changed: int) -> Design:  # noqa: ARG001 - a changed file is another design
    return read_design(path)


def assembled(path: Path, job: Job) -> Cell:
    """The cell around the design of a file."""
    return _assembled(path, path.stat().st_mtime_ns, job)


@lru_cache(maxsize=4)
def _assembled(path: Path, changed: int, job: Job) -> Cell:
    design = stored(path, job.sheet.thickness)
    domains = read_domains(path)
    gain = design.thickness / _read(path, changed).thickness
    return closed(design, replace(domains, dtheta=domains.dtheta * gain), job)
