"""Connectivity of triangle meshes: no coordinates here, only vertex indices.

A half-edge runs from corner i to corner i + 1 of its face; half-edge ``i * n_f + f`` belongs to corner i of face f.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from lce_solver.types import Ints


def half_edges(faces: Ints) -> Ints:
    """(3 n_f, 2) start and end vertex of every half-edge."""
    return np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])


def edges(faces: Ints) -> Ints:
    """(n_e, 2) every edge once, its smaller vertex first, in lexicographic order."""
    return edge_table(faces)[0]


def edge_table(faces: Ints) -> tuple[Ints, Ints, Ints]:
    """Edges, the edge of each half-edge, and the number of triangles at each edge.

    Returns
    -------
    edges (n_e, 2), edge of half-edge (3 n_f,), triangles at edge (n_e,).
    """
    a, b = half_edges(faces).T
    # one integer per edge: much faster to sort than rows, and the same in every NumPy
    base = int(faces.max(initial=0)) + 1
    numbers = np.minimum(a, b) * base + np.maximum(a, b)
    key, which, count = np.unique(numbers, return_inverse=True, return_counts=True)
    return np.column_stack(np.divmod(key, base)), which.reshape(-1), count


def boundary_loops(faces: Ints) -> list[Ints]:
    """Boundaries as closed loops of vertices that keep the surface on their left, each from its smallest vertex.

    The mesh is an oriented manifold: every boundary vertex has one boundary edge out of it.
    """
    ends = half_edges(faces)
    _, which, count = edge_table(faces)
    following = dict(ends[count[which] == 1].tolist())
    loops = []
    for start in sorted(following):
        loop = []
        while start in following:
            loop.append(start)
            start = following.pop(start)  # noqa: PLW2901 - the walk ends where it began
        if loop:
            loops.append(np.array(loop, dtype=np.int64))
    return loops


def neighbours(faces: Ints) -> tuple[Ints, Ints]:
    """(n_i, 2) pairs of half-edges that share an edge with two triangles, and the number of the edge (n_i,)."""
    _, which, count = edge_table(faces)
    order = np.argsort(which, kind="stable")
    inner = order[(count == 2)[which[order]]]
    return inner.reshape(-1, 2), which[inner[::2]]


def pieces(faces: Ints) -> Ints:
    """(n_f,) number of the edge-connected piece of each triangle, counted from the first triangle."""
    pairs, _ = neighbours(faces)
    n = len(faces)
    return _components(pairs[:, 0] % n, pairs[:, 1] % n, n)


def flips(faces: Ints) -> NDArray[np.bool_] | None:
    """Which triangles of one piece must be turned over to agree with the majority; None for a one-sided surface.

    Each triangle has two sides. Neighbours glue sides to sides; a surface is two-sided if the glued sheets stay apart.
    """
    pairs, _ = neighbours(faces)
    n = len(faces)
    start = half_edges(faces)[:, 0]
    f, g = pairs.T % n
    clash = (start[pairs[:, 0]] == start[pairs[:, 1]]).astype(np.int64)  # both run the same way along the edge
    side = _components(np.concatenate([f, f + n]), np.concatenate([g + n * clash, g + n * (1 - clash)]), 2 * n)
    if side[0] == side[n]:
        return None
    turned: NDArray[np.bool_] = side[:n] != side[0]
    return ~turned if 2 * turned.sum() > n else turned


def fans(faces: Ints, cut: NDArray[np.bool_] | None = None) -> Ints:
    """(3 n_f,) number of the fan of each corner (as half-edges are numbered): corners joined by edges at a vertex.

    Edges of ``cut`` (n_e,) join nothing.
    """
    pairs, edge = neighbours(faces)
    if cut is not None:
        pairs = pairs[~cut[edge]]
    n = len(faces)
    corner, follower = np.arange(3 * n), np.roll(np.arange(3 * n), -n)
    ends = half_edges(faces)
    a, b = pairs.T
    same = ends[a, 0] == ends[b, 0]
    at_start = np.where(same, b, follower[b])
    at_end = np.where(same, follower[b], b)
    rows = np.concatenate([corner[a], follower[a]])
    return _components(rows, np.concatenate([at_start, at_end]), 3 * n)


def _components(rows: Ints, columns: Ints, size: int) -> Ints:
    """(size,) component of each node of an undirected graph, numbered in the order of their first nodes."""
    # here, because boundaries are also asked for inside FreeCAD, where Debian may have NumPy alone
    from scipy.sparse import coo_array  # noqa: PLC0415
    from scipy.sparse.csgraph import connected_components  # noqa: PLC0415

    graph = coo_array((np.ones(len(rows), dtype=np.int8), (rows, columns)), shape=(size, size))
    label = connected_components(graph.tocsr(), directed=False)[1]
    _, first, inverse = np.unique(label, return_index=True, return_inverse=True)
    return np.argsort(np.argsort(first))[inverse.reshape(-1)]
