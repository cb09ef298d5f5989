"""Near-equilateral triangles of one size on a smooth surface that is the image of a convex region of the plane.

Outline points stand at equal arc length. Inner points start as a low-discrepancy sequence thinned to the surface's
area density, then repel each other along the edges (Persson and Strang, A simple mesh generator in MATLAB, 2004)
while edges flip to the Delaunay triangulation of the surface. No random numbers: the same request gives the same mesh.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import Delaunay, cKDTree

from lce_solver.topology import edges, neighbours
from lce_solver.types import Floats, Ints, Surface

Embed = Callable[[Floats], Floats]
"""(n, 2) parameters to (n, 3) points."""
Outline = Callable[[Floats], Floats]
"""(n,) curve parameters in [0, 1] to (n, 2) points, counter-clockwise around a convex region, closed."""

SWEEPS = 60
STEP = 0.2
"""Part of the sum of the pushes that a point moves in one sweep."""
AIM = 0.98
"""Part of the wanted edge that is aimed at, so that the mean does not exceed it."""
MARGIN = 0.4
"""Distance that inner points keep from the rim, in units of the rim's edge there."""
PRESSURE = 1.2
"""Rest length over wanted edge: the points push a little, so that they fill the region evenly (Persson and Strang)."""


def mesh(embed: Embed, outline: Outline, edge: float, corners: Sequence[float] = (0.0,)) -> Surface:
    """Triangulate the surface with edges of mean length ``edge`` or up to a few per cent less.

    Parameters
    ----------
    corners : increasing curve parameters in [0, 1) at which the outline must have a vertex.
    """
    edge = AIM * edge
    rim = _outline_points(embed, outline, edge, corners)
    uv = np.vstack([rim, _inner_points(embed, rim, edge)])
    faces = _triangulate(uv)
    for _ in range(SWEEPS):
        moved = uv + STEP * _repulsion(uv, faces, embed(uv), edge)
        uv = np.vstack([rim, _snapped(_kept_inside(rim, moved[len(rim) :]))])
        if (_signed_areas(uv, faces) <= 0).any():
            faces = _triangulate(uv)
        faces = _flipped(uv, faces, embed(uv), passes=1)
    points = embed(uv)
    return Surface(points, _flipped(uv, faces, points, passes=100))


def _outline_points(embed: Embed, outline: Outline, edge: float, corners: Sequence[float]) -> Floats:
    """(n, 2) points of the outline, the corners among them, at equal arc length between corners."""
    parts = []
    for start, end in zip(corners, (*corners[1:], corners[0] + 1.0), strict=True):
        t = np.linspace(start, end, 2001)
        steps = np.linalg.norm(np.diff(embed(outline(t % 1.0)), axis=0), axis=1)
        length = np.concatenate([[0.0], np.cumsum(steps)])
        n = max(3, round(float(length[-1]) / edge))
        parts.append(_snapped(np.interp(np.arange(n) / n * length[-1], length, t)))
    return np.asarray(outline(np.concatenate(parts) % 1.0))


def _snapped(values: Floats) -> Floats:
    """Values on a grid of 2**-24: the sweeps would amplify the last bit, in which versions of NumPy differ."""
    return np.asarray(np.round(values * 2**24) / 2**24)


def _inner_points(embed: Embed, rim: Floats, edge: float) -> Floats:
    """(n, 2) points at least `MARGIN` away from the rim, as many as the area asks for."""
    low, size = rim.min(axis=0), np.ptp(rim, axis=0)
    sample = low + size * _sequence(5_000, 2)
    sample = sample[_inside(rim, sample)]
    density = _area_density(embed, sample)
    region = float(_polygon_area(rim))
    triangles = density.mean() * region / (np.sqrt(3) / 4 * edge**2)
    wanted = max(1, round((triangles - len(rim)) / 2 + 1))
    share = density.mean() / density.max() * region / size.prod()
    draw = _sequence(int(1.3 * wanted / share) + 100, 3)
    points = low + size * draw[:, :2]
    keep = _inside(rim, points)
    keep[keep] = draw[keep, 2] * density.max() <= _area_density(embed, points[keep])
    return np.asarray(points[keep][:wanted])


def _sequence(n: int, dimension: int) -> Floats:
    """(n, dimension) points spread evenly over the unit cube: the additive recurrence of Roberts (2018)."""
    root = 2.0
    for _ in range(30):  # the positive root of x**(d + 1) = x + 1
        root = (1 + root) ** (1 / (dimension + 1))
    return (0.5 + np.outer(np.arange(1, n + 1), root ** -np.arange(1.0, dimension + 1))) % 1.0


def _depth(rim: Floats, points: Floats) -> tuple[Floats, Floats]:
    """Distances of points from the two nearest sides of the convex polygon ``rim``, in units of the sides.

    Returns
    -------
    depth (n, 2), positive inside; inward normals as long as the sides (n, 2, 2).
    """
    ahead = np.roll(rim, -1, axis=0) - rim
    nearest = cKDTree(rim).query(points)[1]
    side = np.column_stack([nearest - 1, nearest])
    normal = np.column_stack([-ahead[:, 1], ahead[:, 0]])[side]
    return np.sum((points[:, None] - rim[side]) * normal, axis=2) / np.sum(normal**2, axis=2), normal


def _inside(rim: Floats, points: Floats) -> NDArray[np.bool_]:
    return np.asarray((_depth(rim, points)[0] > MARGIN).all(axis=1))


def _kept_inside(rim: Floats, points: Floats) -> Floats:
    """Move points that came too close to a side of the rim back to `MARGIN`."""
    depth, normal = _depth(rim, points)
    row, side = np.arange(len(points)), depth.argmin(axis=1)
    lack = np.maximum(MARGIN - depth[row, side], 0.0)
    return np.asarray(points + lack[:, None] * normal[row, side])


def _area_density(embed: Embed, uv: Floats, step: float = 1e-5) -> Floats:
    """(n,) area on the surface per area of the parameters."""
    u, v = np.array([step, 0.0]), np.array([0.0, step])
    along_u, along_v = embed(uv + u) - embed(uv - u), embed(uv + v) - embed(uv - v)
    return np.asarray(np.linalg.norm(np.cross(along_u, along_v), axis=1) / (4 * step**2))


def _repulsion(uv: Floats, faces: Ints, points: Floats, edge: float) -> Floats:
    """(n, 2) how far the edges that are too short push their ends apart, pulled back to the parameters."""
    a, b = edges(faces).T
    length = np.linalg.norm(points[b] - points[a], axis=1)
    push = np.maximum(PRESSURE * edge / length - 1, 0.0)[:, None] * (uv[b] - uv[a])
    total = np.zeros_like(uv)
    np.add.at(total, b, push)
    np.add.at(total, a, -push)
    return total


def _triangulate(uv: Floats) -> Ints:
    """Counter-clockwise Delaunay triangles in the parameter plane, sorted, for Qhull's order is its version's own."""
    faces = np.sort(Delaunay(uv).simplices.astype(np.int64), axis=1)
    faces = faces[np.lexsort(faces.T[::-1])]
    area = _signed_areas(uv, faces)
    faces = np.where(area[:, None] < 0, faces[:, [0, 2, 1]], faces)
    return np.asarray(faces[np.abs(area) > 1e-12 * np.ptp(uv, axis=0).prod()])


def _flipped(uv: Floats, faces: Ints, points: Floats, passes: int) -> Ints:
    """Flip edges whose opposite angles on the surface sum to more than pi, worst first."""
    for _ in range(passes):
        pairs, _ = neighbours(faces)
        n = len(faces)
        (f, g), (i, j) = pairs.T % n, pairs.T // n
        u, v, p, q = faces[f, i], faces[f, (i + 1) % 3], faces[f, (i + 2) % 3], faces[g, (j + 2) % 3]
        excess = -_cotan(points, p, u, v) - _cotan(points, q, u, v)
        one, two = np.column_stack([u, q, p]), np.column_stack([q, v, p])
        valid = (_signed_areas(uv, one) > 0) & (_signed_areas(uv, two) > 0)  # a convex quadrilateral
        excess = np.where(valid, excess, 0.0)
        worst = np.zeros(n)
        np.maximum.at(worst, f, excess)
        np.maximum.at(worst, g, excess)
        turn = (excess > 1e-9) & (excess == worst[f]) & (excess == worst[g])
        if not turn.any():
            break
        faces = faces.copy()
        faces[f[turn]], faces[g[turn]] = one[turn], two[turn]
    return faces


def _cotan(points: Floats, tip: Ints, a: Ints, b: Ints) -> Floats:
    """(n,) cotangent of the angle at ``tip``."""
    to_a, to_b = points[a] - points[tip], points[b] - points[tip]
    return np.asarray(np.sum(to_a * to_b, axis=1) / np.linalg.norm(np.cross(to_a, to_b), axis=1))


def _signed_areas(uv: Floats, faces: Ints) -> Floats:
    a, b, c = np.moveaxis(uv[faces], 1, 0)
    return np.asarray(_cross(b - a, c - a) / 2)


def _polygon_area(ring: Floats) -> Floats:
    return np.asarray(_cross(ring, np.roll(ring, -1, axis=0)).sum() / 2)


def _cross(a: Floats, b: Floats) -> Floats:
    return np.asarray(a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0])
