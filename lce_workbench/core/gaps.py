"""The smallest gap between convex polygons, found among near ones only."""

from __future__ import annotations

import numpy as np

from lce_solver.types import Floats, Ints

TILE = 20_000.0
"""Side of the tiles in which neighbours are looked for [nm]."""

SEEN = 500.0
"""Gaps up to this are found whatever tile they lie in [nm]."""

PAIRS = 200_000
"""Pairs measured at once."""


def smallest_gap(polygons: Floats) -> float:
    """Smallest gap between any two of the polygons (n, k, 2), negative where they overlap; at most ``SEEN`` [nm].

    The gap is the largest distance along the normal of an edge of either: the true distance where an edge faces the
    other polygon, less than it between two corners.
    """
    found = SEEN
    first, second = _near(polygons)
    for start in range(0, len(first), PAIRS):
        a, b = (polygons[owner[start : start + PAIRS]] for owner in (first, second))
        found = min(found, float(np.maximum(_apart(a, b), _apart(b, a)).min()))
    return found


def _apart(a: Floats, b: Floats) -> Floats:
    """Largest distance (n,) of polygons ``b`` (n, k, 2) beyond an edge of counter-clockwise polygons ``a``."""
    edge = np.roll(a, -1, axis=1) - a
    best = np.full(len(a), -np.inf)
    for i in range(a.shape[1]):
        x, y = edge[:, i].T
        across = y[:, None] * (b[..., 0] - a[:, i, None, 0]) - x[:, None] * (b[..., 1] - a[:, i, None, 1])
        best = np.maximum(best, across.min(axis=1) / np.maximum(np.hypot(x, y), 1.0))
    return best


def _near(polygons: Floats) -> tuple[Ints, Ints]:
    """Pairs (n,) (n,) of polygons whose bounding boxes, grown by half of `SEEN`, meet."""
    low, high = polygons.min(axis=1) - SEEN / 2, polygons.max(axis=1) + SEEN / 2
    owner, tile = _tiles(low, high)
    order = np.argsort(tile, kind="stable")
    owner, tile = owner[order], tile[order]
    pairs = []
    for step in range(1, len(owner)):
        same = tile[step:] == tile[:-step]
        if not same.any():
            break
        a, b = owner[:-step][same], owner[step:][same]
        meet = np.all((low[a] <= high[b]) & (low[b] <= high[a]), axis=1)
        pairs.append(a[meet] * len(polygons) + b[meet])
    first, second = np.divmod(np.unique(np.concatenate(pairs or [np.empty(0, np.int64)])), len(polygons))
    return first, second


def _tiles(low: Floats, high: Floats) -> tuple[Ints, Ints]:
    """Every tile that each box touches: index of the box, number of the tile."""
    start, stop = (np.floor((p - low.min(axis=0)) / TILE).astype(np.int64) for p in (low, high))
    size = stop - start + 1
    total = size[:, 0] * size[:, 1]
    owner = np.repeat(np.arange(len(low)), total)
    place = np.arange(len(owner)) - np.repeat(np.cumsum(total) - total, total)
    column, row = np.divmod(place, size[owner, 1])
    columns = start[owner, 0] + column
    return owner, columns * (int(stop[:, 1].max(initial=0)) + 1) + start[owner, 1] + row
