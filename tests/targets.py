"""Small targets with known geometry, on irregular meshes."""

from __future__ import annotations

import numpy as np
from sheets import lattice

from lce_solver.mesher import mesh
from lce_solver.types import Material, Surface

LCE = Material(0.6, 0.5)
COOLED = Material(1.3, 0.4)
"""A sheet that grows along its director."""


def patch(embed, columns, rows, width=2.0, height=1.4, seed=1):
    """A jittered rectangle and its image: parameters (n, 2), surface; ``embed`` maps x, y to three coordinates."""
    points, faces = lattice(columns, rows, width, height, seed=seed)
    x, y = points.T
    return points, Surface(np.stack(np.broadcast_arrays(*embed(x, y)), axis=1), faces)


def flat(columns=8, rows=6, **how):
    """A flat rectangle."""
    return patch(lambda x, y: (x, y, 0 * x), columns, rows, **how)[1]


def hill(columns=10, rows=8):
    """A bent, asymmetric target: no two starts are alike."""
    return patch(lambda x, y: (x, y, 0.2 * x**2 - 0.12 * y**2 + 0.15 * x * y + 0.05 * x**3), columns, rows)[1]


def ramp():
    """A flat strip that winds 1.3 times around an axis, like a parking ramp: it covers itself when laid flat."""

    def embed(along, across):
        turn = 1.3 * np.pi * along
        return (3 + across) * np.cos(turn), (3 + across) * np.sin(turn), 0.4 * turn

    return patch(embed, 60, 3, height=1.0)[1]


def moved(surface, seed=0):
    """The same surface after a rigid motion."""
    rng = np.random.default_rng(seed)
    q, r = np.linalg.qr(rng.normal(size=(3, 3)))
    q = q * np.sign(np.diag(r))
    q[:, 0] *= np.linalg.det(q)
    return Surface(surface.vertices @ q.T + rng.normal(size=3), surface.faces)


def scaled(surface, factor):
    """The same surface in another unit of length."""
    return Surface(surface.vertices * factor, surface.faces)


def renumbered(surface, seed=0):
    """The same surface with vertices, faces and corners in another order, and the order of its faces."""
    rng = np.random.default_rng(seed)
    vertex, face = rng.permutation(len(surface.vertices)), rng.permutation(len(surface.faces))
    new = np.argsort(vertex)
    corner = rng.integers(3, size=len(face))
    faces = new[surface.faces[face]]
    faces = faces[np.arange(len(face))[:, None], (np.arange(3) + corner[:, None]) % 3]
    return Surface(surface.vertices[vertex], faces), face


def mirrored(surface):
    """The mirror image at the y-z plane, with the same side up."""
    return Surface(surface.vertices * (-1, 1, 1), surface.faces[:, ::-1])


def turned_over(surface):
    """The same surface with its other side up."""
    return Surface(surface.vertices, surface.faces[:, ::-1])


def line_difference(a, b, period=np.pi):
    """Smallest difference of angles modulo ``period``."""
    return np.abs((a - b + period / 2) % period - period / 2)


def cap(degrees, edge=0.06, radius=1.0):
    """Spherical cap of a half angle, from a conformal map of the unit disk."""
    half = np.radians(degrees)

    def embed(uv):
        r = np.linalg.norm(uv, axis=1)
        angle = 2 * np.arctan(np.tan(half / 2) * r)
        x, y = uv.T * np.sin(angle) / np.where(r > 0, r, 1)
        return radius * np.column_stack([x, y, np.cos(angle)])

    return mesh(embed, lambda t: np.column_stack([np.cos(2 * np.pi * t), np.sin(2 * np.pi * t)]), edge)
