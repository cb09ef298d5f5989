"""What a design is worth: every measurement as a finding, with the place where it is worst."""

from __future__ import annotations

import numpy as np

from lce_solver import judge
from lce_solver.geometry import face_areas
from lce_solver.topology import neighbours
from lce_solver.types import Design, Finding, Severity, Status, line_angle

RMS_LIMIT = 0.05
"""Largest rms of the relative stretch errors that passes without a warning."""
RMS_LOST = 0.10
"""Rms of the relative stretch errors beyond which the sheet takes another shape."""
TWIST_LIMIT = np.deg2rad(5.0)
"""Largest twist in the paper's models [rad]."""
QUARTER = np.pi / 2
"""Plates fix the director modulo pi: from here on the film may take the other, smaller twist [rad]."""

REMEDY = {
    Status.ITERATION_LIMIT: "raise solver.max_iterations or solver.tolerance",
    Status.FLIPPED: "refine the target, smooth it where it folds, or choose lambda further from 1",
    Status.OVERLAP: "laid flat the target would cover itself: split it, or cut it open (target.cuts)",
}
"""What the user can do about a status that is not success."""


def assess(design: Design) -> tuple[Finding, ...]:
    """Measure a design; findings of severity error mean that the sheet must not be made."""
    return (solved(design), *stretched(design), twisted(design), reached(design), rough(design))


def solved(design: Design) -> Finding:
    """Whether the sheet is a valid, finished solution."""
    flat = design.flattening
    if flat.status is Status.CONVERGED:
        message = f"the best of {len(design.starts)} starts {flat.status.value} after {flat.iterations} iterations"
        return Finding("solver", Severity.INFO, message, value=flat.iterations)
    faults = len(flat.flipped) + len(flat.crossings)
    where = _where(design, flat.flipped[0]) if len(flat.flipped) else ""
    if len(flat.crossings):
        x, y = design.uv[flat.crossings[0, 0]]
        where = where or f"outline at ({x:.2f}, {y:.2f}) mm"
    message = f"{flat.status.value}; {REMEDY[flat.status]}"
    return Finding("solver", Severity.ERROR, message, value=faults or flat.iterations, where=where)


def stretched(design: Design) -> tuple[Finding, Finding]:
    """How well the metric is reached: rms and worst relative error of both stretches."""
    errors = judge.stretch_errors(design.stretch, design.material)
    rms = judge.rms(errors, face_areas(design.surface))
    worst = np.abs(errors).max(axis=1)
    triangle = int(np.argmax(worst))
    place = _where(design, triangle)
    if rms > RMS_LIMIT:
        severity = Severity.ERROR if rms > RMS_LOST else Severity.WARNING
        advice = "; refine the target, choose lambda further from 1, or cut the target open (target.cuts)"
    else:
        severity, advice = Severity.INFO, ""
    message = f"the stretches miss the material's by {rms:.2%} rms{advice}"
    peak = f"the worst stretch misses the material's by {worst[triangle]:.2%}"
    return (
        Finding("stretch_rms", severity, message, value=rms, limit=RMS_LOST if rms > RMS_LOST else RMS_LIMIT),
        Finding("stretch_max", Severity.INFO, peak, value=float(worst[triangle]), where=place),
    )


def twisted(design: Design) -> Finding:
    """Whether the twist stays where the paper's models are."""
    size = np.abs(design.dtheta)
    triangle, beyond = int(np.argmax(size)), int((size > TWIST_LIMIT).sum())
    most, limit = float(np.rad2deg(size[triangle])), float(np.rad2deg(TWIST_LIMIT))
    message = f"the largest twist is {most:.2f} deg"
    if beyond:
        message += (
            f", and {beyond} of {len(size)} triangles exceed {limit:g} deg: "
            "smooth the target there, or make the sheet wider or the film thinner"
        )
    severity = Severity.WARNING if beyond else Severity.INFO
    if size[triangle] >= QUARTER:
        severity, limit = Severity.ERROR, 90.0
        message += "; plates fix the director modulo 180 deg, so from 90 deg on the film takes the other twist"
    return Finding("twist_limit", severity, message, most, limit, unit="deg", where=_where(design, triangle))


def reached(design: Design) -> Finding:
    """How much of the target's bending the twist prescribes; the rest must follow from the metric."""
    share = float(np.sqrt(1 - design.bending_left**2))
    message = f"twist prescribes {share:.0%} of the target's bending; the metric must bring about the rest"
    return Finding("twist_share", Severity.INFO, message, value=share)


def rough(design: Design) -> Finding:
    """How much the director turns from one triangle to the next: the 99th percentile over all inner edges."""
    half, _ = neighbours(design.surface.faces)
    first, second = design.theta[half.T % len(design.theta)]
    turn = line_angle(first - second)
    jump = np.rad2deg(np.minimum(turn, np.pi - turn))
    most = float(np.percentile(jump, 99)) if len(jump) else 0.0
    message = f"the director turns by less than {most:.1f} deg across 99 of 100 borders of domains"
    return Finding("director_jump", Severity.INFO, message, value=most, unit="deg")


def _where(design: Design, triangle: int) -> str:
    x, y = design.uv[design.surface.faces[triangle]].mean(axis=0)
    return f"triangle {triangle} at ({x:.2f}, {y:.2f}) mm"
