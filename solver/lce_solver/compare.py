"""The independent judge: is the predicted shape the target? Pure geometry, no code shared with the simulation."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

import numpy as np
from scipy.spatial import cKDTree

from lce_solver.geometry import shared
from lce_solver.types import Design, Floats, Ints, Material, Prediction, Status

REACH = 1.0
"""Two shapes are the same if their rms distance is at most this [% of the bounding-box diagonal]."""


class Verdict(str, Enum):
    """What the simulation arrived at; the value is the sentence shown to the user."""

    TARGET = "the sheet takes the target shape"
    MIRROR = "the sheet takes the mirror image of the target"
    ISOMETRY = "the sheet takes another shape with the same metric"
    EQUILIBRIUM = "the sheet leaves the target even when it starts there: the design, not the path, is at fault"
    NOT_CONVERGED = "the simulation did not converge, so it says nothing"


@dataclass(frozen=True)
class Comparison:
    """Distances are in % of the diagonal of the target's bounding box, after the best rigid motion."""

    verdict: Verdict
    rms_pct: float
    """Area-weighted rms distance of corresponding vertices."""
    max_pct: float
    hausdorff_pct: float
    """Largest distance from a vertex of either surface to the other surface."""
    mirror_rms_pct: float
    """As ``rms_pct``, with a reflection."""
    scale: float
    """Factor on the prediction that fits the target best."""
    scaled_rms_pct: float
    """As ``rms_pct``, with that factor."""
    residual_strain_rms: float
    """Area rms of the relative errors of both stretches."""
    curvature: float
    """Integral of the Gaussian curvature over the inner vertices, predicted [rad^2]."""
    target_curvature: float
    """The same of the target."""
    energy_ratio: float | None
    """Energy over that of the run which started at the target; near 1 it is the same state or its mirror image."""
    settled_rms_pct: float | None
    """Distance from the shape which that run found."""

    @property
    def mirrored(self) -> bool:
        """Whether the mirror image fits better."""
        return self.mirror_rms_pct < self.rms_pct * (1 - 1e-6)


@dataclass(frozen=True, eq=False)
class Alignment:
    """The best motion ``scale * points @ rotation.T + shift`` of one point set onto another."""

    rotation: Floats
    """(3, 3) orthogonal; its determinant is -1 for a reflection."""
    shift: Floats
    """(3,)"""
    scale: float
    moved: Floats
    """(n, 3)"""
    distance: Floats
    """(n,) that remain."""
    rms: float
    """Their weighted rms."""


def align(points: Floats, onto: Floats, weights: Floats, *, reflect: bool = False, scale: bool = False) -> Alignment:
    """Move ``points`` (n, 3) onto ``onto`` (n, 3) by weighted least squares (W. Kabsch, Acta Cryst. A32, 922 (1976)).

    With ``reflect`` the motion is a rotation with a reflection, never a rotation alone.
    """
    share = weights / weights.sum()
    centre, aim = share @ points, share @ onto
    p, q = points - centre, onto - aim
    left, values, right = np.linalg.svd((share[:, None] * p).T @ q)
    signs = np.array([1.0, 1.0, (-1.0 if reflect else 1.0) * np.sign(np.linalg.det(left @ right))])
    rotation = (right.T * signs) @ left.T
    factor = float(values @ signs / (share @ (p**2).sum(axis=1))) if scale else 1.0
    shift = aim - factor * rotation @ centre
    moved = factor * points @ rotation.T + shift
    distance = np.linalg.norm(moved - onto, axis=1)
    return Alignment(rotation, shift, factor, moved, distance, float(np.sqrt(share @ distance**2)))


def compare(
    design: Design, found: Prediction, settled: Prediction | None = None, *, reach: float = REACH
) -> Comparison:
    """Compare the shape that was ``found`` with the design's target.

    ``settled`` is a run that started at the target: it tells a sheet in a wrong state from one whose right state is not
    the target.
    """
    target, faces = design.surface.vertices, design.surface.faces
    weights = vertex_areas(target, faces)
    percent = 100 / float(np.linalg.norm(np.ptp(target, axis=0)))
    direct = align(found.vertices, target, weights)
    mirror = align(found.vertices, target, weights, reflect=True).rms * percent
    scaled = align(found.vertices, target, weights, scale=True)
    apart = None if settled is None else align(found.vertices, settled.vertices, weights).rms * percent
    return Comparison(
        verdict=_verdict(found.status, direct.rms * percent, mirror, apart, reach),
        rms_pct=direct.rms * percent,
        max_pct=float(direct.distance.max()) * percent,
        hausdorff_pct=hausdorff(direct.moved, target, faces) * percent,
        mirror_rms_pct=mirror,
        scale=scaled.scale,
        scaled_rms_pct=scaled.rms * percent,
        residual_strain_rms=residual_strain(design.uv, faces, design.theta, design.material, found.vertices),
        curvature=float(angle_deficit(found.vertices, faces).sum()),
        target_curvature=float(angle_deficit(target, faces).sum()),
        energy_ratio=None if settled is None else found.energy / settled.energy,
        settled_rms_pct=apart,
    )


def placed(design: Design, found: Prediction) -> Floats:
    """The target (n_v, 3) moved to where the heated sheet is [mm]: on a plate, a run that starts at it starts there."""
    target = design.surface.vertices
    return align(target, found.vertices, vertex_areas(target, design.surface.faces)).moved


def _verdict(status: Status, direct: float, mirror: float, apart: float | None, reach: float) -> Verdict:
    if status is not Status.CONVERGED:
        return Verdict.NOT_CONVERGED
    if direct <= reach:
        return Verdict.TARGET
    if mirror <= reach:
        return Verdict.MIRROR
    return Verdict.EQUILIBRIUM if apart is not None and apart <= reach else Verdict.ISOMETRY


def vertex_areas(vertices: Floats, faces: Ints) -> Floats:
    """A third of the areas of the triangles around each vertex, (n_v,)."""
    corners = vertices[faces]
    area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1) / 2
    return shared(area, faces, len(vertices))


def residual_strain(uv: Floats, faces: Ints, theta: Floats, material: Material, vertices: Floats) -> float:
    """Area rms of sigma/prescribed - 1 for the singular values of each flat triangle's map to ``vertices`` (n_v, 3)."""
    flat, bent = uv[faces], vertices[faces]
    before = np.stack([flat[:, 1] - flat[:, 0], flat[:, 2] - flat[:, 0]], axis=2)
    after = np.stack([bent[:, 1] - bent[:, 0], bent[:, 2] - bent[:, 0]], axis=2)
    director = np.stack([np.stack([np.cos(theta), np.sin(theta)]), np.stack([-np.sin(theta), np.cos(theta)])])
    wanted = np.moveaxis(director, 2, 0).swapaxes(1, 2) / np.array([material.along, material.across])
    ratios = np.linalg.svd(after @ np.linalg.inv(before) @ wanted, compute_uv=False)
    return float(np.sqrt(np.average(((ratios - 1) ** 2).mean(axis=1), weights=np.abs(np.linalg.det(before)))))


def angle_deficit(vertices: Floats, faces: Ints) -> Floats:
    """2 pi less the angles around each inner vertex, 0 on the border, (n_v,) [rad]: the Gaussian curvature it holds."""
    corners = vertices[faces]
    onward = np.roll(corners, -1, axis=1) - corners
    back = np.roll(corners, 1, axis=1) - corners
    angles = np.arctan2(np.linalg.norm(np.cross(onward, back), axis=2), (onward * back).sum(axis=2))
    deficit = 2 * np.pi - np.bincount(faces.ravel(), angles.ravel(), minlength=len(vertices))
    sides = np.sort(np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]), axis=1)
    edges, counts = np.unique(sides, axis=0, return_counts=True)
    deficit[edges[counts == 1]] = 0.0
    return np.asarray(deficit, dtype=np.float64)


def hausdorff(vertices: Floats, others: Floats, faces: Ints) -> float:
    """Largest distance from a vertex of either surface (both with ``faces``) to the other surface."""
    there = distance_to_surface(vertices, others, faces)
    back = distance_to_surface(others, vertices, faces)
    return float(max(there.max(), back.max()))


def distance_to_surface(points: Floats, vertices: Floats, faces: Ints) -> Floats:
    """Exact distance of each point (n, 3) to the nearest triangle, (n,)."""
    corners = vertices[faces]
    centres = corners.mean(axis=1)
    radius = np.linalg.norm(corners - centres[:, None], axis=2).max()
    tree = cKDTree(centres)
    best = np.full(len(points), np.inf)
    open_, count = np.arange(len(points)), 1
    while len(open_):
        count = min(4 * count, len(faces))
        away, near = tree.query(points[open_], k=count)
        away, near = away.reshape(len(open_), -1), near.reshape(len(open_), -1)
        to = distance_to_triangle(np.repeat(points[open_], near.shape[1], axis=0), corners[near.ravel()])
        best[open_] = to.reshape(near.shape).min(axis=1)
        # a triangle that was not tried has its centre beyond the last, and no point nearer than that less its radius
        unsure = best[open_] > away[:, -1] - radius
        open_ = open_[unsure] if count < len(faces) else open_[:0]
    return best


def distance_to_triangle(points: Floats, corners: Floats) -> Floats:
    """Distance of each point (n, 3) to its own triangle (n, 3, 3), (n,)."""
    edges = np.roll(corners, -1, axis=1) - corners
    to = points[:, None] - corners
    length = np.maximum((edges**2).sum(axis=2), np.finfo(float).tiny)
    along = np.clip((to * edges).sum(axis=2) / length, 0, 1)
    to_edges = np.linalg.norm(to - along[..., None] * edges, axis=2).min(axis=1)
    normal = np.cross(edges[:, 0], edges[:, 1])
    size = np.maximum(np.linalg.norm(normal, axis=1), np.finfo(float).tiny)
    inside = ((np.cross(edges, to) * normal[:, None]).sum(axis=2) > 0).all(axis=1)
    return np.asarray(np.where(inside, np.abs((to[:, 0] * normal).sum(axis=1)) / size, to_edges))
