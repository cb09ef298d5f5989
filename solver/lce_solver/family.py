"""Within the family of flat sheets with the same metric, the one whose director lets the twist carry the bending.

A metric has many solutions, two free functions of one variable. A twist bends along the diagonals of the director's
frame, so what it leaves of the target's bending depends on the solution. With mean curvature H, half the difference D
of the principal curvatures, and the angle from the first principal direction to the director, psi, it leaves
``2 H^2 + 2 D^2 cos^2(2 psi)``, of which only the second part can be chosen.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from lce_solver import descent, judge
from lce_solver.geometry import area_vectors, face_areas
from lce_solver.metric import DEFAULT, METHODS, Objective, Stop, as_complex, objective, refine
from lce_solver.mirror import twins
from lce_solver.smoothness import jumps
from lce_solver.twist import bending_left, bending_tensor, pull_back
from lce_solver.types import Flattening, Floats, Ints, Material, Status, Surface
from lce_solver.wirtinger import Complexes, Operator, operator

WEIGHTS = (1e-2, 1e-3, 1e-4)
"""Of the bending left over, against the metric's error, one after the other; the last is what the result has. Some
targets do better without the first ones, which tear their directors into regions, so each tail is tried."""
ROUGH = 1e-6
"""Relative decrease per iteration at which the descents before the last end."""
SYMMETRIC = 1e-6
"""Distance of mirrored vertices, in sizes of the sheet, below which a sheet is symmetric."""
TINY = 1e-9
"""Stands for the size of a and b where they vanish and have no direction."""


@dataclass(frozen=True, eq=False)
class Bent:
    """What a solution leaves of the target's bending, as far as it can be chosen."""

    weight: Floats
    """(n_f,) D^2 times the area, over the sum of (2 H^2 + 2 D^2) times the area."""
    direction: Complexes
    """(n_f,) the same times exp(-4 i phi), phi the first principal direction in the triangle's own plane."""


def steer(
    surface: Surface, flat: Flattening, material: Material, stop: Stop = DEFAULT, *, smoothing: float = 0.0
) -> Flattening:
    """The best of ``flat`` and its neighbours in the family, by rms of the stretches x share of bending left.

    A symmetric flattening stays symmetric. ``stop`` ends each descent (the first ones at `ROUGH` already).
    ``smoothing`` is the weight of the squared `smoothness.jumps`.
    """
    if flat.status is not Status.CONVERGED:
        return flat
    stretches = material.along, material.across
    op, bent = operator(surface), bent_of(surface)
    goal = objective(op, stretches, jumps(surface), smoothing)
    twin = _mirrored(surface, as_complex(flat.uv))
    found = [flat]
    for first in range(len(WEIGHTS)):
        w = as_complex(flat.uv)
        for weight in WEIGHTS[first:]:
            until = stop if weight == WEIGHTS[-1] else replace(stop, tolerance=max(stop.tolerance, ROUGH))
            w = _descend(goal, w, bent, weight=weight, twin=twin, stop=until)
        there = refine(surface, op, w, stretches, Stop(1.0, 0))  # its measures, and not a step more
        if there.status is Status.ITERATION_LIMIT:  # no faults
            energy_ = np.append(flat.energy, there.energy)
            found.append(replace(there, status=flat.status, energy=energy_, iterations=flat.iterations))
    return min(found, key=_score(surface, material))


def _mirrored(surface: Surface, w: Complexes) -> Ints | None:
    """(n_v,) each vertex's mirror image, if the flattening is symmetric about the x axis."""
    twin = twins(surface)
    return twin if twin is not None and np.abs(w[twin] - w.conj()).max() < SYMMETRIC * np.abs(w).max() else None


def _score(surface: Surface, material: Material) -> Callable[[Flattening], float]:
    area, bending = face_areas(surface), bending_tensor(surface)

    def score(flat: Flattening) -> float:
        errors = judge.stretch_errors(judge.stretches(surface, flat.uv, material), material)
        form = pull_back(bending, judge.jacobians(surface, flat.uv))
        return judge.rms(errors, area) * bending_left(form, flat.theta, material, area)

    return score


def bent_of(surface: Surface) -> Bent:
    """The bending of the target in its triangles' planes; a flat target has none."""
    origin, p, _ = np.moveaxis(surface.vertices[surface.faces], 1, 0)
    area = area_vectors(surface)
    e1, normal = ((v / np.linalg.norm(v, axis=1, keepdims=True)) for v in (p - origin, area))
    frame = np.stack([e1, np.cross(normal, e1)], axis=2)
    form = frame.transpose(0, 2, 1) @ bending_tensor(surface) @ frame
    mean, deviator = (form[:, 0, 0] + form[:, 1, 1]) / 2, (form[:, 0, 0] - form[:, 1, 1]) / 2 + 1j * form[:, 0, 1]
    share = face_areas(surface)
    whole = share @ (2 * mean**2 + 2 * np.abs(deviator) ** 2)
    share = share / whole if whole > 0 else 0 * share
    return Bent(share * np.abs(deviator) ** 2, share * deviator.conj() ** 2)


def left(op: Operator, w: Complexes, bent: Bent) -> tuple[float, Complexes]:
    """Share of the bending (squared) that can be chosen and is left over, and its gradient dE/du + i dE/dv (n_v,).

    The director lies at (arg b - arg a) / 2 in the triangle's plane, or at right angles to that: here it is the same.
    """
    a, b = np.split(op.derivative @ w, 2)
    size_a, size_b = np.maximum(np.abs(a), TINY), np.maximum(np.abs(b), TINY)
    aligned = (b / size_b * (a / size_a).conj()) ** 2 * bent.direction
    turn = -2 * aligned.imag  # derivative with respect to arg b, and less that to arg a
    gradient = op.adjoint @ np.concatenate([-1j * a / size_a**2 * turn, 1j * b / size_b**2 * turn])
    return float(np.sum(bent.weight + aligned.real)), gradient


def _descend(goal: Objective, w: Complexes, bent: Bent, *, weight: float, twin: Ints | None, stop: Stop) -> Complexes:
    def function(x: Complexes) -> tuple[float, Complexes]:
        (metric, first), (bending, second) = goal(x), left(goal.operator, x, bent)
        gradient = first + weight * second
        return metric + weight * bending, gradient if twin is None else (gradient + gradient[twin].conj()) / 2

    method = METHODS["lbfgs"]
    return descent.minimise(
        function,
        descent.start(w),
        goal.inverse,
        method=method,
        tolerance=stop.tolerance,
        max_iterations=stop.max_iterations,
        tick=descent.unheard,
    ).x
