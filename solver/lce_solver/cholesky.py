"""Cholesky factorisation of finite-element matrices on a mesh in the plane: nested dissection, multifrontal.

SciPy has no sparse Cholesky, and its LU does no dense block arithmetic; here the work is in a few hundred dense blocks, done
by LAPACK (A. George, SIAM J. Numer. Anal. 10, 345 (1973); J. Liu, SIAM Review 34, 82 (1992)). The plane is halved again and again;
the nodes between two halves are eliminated after both, so each half is a dense front coupled only to what surrounds it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy import sparse
from scipy.linalg.blas import dsyrk, dtrsm, dtrsv
from scipy.linalg.lapack import dpotrf

from lce_solver.errors import SolverError
from lce_solver.types import Floats, Ints

LEAF = 40
"""Parts of at most this many nodes are not halved any more."""


@dataclass(frozen=True, eq=False)
class Front:
    """One dense block of the elimination; nodes are numbered in the order in which they are eliminated."""

    start: int
    """First node eliminated here."""
    stop: int
    border: Ints
    """(b,) nodes eliminated later that are coupled to this block's part, ascending."""
    into: Ints
    """(b,) place of the border nodes in the parent's front, which has its own nodes first, then its border."""
    runs: Any
    children: tuple[int, ...]
    """Fronts that leave their borders to this one."""
    pairs: slice
    """Rows of the pair list that enter here."""


@dataclass(frozen=True, eq=False)
class Plan:
    """Order of elimination of a mesh, reused by all factorisations."""

    order: Ints
    """(n,) nodes in the order of their elimination."""
    fronts: tuple[Front, ...]
    """Children before parents."""
    gather: Any
    """Sparse (n_pairs, n_elements k^2): sums the elements' blocks into node pairs, front by front."""
    row: Ints
    """(n_pairs,) place of the pair's earlier node in its front."""
    column: Ints
    """(n_pairs,) place of the later node."""


def plan(points: Floats, elements: Ints) -> Plan:
    """Order the elimination of nodes at ``points`` (n, 2), each element (n_e, k) coupling all its nodes."""
    n, k = len(points), elements.shape[1]
    ones = np.ones(elements.size)
    incidence = sparse.csr_matrix((ones, (np.repeat(np.arange(len(elements)), k), elements.ravel())), (len(elements), n))
    graph = (incidence.T @ incidence).tocsr()
    parts: list[tuple[Ints, tuple[int, ...]]] = []
    _dissect(points, graph, np.arange(n), parts)
    order = np.concatenate([nodes for nodes, _ in parts])
    place = np.empty(n, dtype=np.int64)
    place[order] = np.arange(n)
    borders = _borders(graph[order][:, order].tocsr(), parts)
    stops = np.cumsum([len(nodes) for nodes, _ in parts])
    return _number(place[elements], order, borders, stops, [children for _, children in parts])


def _dissect(points: Floats, graph: Any, nodes: Ints, parts: list[tuple[Ints, tuple[int, ...]]]) -> int:
    """Append the fronts of ``nodes`` to ``parts`` as (nodes eliminated, children); return the index of the last."""
    children: tuple[int, ...] = ()
    own = nodes
    if len(nodes) > LEAF:
        lower, middle, upper = _halve(points, graph, nodes)
        if len(lower) and len(upper):
            own = middle
            children = (_dissect(points, graph, lower, parts), _dissect(points, graph, upper, parts))
    parts.append((own, children))
    return len(parts) - 1


def _halve(points: Floats, graph: Any, nodes: Ints) -> tuple[Ints, Ints, Ints]:
    """Split across the longer side: a lower and an upper half, and between them the nodes that touch the lower one."""
    longer = np.ptp(points[nodes], axis=0).argmax()
    nodes = nodes[points[nodes, 1 - longer].argsort(kind="stable")]  # along the cut, so that borders come in long runs
    along = points[nodes, longer]
    below = along < np.median(along)
    lower, rest = nodes[below], nodes[~below]
    touched = np.zeros(graph.shape[0], dtype=bool)
    touched[graph[lower].indices] = True
    if not touched[rest].any():
        touched[rest[0]] = True  # the halves are apart; one node makes a front
    return lower, rest[touched[rest]], rest[~touched[rest]]


def _borders(graph: Any, parts: list[tuple[Ints, tuple[int, ...]]]) -> list[Ints]:
    """Later nodes coupled to each part, through its own nodes or its children's borders; ``graph`` in elimination order."""
    borders: list[Ints] = []
    stop = 0
    for nodes, children in parts:
        start, stop = stop, stop + len(nodes)
        own = graph.indices[graph.indptr[start] : graph.indptr[stop]]
        reached = np.unique(np.concatenate([own, *(borders[child] for child in children)]))
        borders.append(reached[reached >= stop].astype(np.int64))
    return borders


def _number(
    elements: Ints, order: Ints, borders: list[Ints], stops: Ints, children: list[tuple[int, ...]]
) -> Plan:
    """Sort the pairs of nodes by the front that eliminates the earlier one; ``elements`` in elimination order."""
    n, k = len(order), elements.shape[1]
    early = np.repeat(elements, k, axis=1).ravel()
    late = np.tile(elements, (1, k)).ravel()
    lower = np.flatnonzero(late >= early)
    keys, pair = np.unique(early[lower] * n + late[lower], return_inverse=True)
    by_pair = np.argsort(pair, kind="stable")
    starts = np.concatenate([[0], np.cumsum(np.bincount(pair))])
    gather = sparse.csr_matrix((np.ones(len(lower)), lower[by_pair], starts), (len(keys), len(early)))
    early, late = keys // n, keys % n
    begin = np.concatenate([[0], stops[:-1]])
    fronts = [np.concatenate([np.arange(*span), border]) for span, border in zip(zip(begin, stops), borders)]
    parent = {child: i for i, mine in enumerate(children) for child in mine}
    limits = np.searchsorted(early, np.concatenate([begin, [n]]))
    column = np.empty_like(late)
    numbered = []
    for i, border in enumerate(borders):
        pairs = slice(int(limits[i]), int(limits[i + 1]))
        column[pairs] = np.searchsorted(fronts[i], late[pairs])
        into = np.searchsorted(fronts[parent[i]], border) if i in parent else border
        numbered.append(Front(int(begin[i]), int(stops[i]), border, into, _runs(into), children[i], pairs))
    row = early - np.repeat(begin, np.diff(limits))
    return Plan(order, tuple(numbered), gather, row, column)


def _runs(into):
    cuts = np.flatnonzero(np.diff(into) > 1) + 1
    return [(int(run[0]), int(run[-1]) + 1) for run in np.split(into, cuts) if len(run)]


def factorise(ordering: Plan, blocks: Floats, shift: Floats) -> Callable[[Floats], Floats]:
    """Factorise the sum of the elements' ``blocks`` (n_e, k, k, d, d) + ``shift`` (n,) on each node's diagonal.

    Returns
    -------
    The function that solves for right-hand sides (n, d).

    Raises
    ------
    SolverError
        The matrix is not positive definite.
    """
    d = blocks.shape[-1]
    entries = (ordering.gather @ blocks.reshape(-1, d * d)).reshape(-1, d, d)
    shifts = np.repeat(shift[ordering.order], d)
    factors: list[tuple[Floats, Floats]] = []
    left: list[Floats] = []  # what each front's elimination leaves on its border, until the parent takes it
    for front in ordering.fronts:
        matrix = _assemble(ordering, front, entries, left)
        k = d * (front.stop - front.start)
        matrix[range(k), range(k)] += shifts[d * front.start : d * front.stop]
        corner, info = dpotrf(matrix[:k, :k], lower=1, clean=0)
        if info:
            msg = f"the stiffness is not positive definite at vertex {ordering.order[front.start + (info - 1) // d]}"
            raise SolverError(msg)
        side, rest = matrix[k:, :k], matrix[k:, k:]
        if len(front.border):  # BLAS takes no empty matrices
            side = dtrsm(1.0, corner, side, side=1, lower=1, trans_a=1)
            rest = dsyrk(-1.0, side, beta=1.0, c=rest, lower=1)
        left.append(rest)
        factors.append((corner, side))
    return lambda right: _solve(ordering, factors, right)


def _assemble(ordering: Plan, front: Front, entries: Floats, left: list[Floats]) -> Floats:
    """Lower triangle of a front, in Fortran's order: its own entries and what its children left."""
    d = entries.shape[-1]
    size = front.stop - front.start + len(front.border)
    upper = np.zeros((size * d, size * d))
    upper.reshape(size, d, size, d)[ordering.row[front.pairs], :, ordering.column[front.pairs], :] = entries[front.pairs]
    for child in front.children:
        _add(upper, left[child].T, [(d * start, d * stop) for start, stop in ordering.fronts[child].runs], d)
        left[child] = left[child][:0]
    return upper.T


def _add(upper, rest, runs, d):
    offsets = np.cumsum([0] + [b - a for a, b in runs]).tolist()
    for i, (r0, r1) in enumerate(runs):
        strip = upper[r0:r1]
        part = rest[offsets[i]:offsets[i + 1]]
        for j in range(i, len(runs)):
            c0, c1 = runs[j]
            strip[:, c0:c1] += part[:, offsets[j]:offsets[j + 1]]


def _freedoms(nodes: Ints, d: int) -> Ints:
    """The d unknowns of each node."""
    return (nodes[:, None] * d + np.arange(d)).ravel()


def _solve(ordering: Plan, factors: list[tuple[Floats, Floats]], right: Floats) -> Floats:
    """Forward and backward substitution for ``right`` (n, d)."""
    d = right.shape[1]
    y = right[ordering.order].ravel()
    borders = [_freedoms(front.border, d) for front in ordering.fronts]
    spans = [slice(d * front.start, d * front.stop) for front in ordering.fronts]
    for (corner, side), span, border in zip(factors, spans, borders, strict=True):
        y[span] = dtrsv(corner, y[span], lower=1)
        y[border] -= side @ y[span]
    for (corner, side), span, border in zip(factors[::-1], spans[::-1], borders[::-1], strict=True):
        y[span] = dtrsv(corner, y[span] - side.T @ y[border], lower=1, trans=1)
    solution = np.empty_like(right)
    solution[ordering.order] = y.reshape(-1, d)
    return solution
