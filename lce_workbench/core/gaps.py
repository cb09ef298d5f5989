"""The smallest gap between convex polygons, found among near ones only."""

from __future__ import annotations

import numpy as np

from lce_solver.types import Floats, Ints

TILE = 40_000.0
"""Side of the tiles in which neighbours are looked for [nm]."""

CUT = 20_000.0
"""Longest box of a piece of an oblique line, along its shorter side [nm]."""

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
        found = min(found, _least(polygons, first[start : start + PAIRS], second[start : start + PAIRS]))
    return found


def _least(polygons: Floats, first: Ints, second: Ints) -> float:
    """Smallest gap of the pairs, at most `SEEN`; a pair is left as soon as one edge shows that it is farther apart."""
    gap = np.full(len(first), -np.inf)
    for swapped in (False, True):
        for edge in (0, 2, 1, 3):  # long edges first: they part neighbouring lines
            a, b = (second, first) if swapped else (first, second)
            gap = np.maximum(gap, _beyond(polygons[a, edge], polygons[a, (edge + 1) % 4], polygons[b]))
            near = gap < SEEN
            gap, first, second = gap[near], first[near], second[near]
    return float(gap.min(initial=SEEN))


def _beyond(start: Floats, end: Floats, polygons: Floats) -> Floats:
    """Distance (n,) of polygons (n, k, 2) beyond edges of counter-clockwise ones, from ``start`` to ``end`` (n, 2)."""
    x, y = (end - start).T
    local = polygons - start[:, None]
    across = [y * local[:, i, 0] - x * local[:, i, 1] for i in range(polygons.shape[1])]
    beyond: Floats = np.minimum.reduce(across) / np.maximum(np.hypot(x, y), 1.0)
    return beyond


def _cut(quadrilaterals: Floats) -> tuple[Floats, Ints]:
    """Pieces (m, 4, 2), cut across edge 0, whose bounding boxes are not wide, and what each is a piece of (m,)."""
    box = np.ptp(quadrilaterals, axis=1).min(axis=1)
    pieces = np.ceil(np.maximum(box / CUT, 1.0)).astype(np.int64)
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
    thin = int(np.argmin((high - low).mean(axis=0)))  # across most lines
    owner, column, row = _tiles(low, high)
    tile = column * (row.max(initial=0) + 1) + row
    order = np.lexsort((low[owner, thin], tile))
    owner, column, row, tile = owner[order], column[order], row[order], tile[order]
    (x0, y0), (x1, y1) = low[owner].T, high[owner].T
    begins, ends = (x0, x1) if thin == 0 else (y0, y1)
    pairs = []
    a = np.arange(len(owner))  # those that may meet one that begins later in the same tile
    for step in range(1, len(owner)):
        a = a[a + step < len(owner)]
        a = a[(tile[a + step] == tile[a]) & (begins[a + step] <= ends[a])]
        if not len(a):
            break
        b = a + step
        left, below = np.maximum(x0[a], x0[b]), np.maximum(y0[a], y0[b])
        meet = (left <= np.minimum(x1[a], x1[b])) & (below <= np.minimum(y1[a], y1[b]))
        once = (np.floor(left / TILE) == column[a]) & (np.floor(below / TILE) == row[a])  # not in each tile they share
        pairs.append(np.stack([owner[a], owner[b]])[:, meet & once])
    first, second = np.concatenate(pairs or [np.empty((2, 0), np.int64)], axis=1)
    meet = whole[first] != whole[second]
    for diagonal in (
        polygons.sum(axis=2),
        np.subtract(polygons[..., 0], polygons[..., 1]),
    ):  # boxes turned by 45 degrees
        begins, ends = diagonal.min(axis=1) - SEEN, diagonal.max(axis=1) + SEEN
        meet &= np.maximum(begins[first], begins[second]) <= np.minimum(ends[first], ends[second])
    return first[meet], second[meet]


def _tiles(low: Floats, high: Floats) -> tuple[Ints, Ints, Ints]:
    """Every tile that each box touches: index of the box, column and row of the tile (n,)."""
    start, stop = (np.floor(p / TILE).astype(np.int64) for p in (low, high))
    size = stop - start + 1
    total = size[:, 0] * size[:, 1]
    owner = np.repeat(np.arange(len(low)), total)
    place = np.arange(len(owner)) - np.repeat(np.cumsum(total) - total, total)
    column, row = np.divmod(place, size[owner, 1])
    return owner, start[owner, 0] + column, start[owner, 1] + row
