"""The sheet cut into domains of the job's kind, and what that does to the design."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from lce_solver.judge import rms, stretch_errors
from lce_solver.types import Design, Finding, Severity, Status, line_angle
from lce_workbench.core.borders import Borders, borders
from lce_workbench.core.domains import Domains, partition, signed_area
from lce_workbench.core.job import Job
from lce_workbench.core.phase import aligned, meeting
from lce_workbench.core.sampling import mismatch, sample
from lce_workbench.core.tessellation import TESSELLATIONS

FOLDED = {Status.FLIPPED, Status.OVERLAP, Status.NOT_FINITE}
"""No mold is made of such a sheet."""

MOST_LOST = 0.01
"""Share of the sheet that may stay without channels at its rim."""


def divide(design: Design, job: Job) -> tuple[Domains, tuple[Finding, ...]]:
    """Domains of the job's kind and size, and findings about them.

    Raises
    ------
    InputError
        The sheet is too small for one domain.
    """
    domains, kind = partition(design), job.domains.kind
    if design.flattening.status in FOLDED:
        return domains, ()  # no mold is made of it
    if kind in TESSELLATIONS:
        domains = sample(design, TESSELLATIONS[kind]((domains.outline, *domains.holes), job.domains.size))
    found = borders(domains)
    report = [_sizes(domains), _steps(domains, found)]
    if kind in TESSELLATIONS:
        report += [covered(domains), *_residual(design, domains)]
    if job.channels.align_phase:
        domains = replace(domains, phase=aligned(domains, found, job.channels))
        report += meeting(domains, found, job.channels)
    return domains, tuple(report)


def _sizes(domains: Domains) -> Finding:
    """Distribution of the domains' sizes."""
    width = 1e3 * np.sqrt(domains.area * 2 / np.sqrt(3))  # of the hexagon of this area, between its flats
    low, middle, high = np.percentile(width, [5, 50, 95])
    text = (
        f"{len(domains)} domains of {domains.sides.min()} to {domains.sides.max()} corners; hexagons of their area are "
        f"{low:.0f} um (5 %), {middle:.0f} um (half), {high:.0f} um (95 %) wide, {width.min():.0f} to "
        f"{width.max():.0f} um in all"
    )
    return Finding("domain_widths", Severity.INFO, text, float(middle), unit="um")


def _steps(domains: Domains, found: Borders) -> Finding:
    """Steps of the director between neighbours."""
    a, b = found.pair.T
    step = np.degrees(np.abs(line_angle(domains.theta[a] - domains.theta[b] + np.pi / 2) - np.pi / 2))
    half, high, most = (float(v) for v in np.percentile(step, [50, 99, 100])) if len(step) else (0.0, 0.0, 0.0)
    text = (
        f"the director turns between neighbours by {half:.2f} deg (half), {high:.1f} deg (99 %), {most:.1f} deg at most"
    )
    where = "" if not len(step) else "domains {}, {}".format(*found.pair[int(np.argmax(step))])
    return Finding("domain_steps", Severity.INFO, text, half, unit="deg", where=where)


def covered(domains: Domains) -> Finding:
    """How much of the sheet has no domain: specks at its rim."""
    whole = sum(float(signed_area(rim[None])[0]) for rim in (domains.outline, *domains.holes))  # holes are clockwise
    lost = max(1 - float(domains.area.sum()) / whole, 0.0)
    severity = Severity.INFO if lost <= MOST_LOST else Severity.WARNING
    text = f"{lost:.2%} of the sheet, in pieces at its rim too small for a domain, stays without channels"
    return Finding("domain_cover", severity, text, lost, MOST_LOST)


def _residual(design: Design, domains: Domains) -> tuple[Finding, Finding]:
    """What the domains do to the metric: their director against the design's triangles."""
    angle, errors, area = mismatch(design, domains)
    turn = float(np.degrees(np.sqrt(np.average(angle**2, weights=area))))
    own = signed_area(design.uv[design.surface.faces])
    before, after = rms(stretch_errors(design.stretch, design.material), own), rms(errors, area)
    return (
        Finding(
            "partition_angle", Severity.INFO, f"the domains' directors differ from the design's by {turn:.2f} deg rms",
            turn, unit="deg",
        ),
        Finding(
            "partition_stretch",
            Severity.INFO,
            f"along and across the domains' directors the map misses the material's stretches by {after:.2%} rms "
            f"({before:.2%} with the design's own)",
            after,
        ),
    )  # fmt: skip
