"""Shipped targets: smooth, analytic, at any resolution. Each is about 1 long; its normal points up (+z) or outwards."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from lce_solver.face import face
from lce_solver.mesher import mesh
from lce_solver.types import Floats, Surface

CAP = np.radians(50.0)
"""Half the opening angle of the dome."""
SADDLE = 0.6
"""z = SADDLE (x^2 - y^2)."""
RUFFLE, WAVE = 0.0098, 3 * np.pi
"""z = RUFFLE sin(WAVE x) sinh(WAVE y)."""
HALF_APEX = np.arcsin(0.6**1.5)
"""The cone that an azimuthal director gives at lambda = 0.6, nu = 0.5: sin(half apex angle) = lambda**(1 + nu)."""
TIP = 0.1
"""Radius of the sphere that rounds the cone's tip."""
ZONE = np.radians(45.0)
"""Latitude at which the sphere's zone ends."""


def dome(edge: float) -> Surface:
    """Spherical cap of half angle `CAP` over the disk of diameter 1 in the plane z = 0."""
    radius = 0.5 / np.sin(CAP)

    def embed(uv: Floats) -> Floats:
        """Stereographic, hence conformal: the rim is the unit circle."""
        angle = 2 * np.arctan(np.tan(CAP / 2) * _radius(uv))
        return _revolved(uv, radius * np.sin(angle), radius * (np.cos(angle) - np.cos(CAP)))

    return mesh(embed, _circle, edge)


def saddle(edge: float) -> Surface:
    """The saddle z = `SADDLE` (x^2 - y^2) over the disk of diameter 1."""

    def embed(uv: Floats) -> Floats:
        x, y = uv.T / 2
        return np.column_stack([x, y, SADDLE * (x**2 - y**2)])

    return mesh(embed, _circle, edge)


def leaf(edge: float) -> Surface:
    """A leaf with a straight midrib and a ruffled edge, 1 long.

    z = `RUFFLE` sin(`WAVE` x) sinh(`WAVE` y) is harmonic, so K < 0 wherever z has curvature; it decays exponentially
    from the edge to the midrib (the paper, figure 3c).
    """

    def embed(uv: Floats) -> Floats:
        x, y = uv.T
        return np.column_stack([x, y, RUFFLE * np.sin(WAVE * x) * np.sinh(WAVE * y)])

    def outline(t: Floats) -> Floats:
        turn = 2 * np.pi * t
        return np.column_stack([0.5 * np.cos(turn), 0.28 * np.sin(turn) * (1 - 0.2 * np.cos(turn))])

    return mesh(embed, outline, edge)


def cone(edge: float) -> Surface:
    """Cone of half angle `HALF_APEX`, 1 in diameter, its tip rounded by a tangent sphere of radius `TIP`.

    The rounded tip keeps the target smooth and a disk; below the circle of contact the cone is exact.
    """

    def embed(uv: Floats) -> Floats:
        radius = _radius(uv) / 2
        contact = TIP * np.cos(HALF_APEX)
        ball = np.sqrt(np.maximum(TIP**2 - radius**2, 0.0)) - TIP * np.sin(HALF_APEX)
        height = np.where(radius < contact, ball, (contact - radius) / np.tan(HALF_APEX))
        return _revolved(uv, radius, height)

    return mesh(embed, _circle, edge)


def sphere_zone(edge: float) -> Surface:
    """Half of a spherical zone: latitudes within `ZONE`, longitudes over 180 degrees, on a sphere of diameter 1.

    A whole zone is an annulus; this half is a disk. With a director that depends on the latitude alone it is the
    closed-form solution of constant K.
    """

    def embed(uv: Floats) -> Floats:
        longitude, latitude = uv.T
        x, y, z = np.cos(latitude) * np.sin(longitude), np.sin(latitude), np.cos(latitude) * np.cos(longitude)
        return np.column_stack([x, y, z]) / 2

    def outline(t: Floats) -> Floats:
        x = np.interp(t, (0, 0.25, 0.5, 0.75, 1), (-1, 1, 1, -1, -1)) * np.pi / 2
        y = np.interp(t, (0, 0.25, 0.5, 0.75, 1), (-1, -1, 1, 1, -1)) * ZONE
        return np.column_stack([x, y])

    return mesh(embed, outline, edge, corners=(0.0, 0.25, 0.5, 0.75))


def _circle(t: Floats) -> Floats:
    return np.column_stack([np.cos(2 * np.pi * t), np.sin(2 * np.pi * t)])


def _radius(uv: Floats) -> Floats:
    return np.asarray(np.hypot(uv[:, 0], uv[:, 1]))


def _revolved(uv: Floats, radius: Floats, z: Floats) -> Floats:
    """Points in the direction of ``uv`` at the given distance from the axis and the given height."""
    scale = radius / np.maximum(_radius(uv), np.finfo(float).tiny)
    return np.column_stack([uv * scale[:, None], z])


SURFACES: dict[str, Callable[[float], Surface]] = {
    "dome": dome,
    "saddle": saddle,
    "leaf": leaf,
    "cone": cone,
    "sphere-zone": sphere_zone,
    "face": face,
}
"""Name in the job file -> surface with edges of the given mean length."""
