"""Monolithic domains: the pieces of the sheet that hold one channel direction on each plate."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from typing import Literal

import numpy as np

from lce_solver.topology import boundary_loops
from lce_solver.types import Design, Floats, Ints, line_angle, owned

Plate = Literal["bottom", "top"]

PLATES: tuple[Plate, Plate] = ("bottom", "top")


@dataclass(frozen=True, eq=False)
class Domains:
    """The sheet cut into convex domains, in sheet coordinates seen from above."""

    vertices: Floats
    """(n_v, 2) corners [mm]."""
    polygons: Ints
    """(n_d, k) vertex indices of each domain, counter-clockwise; -1 after the last of a domain with fewer than k."""
    theta: Floats
    """(n_d,) director at the mid-plane, in [0, pi) [rad]."""
    dtheta: Floats
    """(n_d,) twist from bottom to top, signed [rad]."""
    stretch: Floats
    """(n_d, 2) stretch flat -> target along and across the director."""
    outline: Floats = field(default_factory=lambda: np.empty((0, 2)))
    """(n, 2) rim of the sheet, counter-clockwise; when none is given, the rim of the triangles [mm]."""
    holes: tuple[Floats, ...] = ()
    """Rims (k, 2) of the sheet's holes, clockwise [mm]."""
    phase: Floats = field(default_factory=lambda: np.empty((0, 2)))
    """(n_d, 2) how far to the left of the origin a channel's mid-line runs, modulo the pitch, on the bottom and on the
    top plate [mm]; (0, 2) where every domain centres its channels for itself."""

    def __post_init__(self) -> None:
        n = len(self.polygons)
        for name, dtype, shape in (
            ("vertices", np.float64, (None, 2)),
            ("polygons", np.int64, (n, None)),
            ("theta", np.float64, (n,)),
            ("dtheta", np.float64, (n,)),
            ("stretch", np.float64, (n, 2)),
            ("outline", np.float64, (None, 2)),
            ("phase", np.float64, (n if len(self.phase) else 0, 2)),
        ):
            object.__setattr__(self, name, owned(getattr(self, name), name, dtype, *shape))
        if n and not len(self.outline) and self.polygons.shape[1] == 3:
            rims = [self.vertices[loop] for loop in boundary_loops(self.polygons)]
            rim, *holes = sorted(rims, key=lambda ring: float(signed_area(ring[None])[0]), reverse=True)
            object.__setattr__(self, "outline", owned(rim, "outline", np.float64, None, 2))
            object.__setattr__(self, "holes", tuple(owned(hole, "holes", np.float64, None, 2) for hole in holes))

    def __len__(self) -> int:
        return len(self.polygons)

    def chosen(self, rows: Ints) -> Domains:
        """Some domains alone, of the same sheet."""
        named = ("polygons", "theta", "dtheta", "stretch", *(("phase",) if len(self.phase) else ()))
        return replace(self, **{name: getattr(self, name)[rows] for name in named})

    @property
    def sides(self) -> Ints:
        """(n_d,) corners of each domain."""
        sides: Ints = np.sum(self.polygons >= 0, axis=1)
        return sides

    @property
    def corners(self) -> Floats:
        """(n_d, k, 2) outline of each domain, counter-clockwise; its closing edge is divided to make k corners [mm]."""
        sides, place = self.sides[:, None], np.arange(self.polygons.shape[1])
        last = self.vertices[np.take_along_axis(self.polygons, sides - 1, axis=1)]
        share = np.maximum(place - sides + 1, 0) / (len(place) - sides + 1)
        closing = last + (self.vertices[self.polygons[:, :1]] - last) * share[..., None]
        return np.where((place < sides)[..., None], self.vertices[self.polygons], closing)

    def ring(self, domain: int) -> Floats:
        """(k, 2) true corners of one domain [mm]."""
        ring: Floats = self.vertices[self.polygons[domain, : self.sides[domain]]]
        return ring

    def rings(self) -> Iterator[tuple[Ints, Floats]]:
        """Domains by number of corners: which they are (n,), and their true corners (n, k, 2) [mm]."""
        for k in np.unique(self.sides):
            rows = np.flatnonzero(self.sides == k)
            yield rows, self.vertices[self.polygons[rows, :k]]

    @property
    def centroid(self) -> Floats:
        """(n_d, 2) centre of mass of each domain [mm]."""
        p = self.corners
        fan = np.stack([np.broadcast_to(p[:, :1], p[:, 2:].shape), p[:, 1:-1], p[:, 2:]], axis=2)
        share = signed_area(fan.reshape(-1, 3, 2)).reshape(len(p), -1)
        total = share.sum(axis=1, keepdims=True)
        share = np.where(total == 0, 1 / share.shape[1], share / np.where(total == 0, 1, total))
        centre: Floats = np.einsum("nk,nkc->nc", share, fan.mean(axis=2))
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
