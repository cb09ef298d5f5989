"""Layouts of the plane that need no physics: a valid first map of a disk, and the smallest rectangle around a shape."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.sparse.linalg import splu
from scipy.spatial import ConvexHull

from lce_solver.geometry import face_areas
from lce_solver.topology import boundary_loops
from lce_solver.types import Floats, Ints, Surface

Complexes = NDArray[np.complex128]

SMALL = 1e-6
"""Shorter edges, in mean edges, count as that long."""
SAME = 1e-6
"""Rectangles whose areas differ by less are equally small."""


def convex_map(surface: Surface) -> Floats:
    """Map a disk, with or without holes, to a circle of its area: outline by arc length, inside by mean-value weights.

    Positive weights and a convex boundary make it injective for every mesh (Tutte 1963, Floater 2003); holes are filled
    for that with triangles around their centre. The outline is the longest boundary.

    Returns
    -------
    (n_v, 2) flat coordinates, in the surface's unit of length.
    """
    whole, loop = _filled(surface)
    return _circle_map(whole, loop)[: len(surface.vertices)]


def _filled(surface: Surface) -> tuple[Surface, Ints]:
    """The surface with its holes filled by fans, and its outline."""
    *holes, outline = sorted(boundary_loops(surface.faces), key=lambda loop: _length(surface.vertices[loop]))
    n = len(surface.vertices)
    centres = [surface.vertices[hole].mean(axis=0) for hole in holes]
    fan = [np.column_stack([hole, np.full(len(hole), n + k), np.roll(hole, -1)]) for k, hole in enumerate(holes)]
    return Surface(np.vstack([surface.vertices, *centres]), np.concatenate([surface.faces, *fan])), outline


def _length(ring: Floats) -> float:
    return float(np.linalg.norm(ring - np.roll(ring, 1, axis=0), axis=1).sum())


def _circle_map(surface: Surface, loop: Ints) -> Floats:
    sides = np.linalg.norm(surface.vertices[np.roll(loop, -1)] - surface.vertices[loop], axis=1)
    angle = 2 * np.pi * (np.cumsum(sides) - sides) / sides.sum()
    circle = np.sqrt(face_areas(surface).sum() / np.pi) * np.column_stack([np.cos(angle), np.sin(angle)])
    inside = np.setdiff1d(np.arange(len(surface.vertices)), loop)
    uv = np.zeros((len(surface.vertices), 2))
    uv[loop] = circle
    if len(inside):
        rows = _mean_value_laplacian(surface)[inside]
        uv[inside] = splu(rows[:, inside].tocsc()).solve(-(rows[:, loop] @ circle))
    return uv


def _mean_value_laplacian(surface: Surface) -> sparse.csr_array:
    """(n_v, n_v) row sums zero, entries off the diagonal <= 0: ``-(tan(left/2) + tan(right/2)) / length``."""
    corner = surface.vertices[surface.faces]
    to_next, to_last = np.roll(corner, -1, axis=1) - corner, np.roll(corner, 1, axis=1) - corner
    least = SMALL * np.sqrt(np.mean(np.einsum("fki,fki->fk", to_next, to_next)))  # where a hole has no area, say
    next_length, last_length = (np.maximum(np.linalg.norm(v, axis=2), least) for v in (to_next, to_last))
    cosine = np.einsum("fki,fki->fk", to_next, to_last)
    sine, sum_ = np.maximum(2 * face_areas(surface)[:, None], least**2), next_length * last_length + np.abs(cosine)
    tangent = np.where(cosine > 0, sine / sum_, sum_ / sine)  # of half the corner's angle; neither loses digits
    weight = np.hstack([tangent / next_length, tangent / last_length])
    here, there = np.tile(surface.faces, 2), np.hstack([np.roll(surface.faces, s, axis=1) for s in (-1, 1)])
    entry, n = (here.ravel(), there.ravel()), len(surface.vertices)
    weights = sparse.csr_array((weight.ravel(), entry), shape=(n, n))
    return (sparse.diags(weights @ np.ones(n)) - weights).tocsr()


def rectangle_angles(uv: Floats) -> Floats:
    """(k,) directions of a side of the smallest rectangles around the points, several when equally small [rad]."""
    hull = uv[ConvexHull(uv).vertices]
    side = np.roll(hull, -1, axis=0) - hull
    angle = np.arctan2(side[:, 1], side[:, 0])
    turned = turn(hull[None], -angle[:, None])
    area = np.ptp(turned, axis=1).prod(axis=1)
    smallest: Floats = angle[area <= (1 + SAME) * area.min()]
    return smallest


def turn(uv: Floats, angle: float | Floats) -> Floats:
    """Turn points counter-clockwise about the origin; ``angle`` broadcasts against the points."""
    c, s = np.cos(angle), np.sin(angle)
    u, v = uv[..., 0], uv[..., 1]
    return np.stack([c * u - s * v, s * u + c * v], axis=-1)


def long_side_along_x(uv: Floats) -> Floats:
    """Turn the points so that the long side of their smallest rectangle lies along x."""
    lying = turn(uv, -rectangle_angles(uv)[0])
    width, height = np.ptp(lying, axis=0)
    return lying if width >= height else turn(lying, -np.pi / 2)


def axis_along_x(w: Complexes, twin: Ints) -> Complexes:
    """Turn and shift a nearly symmetric map so that mirror images (``twin``, (n,)) have conjugate coordinates."""
    centred = w - w.mean()
    turned = centred * np.exp(-0.5j * np.angle(np.vdot(centred.conj(), centred[twin])))
    symmetric: Complexes = (turned + turned[twin].conj()) / 2
    return symmetric
