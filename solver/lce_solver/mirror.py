"""Targets that are their own mirror image, and even meshes that are it vertex by vertex.

On such a mesh a symmetric start stays symmetric through the whole minimisation, because the energy and its gradient
are symmetric to the last digits; on any other mesh the triangles decide which lopsided minimum is found.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import igl
import numpy as np
from scipy.spatial import cKDTree

from lce_solver.errors import InputError
from lce_solver.geometry import face_areas
from lce_solver.remesh import kind, remesh
from lce_solver.topology import boundary_loops, edges
from lce_solver.types import Floats, Ints, Surface

MISMATCH = 5e-4
"""Largest rms distance of a target to its mirror image at which it counts as symmetric, in diagonals of its box."""
COINCIDE = 1e-7
"""Distance, in diagonals, at which a vertex is its neighbour's mirror image."""
SNAP = 0.1
"""Vertices nearer to the plane than this part of the wanted edge are moved into it: no slivers along the seam."""
TURNS = 90
"""Directions tried where two principal axes are alike."""
ALIKE = 0.02
"""Relative difference of the spreads along two principal axes below which every direction between them is tried."""
SAMPLE = 400
"""Points that are compared for each direction."""
FITS = 25
"""Corrections of the plane from pairs of points."""
THIN = 0.05
"""A surface must reach this far to both sides of its mirror plane, in diagonals."""


@dataclass(frozen=True, eq=False)
class Plane:
    """The mirror plane ``normal . x = offset``."""

    normal: Floats
    """(3,) unit vector."""
    offset: float
    """[the surface's unit of length]"""

    def height(self, points: Floats) -> Floats:
        """(n,) signed distances."""
        heights: Floats = np.einsum("ni,i->n", points, self.normal) - self.offset
        return heights

    def image(self, points: Floats) -> Floats:
        """(n, 3) mirrored points."""
        mirrored: Floats = points - 2 * self.height(points)[:, None] * self.normal
        return mirrored


def mirror_plane(surface: Surface, known: float = 0.0) -> Plane | None:
    """The plane at which the surface is its own mirror image, if there is one; the best of several.

    Parameters
    ----------
    known : rms distance up to which the surface is known. Its image is known no better, so the root of two times it is
        allowed, but `MISMATCH` at least.
    """
    diagonal = float(np.linalg.norm(np.ptp(surface.vertices, axis=0)))
    points = surface.vertices[:: max(1, len(surface.vertices) // SAMPLE)]
    candidates = [plane for plane in _candidates(surface) if np.ptp(plane.height(points)) > 2 * THIN * diagonal]
    if not candidates:
        return None
    closest = _closest_on(surface)
    misses = [float(np.abs(plane.image(points) - closest(plane.image(points))).max()) for plane in candidates]
    plane = candidates[int(np.argmin(misses))]
    for _ in range(FITS):
        plane = _fitted(points, closest(plane.image(points)), plane)
    miss = np.sqrt(np.mean(mismatch(surface, plane) ** 2))
    return plane if miss <= max(np.sqrt(2) * known, MISMATCH * diagonal) else None


def mismatch(surface: Surface, plane: Plane) -> Floats:
    """(n_v,) distances of the vertices' mirror images from the surface."""
    image = plane.image(surface.vertices)
    return np.asarray(np.linalg.norm(image - _closest_on(surface)(image), axis=1))


def _candidates(surface: Surface) -> list[Plane]:
    """Planes through the centroid at right angles to the principal axes, and between two that are alike."""
    area = face_areas(surface)
    middle = surface.vertices[surface.faces].mean(axis=1)
    centroid = np.average(middle, axis=0, weights=area)
    offset = (middle - centroid) * np.sqrt(area / area.sum())[:, None]
    spread, axes = np.linalg.eigh(offset.T @ offset)
    normals = list(axes.T)
    for i, j in ((0, 1), (1, 2)):
        if spread[j] - spread[i] <= ALIKE * spread[2]:
            angle = np.arange(TURNS) * np.pi / TURNS
            normals += list(np.cos(angle)[:, None] * axes[:, i] + np.sin(angle)[:, None] * axes[:, j])
    return [Plane(normal, float(normal @ centroid)) for normal in normals]


def _closest_on(surface: Surface) -> Callable[[Floats], Floats]:
    """Function from points (n, 3) to their closest points on the surface."""
    vertices, faces = np.array(surface.vertices, order="C"), np.array(surface.faces, order="C")
    tree = igl.AABB()
    tree.init(vertices, faces)
    return lambda points: np.asarray(tree.squared_distance(vertices, faces, np.array(points, order="C"))[2])


def _fitted(points: Floats, partners: Floats, plane: Plane) -> Plane:
    """The plane that best swaps points with the partners found near their images."""
    apart, middle = points - partners, (points + partners) / 2
    centre = middle.mean(axis=0)
    _, axes = np.linalg.eigh(apart.T @ apart - (middle - centre).T @ (middle - centre))
    normal = axes[:, 2] * np.sign(axes[:, 2] @ plane.normal)
    return Plane(normal, float(normal @ centre))


def even_mesh(surface: Surface, edge: float, known: float = 0.0) -> Surface:
    """The surface with near-equilateral triangles of mean edge ``edge``; symmetric if the surface is.

    Of a symmetric surface one half is meshed and mirrored, so the surface changes by what `mirror_plane` allows, rms.

    Raises
    ------
    InputError, SolverError
        As `remesh`.
    """
    plane = mirror_plane(surface, known)
    half = None if plane is None else _half(surface, plane, edge)
    if plane is None or half is None:
        return remesh(surface, edge)
    try:
        made = _doubled(remesh(half, edge), plane)
    except InputError:  # the half may have a neck that the whole has not
        return remesh(surface, edge)
    return made if kind(made.faces) == kind(surface.faces) else remesh(surface, edge)  # a small hole of the other half


def _half(surface: Surface, plane: Plane, edge: float) -> Surface | None:
    """The part above the plane, if it is one disk."""
    height = plane.height(surface.vertices)
    near = np.abs(height) < SNAP * edge
    points = np.where(near[:, None], surface.vertices - height[:, None] * plane.normal, surface.vertices)
    half = clipped(Surface(points, surface.faces), np.where(near, 0.0, height))
    loops, used = boundary_loops(half.faces), len(half.vertices)
    return half if len(loops) == 1 and used - len(edges(half.faces)) + len(half.faces) == 1 else None


def clipped(surface: Surface, height: Floats) -> Surface:
    """The part where the piecewise linear ``height`` (n_v,) is positive; cut triangles become one or two."""
    faces, n = surface.faces, len(surface.vertices)
    after = np.roll(faces, -1, axis=1)
    cut = height[faces] * height[after] < 0
    low, high = np.minimum(faces, after)[cut], np.maximum(faces, after)[cut]
    key, which = np.unique(low * n + high, return_inverse=True)
    a, b = key // n, key % n
    at = (height[a] / (height[a] - height[b]))[:, None]
    points = np.vstack([surface.vertices, (1 - at) * surface.vertices[a] + at * surface.vertices[b]])
    crossing = np.full(faces.shape, -1)
    crossing[cut] = n + which.reshape(-1)
    ring = np.stack([np.where(height[faces] >= 0, faces, -1), crossing], axis=2).reshape(-1, 6)
    ring = np.take_along_axis(ring, np.argsort(ring < 0, axis=1, kind="stable"), axis=1)
    ring = ring[(height[faces] > 0).any(axis=1)]
    parts = np.concatenate([ring[:, [0, 1, 2]], ring[:, [0, 2, 3]]])
    used, renumbered = np.unique(parts[(parts >= 0).all(axis=1)], return_inverse=True)
    return Surface(points[used], renumbered.reshape(-1, 3))


def _doubled(half: Surface, plane: Plane) -> Surface:
    """A half and its mirror image, sharing the vertices in the plane."""
    height = plane.height(half.vertices)
    seam = np.abs(height) <= COINCIDE * np.linalg.norm(np.ptp(half.vertices, axis=0))
    points = np.where(seam[:, None], half.vertices - height[:, None] * plane.normal, half.vertices)
    n = len(points)
    twin = np.where(seam, np.arange(n), n - 1 + np.cumsum(~seam))
    return Surface(np.vstack([points, plane.image(points[~seam])]), np.vstack([half.faces, twin[half.faces][:, ::-1]]))


def twins(surface: Surface) -> Ints | None:
    """(n_v,) each vertex's mirror image, if the mesh is symmetric vertex by vertex."""
    plane = mirror_plane(surface)
    if plane is None:
        return None
    diagonal = float(np.linalg.norm(np.ptp(surface.vertices, axis=0)))
    near = cKDTree(surface.vertices)
    _, twin = near.query(plane.image(surface.vertices))
    plane = _fitted(surface.vertices, surface.vertices[twin], plane)  # from pairs of vertices it is exact
    distance, twin = near.query(plane.image(surface.vertices))
    exact = distance.max() <= COINCIDE * diagonal and np.array_equal(twin[twin], np.arange(len(twin)))
    return np.asarray(twin, dtype=np.int64) if exact and _same_faces(surface.faces, twin) else None


def _same_faces(faces: Ints, twin: Ints) -> bool:
    """Whether the mirrored triangles are the triangles."""
    listed, mirrored = (np.unique(np.sort(f, axis=1), axis=0) for f in (faces, twin[faces]))
    return np.array_equal(listed, mirrored)
