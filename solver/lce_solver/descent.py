"""Minimisation: limited-memory BFGS whose first guess of the inverse Hessian is the caller's."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from lce_solver.types import Floats

Complexes = NDArray[np.complex128]
Function = Callable[[Complexes], tuple[float, Complexes]]
"""Value and gradient, the latter as d/dx + i d/dy."""
Inverse = Callable[[Complexes], Complexes]
Tick = Callable[[int], None]
"""Called before each iteration with its number; it may raise to stop the work."""

WINDOW = 10
"""Iterations over which the decrease is averaged: single steps of L-BFGS are uneven."""
FLOOR = 1e-30
"""A decrease below this is nothing, however small the value itself (exact solutions end at zero)."""
SUFFICIENT, CURVED, TRIALS = 1e-4, 0.9, 40
"""The line search: least decrease (Armijo), largest remaining slope (Wolfe), most evaluations."""


@dataclass(frozen=True)
class Method:
    """A way to use the inverse Hessian that the caller offers."""

    memory: int
    """Steps remembered by L-BFGS; with 0 every step is the plain ``-inverse(gradient)``."""
    stride: float
    """Multiplies the offered inverse where there is memory: more than 1 if it belongs to too stiff a model."""


@dataclass(frozen=True, eq=False)
class Minimum:
    """Where the descent stopped."""

    x: Complexes
    history: Floats
    """(iterations + 1,) values."""
    converged: bool


@dataclass(frozen=True, eq=False)
class _Point:
    x: Complexes
    value: float
    gradient: Complexes


def unheard(iteration: int) -> None:
    """The `Tick` that does nothing."""


def minimise(
    function: Function,
    x: Complexes,
    inverse: Inverse,
    *,
    method: Method,
    tolerance: float,
    max_iterations: int,
    tick: Tick,
) -> Minimum:
    """Descend from ``x`` until the relative decrease per iteration stays below ``tolerance``.

    Parameters
    ----------
    inverse : product with the inverse of a positive model of the Hessian.
    """
    point = _Point(x, *function(x))
    history = [point.value]
    pairs: deque[tuple[Complexes, Complexes, float]] = deque(maxlen=method.memory)
    while np.isfinite(point.value) and len(history) <= max_iterations:
        tick(len(history) - 1)
        downhill = -_product(pairs, inverse, method.stride, point.gradient)
        after = _search(function, point, downhill)
        if after is None and pairs:
            pairs.clear()  # the memory is stale: begin again from the plain step
            continue
        if after is None:
            return Minimum(point.x, np.array(history), converged=True)  # no decrease that floats can show
        _remember(pairs, after.x - point.x, after.gradient - point.gradient)
        point = after
        history.append(point.value)
        if _settled(history, tolerance):
            return Minimum(point.x, np.array(history), converged=True)
    return Minimum(point.x, np.array(history), converged=False)


def _settled(history: list[float], tolerance: float) -> bool:
    decrease = history[-1 - WINDOW] - history[-1] if len(history) > WINDOW else np.inf
    return decrease <= WINDOW * tolerance * history[-1] + FLOOR


def _dot(x: Complexes, y: Complexes) -> float:
    """Scalar product of two planar vector fields.

    Not by BLAS: its threads cost more than they save here, and their number would change the last digits.
    """
    return float(np.einsum("i,i->", x.view(np.float64), y.view(np.float64)))


def _remember(pairs: deque[tuple[Complexes, Complexes, float]], step: Complexes, change: Complexes) -> None:
    curvature = _dot(step, change)
    if curvature > 0:
        pairs.append((step, change, curvature))


def _product(
    pairs: deque[tuple[Complexes, Complexes, float]], inverse: Inverse, stride: float, gradient: Complexes
) -> Complexes:
    """Inverse Hessian times gradient (two-loop recursion; Nocedal and Wright, algorithm 7.4)."""
    if not pairs:
        return inverse(gradient)
    q = gradient.copy()
    shares = []
    for step, change, curvature in reversed(pairs):
        share = _dot(step, q) / curvature
        q -= share * change
        shares.append(share)
    q = stride * inverse(q)
    for (step, change, curvature), share in zip(pairs, reversed(shares), strict=True):
        q += (share - _dot(change, q) / curvature) * step
    return q


def _search(function: Function, start: _Point, direction: Complexes) -> _Point | None:
    """Bisect for a step with the weak Wolfe conditions; ``None`` when nothing decreases."""
    slope = _dot(start.gradient, direction)
    low, high, length = 0.0, np.inf, 1.0
    best = None
    for _ in range(TRIALS if slope < 0 else 0):
        x = start.x + length * direction
        trial = _Point(x, *function(x))
        if not trial.value <= start.value + SUFFICIENT * length * slope:  # also when it is not a number
            high = length
        elif _dot(trial.gradient, direction) < CURVED * slope:
            low, best = length, trial
        else:
            return trial
        length = (low + high) / 2 if np.isfinite(high) else 2 * low
    return best
