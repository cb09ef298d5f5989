"""The judge of a flattening. It shares no code with the solver: it looks at the map sheet -> target, edge by edge."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from lce_solver.types import Floats, Ints, Material, Surface

SINGULAR = 1e-100
"""Stands for the determinant of a triangle without area in the plane, whose stretches are endless."""


def jacobians(surface: Surface, uv: Floats) -> Floats:
    """(n_f, 3, 2) derivative of the map sheet -> target on each triangle (the paper's J_f)."""
    (a, b), (c, d) = np.moveaxis(_edges(uv, surface.faces), 0, -1)
    determinant = a * d - b * c
    adjugate = np.moveaxis(np.array([[d, -b], [-c, a]]), -1, 0)
    inverse = adjugate / np.where(determinant == 0, SINGULAR, determinant)[:, None, None]
    return np.asarray(_edges(surface.vertices, surface.faces) @ inverse, dtype=np.float64)


def stretches(surface: Surface, uv: Floats, material: Material) -> Floats:
    """(n_f, 2) achieved stretch sheet -> target along and across the director.

    The director is the principal direction whose stretch comes in the same order of size as ``material.along``.
    """
    return principal(jacobians(surface, uv), material)


def principal(jacobian: Floats, material: Material) -> Floats:
    """(n_f, 2) singular values of ``jacobian`` (n_f, 3, 2), along and across the director.

    From the metric's trace and difference the larger one, and from the area the smaller: ten times as fast as an SVD.
    """
    u, v = np.moveaxis(jacobian, 2, 0)
    uu, vv, uv = (np.einsum("fi,fi->f", p, q) for p, q in ((u, u), (v, v), (u, v)))
    large = np.sqrt((uu + vv) / 2 + np.hypot((uu - vv) / 2, uv))
    area = np.linalg.norm(np.cross(u, v), axis=1)
    small = area / np.maximum(large, SINGULAR)
    return np.stack([large, small] if material.along > material.across else [small, large], axis=1)


def stretch_errors(stretch: Floats, material: Material) -> Floats:
    """(n_f, 2) relative errors of achieved stretches, along and across the director."""
    errors: Floats = stretch / (material.along, material.across) - 1
    return errors


def rms(errors: Floats, area: Floats) -> float:
    """Root of the area mean of both squared errors."""
    return float(np.sqrt(np.average(np.mean(errors**2, axis=1), weights=area)))


def flipped(uv: Floats, faces: Ints) -> Ints:
    """(k,) triangles that are not counter-clockwise in the plane."""
    (u1, u2), (v1, v2) = np.moveaxis(_edges(uv, faces), 0, -1)
    return np.flatnonzero(~(u1 * v2 - u2 * v1 > 0))  # so that what is not a number is flipped too


def crossings(uv: Floats, edges: Ints) -> Ints:
    """(k, 2) pairs of segments, by their row in ``edges``, that meet without sharing an end.

    Segments are sorted by their left end, so that only those that overlap in x are compared.
    """
    order = np.argsort(uv[edges, 0].min(axis=1), kind="stable")
    first, second = _overlapping_in_x(uv[edges[order]])
    first, second = order[first], order[second]
    shared = (edges[first][:, :, None] == edges[second][:, None, :]).any(axis=(1, 2))
    first, second = first[~shared], second[~shared]
    meet = _separates(uv[edges[first]], uv[edges[second]]) & _separates(uv[edges[second]], uv[edges[first]])
    pairs = np.stack([first[meet], second[meet]], axis=1)
    return np.sort(pairs, axis=1)


def _edges(points: Floats, faces: Ints) -> Floats:
    """(n_f, d, 2) two edge vectors of each triangle, as columns."""
    corner = points[faces]
    return np.moveaxis(corner[:, 1:] - corner[:, :1], 1, 2)


def _overlapping_in_x(segments: Floats) -> tuple[Ints, Ints]:
    """Pairs of rows of (n, 2, 2) ``segments``, sorted by left end, whose bounding boxes touch."""
    low, high = segments.min(axis=1), segments.max(axis=1)
    n = len(segments)
    count = np.searchsorted(low[:, 0], high[:, 0], side="right") - np.arange(n) - 1
    first = np.repeat(np.arange(n), count)
    second = first + 1 + np.arange(len(first)) - np.repeat(np.cumsum(count) - count, count)
    touch = (low[first, 1] <= high[second, 1]) & (low[second, 1] <= high[first, 1])
    return first[touch], second[touch]


def _separates(line: Floats, points: Floats) -> NDArray[np.bool_]:
    """Whether the line through (k, 2, 2) ``line`` has the ends of ``points`` on different sides, or one on it."""
    direction = line[:, 1] - line[:, 0]
    offset = points - line[:, :1]
    side = direction[:, None, 0] * offset[..., 1] - direction[:, None, 1] * offset[..., 0]
    separate: NDArray[np.bool_] = side.prod(axis=1) <= 0
    return separate
