"""Flat meshes and director fields whose heated shape is known."""

from __future__ import annotations

import numpy as np
from scipy.spatial import Delaunay

from lce_solver.compare import align
from lce_solver.shell import film
from lce_solver.types import Material

WARM, HOT = Material(0.7, 0.5), Material(0.6, 0.5)


def disk(rings, jitter=0.2, radius=1.0, seed=0):
    """About 6 rings^2 triangles of a disk, jittered inside by a share of the edge: points (n, 2), faces."""
    points = [np.zeros((1, 2))]
    for ring in range(1, rings + 1):
        angle = 2 * np.pi * np.arange(6 * ring) / (6 * ring)
        points.append(ring / rings * np.column_stack([np.cos(angle), np.sin(angle)]))
    points = np.concatenate(points)
    inner = np.hypot(*points.T) < 1 - 0.5 / rings
    points[inner] += jitter / rings * np.random.default_rng(seed).uniform(-1, 1, (inner.sum(), 2))
    points[0] = 0.0
    return triangulated(points, radius)


def triangulated(points, scale=1.0):
    faces = Delaunay(points).simplices.astype(np.int64)
    twice = np.linalg.det(np.diff(points[faces], axis=1))
    faces[twice < 0] = faces[twice < 0][:, ::-1]
    return points * scale, faces[np.abs(twice) > 1e-9]


def rectangle(columns, rows, width, height, jitter=0.2, turn=0.0, seed=0):
    """A jittered lattice of a rectangle about the origin, turned by an angle [rad]."""
    x, y = np.meshgrid(np.arange(columns + 1.0), np.arange(rows + 1.0), indexing="ij")
    inside = (x > 0) & (x < columns) & (y > 0) & (y < rows)
    noise = jitter * inside * np.random.default_rng(seed).uniform(-1, 1, (2, *x.shape))
    points = np.column_stack([((x + noise[0]) / columns).ravel(), ((y + noise[1]) / rows).ravel()]) - 0.5
    _, faces = triangulated(points * (columns, rows))
    points = points * (width, height)
    return points @ np.array([[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]]), faces


def uniform(mesh, material, thickness, theta=0.0, dtheta=0.0):
    """The same director and twist everywhere."""
    uv, faces = mesh
    n = len(faces)
    return film(uv, faces, np.full(n, theta), np.full(n, dtheta), material=material, thickness=thickness)


def polar(mesh):
    uv, faces = mesh
    x, y = uv[faces].mean(axis=1).T
    return np.hypot(x, y), np.arctan2(y, x)


def cone_film(mesh, material=WARM, thickness=0.01):
    """The director runs in circles: half angle ``cone_angle``."""
    azimuth = polar(mesh)[1]
    return film(*mesh, azimuth + np.pi / 2, 0 * azimuth, material=material, thickness=thickness)


def cone_angle(material):
    """Circumference x lambda, slant x lambda^-nu [rad]."""
    return np.arcsin(material.lambda_ ** (1 + material.nu))


def fitted_cone_angle(flat, vertices):
    """Half angle [rad] of the heated disk away from tip and edge: its normals are at one angle from the axis."""
    corners = vertices[flat.sheet.faces]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    r = polar((flat.sheet.uv, flat.sheet.faces))[0]
    normals = (normals / np.linalg.norm(normals, axis=1)[:, None])[(r > 0.3) & (r < 0.8)]
    axis = np.linalg.svd(normals - normals.mean(axis=0), full_matrices=False)[2][2]
    return np.arcsin(abs(normals.mean(axis=0) @ axis))


def cap_film(mesh, curvature=2.6, material=HOT, thickness=0.01):
    """The rotationally symmetric director of constant Gaussian curvature [1/mm^2]: a spherical cap."""
    r, azimuth = polar(mesh)
    along, across = material.along**2, material.across**2
    growth = material.along * material.across
    cosine = (along + across - 2 * growth + curvature * growth**2 * r**2 / 2) / (along - across)
    theta = azimuth + np.arccos(cosine) / 2
    return film(*mesh, theta, 0 * theta, material=material, thickness=thickness)


def fitted_radius(vertices):
    """Radius of the sphere of least squares."""
    system = np.column_stack([2 * vertices, np.ones(len(vertices))])
    *centre, rest = np.linalg.lstsq(system, (vertices**2).sum(axis=1), rcond=None)[0]
    return np.sqrt(rest + np.dot(centre, centre))


def quadratic_fit(flat, vertices, within):
    """Second form (11, 22, 12) at the sheet's middle, from a fit of positions over a disk of radius ``within``."""
    uv = flat.sheet.uv
    near = np.hypot(*uv.T) < within
    u, v = uv[near].T
    monomials = np.column_stack([np.ones_like(u), u, v, u * u / 2, v * v / 2, u * v, u**3, u * u * v, u * v * v, v**3])
    taylor = np.linalg.lstsq(monomials, vertices[near], rcond=None)[0]
    normal = np.cross(taylor[1], taylor[2])
    return taylor[3:6] @ (normal / np.linalg.norm(normal))


def apart(points, others):
    """Largest distance after the best rotation."""
    return align(points, others, np.ones(len(points))).distance.max()


def random_state(rings=5, seed=1):
    """A sheet with random pattern, far from equilibrium."""
    rng = np.random.default_rng(seed)
    uv, faces = disk(rings)
    flat = film(
        uv,
        faces,
        rng.uniform(0, 3, len(faces)),
        rng.normal(size=len(faces)),
        material=Material(1.3, 0.4),
        thickness=0.1,
    )
    x = np.column_stack([uv, 0.3 * uv[:, 0] ** 2 + 0.2 * uv[:, 1]]) + 0.03 * rng.normal(size=(len(uv), 3))
    return flat, x, rng.normal(size=x.shape)


def hot(flat):
    return flat.at(flat.material.lambda_)
