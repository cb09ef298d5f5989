"""The director as a line field with a value at every vertex: one order more accurate than a value per triangle.

On a triangle the map is linear, so its director is first order; a polynomial through the vertices around, which lie on
the surface itself, has a derivative of second order at its centre, on the rim too (Zhang and Naga, SIAM J. Sci. Comput.
26, 1192 (2005)).
"""

from __future__ import annotations

import igl
import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from lce_solver.types import Design, Floats, Ints, Material, Surface

Lines = NDArray[np.complex128]
"""(n,) exp(2 i theta) of directors theta: the same for a line turned by half a turn."""

NEARNESS = 4.0
"""Neighbours count by this power of their inverse distance: the near ones decide, the far ones steady the fit."""


def vertex_line_field(design: Design) -> Lines:
    """(n_v,) exp(2 i theta) of the mid-plane director at the vertices of the sheet."""
    return vertex_lines(design.surface, design.uv, design.material)


def vertex_lines(surface: Surface, uv: Floats, material: Material) -> Lines:
    """(n_v,) exp(2 i theta) at the vertices of the flat sheet ``uv`` (n_v, 2) that becomes ``surface``."""
    slope = _derivative(uv, surface.faces, surface.vertices)
    metric = np.einsum("nij,nik->njk", slope, slope)
    largest = metric[:, 0, 0] - metric[:, 1, 1] + 2j * metric[:, 0, 1]  # along the direction of the largest stretch
    line: Lines = largest / np.maximum(np.abs(largest), np.finfo(float).tiny)
    return line if material.along > material.across else -line


def sampled(values: Floats | Lines, uv: Floats, faces: Ints, points: Floats) -> Floats | Lines:
    """(k,) linear interpolation of ``values`` (n_v,) at ``points`` (k, 2); outside the sheet, at its closest point.

    The angle of an interpolated line is ``numpy.angle(line) / 2``.
    """
    flat, asked = (np.column_stack([p, np.zeros(len(p))]) for p in (uv, points))
    _, triangle, closest = igl.point_mesh_squared_distance(asked, flat, np.array(faces, order="C"))
    corner = faces[triangle]
    origin, p, q = (uv[corner[:, k]] for k in range(3))
    share = np.linalg.solve(np.stack([p - origin, q - origin], axis=2), (closest[:, :2] - origin)[..., None])[..., 0]
    weight = np.column_stack([1 - share.sum(axis=1), share])
    found: Floats | Lines = np.einsum("nk,nk->n", weight, values[corner])
    return found


def _derivative(uv: Floats, faces: Ints, values: Floats) -> Floats:
    """(n_v, d, 2) derivative of ``values`` (n_v, d) of the best quadratic through each vertex and its two rings."""
    here, there = _two_rings(faces, len(uv))
    offset = uv[there] - uv[here]
    square = np.einsum("ki,ki->k", offset, offset)
    unit = np.sqrt(np.bincount(here, square) / np.bincount(here))
    x, y = (offset / unit[here, None]).T
    terms = np.column_stack([x, y, x * x, x * y, y * y])
    weighted = terms * ((x * x + y * y) ** (-NEARNESS / 2))[:, None]
    sums = sparse.csr_array((np.ones(len(here)), (here, np.arange(len(here)))))
    normal = sums @ np.einsum("ki,kj->kij", weighted, terms).reshape(len(here), -1)
    right = sums @ np.einsum("ki,kj->kij", weighted, values[there] - values[here]).reshape(len(here), -1)
    # Where there are too few neighbours, the smallest of the polynomials.
    inverse = np.linalg.pinv(normal.reshape(-1, 5, 5), rcond=1e-9, hermitian=True)
    slope: Floats = np.moveaxis((inverse @ right.reshape(len(uv), 5, -1))[:, :2], 1, 2) / unit[:, None, None]
    return slope


def _two_rings(faces: Ints, n: int) -> tuple[Ints, Ints]:
    """Pairs (vertex, another at most two edges away), sorted by the first."""
    touch = sparse.csr_array(
        (np.ones(faces.size, dtype=np.int32), (faces.ravel(), np.repeat(np.arange(len(faces)), 3)))
    )
    ring = touch @ touch.T
    both = (ring @ ring).tocoo()
    here, there = (np.asarray(k, dtype=np.int64) for k in (both.row, both.col))
    other = here != there
    order = np.argsort(here[other] * n + there[other], kind="stable")
    return here[other][order], there[other][order]
