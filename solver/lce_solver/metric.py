"""Inverse design of the metric: flat coordinates and director such that heating gives the target (the paper, S1-S3)."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial

import numpy as np
from scipy import sparse

from lce_solver import judge
from lce_solver.descent import Inverse, Method, Minimum, Tick, minimise, start, unheard
from lce_solver.mirror import twins
from lce_solver.plane import axis_along_x, convex_map, long_side_along_x
from lce_solver.topology import boundary_loops
from lce_solver.types import Flattening, Floats, Ints, Status, Surface
from lce_solver.wirtinger import Complexes, Operator, Term, director, energy, inverse, operator, stretched

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


@dataclass(frozen=True)
class Stop:
    """When a minimisation ends."""

    tolerance: float = 1e-8
    """Relative decrease of the energy per iteration."""
    max_iterations: int = 5000


DEFAULT = Stop()


@dataclass(frozen=True, eq=False)
class Objective:
    """What a descent minimises on one mesh: the energy of the stretches and, if wanted, the director's roughness."""

    operator: Operator
    stretches: Stretches
    inverse: Inverse
    """Of a positive model of the Hessian."""
    more: Term | None = None
    """As in `wirtinger.energy`."""

    def __call__(self, x: Complexes) -> tuple[float, Complexes]:
        """Value and gradient."""
        return energy(self.operator, x, self.stretches, self.more)


def objective(
    op: Operator, stretches: Stretches, jumps: sparse.csr_array | None = None, smoothing: float = 0.0
) -> Objective:
    """The objective with its preconditioner, which models every triangle as stiff in all directions.

    Parameters
    ----------
    jumps : as `smoothness.jumps`.
    smoothing : weight of their sum of squares.
    """
    if jumps is None or smoothing == 0:
        return Objective(op, stretches, op.solve)
    scaled = np.sqrt(2 * smoothing) * jumps
    back = scaled.conj().T.tocsr()
    stiffness = op.stiffness + (op.adjoint @ (back @ scaled) @ op.derivative).real

    def roughness(ab: Complexes) -> tuple[float, Complexes]:
        jump = scaled @ ab
        parts = jump.view(np.float64)
        return float(np.einsum("i,i->", parts, parts)) / 2, back @ jump

    return Objective(op, stretches, inverse(stiffness), roughness)


@dataclass(frozen=True, eq=False)
class Rigid:
    """What all starts share: the target laid flat as rigidly as it goes."""

    surface: Surface
    operator: Operator
    w: Complexes
    """(n_v,) flat coordinates; their mirror axis lies along x, or the long side of their smallest rectangle."""
    twins: Ints | None
    """(n_v,) each vertex's mirror image, if the mesh is symmetric vertex by vertex."""


def lay_flat(surface: Surface) -> Rigid:
    """Map the disk to a circle (always valid), then minimise the same energy with both stretches 1."""
    op = operator(surface)
    w = descend(objective(op, ISOMETRIC), start(as_complex(convex_map(surface))), Stop(ROUGH)).x
    twin = twins(surface)
    aligned = as_complex(long_side_along_x(as_points(w))) if twin is None else axis_along_x(w, twin)
    return Rigid(surface, op, aligned, twin)


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
    tick : called before each iteration with its number and the energy; it may raise to stop.
    """
    begin = stretched(rigid.w, stretches, angle)
    return refine(rigid.surface, rigid.operator, begin, stretches, stop, method=method, twin=rigid.twins, tick=tick)


def refine(
    surface: Surface,
    op: Operator,
    begin: Complexes,
    stretches: Stretches,
    stop: Stop = DEFAULT,
    *,
    method: str = "lbfgs",
    twin: Ints | None = None,
    tick: Tick = unheard,
) -> Flattening:
    """Minimise the energy from any flat coordinates ``begin`` (n_v,), u + i v.

    Parameters
    ----------
    twin : (n_v,) each vertex's mirror image, to keep a symmetric start symmetric against rounding.
    """
    found = descend(objective(op, stretches), start(begin), stop, method=method, twin=twin, tick=tick)
    return flattening(surface, op, found, stretches)


def flattening(surface: Surface, op: Operator, found: Minimum, stretches: Stretches) -> Flattening:
    """What a descent found, with its director and its faults."""
    uv = as_points(found.x)
    finite = bool(np.isfinite(found.history[-1]))
    flipped = judge.flipped(uv, surface.faces)
    crossings = _outline_crossings(uv, surface.faces) if finite else np.empty((0, 2), np.int64)
    return Flattening(
        uv=uv,
        theta=director(op, found.x, stretches),
        status=_status(finite, len(flipped), len(crossings), found.converged),
        energy=found.history,
        iterations=len(found.history) - 1,
        flipped=flipped,
        crossings=crossings,
    )


local_global = partial(flatten, method="local_global")
"""The paper's method (Liu et al. 2008): same start, same energy, same answer, many more iterations."""


def descend(
    goal: Objective,
    begin: Minimum,
    stop: Stop = DEFAULT,
    *,
    method: str = "lbfgs",
    twin: Ints | None = None,
    tick: Tick = unheard,
) -> Minimum:
    """Minimise from ``begin``, or go on with the descent that stopped there; ``twin`` as in `refine`."""

    def function(x: Complexes) -> tuple[float, Complexes]:
        value, gradient = goal(x)
        return value, gradient if twin is None else (gradient + gradient[twin].conj()) / 2

    return minimise(
        function,
        begin,
        goal.inverse,
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


def as_complex(uv: Floats) -> Complexes:
    """(n,) u + i v of (n, 2) points."""
    return uv[:, 0] + 1j * uv[:, 1]


def as_points(w: Complexes) -> Floats:
    """(n, 2) points of (n,) u + i v."""
    return np.column_stack([w.real, w.imag])
