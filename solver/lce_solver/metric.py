"""Inverse design of the metric: flat coordinates and director such that heating gives the target (the paper, S1-S3)."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial

import numpy as np

from lce_solver import judge
from lce_solver.descent import Method, Minimum, Tick, minimise, unheard
from lce_solver.geometry import face_areas
from lce_solver.plane import convex_map, long_side_along_x
from lce_solver.topology import boundary_loops
from lce_solver.twist import bending_left, bending_tensor, pull_back
from lce_solver.types import Flattening, Floats, Ints, Material, Progress, Start, Status, Surface, silent
from lce_solver.wirtinger import Complexes, Operator, director, energy, operator, stretched

Stretches = tuple[float, float]
"""Wanted stretches sheet -> target, along and across the director."""

METHODS = {"lbfgs": Method(memory=10, stride=4.0), "local_global": Method(memory=0, stride=1.0)}
"""The Laplacian models every term as stiff in all directions, but each is stiff in one of two: hence long strides.

Without memory the step is the global step of the paper's local/global method (its local step is in the energy).
"""
ISOMETRIC: Stretches = (1.0, 1.0)
"""With these stretches the energy is that of an as-rigid-as-possible map."""
ROUGH = 1e-6
"""Tolerance of the as-rigid-as-possible map: the director's stretch changes it anyway."""
TYPICAL = 300
"""Iterations of one start, for the progress bar only."""
TIE = 1e-6
"""Scores as close as this are equal (symmetric targets); the smaller angle wins, so that the result is repeatable."""


@dataclass(frozen=True)
class Stop:
    """When a minimisation ends."""

    tolerance: float = 1e-8
    """Relative decrease of the energy per iteration."""
    max_iterations: int = 5000


DEFAULT = Stop()


@dataclass(frozen=True, eq=False)
class Rigid:
    """What all starts share: the target laid flat as rigidly as it goes."""

    surface: Surface
    operator: Operator
    w: Complexes
    """(n_v,) flat coordinates; the long side of their smallest rectangle lies along x."""


def lay_flat(surface: Surface) -> Rigid:
    """Map the disk to a circle (always valid), then minimise the same energy with both stretches 1."""
    op = operator(surface)
    w = _descend(op, _complex(convex_map(surface)), ISOMETRIC, method="lbfgs", stop=Stop(ROUGH)).x
    return Rigid(surface, op, _complex(long_side_along_x(_plane(w))))


def flatten(
    rigid: Rigid,
    stretches: Stretches,
    angle: float,
    stop: Stop = DEFAULT,
    *,
    method: str = "lbfgs",
    tick: Tick = unheard,
) -> Flattening:
    """Minimise the energy from one start: the rigid map, stretched by ``1/along`` in the direction ``angle``.

    Parameters
    ----------
    angle : direction of the first guess of the director, from the long side of the rigid map [rad].
    method : a name in `METHODS`; ``local_global`` is the paper's.
    tick : called before each iteration with its number; it may raise to stop.
    """
    start = stretched(rigid.w, stretches, angle)
    found = _descend(rigid.operator, start, stretches, method=method, stop=stop, tick=tick)
    uv = _plane(found.x)
    finite = bool(np.isfinite(found.history[-1]))
    flipped = judge.flipped(uv, rigid.surface.faces)
    crossings = _outline_crossings(uv, rigid.surface.faces) if finite else np.empty((0, 2), np.int64)
    return Flattening(
        uv=uv,
        theta=director(rigid.operator, found.x, stretches),
        status=_status(finite, len(flipped), len(crossings), found.converged),
        energy=found.history,
        iterations=len(found.history) - 1,
        flipped=flipped,
        crossings=crossings,
    )


local_global = partial(flatten, method="local_global")
"""The paper's method (Liu et al. 2008): same start, same energy, same answer, many more iterations."""


def compete(
    surface: Surface, material: Material, starts: int = 12, stop: Stop = DEFAULT, progress: Progress = silent
) -> tuple[Flattening, tuple[Start, ...]]:
    """Minimise from stretches of the plane in ``starts`` directions and take the best.

    The energy has many minima. The best has the smallest rms error x share of bending that twist cannot reach, among
    those that are valid (no flipped triangle, simple outline); if none is, the one with the fewest faults is returned.

    Returns
    -------
    The best flattening, and one record per start in the order of the angles.
    """
    rigid = lay_flat(surface)
    bending = bending_tensor(surface)
    results = []
    for k in range(starts):
        tick = partial(_report, progress, k / starts, 1 / starts)
        angle = k * np.pi / starts
        flat = flatten(rigid, (material.along, material.across), angle, stop, tick=tick)
        results.append((flat, _record(surface, flat, material, angle, bending)))
    progress("flatten", 1.0)
    return results[best([start for _, start in results])][0], tuple(start for _, start in results)


def _report(progress: Progress, done: float, share: float, iteration: int) -> None:
    progress("flatten", done + share * iteration / (iteration + TYPICAL))


def _record(surface: Surface, flat: Flattening, material: Material, angle: float, bending: Floats) -> Start:
    area = face_areas(surface)
    errors = judge.stretch_errors(judge.stretches(surface, flat.uv, material), material)
    form = pull_back(bending, judge.jacobians(surface, flat.uv))
    return Start(
        angle=angle,
        status=flat.status,
        rms=judge.rms(errors, area),
        bending_left=bending_left(form, flat.theta, material, area),
        flipped=len(flat.flipped),
        crossings=len(flat.crossings),
    )


def best(starts: list[Start]) -> int:
    """Index of the smallest score among those with the fewest faults; the first of equals."""
    faults = [start.flipped + start.crossings for start in starts]
    valid = [k for k, fault in enumerate(faults) if fault == min(faults)]
    limit = (1 + TIE) * min(starts[k].score for k in valid)
    return next(k for k in valid if starts[k].score <= limit)


def _descend(
    op: Operator,
    w: Complexes,
    stretches: Stretches,
    *,
    method: str,
    stop: Stop,
    tick: Tick = unheard,
) -> Minimum:
    return minimise(
        lambda x: energy(op, x, stretches),
        w,
        op.solve,
        method=METHODS[method],
        tolerance=stop.tolerance,
        max_iterations=stop.max_iterations,
        tick=tick,
    )


def _status(finite: bool, flipped: int, crossings: int, converged: bool) -> Status:
    if not finite:
        return Status.NOT_FINITE
    if flipped:
        return Status.FLIPPED
    if crossings:
        return Status.OVERLAP
    return Status.CONVERGED if converged else Status.ITERATION_LIMIT


def _outline_crossings(uv: Floats, faces: Ints) -> Ints:
    """(k, 2) pairs of boundary edges that cross, each named by its first vertex."""
    edges = np.concatenate([np.column_stack([loop, np.roll(loop, -1)]) for loop in boundary_loops(faces)])
    pairs: Ints = edges[judge.crossings(uv, edges), 0]
    return pairs


def _complex(uv: Floats) -> Complexes:
    return uv[:, 0] + 1j * uv[:, 1]


def _plane(w: Complexes) -> Floats:
    return np.column_stack([w.real, w.imag])
