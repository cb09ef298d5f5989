"""The masks of both plates as independent tasks: every file and every check can be made by another process."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from lce_solver.types import Finding, Floats
from lce_workbench.core.channels import ChannelField, empty_domains
from lce_workbench.core.domains import Domains, Plate
from lce_workbench.core.frame import Frame
from lce_workbench.core.job import Job
from lce_workbench.core.job_sheet import Total, totals
from lce_workbench.core.mask import Mask, compose
from lce_workbench.core.mask_checks import check
from lce_workbench.export import EXPORTERS


@dataclass(frozen=True, eq=False)
class Sheet:
    """What both masks are made of."""

    frame: Frame
    domains: Domains
    job: Job
    seams: Floats
    """(n, 2, 2) see `compose`."""

    def field(self, plate: Plate) -> ChannelField:
        """The channels of one plate."""
        return ChannelField(self.domains, plate, self.job.channels)

    def mask(self, plate: Plate) -> Mask:
        """The mask of one plate, the same in every process."""
        return compose(self.frame, self.field(plate), self.job, self.seams)


def expose(sheet: Sheet, plate: Plate, name: str, folder: Path) -> str:
    """Write one mask in one format; the name of the file."""
    path = folder / f"{plate}.{name}"
    EXPORTERS[name](sheet.mask(plate), path)
    return path.name


def measure(sheet: Sheet, plate: Plate) -> tuple[tuple[Finding, ...], Mapping[str, Total]]:
    """Check one mask and count what is on it."""
    field, mask = sheet.field(plate), sheet.mask(plate)
    return (*empty_domains(field), *check(mask, field, sheet.frame, sheet.job)), totals(mask)
