"""A flat triangle mesh with the operators of a thin shell: tangents per triangle, second derivatives per 6-node patch.

The patch is the triangle with the three vertices opposite its edges. The one quadratic through the six nodes has
constant second derivatives, exact for quadratic maps on any mesh (from hinge angles they do not even converge).
Where the mesh ends, or the six nodes lie near a conic, the three outer nodes are chosen anew from the neighbourhood.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations
from typing import Any

import numpy as np
from scipy import sparse

from lce_solver.errors import InputError
from lce_solver.types import Floats, Ints, owned

NEIGHBOURS = 10
"""Outer nodes are chosen among this many nearest vertices of the neighbourhood: 120 patches are tried."""
WORST_PATCH = 3.0
"""A patch that errs this many times more than the patch of equilateral triangles is chosen anew."""


@dataclass(frozen=True, eq=False)
class Shell:
    """A flat mesh and its linear operators on vertex positions ``x`` (n_v, 3); components gamma are 11, 22, 12."""

    uv: Floats
    """(n_v, 2) flat sheet [mm]."""
    faces: Ints
    """(n_f, 3) vertex indices, counter-clockwise in ``uv``."""
    area: Floats
    """(n_f,) [mm^2]."""
    patch: Ints
    """(n_f, 6) nodes of the quadratic patch, the triangle's own first."""
    slopes: Floats
    """(n_f, 3, 2) gradients of the triangle's linear shape functions [1/mm]."""
    bends: Floats
    """(n_f, 6, 3) second derivatives of the patch's quadratic shape functions [1/mm^2]."""
    tangents: Any
    """Sparse (2 n_f, n_v): ``tangents @ x`` are both tangent vectors, all of u before all of v."""
    curves: Any
    """Sparse (3 n_f, n_v): ``curves @ x`` are the second derivatives, component by component."""

    @property
    def size(self) -> float:
        """Diagonal of the flat sheet's bounding box [mm]."""
        return float(np.linalg.norm(np.ptp(self.uv, axis=0)))

    @property
    def edge(self) -> float:
        """Edge of the equilateral triangle of mean area [mm]."""
        return float(np.sqrt(4 / np.sqrt(3) * self.area.mean()))


def shell(uv: Floats, faces: Ints) -> Shell:
    """Precompute the operators of the flat mesh ``uv`` (n_v, 2) [mm], ``faces`` (n_f, 3).

    Raises
    ------
    InputError
        A triangle is flipped or has no area, or the mesh has no room for a quadratic patch.
    """
    uv, faces = owned(uv, "uv", np.float64, None, 2), owned(faces, "faces", np.int64, None, 3)
    slopes, area = _linear(uv, faces)
    patch, bends = _patches(uv, faces)
    return Shell(
        uv,
        faces,
        area,
        patch,
        slopes,
        bends,
        _operator(faces, slopes, len(uv)),
        _operator(patch, bends, len(uv)),
    )


def _linear(uv: Floats, faces: Ints) -> tuple[Floats, Floats]:
    """Return gradients of the linear shape functions (n_f, 3, 2) and areas (n_f,)."""
    edges = uv[np.roll(faces, -2, axis=1)] - uv[np.roll(faces, -1, axis=1)]  # edge i is opposite vertex i
    twice = edges[:, 0, 0] * edges[:, 1, 1] - edges[:, 0, 1] * edges[:, 1, 0]
    bad = np.flatnonzero(~(twice > 1e-12 * np.mean(edges**2)))
    if len(bad):
        msg = f"triangle {bad[0]} of the flat sheet is flipped or has no area; choose another start of the flattening"
        raise InputError(msg)
    slopes = np.stack([-edges[..., 1], edges[..., 0]], axis=-1) / twice[:, None, None]
    return slopes, twice / 2


def _operator(nodes: Ints, weights: Floats, n_vertices: int) -> Any:
    """Sparse matrix from vertex values to ``weights`` (n_f, k, components), component by component."""
    n_f, k, components = weights.shape
    rows = np.arange(0, n_f * components * k + 1, k)
    columns = np.tile(nodes.ravel(), components)
    return sparse.csr_matrix((np.moveaxis(weights, 2, 0).ravel(), columns, rows), shape=(n_f * components, n_vertices))


def _patches(uv: Floats, faces: Ints) -> tuple[Ints, Floats]:
    """Choose six nodes per triangle: (n_f, 6) nodes and (n_f, 6, 3) second derivatives."""
    patch = np.hstack([faces, _opposite(faces)])
    bends, error = _quadratic(uv, patch)
    poor = np.flatnonzero(error > WORST_PATCH * _equilateral())
    if len(poor):
        patch[poor] = _choose(uv, faces, poor)
        bends[poor], error[poor] = _quadratic(uv, patch[poor])
    if not np.isfinite(error).all():
        bad = int(np.flatnonzero(~np.isfinite(error))[0])
        msg = f"triangle {bad} of the flat sheet has too few neighbours to measure curvature; use smaller domains"
        raise InputError(msg)
    return patch, bends


def _opposite(faces: Ints) -> Ints:
    """Return the vertex across each edge (n_f, 3); at the border the triangle's own vertex, which spans no patch."""
    n = int(faces.max()) + 1
    start, end = np.roll(faces, -1, axis=1).ravel(), np.roll(faces, -2, axis=1).ravel()
    keys, twins, apex = start * n + end, end * n + start, faces.ravel()
    order = np.argsort(keys)
    place = order[np.minimum(np.searchsorted(keys, twins, sorter=order), len(keys) - 1)]
    across: Ints = np.where(keys[place] == twins, apex[place], apex)
    return across.reshape(-1, 3)


def _quadratic(uv: Floats, patch: Ints) -> tuple[Floats, Floats]:
    """Second derivatives (k, 6, 3) of the quadratics through ``patch`` (k, 6), and how much they err on cubics (k,)."""
    nodes = uv[patch] - uv[patch[:, :3]].mean(axis=1, keepdims=True)
    length = np.sqrt((nodes[:, :3] ** 2).mean(axis=(1, 2)))[:, None, None]
    u, v = np.moveaxis(nodes / length, 2, 0)
    monomials = np.stack([np.ones_like(u), u, v, u * u / 2, v * v / 2, u * v], axis=2)
    usable = np.abs(np.linalg.det(monomials)) > 1e-6
    monomials[~usable] = np.eye(6)
    weights = np.linalg.inv(monomials)[:, 3:, :]
    error = np.einsum("kgj,kj->k", np.abs(weights), np.hypot(u, v) ** 3)
    return np.moveaxis(weights, 1, 2) / length**2, np.where(usable, error, np.inf)


def _equilateral() -> float:
    """Error of the patch of four equilateral triangles: the yardstick of the others."""
    corners = np.exp(2j * np.pi * np.arange(3) / 3)
    points = np.concatenate([corners, -2 * corners])
    return float(_quadratic(np.column_stack([points.real, points.imag]), np.arange(6)[None])[1][0])


def _choose(uv: Floats, faces: Ints, chosen: Ints) -> Ints:
    """For the triangles ``chosen`` (k,), return the patch (k, 6) of nearby nodes that errs least on cubics."""
    triples = np.array(list(combinations(range(NEIGHBOURS), 3)))
    near = _neighbours(uv, faces, chosen)
    own = np.broadcast_to(faces[chosen][:, None], (len(chosen), len(triples), 3))
    tried = np.concatenate([own, near[:, triples]], axis=2)
    best = _quadratic(uv, tried.reshape(-1, 6))[1].reshape(len(chosen), -1).argmin(axis=1)
    found: Ints = tried[np.arange(len(chosen)), best]
    return found


def _neighbours(uv: Floats, faces: Ints, chosen: Ints) -> Ints:
    """Return the nearest vertices within two edges of each triangle, (k, NEIGHBOURS), padded with its first vertex.

    Neighbours are found along the mesh: across a slit of the sheet a near vertex is not on the same shell.
    """
    n = len(uv)
    rows = np.repeat(np.arange(len(faces)), 3)
    incidence = sparse.csr_matrix((np.ones(faces.size), (rows, faces.ravel())), shape=(len(faces), n))
    steps = incidence.T @ incidence
    reach = (incidence[chosen] @ steps @ steps).tocoo()
    row, column = reach.row.astype(np.int64), reach.col.astype(np.int64)
    outer = (faces[chosen][row] != column[:, None]).all(axis=1)
    row, column = row[outer], column[outer]
    away = np.linalg.norm(uv[column] - uv[faces[chosen]].mean(axis=1)[row], axis=1)
    order = np.lexsort((column, away, row))
    row, column = row[order], column[order]
    rank = np.arange(len(row)) - np.searchsorted(row, row)
    near = np.repeat(faces[chosen][:, :1], NEIGHBOURS, axis=1)
    near[row[rank < NEIGHBOURS], rank[rank < NEIGHBOURS]] = column[rank < NEIGHBOURS]
    return near
