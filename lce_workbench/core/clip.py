"""Convex polygons cut along the rims of the sheet, which may be concave and have holes, into convex pieces."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from lce_solver.types import Floats, Ints
from lce_workbench.core.domains import signed_area

Bools = NDArray[np.bool_]

TOUCH = 1e-9
"""Lengths below this count as nothing [mm]."""


@dataclass(frozen=True, eq=False)
class Cut:
    """Polygons cut along the rims of a sheet."""

    whole: Ints
    """(n,) polygons that lie inside as they are."""
    pieces: tuple[Floats, ...]
    """Convex pieces (k, 2) of those at the rim, counter-clockwise [mm]."""
    owner: Ints
    """(m,) the polygon that each piece is of."""


def cut(polygons: Floats, rims: Sequence[Floats]) -> Cut:
    """Cut convex ``polygons`` (n, k, 2), counter-clockwise, along simple ``rims`` (m, 2): an outline and its holes.

    A polygon is divided by the line of an edge that crosses it, then its parts by the next edge, until no edge crosses
    any part: so the pieces are convex and cover what lies inside exactly. Corners may repeat.
    """
    edges = _edges(rims)
    touched: dict[int, list[Floats]] = {}
    low, high = polygons.min(axis=1), polygons.max(axis=1)
    for edge in edges:
        near = np.all((low <= edge.max(axis=0)) & (high >= edge.min(axis=0)), axis=1)
        for i in np.flatnonzero(near).tolist():
            touched.setdefault(i, []).append(edge)
    rim = np.array(sorted(touched), dtype=np.int64)
    others = np.setdiff1d(np.arange(len(polygons)), rim)
    divided = [(piece, i) for i in rim.tolist() for piece in _divided(distinct(polygons[i]), touched[i])]
    kept = inside(np.array([piece.mean(axis=0) for piece, _ in divided]).reshape(-1, 2), rims)
    pieces, owner = zip(*(found for found, good in zip(divided, kept, strict=True) if good), strict=True) or ((), ())
    return Cut(others[inside(polygons[others].mean(axis=1), rims)], pieces, np.array(owner, dtype=np.int64))


def _edges(rims: Sequence[Floats]) -> Floats:
    """(n, 2, 2) edges of closed rings."""
    return np.concatenate([np.stack([rim, np.roll(rim, -1, axis=0)], axis=1) for rim in rims])


def inside(points: Floats, rims: Sequence[Floats]) -> Bools:
    """Which of ``points`` (n, 2) lie in the sheet: a ray to the right crosses its rims an odd number of times."""
    x, y = points.T
    odd = np.zeros(len(points), dtype=bool)
    for (ax, ay), (bx, by) in _edges(rims):
        if ay != by:
            odd ^= ((ay <= y) != (by <= y)) & (x < ax + (y - ay) * (bx - ax) / (by - ay))
    return odd


def _divided(polygon: Floats, edges: list[Floats]) -> list[Floats]:
    """Convex parts of a polygon that none of the edges (2, 2) crosses."""
    for k, edge in enumerate(edges):
        if _crosses(edge, polygon):
            left, right = (_half(polygon, *ends) for ends in (edge, edge[::-1]))
            return [part for half in (left, right) if len(half) > 2 for part in _divided(half, edges[k + 1 :])]
    return [polygon]


def _crosses(edge: Floats, polygon: Floats) -> bool:
    """Whether a part of the edge (2, 2) lies inside the convex polygon, not only on its rim."""
    along = np.roll(polygon, -1, axis=0) - polygon
    inward = np.stack([-along[:, 1], along[:, 0]], axis=1) / np.linalg.norm(along, axis=1)[:, None]
    first, last = (np.sum(inward * (end - polygon), axis=1) - TOUCH for end in edge)
    if np.any((first <= 0) & (last <= 0)):
        return False
    change = np.where(first == last, 1.0, last - first)
    at = -first / change
    enters = float(np.max(at, where=first < 0, initial=0.0))
    leaves = float(np.min(at, where=last < 0, initial=1.0))
    return (leaves - enters) * float(np.linalg.norm(edge[1] - edge[0])) > TOUCH


def _half(polygon: Floats, start: Floats, end: Floats) -> Floats:
    """The part (k, 2) of a convex polygon to the left of the line from ``start`` to ``end``; empty if there is none."""
    along = (end - start) / np.linalg.norm(end - start)
    local = polygon - start
    height = along[0] * local[:, 1] - along[1] * local[:, 0]
    corners = []
    for i, here in enumerate(height):
        if here >= 0:
            corners.append(polygon[i])
        following = (i + 1) % len(polygon)
        if here * height[following] < 0:
            share = here / (here - height[following])
            corners.append(polygon[i] + share * (polygon[following] - polygon[i]))
    return distinct(np.array(corners).reshape(-1, 2))


def distinct(ring: Floats) -> Floats:
    """The ring without corners that fall on the one before."""
    kept: Floats = ring[np.linalg.norm(ring - np.roll(ring, 1, axis=0), axis=1) > TOUCH]
    return kept


def blunted(ring: Floats, height: float) -> Floats:
    """A convex ring without corners lower than ``height`` over the line between their neighbours; still convex."""
    while len(ring) > 3:
        before, after = np.roll(ring, 1, axis=0), np.roll(ring, -1, axis=0)
        base = np.maximum(np.linalg.norm(after - before, axis=1), TOUCH)
        rise = 2 * signed_area(np.stack([before, ring, after], axis=1)) / base
        lowest = int(np.argmin(rise))
        if rise[lowest] >= height:
            break
        ring = np.delete(ring, lowest, axis=0)
    return ring
