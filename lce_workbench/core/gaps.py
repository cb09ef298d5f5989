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


def smallest_gap(quadrilaterals: Floats) -> float:
    """Smallest gap between any two of convex (n, 4, 2), negative where they overlap; at most ``SEEN`` [nm].

    The gap is the largest distance along the normal of an edge of either: the true distance where an edge faces the
    other polygon, less than it between two corners.
    """
    found = SEEN
    polygons, whole = _cut(quadrilaterals)
    first, second = _near(polygons, whole)
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


def _cut(quadrilaterals: Floats) -> tuple[Floats, Ints]:
    """Pieces (m, 4, 2), cut across edge 0, whose bounding boxes are about a tile, and what each is a piece of (m,)."""
    box = np.ptp(quadrilaterals, axis=1).min(axis=1)
    pieces = np.ceil(np.maximum(box / TILE, 1.0)).astype(np.int64)
    whole = np.repeat(np.arange(len(pieces)), pieces)
    place = np.arange(len(whole)) - np.repeat(np.cumsum(pieces) - pieces, pieces)
    start, stop = ((place + i) / pieces[whole] for i in (0, 1))
    a, b, c, d = (quadrilaterals[whole, i] for i in range(4))
    corners = [p + (q - p) * t[:, None] for p, q, t in ((a, b, start), (a, b, stop), (d, c, stop), (d, c, start))]
    return np.stack(corners, axis=1), whole


def _near(polygons: Floats, whole: Ints) -> tuple[Ints, Ints]:
    """Pairs (n,) (n,) of pieces of different polygons whose bounding boxes, grown by half of `SEEN`, meet."""
    low, high = polygons.min(axis=1) - SEEN / 2, polygons.max(axis=1) + SEEN / 2
    low, high = low - low.min(axis=0), high - low.min(axis=0)
    owner, tile = _tiles(low, high)
    order = np.argsort(tile[:, 0] * (tile[:, 1].max(initial=0) + 1) + tile[:, 1], kind="stable")
    owner, tile = owner[order], tile[order]
    pairs = []
    for step in range(1, len(owner)):
        same = np.all(tile[step:] == tile[:-step], axis=1)
        if not same.any():
            break
        a, b = owner[:-step][same], owner[step:][same]
        overlap = np.maximum(low[a], low[b])
        once = np.all(np.floor(overlap / TILE) == tile[step:][same], axis=1)  # not again in each tile they share
        meet = once & (whole[a] != whole[b]) & np.all(overlap <= np.minimum(high[a], high[b]), axis=1)
        pairs.append(np.stack([a[meet], b[meet]]))
    first, second = np.concatenate(pairs or [np.empty((2, 0), np.int64)], axis=1)
    return first, second


def _tiles(low: Floats, high: Floats) -> tuple[Ints, Ints]:
    """Every tile that each box touches: index of the box (n,), column and row of the tile (n, 2)."""
    start, stop = (np.floor(p / TILE).astype(np.int64) for p in (low, high))
    size = stop - start + 1
    total = size[:, 0] * size[:, 1]
    owner = np.repeat(np.arange(len(low)), total)
    place = np.arange(len(owner)) - np.repeat(np.cumsum(total) - total, total)
    column, row = np.divmod(place, size[owner, 1])
    return owner, start[owner] + np.stack([column, row], axis=1)
