"""Minimisation: limited-memory BFGS whose first guess of the inverse Hessian is the caller's."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg.lapack import dtrtrs

from lce_solver.types import Floats

Complexes = NDArray[np.complex128]
Function = Callable[[Complexes], tuple[float, Complexes]]
"""Value and gradient, the latter as d/dx + i d/dy."""
Inverse = Callable[[Complexes], Complexes]
Tick = Callable[[int, float], None]
"""Called before each iteration with its number and the value reached; it may raise to stop the work."""

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


class Memory:
    """The last steps of a descent and the changes of the gradient that they made, at most ``size`` pairs.

    The inverse Hessian that they imply is applied in closed form: a few products of tall matrices and two triangular
    systems of that size (Byrd, Nocedal and Schnabel, Math. Program. 63, 129 (1994)), not a loop over long vectors.
    """

    def __init__(self, size: int, n: int) -> None:
        self._steps, self._changes = np.empty((size, 2 * n)), np.empty((size, 2 * n))
        self._products = np.zeros((size, size))
        """[i, j] step i times change j, in the order of storage."""
        self._order: list[int] = []
        """Places in storage from the oldest pair to the newest."""

    def __len__(self) -> int:
        return len(self._order)

    def clear(self) -> None:
        """Forget all."""
        self._order.clear()

    def add(self, step: Complexes, change: Complexes) -> None:
        """Remember a pair in place of the oldest, if the function curves upwards along it."""
        s, y = step.view(np.float64), change.view(np.float64)
        if not len(self._steps) or _product(s, y) <= 0:
            return
        full = len(self._order) == len(self._steps)
        place = self._order.pop(0) if full else len(self._order)
        self._order.append(place)
        self._steps[place], self._changes[place] = s, y
        used = len(self._order)
        self._products[place, :used] = _times(self._changes[:used], s)
        self._products[:used, place] = _times(self._steps[:used], y)

    def downhill(self, gradient: Complexes, inverse: Inverse, stride: float) -> Complexes:
        """Minus the inverse Hessian times the gradient; without memory the plain ``-inverse(gradient)``."""
        if not self._order:
            return -inverse(gradient)
        used = len(self._order)
        steps, changes = self._steps[:used], self._changes[:used]
        products = self._products[np.ix_(self._order, self._order)]
        curvature, upper = np.diag(products), np.triu(products)
        g = gradient.view(np.float64)
        ahead = np.empty(used)
        ahead[self._order] = dtrtrs(upper, _times(steps, g)[self._order])[0]
        q = stride * inverse((g - _sum(ahead, changes)).view(np.complex128)).view(np.float64)
        behind = curvature * ahead[self._order] - _times(changes, q)[self._order]
        back = np.empty(used)
        back[self._order] = dtrtrs(upper, behind, trans=1)[0]
        direction: Complexes = -(q + _sum(back, steps)).view(np.complex128)
        return direction


def _product(x: Floats, y: Floats) -> float:
    """Scalar product. Not by BLAS: its threads cost more than they save here, and would change the last digits."""
    return float(np.einsum("i,i->", x, y))


def _times(rows: Floats, x: Floats) -> Floats:
    """(k,) scalar products of ``rows`` (k, n) with ``x``."""
    return np.asarray(np.einsum("ki,i->k", rows, x))


def _sum(factors: Floats, rows: Floats) -> Floats:
    """(n,) sum of the ``rows`` (k, n), each times its factor."""
    return np.asarray(np.einsum("k,ki->i", factors, rows))


@dataclass(frozen=True, eq=False)
class Minimum:
    """Where a descent stopped; it can go on from here as if it had not stopped."""

    x: Complexes
    history: Floats
    """(iterations + 1,) values; empty before the first."""
    converged: bool
    memory: Memory | None = None


def start(x: Complexes) -> Minimum:
    """A descent that has not begun."""
    return Minimum(x, np.empty(0), converged=False)


@dataclass(frozen=True, eq=False)
class _Point:
    x: Complexes
    value: float
    gradient: Complexes


def unheard(iteration: int, value: float) -> None:
    """The `Tick` that does nothing."""


def minimise(
    function: Function,
    begin: Minimum,
    inverse: Inverse,
    *,
    method: Method,
    tolerance: float,
    max_iterations: int,
    tick: Tick,
) -> Minimum:
    """Descend from ``begin`` until the relative decrease per iteration stays below ``tolerance``.

    Parameters
    ----------
    inverse : product with the inverse of a positive model of the Hessian.
    max_iterations : of the whole descent, with those behind ``begin``.
    """
    point = _Point(begin.x, *function(begin.x))
    history = begin.history.tolist() or [point.value]
    memory = begin.memory or Memory(method.memory, len(point.x))
    while np.isfinite(point.value) and len(history) <= max_iterations:
        tick(len(history) - 1, point.value)
        after = _search(function, point, memory.downhill(point.gradient, inverse, method.stride))
        if after is None and len(memory):
            memory.clear()  # it is stale: begin again from the plain step
            continue
        if after is None:
            return Minimum(point.x, np.array(history), converged=True)  # no decrease that floats can show
        memory.add(after.x - point.x, after.gradient - point.gradient)
        point = after
        history.append(point.value)
        if _settled(history, tolerance):
            return Minimum(point.x, np.array(history), converged=True, memory=memory)
    return Minimum(point.x, np.array(history), converged=False, memory=memory)


def _settled(history: list[float], tolerance: float) -> bool:
    decrease = history[-1 - WINDOW] - history[-1] if len(history) > WINDOW else np.inf
    return decrease <= WINDOW * tolerance * abs(history[-1]) + FLOOR  # rounding makes zeros negative


def _search(function: Function, start: _Point, direction: Complexes) -> _Point | None:
    """Bisect for a step with the weak Wolfe conditions; ``None`` when nothing decreases."""
    slope = _slope(start, direction)
    low, high, length = 0.0, np.inf, 1.0
    best = None
    for _ in range(TRIALS if slope < 0 else 0):
        x = start.x + length * direction
        trial = _Point(x, *function(x))
        if not trial.value <= start.value + SUFFICIENT * length * slope:  # also when it is not a number
            high = length
        elif _slope(trial, direction) < CURVED * slope:
            low, best = length, trial
        else:
            return trial
        length = (low + high) / 2 if np.isfinite(high) else 2 * low
    return best


def _slope(point: _Point, direction: Complexes) -> float:
    return _product(point.gradient.view(np.float64), direction.view(np.float64))
