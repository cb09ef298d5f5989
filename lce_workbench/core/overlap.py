"""Areas that convex polygons share, for plates that do not lie as drawn."""

from __future__ import annotations

import numpy as np

from lce_solver.types import Floats


def shared_area(polygons: Floats, others: Floats) -> Floats:
    """Area (n,) [mm2] that each convex polygon (n, k, 2) shares with its own other one (n, m, 2).

    Both counter-clockwise; corners may repeat. The other's edges cut the polygon one after the other (I. Sutherland and
    G. Hodgman, Comm. ACM 17, 32 (1974)).
    """
    left = polygons
    for start, end in zip(np.moveaxis(others, 1, 0), np.moveaxis(np.roll(others, -1, axis=1), 1, 0), strict=True):
        left = _left_of(left, start, end)
    p = left - left[:, :1]
    q = np.roll(p, -1, axis=1)
    area: Floats = 0.5 * np.sum(p[..., 0] * q[..., 1] - p[..., 1] * q[..., 0], axis=1)
    return area


def _left_of(polygons: Floats, start: Floats, end: Floats) -> Floats:
    """What of the polygons (n, k, 2) lies left of the lines from ``start`` to ``end`` (n, 2): (n, k + 1, 2).

    Corners repeat; nothing is a polygon of one point.
    """
    along, local = end - start, polygons - start[:, None]
    height = along[:, :1] * local[..., 1] - along[:, 1:] * local[..., 0]
    after = np.roll(height, -1, axis=1)
    crosses = height * after < 0
    share = height / np.where(crosses, height - after, 1.0)
    crossing = polygons + share[..., None] * (np.roll(polygons, -1, axis=1) - polygons)
    corners = np.stack([polygons, crossing], axis=2).reshape(len(polygons), -1, 2)
    kept = np.stack([height >= 0, crosses], axis=2).reshape(len(polygons), -1)
    order = np.argsort(~kept, axis=1, kind="stable")[:, : polygons.shape[1] + 1]
    last = np.maximum(kept.sum(axis=1) - 1, 0)[:, None]
    order = np.take_along_axis(order, np.minimum(np.arange(order.shape[1]), last), axis=1)
    return np.take_along_axis(corners, order[..., None], axis=1)
