"""Inverse design of the curvature: how much the director turns through the thickness (the paper, S4 and S5)."""

from __future__ import annotations

import numpy as np
from scipy import sparse

from lce_solver.geometry import vertex_normals
from lce_solver.judge import jacobians
from lce_solver.topology import boundary_loops
from lce_solver.types import Floats, Ints, Material, Surface

RIDGE = 1e-9
"""Keeps the fit unique at corners with few neighbours: what the points do not say is zero."""
FLAT = 1e-9
"""A target bent less than this (rms curvature x size) is flat, and nothing of its bending is left over."""
OVERDRIVE, OVERDRIVE_REACH = 5.0, 2.0
"""The paper's factor 1 + 5 exp(-d / 2 mm) near the edge [1, mm]."""


def bending_tensor(surface: Surface) -> Floats:
    """(n_f, 3, 3) second fundamental form of the target: ``t . B t`` for tangent vectors t of a triangle.

    At each vertex the heights of the two-ring over the tangent plane are fitted with a quadratic through the vertex;
    a triangle takes the mean of its corners. The error falls with the mesh size also on irregular meshes, where
    curvature from hinges does not converge. Positive where the surface bends towards its normal [1 / length].
    """
    normal = vertex_normals(surface)
    e1 = _perpendicular(normal)
    frame = np.stack([e1, np.cross(normal, e1)], axis=2)
    hessian = _fitted_hessian(surface, frame, normal)
    at_vertex = frame @ hessian @ frame.transpose(0, 2, 1)
    mean: Floats = at_vertex[surface.faces].mean(axis=1)
    return mean


def _perpendicular(normal: Floats) -> Floats:
    """(n, 3) some unit vector at right angles to each ``normal``."""
    axis = np.eye(3)[np.argmin(np.abs(normal), axis=1)]
    across = np.cross(normal, axis)
    unit: Floats = across / np.linalg.norm(across, axis=1, keepdims=True)
    return unit


def _fitted_hessian(surface: Surface, frame: Floats, normal: Floats) -> Floats:
    """(n_v, 2, 2) second form at the vertices in their frames, from least squares over the two-ring."""
    rows, columns, first = _two_ring(surface.faces, len(surface.vertices))
    offset = surface.vertices[columns] - surface.vertices[rows]
    x, y = np.einsum("pi,pik->kp", offset, frame[rows])
    height = np.einsum("pi,pi->p", offset, normal[rows])
    count = np.diff(np.append(first, len(rows)))
    size = np.sqrt(np.add.reduceat(x**2 + y**2, first) / count)
    x, y, height = x / size[rows], y / size[rows], height / size[rows]
    terms = np.stack([x, y, x**2 / 2, x * y, y**2 / 2], axis=1)
    matrix = np.add.reduceat(terms[:, :, None] * terms[:, None, :], first)
    right = np.add.reduceat(terms * height[:, None], first)
    ridge = RIDGE * np.trace(matrix, axis1=1, axis2=2)[:, None, None] * np.eye(5)
    c = np.linalg.solve(matrix + ridge, right[..., None])[..., 0]
    slant = np.sqrt(1 + c[:, 0] ** 2 + c[:, 1] ** 2)
    hessian: Floats = c[:, [2, 3, 3, 4]].reshape(-1, 2, 2) / (slant * size)[:, None, None]
    return hessian


def _two_ring(faces: Ints, n: int) -> tuple[Ints, Ints, Ints]:
    """Pairs (vertex, vertex within two edges), sorted by the first, and where each vertex's pairs begin."""
    rows, columns = np.repeat(faces, 3, axis=1).ravel(), np.tile(faces, 3).ravel()
    near = sparse.csr_array((np.ones(len(rows)), (rows, columns)), shape=(n, n))
    ring = (near @ near).tocsr()
    ring.sort_indices()
    return np.repeat(np.arange(n), np.diff(ring.indptr)), ring.indices.astype(np.int64), ring.indptr[:-1]


def second_form(surface: Surface, uv: Floats) -> Floats:
    """(n_f, 2, 2) the target's second form in sheet coordinates, the paper's b~ [1 / length of the target]."""
    return pull_back(bending_tensor(surface), jacobians(surface, uv))


def pull_back(tensor: Floats, jacobian: Floats) -> Floats:
    """(n_f, 2, 2) ``J^T B J``: a form on the target as a form on the sheet."""
    form: Floats = jacobian.transpose(0, 2, 1) @ tensor @ jacobian
    return form


def in_director_frame(form: Floats, theta: Floats) -> Floats:
    """(n_f, 2, 2) ``R^T b R``: the first axis along the director."""
    c, s = np.cos(theta), np.sin(theta)
    rotation = np.stack([c, -s, s, c], axis=1).reshape(-1, 2, 2)
    turned: Floats = rotation.transpose(0, 2, 1) @ form @ rotation
    return turned


def twist(form: Floats, theta: Floats, material: Material, thickness: float) -> Floats:
    """(n_f,) the twist, theta(top) - theta(bottom), whose bending comes closest to ``form`` [rad].

    It minimises ``Tr[(b - b~)^2]`` over the twist. The paper's S5 prints twice as much, which contradicts its S4;
    the factor lambda_z, the stretch of the thickness, is missing there too.

    Parameters
    ----------
    form : (n_f, 2, 2) b~ in sheet coordinates [1 / mm].
    thickness : of the flat film, as prepared [mm].
    """
    contrast = material.along**2 - material.across**2
    shear: Floats = in_director_frame(form, theta)[:, 0, 1]
    return -2 * thickness * material.through / contrast * shear


def twisted_form(dtheta: Floats, theta: Floats, material: Material, thickness: float) -> Floats:
    """(n_f, 2, 2) second form that a twist prescribes, b-bar (the paper, S4) [1 / mm]."""
    contrast = material.along**2 - material.across**2
    size = -dtheta * contrast / (2 * thickness * material.through)
    c, s = np.cos(2 * theta), np.sin(2 * theta)
    form: Floats = size[:, None, None] * np.stack([-s, c, c, s], axis=1).reshape(-1, 2, 2)
    return form


def bending_left(form: Floats, theta: Floats, material: Material, area: Floats) -> float:
    """Share of the bending that no twist can prescribe: the diagonal in the director frame.

    The norm is Frobenius' over the target's area, in units of the heated sheet (each axis divided by its stretch, as
    the elastic energy measures it). In plain sheet coordinates the axis across the director would count too much,
    and the ranking of starts would prefer solutions that bend wrongly.
    """
    stretch = np.array([material.along, material.across])
    squared = (in_director_frame(form, theta) / np.outer(stretch, stretch)) ** 2
    whole, left = area @ squared.sum(axis=(1, 2)), area @ np.trace(squared, axis1=1, axis2=2)
    return float(np.sqrt(left / whole)) if whole > FLAT**2 else 0.0


def edge_factor(uv: Floats, faces: Ints) -> Floats:
    """(n_f,) the paper's overdrive ``1 + 5 exp(-d / 2 mm)``, d from a triangle's centroid to the edge; uv in mm."""
    factor: Floats = 1 + OVERDRIVE * np.exp(-edge_distance(uv, faces) / OVERDRIVE_REACH)
    return factor


def edge_distance(uv: Floats, faces: Ints) -> Floats:
    """(n_f,) distance of the triangles' centroids to the outline of the flat sheet."""
    point = uv[faces].mean(axis=1)
    nearest = np.full(len(point), np.inf)
    for loop in boundary_loops(faces):
        for start, end in zip(uv[loop], uv[np.roll(loop, -1)], strict=True):
            side = end - start
            along = np.clip((point - start) @ side / (side @ side), 0, 1)
            nearest = np.minimum(nearest, np.sum((point - start - along[:, None] * side) ** 2, axis=1))
    distance: Floats = np.sqrt(nearest)
    return distance
