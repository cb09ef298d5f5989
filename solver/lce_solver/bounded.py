"""Twist that a film can follow: filtered over a few thicknesses, capped where the material has been shown to work."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy import sparse
from scipy.sparse.linalg import splu

from lce_solver.geometry import face_areas
from lce_solver.topology import half_edges, neighbours
from lce_solver.twist import FLAT, edge_factor, in_director_frame, twist, twisted_form
from lce_solver.types import Design, Finding, Floats, Ints, Severity

FOLLOWED = 3.0
"""Thicknesses over which a film evens out its bending: a plate's edge effects reach about that far."""
COSTLY = 0.05
"""Part of the target's bending from which on what filter and cap take away is a warning."""
USELESS = 0.5
"""Part of the bending in reach of twist below which what is left of the twist is of no use."""


def retwisted(
    plan: Design,
    form: Floats,
    thickness: float,
    *,
    twist_gain: float = 1.0,
    edge_overdrive: bool = False,
    twist_filter: float = FOLLOWED,
    twist_limit: float = np.inf,
) -> Design:
    """The design for a film of another ``thickness`` [mm], gain or limit: its metric, and the twist anew.

    Flat sheet and director depend on none of them. ``form`` is the `second_form` of the design; the others are as for
    `lce_solver.design.design`. The findings are left as they were.
    """
    thicker = replace(plan, thickness=thickness)
    length = twist_filter * thickness
    found = bounded_twist(
        form, thicker, gain=twist_gain, overdrive=edge_overdrive, filter_length=length, limit=twist_limit
    )
    return replace(thicker, dtheta=found)


def bounded_twist(
    form: Floats, plan: Design, *, gain: float, overdrive: bool, filter_length: float, limit: float
) -> Floats:
    """(n_f,) the twist of the filtered second form, times ``gain``, cut off at ``limit`` [rad].

    Parameters
    ----------
    form : (n_f, 2, 2) the target's second form in sheet coordinates [1 / mm].
    plan : the design but for its twist.
    overdrive : multiply by the paper's factor near the edge.
    filter_length : standard deviation of the filter [mm].
    """
    factor = gain * (edge_factor(plan.uv, plan.surface.faces) if overdrive else 1.0)
    smooth = filtered(form, plan.uv, plan.surface.faces, filter_length)
    return np.clip(factor * twist(smooth, plan.theta, plan.material, plan.thickness), -limit, limit)


def filtered(values: Floats, uv: Floats, faces: Ints, length: float) -> Floats:
    """Smooth (n_f, ...) values on the sheet's triangles as diffusion does, with standard deviation ``length``.

    One implicit step on the graph of adjacent triangles: integrals stay, and no value leaves the range of the old ones.
    """
    if length == 0:
        return values
    half, _ = neighbours(faces)
    pair = half.T % len(faces)
    ends = uv[half_edges(faces)[half[:, 0]]]
    middle = uv[faces].mean(axis=1)
    side = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
    flow = side / np.linalg.norm(middle[pair[0]] - middle[pair[1]], axis=1)
    graph = sparse.coo_array((flow, tuple(pair)), shape=(len(faces), len(faces)))
    graph = (graph + graph.T).tocsr()
    area = np.linalg.det(np.diff(uv[faces], axis=1)) / 2
    spread = sparse.diags(graph @ np.ones(len(faces))) - graph
    matrix = (sparse.diags(area) + length**2 / 2 * spread).tocsc()
    flat = values.reshape(len(faces), -1)
    solution: Floats = splu(matrix).solve(area[:, None] * flat).reshape(values.shape)
    return solution


def bending_missed(form: Floats, dtheta: Floats, plan: Design) -> float:
    """Part of the bending, measured as in `bending_left`, that a twist (n_f,) leaves to the metric."""
    stretch = np.array([plan.material.along, plan.material.across])
    left = form - twisted_form(dtheta, plan.theta, plan.material, plan.thickness)
    area = face_areas(plan.surface)
    whole, rest = (
        area @ ((in_director_frame(f, plan.theta) / np.outer(stretch, stretch)) ** 2).sum(axis=(1, 2))
        for f in (form, left)
    )
    return float(np.sqrt(rest / whole)) if whole > FLAT**2 else 0.0


def cost(form: Floats, plan: Design, limit: float) -> Finding:
    """What filter and cap cost: how much more of the target's bending is left than with the pointwise best twist."""
    best = twist(form, plan.theta, plan.material, plan.thickness)
    left, least = (bending_missed(form, dtheta, plan) for dtheta in (plan.dtheta, best))
    capped = int((np.abs(plan.dtheta) >= limit).sum())
    message = (
        f"the pointwise best twist peaks at {np.rad2deg(np.abs(best).max()):.2f} deg and leaves {least:.1%} of the "
        f"bending to the metric; filtered, and capped in {capped} of {len(best)} triangles, it leaves {left:.1%}"
    )
    severe = left - least > COSTLY
    if severe:
        message += "; make the sheet wider or the film thinner, or raise sheet.twist_limit_deg"
    if 1 - left < USELESS * (1 - least):
        message += "; so little twist hardly bends the sheet: choose lambda further from 1"
    return Finding("twist_cost", Severity.WARNING if severe else Severity.INFO, message, left - least, COSTLY)
