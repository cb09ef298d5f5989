"""Refining a target until its triangles are as small as the domains: each triangle becomes four."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy.sparse import coo_array, csr_array, eye, vstack

from lce_solver.errors import InputError
from lce_solver.geometry import mean_edge
from lce_solver.topology import edge_table
from lce_solver.types import Floats, Ints, Surface

MOST_FACES = 2_000_000
"""A request beyond this is a slip of the unit; it would not fit into memory later on."""


def subdivide(surface: Surface, edge: float, scheme: str) -> Surface:
    """Refine until the mean edge is at most ``edge``; a mesh that is fine enough comes back unchanged.

    Parameters
    ----------
    edge : wanted mean edge, in the surface's unit of length.
    scheme : a name in `SCHEMES`: ``loop`` for smooth surfaces, ``midpoint`` for faceted ones.

    Raises
    ------
    InputError
        Unknown scheme, a wanted edge that is not positive, or more than `MOST_FACES` triangles.
    """
    if scheme not in SCHEMES:
        msg = f"subdivision scheme {scheme!r} is unknown; choose one of {', '.join(SCHEMES)}"
        raise InputError(msg)
    coarse = mean_edge(surface)
    if not (edge > 0 and len(surface.faces) * max(1.0, coarse / edge) ** 2 <= MOST_FACES):
        msg = (
            f"a mean edge of {edge:g} cannot be reached from a mesh with {len(surface.faces)} triangles and a mean "
            f"edge of {coarse:g} within {MOST_FACES} triangles; ask for a larger edge"
        )
        raise InputError(msg)
    while mean_edge(surface) > edge:
        surface = refine(surface, scheme)
    return surface


def refine(surface: Surface, scheme: str) -> Surface:
    """One step: the old vertices come first (moved by the scheme), then one new vertex per edge, in `edges`' order."""
    faces = surface.faces
    _, which, _ = edge_table(faces)
    ab, bc, ca = which.reshape(3, -1) + len(surface.vertices)
    a, b, c = faces.T
    four = np.stack([(a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)])
    weights = SCHEMES[scheme](faces, len(surface.vertices))
    # about the centre, so that rounding does not depend on where the mesh lies
    centre = surface.vertices.mean(axis=0)
    return Surface(weights @ (surface.vertices - centre) + centre, four.transpose(2, 0, 1).reshape(-1, 3))


def midpoint_weights(faces: Ints, n_vertices: int) -> csr_array:
    """(n_v + n_e, n_v): vertices stay, edges are halved. The surface as a set of points does not change."""
    edges, _, _ = edge_table(faces)
    row = np.arange(len(edges)).repeat(2)
    half = _matrix(np.full(row.shape, 0.5), row, edges.ravel(), (len(edges), n_vertices))
    return csr_array(vstack([eye(n_vertices), half]))


def loop_weights(faces: Ints, n_vertices: int) -> csr_array:
    """(n_v + n_e, n_v): Loop's scheme (1987) with the cubic B-spline on the boundary (Hoppe et al. 1994).

    trimesh's own `subdivide_loop` takes every neighbour on the boundary for a neighbour along the boundary, which is
    wrong at an inner edge between two boundary vertices; hence these weights.
    """
    edges, which, count = edge_table(faces)
    rim = count == 1
    row = np.arange(len(edges)).repeat(2)
    opposite = faces[:, [2, 0, 1]].T.ravel()
    across = ~rim[which]
    odd = _matrix(
        np.concatenate([np.where(rim, 1 / 2, 3 / 8).repeat(2), np.full(across.sum(), 1 / 8)]),
        np.concatenate([row, which[across]]),
        np.concatenate([edges.ravel(), opposite[across]]),
        (len(edges), n_vertices),
    )
    return csr_array(vstack([_vertices(faces, n_vertices, 1 / 8, _beta), odd]))


def loop_limit(faces: Ints, n_vertices: int) -> csr_array:
    """(n_v, n_v): where Loop's scheme takes the vertices in the end (Hoppe et al. 1994)."""
    return _vertices(faces, n_vertices, 1 / 6, lambda valence: 1 / (valence + 3 / (8 * _beta(valence))))


def _vertices(faces: Ints, n_vertices: int, rim_weight: float, inner_weight: Callable[[Ints], Floats]) -> csr_array:
    """(n_v, n_v) means of vertices and neighbours, from the weight of each: ``inner_weight`` knows their number."""
    edges, _, count = edge_table(faces)
    rim = count == 1
    on_rim = np.zeros(n_vertices, dtype=bool)
    on_rim[edges[rim]] = True
    vertex, other = np.concatenate([edges, edges[:, ::-1]]).T
    valence = np.maximum(np.bincount(vertex, minlength=n_vertices), 1)
    weight = np.where(on_rim[vertex], np.where(np.tile(rim, 2), rim_weight, 0.0), inner_weight(valence)[vertex])
    pull = _matrix(weight, vertex, other, (n_vertices, n_vertices))
    keep = 1 - np.ravel(pull.sum(axis=1))
    return csr_array(pull + _matrix(keep, np.arange(n_vertices), np.arange(n_vertices), pull.shape))


def _beta(valence: Ints) -> Floats:
    """Loop's weight of each neighbour of an inner vertex."""
    return (5 / 8 - (3 / 8 + np.cos(2 * np.pi / valence) / 4) ** 2) / valence


def _matrix(values: Floats, rows: Ints, columns: Ints, shape: tuple[int, int]) -> csr_array:
    return csr_array(coo_array((values, (rows, columns)), shape=shape))


SCHEMES: dict[str, Callable[[Ints, int], csr_array]] = {"loop": loop_weights, "midpoint": midpoint_weights}
