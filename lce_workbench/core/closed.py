"""The closed cell of a design: everything that `assemble` needs, with channels in few domains only."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from lce_solver.types import Design, Ints
from lce_workbench.core.cell import Cell, assemble, wanted
from lce_workbench.core.channels import Channels, hatch
from lce_workbench.core.domains import PLATES, Domains, Plate
from lce_workbench.core.frame import arrange
from lce_workbench.core.job import ChannelSpec, Job
from lce_workbench.core.marks import marks

CANDIDATES = 16
"""The most central of so many domains is shown when the job chooses none; only a speck of a domain has no channel."""


def closed(design: Design, domains: Domains, job: Job) -> Cell:
    """The assembled cell. Only domains that can become solids are hatched: a sheet has a million channels.

    Raises
    ------
    InputError
        The parameters do not go together; the sentence names the one to change.
    """
    frame = arrange(design.uv, job)
    shown = _shown(domains, job)
    channels = {plate: _channels(domains, plate, job.channels, shown) for plate in PLATES}
    drawn = {plate: [r for rings in marks(frame, plate, job.marks).values() for r in rings] for plate in PLATES}
    return assemble(frame, job, domains, drawn, channels)


def _shown(domains: Domains, job: Job) -> Ints:
    """The domains that can become solids: those the job chooses, or the most central ones."""
    chosen = {k for k in wanted(domains, job.output) if 0 <= k < len(domains)}  # `assemble` refuses the others
    if chosen:
        return np.array(sorted(chosen))
    far = np.linalg.norm(domains.centroid, axis=1)
    return np.sort(np.argsort(far, kind="stable")[:CANDIDATES])


def _channels(domains: Domains, plate: Plate, spec: ChannelSpec, shown: Ints) -> Channels:
    """The channels of some domains alone, numbered as in the whole sheet."""
    found = hatch(domains.chosen(shown), plate, spec)
    return replace(found, angle=domains.angle(plate), domain=shown[found.domain])
