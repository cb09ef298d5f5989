"""The cell of a stored design: read and assembled once for all the bodies that show it."""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache
from pathlib import Path

import numpy as np

from lce_solver.types import Design, Ints
from lce_workbench.core.cell import Cell, assemble
from lce_workbench.core.channels import Channels, hatch
from lce_workbench.core.domains import PLATES, Domains, Plate, partition
from lce_workbench.core.frame import arrange
from lce_workbench.core.job import ChannelSpec, Job
from lce_workbench.core.marks import marks
from lce_workbench.outputs import read_design

CANDIDATES = 16
"""The most central of so many domains is shown when the job chooses none; only a speck of a domain has no channel."""


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
def _assembled(path: Path, changed: int, job: Job) -> Cell:  # noqa: ARG001
    design = stored(path, job.sheet.thickness)
    domains, frame = partition(design), arrange(design.uv, job)
    shown = _shown(domains, job)
    channels = {plate: _channels(domains, plate, job.channels, shown) for plate in PLATES}
    drawn = {plate: np.concatenate([*marks(frame, plate, job.marks).values()]) for plate in PLATES}
    return assemble(frame, job, domains, drawn, channels)


def _shown(domains: Domains, job: Job) -> Ints:
    """The domains that can become solids: those the job chooses, or the most central ones."""
    chosen = np.unique(np.array(job.output.step_domains, dtype=np.int64))
    chosen = chosen[(chosen >= 0) & (chosen < len(domains))]  # `assemble` refuses the others
    if len(chosen):
        return chosen
    far = np.linalg.norm(domains.centroid, axis=1)
    return np.sort(np.argsort(far, kind="stable")[:CANDIDATES])


def _channels(domains: Domains, plate: Plate, spec: ChannelSpec, shown: Ints) -> Channels:
    """The channels of some domains alone, numbered as in the whole sheet (which has a million of them)."""
    rows = (domains.triangles, domains.theta, domains.dtheta, domains.stretch)
    found = hatch(Domains(domains.vertices, *(row[shown] for row in rows)), plate, spec)
    return replace(found, angle=domains.angle(plate), domain=shown[found.domain])
