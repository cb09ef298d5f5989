"""Cholesky factorisation of finite-element matrices on a mesh in the plane: nested dissection, multifrontal.

SciPy has no sparse Cholesky, and its LU is four times slower on these matrices: here the work is in a few hundred dense
blocks, done by LAPACK (A. George, SIAM J. Numer. Anal. 10, 345 (1973); J. Liu, SIAM Review 34, 82 (1992)). The plane is
halved again and again; the nodes between two halves are eliminated after both, so each half is a dense front, coupled
only to what surrounds it.
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
    runs: tuple[tuple[int, int], ...]
    """Where the border's nodes are in the parent's front (its own nodes, then its border): starts and stops of runs."""
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
    incidence = sparse.csr_matrix((ones, elements.ravel(), np.arange(0, elements.size + 1, k)), (len(elements), n))
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
    """Later nodes coupled to each part, by itself or through its children; ``graph`` in elimination order."""
    borders: list[Ints] = []
    stop = 0
    for nodes, children in parts:
        start, stop = stop, stop + len(nodes)
        own = graph.indices[graph.indptr[start] : graph.indptr[stop]]
        reached = np.unique(np.concatenate([own, *(borders[child] for child in children)]))
        borders.append(reached[reached >= stop].astype(np.int64))
    return borders


def _number(elements: Ints, order: Ints, borders: list[Ints], stops: Ints, children: list[tuple[int, ...]]) -> Plan:
    """Sort the pairs of nodes by the front that eliminates the earlier one; ``elements`` in elimination order."""
    gather, early, late = _pairs(elements, len(order))
    starts = np.concatenate([[0], stops[:-1]])
    nodes = [np.concatenate([np.arange(a, b), border]) for a, b, border in zip(starts, stops, borders, strict=True)]
    parent = {child: i for i, mine in enumerate(children) for child in mine}
    limits = np.searchsorted(early, np.append(starts, len(order)))
    column, fronts = np.empty_like(late), []
    for i, border in enumerate(borders):
        pairs = slice(int(limits[i]), int(limits[i + 1]))
        column[pairs] = np.searchsorted(nodes[i], late[pairs])
        runs = _runs(np.searchsorted(nodes[parent[i]], border)) if i in parent else ()
        fronts.append(Front(int(starts[i]), int(stops[i]), border, runs, children[i], pairs))
    return Plan(order, tuple(fronts), gather, early - np.repeat(starts, np.diff(limits)), column)


def _pairs(elements: Ints, n: int) -> tuple[Any, Ints, Ints]:
    """Pairs of nodes that share an element, (early, late), and the matrix that sums the elements' blocks into them."""
    k = elements.shape[1]
    early, late = np.repeat(elements, k, axis=1).ravel(), np.tile(elements, (1, k)).ravel()
    upper = np.flatnonzero(late >= early)
    keys, pair = np.unique(early[upper] * n + late[upper], return_inverse=True)
    starts = np.concatenate([[0], np.cumsum(np.bincount(pair))])
    blocks = upper[np.argsort(pair, kind="stable")]
    gather = sparse.csr_matrix((np.ones(len(upper)), blocks, starts), (len(keys), len(early)))
    return gather, keys // n, keys % n


def _runs(places: Ints) -> tuple[tuple[int, int], ...]:
    """Starts and stops of the runs of consecutive numbers."""
    cuts = np.flatnonzero(np.diff(places) > 1) + 1
    return tuple((int(run[0]), int(run[-1]) + 1) for run in np.split(places, cuts) if len(run))


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
            at = ordering.order[front.start + (info - 1) // d]
            msg = f"the stiffness is not positive definite at vertex {at}: take a thicker film or smaller domains"
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
    row, column = ordering.row[front.pairs], ordering.column[front.pairs]
    upper.reshape(size, d, size, d)[row, :, column, :] = entries[front.pairs]
    for child in front.children:
        _add(upper, left[child].T, [(d * start, d * stop) for start, stop in ordering.fronts[child].runs])
        left[child] = left[child][:0]
    return upper.T


def _add(onto: Floats, rest: Floats, runs: list[tuple[int, int]]) -> None:
    """Add the upper triangle of a child's rest where the runs say: five times as fast as entry by entry."""
    stops = np.cumsum([stop - start for start, stop in runs])
    spans = [slice(stop - (run[1] - run[0]), stop) for run, stop in zip(runs, stops, strict=True)]
    for i, (top, bottom) in enumerate(runs):
        for (start, stop), columns in zip(runs[i:], spans[i:], strict=True):
            onto[top:bottom, start:stop] += rest[spans[i], columns]


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
