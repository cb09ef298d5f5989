"""Merging of marks that touch, so that each becomes one recess: a face's holes must not meet."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from lce_solver.types import Floats, Ints
from lce_workbench.core.mask import nanometres
from lce_workbench.core.units import NM

Bools = NDArray[np.bool_]


def merged(polygons: Sequence[Floats]) -> list[Floats]:
    """Outlines (k, 2) of the regions that the polygons cover together, counter-clockwise [mm].

    A polygon whose bounding box meets no other's stays as it is. Polygons whose boxes meet must be axis-parallel
    rectangles; their outline is on the writer's 1 nm grid.

    Raises
    ------
    ValueError
        The regions have no simple outline: they touch in a point only, or enclose an island.
    """
    if not len(polygons):
        return []
    low = nanometres(np.array([p.min(axis=0) for p in polygons]))
    high = nanometres(np.array([p.max(axis=0) for p in polygons]))
    meets = np.all((low[:, None] <= high) & (low <= high[:, None]), axis=2)
    group = _groups(meets)
    n = int(group.max()) + 1
    alone = np.bincount(group) == 1
    return [
        polygons[int(np.argmax(group == g))] if alone[g] else _outline(low[group == g], high[group == g])
        for g in range(n)
    ]


def _groups(meets: Bools) -> Ints:
    """(n,) group of each polygon under the relation (n, n), from 0; NumPy alone, because it runs inside FreeCAD too."""
    label = np.arange(len(meets))
    while np.any((least := np.where(meets, label, len(label)).min(axis=1)) != label):
        label = least
    return np.unique(label, return_inverse=True)[1]


def _outline(low: NDArray[np.int32], high: NDArray[np.int32]) -> Floats:
    """Outline (k, 2) of touching rectangles with corners ``low``, ``high`` (n, 2) [nm], in mm."""
    x, y = (np.unique(np.concatenate([low[:, i], high[:, i]])) for i in (0, 1))
    covered = np.zeros((len(x) + 1, len(y) + 1), dtype=bool)  # cell (i, j) ends at x[i], y[j]; a free rim all round
    for (x0, y0), (x1, y1) in zip(low, high, strict=True):
        covered[slice(*(1 + np.searchsorted(x, (x0, x1)))), slice(*(1 + np.searchsorted(y, (y0, y1))))] = True
    nodes = _walk(_sides(covered))
    ring = np.stack([x[nodes[:, 0]], y[nodes[:, 1]]], axis=1) * NM
    step = np.roll(nodes, -1, axis=0) - nodes
    corner = np.any(step != np.roll(step, 1, axis=0), axis=1)
    return ring[corner]


def _sides(covered: Bools) -> Ints:
    """Sides (n, 2, 2) of the covered cells that bound the region, from node to node, the region on their left."""
    sides = []
    for axis, from_first in ((0, False), (0, True), (1, True), (1, False)):
        first = np.delete(covered, -1, axis=axis)
        second = np.delete(covered, 0, axis=axis)
        node = np.argwhere(first & ~second if from_first else second & ~first)
        along = np.array([0, 1]) if axis == 0 else np.array([1, 0])
        before = node - along  # the cell ends at `node`, so its side begins one step before
        forward = from_first == (axis == 0)
        sides.append(np.stack([before, node] if forward else [node, before], axis=1))
    return np.concatenate(sides)


def _walk(sides: Ints) -> Ints:
    """Nodes (k, 2) of the one loop that ``sides`` form."""
    following = {tuple(a): tuple(b) for a, b in sides.tolist()}
    node = start = min(following)
    loop = []
    while node in following:
        loop.append(node)
        node = following.pop(node)
    if len(loop) != len(sides):
        msg = f"rectangles that touch in a point only, or enclose an island, have no outline (near node {start})"
        raise ValueError(msg)
    return np.array(loop)
