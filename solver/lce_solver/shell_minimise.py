"""Preconditioned L-BFGS: a semi-definite Hessian, factorised now and then, and the curvature met in the last steps."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from lce_solver.errors import SolverError
from lce_solver.types import Floats, Status

MEMORY = 10
REFRESH = 12
"""Iterations between factorisations."""
PATIENCE = 3
"""A step that had to be cut brings the next factorisation forward, to no fewer iterations than this."""
SUFFICIENT = 1e-4
"""Share of the predicted decrease that a step must achieve (Armijo)."""
SHORTEST = 1e-8
"""A step cut below this fraction is given up."""

Energy = Callable[[Floats], tuple[float, Floats]]
Solve = Callable[[Floats], Floats]


@dataclass(frozen=True, eq=False)
class Minimum:
    """Where the minimisation stopped, and why."""

    x: Floats
    """(n_v, 3) [mm]."""
    energy: float
    status: Status
    iterations: int
    factorisations: int
    decrement: float
    """Energy that a further step was expected to save."""


@dataclass(frozen=True, eq=False)
class _Point:
    x: Floats
    energy: float
    gradient: Floats


def minimise(
    energy: Energy,
    factorise: Callable[[Floats], Solve],
    x: Floats,
    *,
    tolerance: float,
    longest: float,
    limit: int,
    watch: Callable[[float], None],
) -> Minimum:
    """Minimise from ``x`` (n_v, 3) until a step is expected to save less than ``tolerance``, an energy.

    ``factorise(x)`` returns the solver of a positive definite approximation of the Hessian; where it raises
    `SolverError`, a triangle has collapsed, and the sheet is stuck. No vertex moves further than ``longest`` [mm] in
    one step. ``watch`` is called with the energy before every step and may raise.
    """
    at = _Point(x, *energy(x))
    if not np.isfinite(at.energy):
        return Minimum(x, at.energy, Status.NOT_FINITE, 0, 0, np.nan)
    pairs: deque[tuple[Floats, Floats]] = deque(maxlen=MEMORY)
    solve, age, factorisations, saving = _solver(factorise, x), 0, 1, np.inf
    for iteration in range(limit):
        if solve is None:
            return Minimum(at.x, at.energy, Status.STALLED, iteration, factorisations, saving)
        step = _direction(solve, pairs, at.gradient)
        saving = -float(np.vdot(at.gradient, step)) / 2
        watch(at.energy)
        if saving < tolerance:
            return Minimum(at.x, at.energy, Status.CONVERGED, iteration, factorisations, saving)
        found, fraction = _search(energy, at, step, saving, longest)
        if found is None and age == 0 and not pairs:
            return Minimum(at.x, at.energy, Status.STALLED, iteration, factorisations, saving)
        if found is None:
            pairs.clear()
        else:
            _remember(pairs, found.x - at.x, found.gradient - at.gradient)
            at = found
        age += 1
        if found is None or (fraction < 1 and age >= PATIENCE) or age >= REFRESH:
            solve, age, factorisations = _solver(factorise, at.x), 0, factorisations + 1
    return Minimum(at.x, at.energy, Status.ITERATION_LIMIT, limit, factorisations, saving)


def _solver(factorise: Callable[[Floats], Solve], x: Floats) -> Solve | None:
    """None where the approximation is singular."""
    try:
        return factorise(x)
    except SolverError:
        return None


def _direction(solve: Solve, pairs: deque[tuple[Floats, Floats]], gradient: Floats) -> Floats:
    """Two-loop recursion (Nocedal and Wright, algorithm 7.4) around the factorised Hessian."""
    step, weights = -gradient, []
    for moved, turned in reversed(pairs):
        weights.append(float(np.vdot(moved, step) / np.vdot(moved, turned)))
        step = step - weights[-1] * turned
    step = solve(step)
    for (moved, turned), weight in zip(pairs, reversed(weights), strict=True):
        step = step + (weight - float(np.vdot(turned, step) / np.vdot(moved, turned))) * moved
    return step


def _remember(pairs: deque[tuple[Floats, Floats]], moved: Floats, turned: Floats) -> None:
    """Keep a step if the energy curves upwards along it: only such steps keep the direction one of descent."""
    if np.vdot(moved, turned) > 1e-10 * np.linalg.norm(moved) * np.linalg.norm(turned):
        pairs.append((moved, turned))


def _search(energy: Energy, at: _Point, step: Floats, saving: float, longest: float) -> tuple[_Point | None, float]:
    """Backtrack until the energy falls enough; return the point, if there is one, and the fraction of the step."""
    fraction = min(1.0, longest / float(np.linalg.norm(step, axis=1).max()))
    while fraction > SHORTEST:
        x = at.x + fraction * step
        found = _Point(x, *energy(x))
        drop = at.energy - found.energy
        if drop >= SUFFICIENT * 2 * saving * fraction:
            return found, fraction
        # the parabola through the two energies and the slope has its minimum here; NaN takes the smallest fraction
        cut = fraction * saving / (2 * saving * fraction - drop) if np.isfinite(drop) else 0.0
        fraction *= float(np.clip(cut, 0.1, 0.5))
    return None, 0.0
