"""Isotropic remeshing: the same surface with equal triangles of the wanted edge, whatever the input's resolution.

MMG (mmgs; Dapogny, Dobrzynski, Frey, J. Comput. Phys. 2014) splits, collapses, flips and moves; libigl then puts every
vertex on the input: inner ones on its triangles, those of the rim on its rim. Both get coordinates of size one.
"""

from __future__ import annotations

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager

import igl
import numpy as np
from mmgpy import MmgMeshS
from scipy.spatial import cKDTree

from lce_solver.errors import InputError, SolverError
from lce_solver.geometry import face_areas, mean_edge
from lce_solver.topology import boundary_loops, edges
from lce_solver.types import Floats, Ints, Surface

CORNER = np.radians(40)
"""Turn of the rim, seen at the scale of the new edge, from which a vertex is a corner and stays where it is."""
LENGTHENING = 1.02
"""Mean edge over MMG's request; typical, so that most surfaces need no correction."""
TOLERANCE = 0.02
"""Accepted relative error of the mean edge before another pass with a corrected request."""
PASSES = 5
"""At most; at least two, because the second, which starts from the first's even triangles, betters them."""
LONGEST = 0.25
"""Longest edge, in diagonals of the bounding box, at which a surface is still recognisable."""
SLIVER = 1e-3
"""Least area of a triangle, in squared edges."""
MOST_TRIANGLES = 1_000_000


def remesh(surface: Surface, edge: float) -> Surface:
    """The surface with near-equilateral triangles of mean edge ``edge`` (to about 2 %), vertices on the input.

    Holes stay holes, corners of the rim stay vertices; creases are rounded within an edge. The same input gives the
    same mesh.

    Raises
    ------
    InputError
        ``edge`` is not positive, too long for the surface or its holes, or asks for too many triangles.
    SolverError
        MMG gave up.
    """
    _check_edge(surface, edge)
    low, high = surface.vertices.min(axis=0), surface.vertices.max(axis=0)
    centre, scale = low + (high - low) / 2, 2.0 ** np.ceil(np.log2((high - low).max()))  # a power of two rounds nothing
    unit, aim = Surface((surface.vertices - centre) / scale, surface.faces), edge / scale
    loops = boundary_loops(unit.faces)
    sharp = np.concatenate(
        [np.empty((0, 3)), *(unit.vertices[loop[corners(unit.vertices[loop], aim)]] for loop in loops)]
    )
    found, request = unit, aim / LENGTHENING
    for done in range(PASSES):
        _, fixed = cKDTree(found.vertices).query(sharp)
        found = _on(unit, loops, _mmg(found, request, fixed))
        ratio = mean_edge(found) / aim
        if done and abs(ratio - 1) <= TOLERANCE:
            break
        request /= ratio
    if kind(found.faces) != kind(unit.faces) or face_areas(found).min() < SLIVER * aim**2:
        msg = f"edges of {edge:g} are too long for the holes and necks of this surface; ask for shorter ones"
        raise InputError(msg)
    return Surface(found.vertices * scale + centre, found.faces)


def kind(faces: Ints) -> tuple[int, int]:
    """Number of rims, and Euler characteristic: whether two surfaces have the same holes and handles."""
    return len(boundary_loops(faces)), len(np.unique(faces)) - len(edges(faces)) + len(faces)


def _check_edge(surface: Surface, edge: float) -> None:
    diagonal = float(np.linalg.norm(np.ptp(surface.vertices, axis=0)))
    if not 0 < edge <= LONGEST * diagonal:
        msg = (
            f"edges of {edge:g} do not suit a surface whose diagonal is {diagonal:.6g}; ask for a length between 0 and "
            f"{LONGEST * diagonal:.3g}"
        )
        raise InputError(msg)
    number = float(face_areas(surface).sum()) / (np.sqrt(3) / 4 * edge**2)
    if number > MOST_TRIANGLES:
        least = edge * np.sqrt(number / MOST_TRIANGLES)
        msg = (
            f"edges of {edge:g} make {number:.3g} triangles, more than {MOST_TRIANGLES:g}; ask for {least:.3g} or more"
        )
        raise InputError(msg)


def corners(rim: Floats, edge: float) -> Ints:
    """Corners of a closed polyline (n, 3): indices where it turns sharply when looked at from ``edge`` away.

    Looking from a distance tells a corner from the teeth that scanning leaves, and from the steps of a fine circle.
    """
    before, after = (_first_away(rim, edge, step) for step in (-1, 1))
    turn = _angle(rim - before, after - rim)
    found: list[int] = []
    for i in np.flatnonzero(turn > CORNER)[np.argsort(-turn[turn > CORNER], kind="stable")]:
        if not found or np.linalg.norm(rim[found] - rim[i], axis=1).min() > edge / 2:
            found.append(int(i))
    return np.array(sorted(found), dtype=np.int64)


def _first_away(rim: Floats, distance: float, step: int) -> Floats:
    """(n, 3) where the rim, walked from each vertex, gets ``distance`` away; of a small hole the farthest vertex."""
    far, best, open_ = np.array(rim), np.zeros(len(rim)), np.ones(len(rim), dtype=bool)
    for k in range(1, len(rim)):
        last, here = np.roll(rim, (1 - k) * step, axis=0), np.roll(rim, -k * step, axis=0)
        gap = np.linalg.norm(here - rim, axis=1)
        crossing = open_ & (gap >= distance)
        far[crossing] = _on_sphere(rim[crossing], last[crossing], here[crossing], distance)
        open_ &= ~crossing
        farther = open_ & (gap > best)
        far[farther], best[farther] = here[farther], gap[farther]
        if not open_.any():
            break
    return far


def _on_sphere(centre: Floats, inside: Floats, outside: Floats, radius: float) -> Floats:
    """(n, 3) where the segments from inside to outside leave the spheres."""
    p, q = inside - centre, outside - inside
    pq, qq = (p * q).sum(axis=1), (q * q).sum(axis=1)
    t = (-pq + np.sqrt(pq**2 + qq * np.maximum(radius**2 - (p * p).sum(axis=1), 0.0))) / qq
    return np.asarray(inside + t[:, None] * q)


def _angle(a: Floats, b: Floats) -> Floats:
    return np.asarray(np.arctan2(np.linalg.norm(np.cross(a, b), axis=1), (a * b).sum(axis=1)))


def _mmg(surface: Surface, size: float, fixed: Ints) -> Surface:
    """MMG's mesh of constant ``size``; the vertices ``fixed`` (k,) stay."""
    mesh = MmgMeshS(np.array(surface.vertices, order="C"), np.array(surface.faces, np.int32, order="C"))
    if len(fixed):
        mesh.set_required_vertices(fixed.astype(np.int32))
    try:
        # angle: no ridges, which noise would be taken for; nosizreq: required vertices do not set the size around them;
        # hausd: the size alone rules, not the curvature.
        with _signals_kept():
            mesh.remesh(hsiz=float(size), hausd=1.0, angle=0, nosizreq=True, verbose=-1)
    except RuntimeError as fault:
        msg = f"the remesher gave up ({fault}); repair the mesh in a mesh editor or keep the input's triangles"
        raise SolverError(msg) from fault
    return Surface(mesh.get_vertices(), mesh.get_triangles().astype(np.int64))


@contextmanager
def _signals_kept() -> Iterator[None]:
    """Hold signals back and put their handlers back: MMG sets its own, which end the process at once."""
    handlers = {number: signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM)}
    held = signal.pthread_sigmask(signal.SIG_BLOCK, handlers)
    try:
        yield
    finally:
        if threading.current_thread() is threading.main_thread():  # no other may set them
            for number, handler in handlers.items():
                signal.signal(number, handler)
        signal.pthread_sigmask(signal.SIG_SETMASK, held)


def _on(target: Surface, loops: list[Ints], found: Surface) -> Surface:
    """``found`` with its vertices moved to the closest points of ``target``, rim to rim."""
    points = closest(found.vertices, target.vertices, target.faces)
    if loops:
        rim = np.concatenate(boundary_loops(found.faces))
        segments = np.concatenate([np.stack([loop, np.roll(loop, -1)], axis=1) for loop in loops])
        points[rim] = closest(found.vertices[rim], target.vertices, segments)
    return Surface(points, found.faces)


def closest(points: Floats, vertices: Floats, elements: Ints) -> Floats:
    """(n, 3) closest points on triangles (m, 3) or segments (m, 2)."""
    arrays = (np.array(values, order="C") for values in (points, vertices, elements))
    return np.asarray(igl.point_mesh_squared_distance(*arrays)[2])
