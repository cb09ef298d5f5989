"""Cuts that open a target: where it is closed, has handles, or is too curved for a sheet without a seam.

A cut is a polyline (k, 3) on the target, in its unit of length, so that it can be planned on a coarse mesh and made in
a fine one.
"""

from __future__ import annotations

from itertools import pairwise

import igl
import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.sparse.csgraph import dijkstra

from lce_solver import judge
from lce_solver.geometry import edge_lengths, evened, face_areas, mean_edge
from lce_solver.metric import Stop, flatten, lay_flat
from lce_solver.topology import boundary_loops, edge_table, edges, fans, half_edges
from lce_solver.types import Flattening, Floats, Ints, Material, Surface

MOST = 6
"""Cuts that are tried."""
GOOD = 0.05
"""A target whose stretches miss by less, rms, stays as it is."""
WORTH = 0.8
"""Each cut must lower the rms error to this share at least."""
ANGLES = 4
"""Directions of the first stretch with which a cut is judged."""
QUICK = Stop(1e-4, 400)
"""How far they are solved."""
EVEN = 4
"""Rounds of averaging of the error whose peak is cut to."""
STRIDE = 4
"""Edges between the points of a planned cut."""
STRAIGHT = 30
"""Rounds of averaging that make a seam straight."""
SLIVER = 0.5
"""A straight seam may make the smallest angle of all triangles no smaller than this part of it."""
SNAP = 1.5
"""An end of a cut this close to the rim, in mean edges, is on the rim."""


def opened(surface: Surface, cuts: tuple[Floats, ...], *, straight: bool = False) -> Surface:
    """The surface cut along the edges closest to ``cuts``; both sides of a cut get vertices of their own.

    If the cuts shall be ``straight``, the vertices along and about them are moved within the surface.
    """
    if not cuts:
        return surface
    edge, _, count = edge_table(surface.faces)
    chosen = count == 1
    for cut in cuts:
        chosen |= _along(surface, cut, edge, np.unique(edge[chosen]))
    fan = fans(surface.faces, chosen)
    _, corner = np.unique(fan, return_index=True)
    points = straightened(surface, edge[chosen & (count == 2)]) if straight else surface.vertices
    return Surface(points[half_edges(surface.faces)[corner, 0]], fan.reshape(3, -1).T)


def straightened(surface: Surface, seam: Ints) -> Floats:
    """(n_v, 3) vertices moved within the surface so that the ``seam`` (k, 2) of edges runs straight.

    Ends, forks and the rim stay. A seam whose triangles would become slivers stays as it is.
    """
    n, free = len(surface.vertices), np.bincount(seam.ravel(), minlength=len(surface.vertices)) == 2
    free[_rim(surface)] = False
    line, mesh = (_adjacency(pairs, n) for pairs in (seam, edges(surface.faces)))
    about = mesh @ (mesh @ free) > 0
    about[seam.ravel()] = about[_rim(surface)] = False
    tree, points = igl.AABB(), np.array(surface.vertices, order="C")
    vertices, faces = points.copy(), np.array(surface.faces, order="C")
    tree.init(vertices, faces)
    for _ in range(STRAIGHT):
        for chosen, graph in ((free, line), (about, mesh)):
            mean = (graph @ points)[chosen] / (graph @ np.ones(n))[chosen, None]
            points[chosen] = tree.squared_distance(vertices, faces, (points[chosen] + mean) / 2)[2]
    return points if _narrowest(points, faces) > SLIVER * _narrowest(vertices, faces) else surface.vertices


def _adjacency(pairs: Ints, n: int) -> sparse.csr_array:
    """(n, n) 1 where two vertices are a pair."""
    both = np.concatenate([pairs, pairs[:, ::-1]])
    return sparse.csr_array((np.ones(len(both)), tuple(both.T)), shape=(n, n))


def _narrowest(points: Floats, faces: Ints) -> float:
    """Smallest angle of all triangles [rad]."""
    corner = points[faces]
    ahead, back = np.roll(corner, -1, axis=1) - corner, np.roll(corner, 1, axis=1) - corner
    across = np.linalg.norm(np.cross(ahead, back), axis=2)
    return float(np.arctan2(across, np.einsum("fki,fki->fk", ahead, back)).min())


def _along(surface: Surface, cut: Floats, edge: Ints, rim: Ints) -> NDArray[np.bool_]:
    """(n_e,) the edges on the shortest way through the vertices closest to a polyline; ends near the rim are on it."""
    graph = _graph(surface)
    chosen = np.zeros(len(edge), dtype=bool)
    stops = [int(np.argmin(np.linalg.norm(surface.vertices - point, axis=1))) for point in cut]
    for k in (0, -1) if len(rim) else ():
        away = np.linalg.norm(surface.vertices[rim] - cut[k], axis=1)
        if away.min() < SNAP * mean_edge(surface):
            stops[k] = int(rim[np.argmin(away)])
    for start, end in pairwise(stops):
        for pair in pairwise(_way(graph, start, end)):
            chosen |= (edge == sorted(pair)).all(axis=1)
    return chosen


def _way(graph: sparse.csr_array, start: int, end: int) -> list[int]:
    """The vertices of the shortest way."""
    before = dijkstra(graph, directed=False, indices=start, return_predecessors=True)[1]
    way = [end]
    while way[-1] != start:
        way.append(int(before[way[-1]]))
    return way[::-1]


def _thinned(surface: Surface, way: list[int]) -> Floats:
    """(k, 3) every `STRIDE`-th point of a way and its end: a finer mesh finds the same way between them."""
    return surface.vertices[[*way[:-1:STRIDE], way[-1]]]


def _rim(surface: Surface) -> Ints:
    loops = boundary_loops(surface.faces)
    return np.concatenate(loops) if loops else np.empty(0, np.int64)


def _graph(surface: Surface) -> sparse.csr_array:
    n = len(surface.vertices)
    return sparse.csr_array((edge_lengths(surface), tuple(edges(surface.faces).T)), shape=(n, n))


def seams(surface: Surface) -> Ints:
    """(k, 2, 2) pairs of rim edges that lie on each other, the two sides of a cut; each from and to a vertex."""
    loops = boundary_loops(surface.faces)
    rim = np.concatenate([np.stack([loop, np.roll(loop, -1)], axis=1) for loop in loops])
    _, place = np.unique(surface.vertices, axis=0, return_inverse=True)
    sides = np.sort(place.reshape(-1)[rim], axis=1)
    _, which, count = np.unique(sides, axis=0, return_inverse=True, return_counts=True)
    order = np.argsort(which.reshape(-1), kind="stable")
    pairs: Ints = rim[order[(count == 2)[which.reshape(-1)[order]]]].reshape(-1, 2, 2)
    return pairs


def handles(surface: Surface) -> int:
    """Handles of the surface: 0 for a sphere, a disk and a disk with holes, 1 for a torus."""
    euler = len(surface.vertices) - len(edges(surface.faces)) + len(surface.faces)
    return (2 - euler - len(boundary_loops(surface.faces))) // 2


def proposed(surface: Surface, material: Material, most: int = MOST) -> tuple[Floats, ...]:
    """Cuts with which a target lies flat within `GOOD`, or as near as ``most`` cuts come; none if it does without.

    A closed surface is cut between its farthest points, handles as a shortest tree does it. Then the error of a quick
    solution says where to go on: two rims are joined, or the place with the largest error is joined with the rim. A cut
    that gains little ends it.
    """
    cuts = _opening(surface)
    trial = opened(surface, cuts)
    flat, error = _judged(trial, material)
    while len(cuts) < most and error > GOOD:
        further = _next(trial, flat, material)
        longer = opened(surface, (*cuts, further))
        again, less = _judged(longer, material)
        if less > WORTH * error:
            break
        cuts, trial, flat, error = (*cuts, further), longer, again, less
    return cuts


def _opening(surface: Surface) -> tuple[Floats, ...]:
    """What makes a disk with holes of any surface."""
    if handles(surface):
        ways = igl.cut_to_disk(np.array(surface.faces, order="C"))
        return tuple(surface.vertices[np.asarray(way)] for way in ways)
    if len(_rim(surface)):
        return ()
    graph = _graph(surface)
    start = int(np.argmax(dijkstra(graph, directed=False, indices=0)))
    end = int(np.argmax(dijkstra(graph, directed=False, indices=start)))
    return (_thinned(surface, _way(graph, start, end)),)


def _next(surface: Surface, flat: Flattening, material: Material) -> Floats:
    """The next cut: between two rims, or from where the error is largest to the rim."""
    loops = sorted(boundary_loops(surface.faces), key=len)
    graph = _graph(surface)
    if len(loops) > 1:
        reach = dijkstra(graph, directed=False, indices=loops[0])
        others = np.concatenate(loops[1:])
        start, end = np.unravel_index(np.argmin(reach[:, others]), (len(loops[0]), len(others)))
        return _thinned(surface, _way(graph, int(loops[0][start]), int(others[end])))
    reach = dijkstra(graph, directed=False, indices=_rim(surface), min_only=True)
    worst = int(np.argmax(_error(surface, flat, material) * reach))
    nearest = int(_rim(surface)[np.argmin(dijkstra(graph, directed=False, indices=worst)[_rim(surface)])])
    return _thinned(surface, _way(graph, worst, nearest))


def _error(surface: Surface, flat: Flattening, material: Material) -> Floats:
    """(n_v,) the stretches' relative error, averaged over a few edges."""
    errors = judge.stretch_errors(judge.stretches(surface, flat.uv, material), material)
    return evened(surface, np.sqrt((errors**2).mean(axis=1)), EVEN)


def _judged(surface: Surface, material: Material) -> tuple[Flattening, float]:
    """The best of a few quick solutions and its rms error; one that is not valid counts as wrong by 100 %."""
    rigid = lay_flat(surface)
    stretches = material.along, material.across
    found = [flatten(rigid, stretches, k * np.pi / ANGLES, QUICK) for k in range(ANGLES)]
    errors = []
    for flat in found:
        error = judge.stretch_errors(judge.stretches(surface, flat.uv, material), material)
        bad = len(flat.flipped) + len(flat.crossings) > 0
        errors.append(judge.rms(error, face_areas(surface)) + bad)
    best = int(np.argmin(errors))
    return found[best], errors[best]
