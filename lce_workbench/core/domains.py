"""Monolithic domains: the pieces of the sheet that hold one channel direction on each plate."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from lce_solver.types import Design, Floats, Ints, line_angle, owned

Plate = Literal["bottom", "top"]

PLATES: tuple[Plate, Plate] = ("bottom", "top")


@dataclass(frozen=True, eq=False)
class Domains:
    """The sheet cut into domains, in sheet coordinates seen from above."""

    vertices: Floats
    """(n_v, 2) corners [mm]."""
    triangles: Ints
    """(n_d, 3) vertex indices, counter-clockwise."""
    theta: Floats
    """(n_d,) director at the mid-plane, in [0, pi) [rad]."""
    dtheta: Floats
    """(n_d,) twist from bottom to top, signed [rad]."""
    stretch: Floats
    """(n_d, 2) stretch flat -> target along and across the director."""

    def __post_init__(self) -> None:
        n = len(self.triangles)
        for name, dtype, shape in (
            ("vertices", np.float64, (None, 2)),
            ("triangles", np.int64, (n, 3)),
            ("theta", np.float64, (n,)),
            ("dtheta", np.float64, (n,)),
            ("stretch", np.float64, (n, 2)),
        ):
            object.__setattr__(self, name, owned(getattr(self, name), name, dtype, *shape))

    def __len__(self) -> int:
        return len(self.triangles)

    @property
    def corners(self) -> Floats:
        """(n_d, 3, 2) corners of each domain, counter-clockwise [mm]."""
        return self.vertices[self.triangles]

    @property
    def centroid(self) -> Floats:
        """(n_d, 2) centre of each domain [mm]."""
        centre: Floats = self.corners.mean(axis=1)
        return centre

    @property
    def area(self) -> Floats:
        """(n_d,) area of each domain, negative if the flat sheet is folded there [mm2]."""
        return signed_area(self.corners)

    def angle(self, plate: Plate) -> Floats:
        """(n_d,) channel direction on ``plate``, seen from above: theta -+ dtheta/2 in [0, pi) [rad]."""
        return line_angle(self.theta + SIDE[plate] * self.dtheta / 2)

    def written(self, plate: Plate) -> Floats:
        """(n_d,) channel direction on the master, in [0, pi) [rad]; the top master is mirrored, x -> -x."""
        return line_angle(np.pi - self.angle(plate)) if plate == "top" else self.angle(plate)


SIDE: dict[Plate, int] = {"bottom": -1, "top": 1}
"""On which side of the film's mid-plane a plate lies."""


def signed_area(polygons: Floats) -> Floats:
    """Areas (n,) of polygons (n, k, 2), positive if counter-clockwise.

    Taken about each polygon's first corner, so that a polygon far from the origin loses no digits.
    """
    p = polygons - polygons[:, :1]
    q = np.roll(p, -1, axis=1)
    area: Floats = 0.5 * np.sum(p[..., 0] * q[..., 1] - p[..., 1] * q[..., 0], axis=1)
    return area


def partition(design: Design) -> Domains:
    """Cut the sheet into the design's own triangles; each keeps its director, which needs no average."""
    return Domains(design.uv, design.surface.faces, line_angle(design.theta), design.dtheta, design.stretch)
