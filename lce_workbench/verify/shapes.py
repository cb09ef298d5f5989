"""Polygons (n, k, 2) as the readers give them; those with fewer than k corners repeat their last one."""

from __future__ import annotations

from collections.abc import Iterable
from functools import reduce

import numpy as np

from lce_solver.types import Floats


def _crosses(polygons: Floats) -> tuple[Floats, Floats, Floats]:
    """Corners from the first one (n, k, 2), the next ones, and twice the areas (n, k) of the triangles with it."""
    p = polygons - polygons[:, :1]
    q = np.roll(p, -1, axis=1)
    return p, q, np.asarray(p[..., 0] * q[..., 1] - p[..., 1] * q[..., 0])


def areas(polygons: Floats) -> Floats:
    """(n,) areas, whichever way the polygons run."""
    return np.asarray(np.abs(_crosses(polygons)[2].sum(axis=1)) / 2)


def centroids(polygons: Floats) -> Floats:
    """(n, 2) centres of mass; of polygons without area, the mean of their corners."""
    p, q, cross = _crosses(polygons)
    total = cross.sum(axis=1)[:, None]
    flat = total == 0
    middle = np.sum((p + q) * cross[..., None], axis=1) / np.where(flat, 1, 3 * total)
    return np.asarray(polygons[:, 0] + np.where(flat, p.mean(axis=1), middle))


def boxes(polygons: Floats) -> Floats:
    """(n, 4) low x, low y, high x, high y."""
    corners = np.moveaxis(polygons, 1, 0)  # few: one after the other they take a tenth of the time
    return np.concatenate([reduce(np.minimum, corners), reduce(np.maximum, corners)], axis=1)


def extent(groups: Iterable[Floats]) -> Floats:
    """(4,) low x, low y, high x, high y of everything."""
    found = np.concatenate([boxes(group) for group in groups if len(group)])
    return np.concatenate([found[:, :2].min(axis=0), found[:, 2:].max(axis=0)])


def mirrored(polygons: Floats) -> Floats:
    """Polygons seen from the other side, x -> -x."""
    return np.asarray(polygons * np.array([-1.0, 1.0]))


def canonical(polygons: Floats) -> Floats:
    """(n, 2 k) rows that do not depend on where a polygon begins, which way it runs, nor on the order of polygons."""
    clockwise = _crosses(polygons)[2].sum(axis=1) < 0
    turned, sides = _packed(np.where(clockwise[:, None, None], polygons[:, ::-1], polygons))
    n, k, _ = turned.shape
    order = np.lexsort((turned[..., 1].ravel(), turned[..., 0].ravel()))  # rank of every corner
    rank = np.empty(n * k, dtype=np.int64)
    rank[order] = np.arange(n * k)
    place = np.arange(k)
    own = place < sides[:, None]
    first = np.where(own, rank.reshape(n, k), n * k).argmin(axis=1)[:, None]
    index = np.where(own, (first + place) % sides[:, None], (first - 1) % sides[:, None])
    rolled = np.take_along_axis(turned, index[..., None], axis=1).reshape(n, 2 * k)
    return rolled[np.lexsort(rolled.T[::-1])]


def _packed(polygons: Floats) -> tuple[Floats, Floats]:
    """Polygons without corners that repeat the one before, which leaves them (n,) at the front of each row."""
    new = np.any(polygons != np.roll(polygons, 1, axis=1), axis=2)
    order = np.argsort(~new, axis=1, kind="stable")
    return np.take_along_axis(polygons, order[..., None], axis=1), np.maximum(new.sum(axis=1), 1)


def unlike(one: Floats, other: Floats) -> Floats:
    """Polygons (m, k, 2) of ``one`` that ``other`` lacks."""
    if one.shape == other.shape and np.array_equal(one, other):
        return one[:0]
    if one.shape[1] != other.shape[1]:
        return one
    rows, others = canonical(one), canonical(other)
    kind = np.dtype((np.void, rows.dtype.itemsize * rows.shape[1]))
    missing = ~np.isin(*(np.ascontiguousarray(r + 0.0).view(kind).ravel() for r in (rows, others)))
    return np.asarray(rows[missing].reshape(-1, one.shape[1], 2))
