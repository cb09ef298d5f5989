"""Lengths, areas and frames of a surface, vectorised over its triangles."""

from __future__ import annotations

import numpy as np

from lce_solver.topology import edges
from lce_solver.types import Floats, Ints, Surface


def edge_lengths(surface: Surface) -> Floats:
    """(n_e,) lengths, in the order of `edges`."""
    a, b = surface.vertices[edges(surface.faces).T]
    return np.asarray(np.linalg.norm(b - a, axis=1))


def mean_edge(surface: Surface) -> float:
    """Mean length over all edges, each counted once."""
    return float(edge_lengths(surface).mean())


def area_vectors(surface: Surface) -> Floats:
    """(n_f, 3) normals of the triangles, as long as the areas are large."""
    a, b, c = np.moveaxis(surface.vertices[surface.faces], 1, 0)
    return np.asarray(np.cross(b - a, c - a) / 2)


def face_areas(surface: Surface) -> Floats:
    """(n_f,) areas [unit of length squared]."""
    return np.asarray(np.linalg.norm(area_vectors(surface), axis=1))


def frames(surface: Surface) -> tuple[Floats, Floats, Floats]:
    """Right-handed orthonormal frame (e1, e2, normal) of each triangle, e1 along its first edge; each (n_f, 3)."""
    a, b, _ = np.moveaxis(surface.vertices[surface.faces], 1, 0)
    e1 = _unit(b - a)
    normal = _unit(area_vectors(surface))
    return e1, np.cross(normal, e1), normal


def vertex_normals(surface: Surface) -> Floats:
    """(n_v, 3) unit normals, the mean of the adjacent triangles weighted with their angles at the vertex."""
    corners = surface.vertices[surface.faces]
    normal = _unit(area_vectors(surface))
    total = np.zeros_like(surface.vertices)
    for i in range(3):
        to_next, to_last = corners[:, i - 2] - corners[:, i], corners[:, i - 1] - corners[:, i]
        angle = np.arctan2(np.linalg.norm(np.cross(to_next, to_last), axis=1), np.sum(to_next * to_last, axis=1))
        np.add.at(total, surface.faces[:, i], angle[:, None] * normal)
    return _unit(total)


def shared(values: Floats, faces: Ints, count: int) -> Floats:
    """(n_v,) a third of the values (n_f,) of the triangles around each of ``count`` vertices."""
    return np.asarray(np.bincount(faces.ravel(), np.repeat(values / 3, 3), minlength=count), dtype=np.float64)


def evened(surface: Surface, values: Floats, rounds: int) -> Floats:
    """(n_v,) means at the vertices of ``values`` (n_f,) on the triangles, averaged ``rounds`` times over an edge."""
    weight, corner = np.repeat(face_areas(surface), 3), surface.faces.ravel()
    whole = np.bincount(corner, weight)
    for _ in range(rounds):
        at_vertex = np.bincount(corner, weight * np.repeat(values, 3)) / whole
        values = at_vertex[surface.faces].mean(axis=1)
    return np.asarray(at_vertex)


def _unit(vectors: Floats) -> Floats:
    return np.asarray(vectors / np.linalg.norm(vectors, axis=1, keepdims=True))
