"""Splitting the polygons of a mesh file into triangles that stay inside them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from lce_solver.errors import InputError
from lce_solver.types import Floats, Ints

ROUNDING = 1e-9
"""Area that a triangle may turn against its polygon, as a fraction of the polygon's: collinear corners."""
CROSSED = 1e-6
"""A polygon whose parts cancel up to this fraction crosses itself."""


def triangulated(vertices: Floats, polygons: Sequence[Sequence[int]]) -> Ints:
    """Split each polygon from its first corner from which all others are seen inside it; convex ones from the first.

    Parameters
    ----------
    vertices : (n_v, 3) positions.
    polygons : vertex indices of each polygon; an index that is out of range is left for others to report.

    Returns
    -------
    (n_f, 3) triangles in the order of the polygons.

    Raises
    ------
    InputError
        Names the first polygon that no such corner exists for, counted from 0.
    """
    sizes = np.array([len(polygon) for polygon in polygons], dtype=np.int64)
    triangles, owner = [np.empty((0, 3), dtype=np.int64)], [np.empty(0, dtype=np.int64)]
    for size in np.unique(sizes[sizes >= 3]):
        rows = np.flatnonzero(sizes == size)
        corners = np.array([polygons[row] for row in rows.tolist()], dtype=np.int64)
        start, possible = _starts(vertices, corners) if size > 3 else (np.zeros(len(rows), np.int64), rows >= 0)
        if not possible.all():
            row = int(rows[~possible][0])
            msg = (
                f"polygon {row} of {size} corners is strongly concave or crosses itself; triangulate it in your program"
            )
            raise InputError(msg)
        turned = np.take_along_axis(corners, (start[:, None] + np.arange(size)) % size, axis=1)
        fan = np.stack([np.broadcast_to(turned[:, :1], (len(rows), size - 2)), turned[:, 1:-1], turned[:, 2:]], axis=2)
        triangles.append(fan.reshape(-1, 3))
        owner.append(np.repeat(rows, size - 2))
    return np.concatenate(triangles)[np.argsort(np.concatenate(owner), kind="stable")]


def _starts(vertices: Floats, corners: Ints) -> tuple[Ints, NDArray[np.bool_]]:
    """(m,) corner to split (m, size) polygons from, and whether there is one; what cannot be judged passes."""
    known: NDArray[np.bool_] = np.all((corners >= 0) & (corners < len(vertices)), axis=1)
    points = vertices[np.where(known[:, None], corners, 0)]
    inside = np.zeros(corners.shape, dtype=bool)
    with np.errstate(all="ignore"):  # coordinates that overflow are refused later, with their vertex
        for start in range(corners.shape[1]):
            spokes = np.roll(points, -start, axis=1)[:, 1:] - points[:, [start]]
            area = np.cross(spokes[:, :-1], spokes[:, 1:])
            whole = area.sum(axis=1)
            size, parts = np.linalg.norm(whole, axis=1), np.linalg.norm(area, axis=2).sum(axis=1)
            against = (area * whole[:, None]).sum(axis=2).min(axis=1) < -ROUNDING * size**2
            inside[:, start] = ~(against | (size < CROSSED * parts))
    found: NDArray[np.bool_] = np.any(inside, axis=1)
    return inside.argmax(axis=1), found | ~known
