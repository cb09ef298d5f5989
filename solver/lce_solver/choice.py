"""Which finalist is made: the best one whose sheet, corrected and heated from flat, takes the target's shape."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

import numpy as np

from lce_solver.arrive import LOST, arrive
from lce_solver.types import Design, Finding, Progress, silent

HEATED = 3
"""Most finalists that are heated."""


def arriving(plans: Iterable[Design], part: str, limit: float, progress: Progress = silent) -> tuple[Design, Finding]:
    """The first design that ends within `arrive.LOST` of its target, corrected; if none does, the nearest.

    Parameters
    ----------
    plans : of one target, the best first; those after the one that arrives are not asked for.
    part, limit : as for `arrive.arrive`.
    """
    tried: list[tuple[Design, Finding]] = []
    for plan, _ in zip(plans, range(HEATED), strict=False):
        made, told = arrive(plan, part, limit, progress)
        tried.append((made, told))
        if told.value is None or told.value <= LOST:  # without a value it was not heated at all
            break
    best, told = min(tried, key=lambda one: _distance(one[1]))
    heated = {_angle(plan): _distance(said) for plan, said in tried}
    starts = tuple(replace(start, heated_pct=heated.get(start.angle, np.inf)) for start in best.starts)
    return replace(best, starts=starts), told if len(tried) == 1 else _compared(told, tried)


def _distance(told: Finding) -> float:
    return np.inf if told.value is None else told.value


def _angle(plan: Design) -> float | None:
    """Of the start that the design is made of."""
    return next((start.angle for start in plan.starts if start.winner), None)


def _compared(told: Finding, tried: list[tuple[Design, Finding]]) -> Finding:
    each = ", ".join(f"{np.degrees(_angle(plan) or 0.0):.0f} deg {_distance(said):.2g}%" for plan, said in tried)
    text = f"{told.message}; of {len(tried)} finalists it comes nearest (start at {each})"
    return replace(told, message=text)
