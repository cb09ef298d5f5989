"""A director field in closed form, the surface it becomes, the curvature certificate, and both on a mesh."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import cycle

import numpy as np
from scipy.spatial import Delaunay

from lce_solver.errors import InputError
from lce_solver.series import Numbers, Profile, Span
from lce_solver.types import Floats, Ints, Material, Surface, line_angle


@dataclass(frozen=True, eq=False)
class Field:
    """A director field and the surface it becomes."""

    name: str
    material: Material
    polar: bool
    """True: q is the distance from the origin and alpha is measured from the radius; False: q is u, alpha from u."""
    limits: Span
    """Range of q in which the field exists."""
    bound: str
    """The inequality behind ``limits``, for messages."""
    angle: Profile
    """alpha(q) [rad]."""
    turn: Profile
    """Rotation of the circle q of the target against the sheet's [rad]."""
    place: Callable[[Numbers, Numbers], Numbers]
    """(q, longitude) to the point (3, ...) of the target."""
    gaussian: Profile
    """Gauss curvature of the target at q."""
    rate: float = 1.0
    """Longitude per unit of v (a strip), 1 for a disk."""

    def radial(self, uv: Numbers) -> Numbers:
        """Coordinate q (n,) of the points ``uv`` (n, 2); raises `InputError` outside the field."""
        q: Numbers = np.sqrt(uv[:, 0] ** 2 + uv[:, 1] ** 2) if self.polar else uv[:, 0]
        bad = np.flatnonzero(~((q.real >= self.limits[0]) & (q.real <= self.limits[1])))
        if len(bad):
            (u, v), (lo, hi), letter = uv[bad[0]].real, self.limits, "r" if self.polar else "x"
            msg = (
                f"the {self.name} field with lambda = {self.material.lambda_:g} holds for {lo:.6g} <= {letter} <= "
                f"{hi:.6g} ({self.bound}), but the point ({u:.6g}, {v:.6g}) has {letter} = {q[bad[0]].real:.6g}; "
                "take a smaller sheet or a less curved target"
            )
            raise InputError(msg)
        return q

    def director(self, uv: Numbers) -> tuple[Numbers, Numbers]:
        """Cosine and sine of twice the director's angle at ``uv`` (n, 2), each (n,): smooth where it jumps by pi."""
        alpha = self.angle(self.radial(uv))
        c, s = np.cos(2 * alpha), np.sin(2 * alpha)
        if not self.polar:
            return c, s
        u, v = uv[:, 0], uv[:, 1]
        c2, s2 = (u**2 - v**2) / (u**2 + v**2), 2 * u * v / (u**2 + v**2)
        return c2 * c - s2 * s, s2 * c + c2 * s

    def theta(self, uv: Floats) -> Floats:
        """Director angle (n,) at ``uv`` (n, 2), in [0, pi) [rad]."""
        c, s = self.director(uv)
        return line_angle(np.arctan2(s, c) / 2)

    def map(self, uv: Numbers) -> Numbers:
        """Points (n, 3) of the target at ``uv`` (n, 2); complex arguments give complex points."""
        q = self.radial(uv)
        around = longitude(uv) if self.polar else self.rate * uv[:, 1]
        return np.stack(tuple(self.place(q, around + self.turn(q))), axis=-1)

    def curvature(self, uv: Floats) -> Floats:
        """Gauss curvature (n,) from the director alone: the certificate to compare with ``gaussian``."""
        q = self.radial(uv)
        room = np.minimum(q - (0.0 if self.polar else self.limits[0]), self.limits[1] - q)
        return curvature(self.director, uv, self.material, 0.1 * room)


def longitude(uv: Numbers) -> Numbers:
    """Polar angle (n,) of ``uv`` (n, 2), analytic about each real point (arctan2 takes no complex numbers)."""
    (u, v), (u0, v0) = uv.T, uv.T.real
    away = np.where((u0 == 0) & (v0 == 0), 1.0, u0 * u + v0 * v)
    angle: Numbers = np.arctan2(v0, u0) + np.arctan((u0 * v - v0 * u) / away)
    return angle


def curvature(
    director: Callable[[Numbers], tuple[Numbers, Numbers]], uv: Floats, material: Material, radius: float | Floats
) -> Floats:
    """Gauss curvature (n,) of the metric of a director field: K = 1/2 (lambda^2nu - lambda^-2) d_i d_j (n_i n_j).

    ``director(uv)`` gives cos and sin of twice the angle for complex ``uv`` (n, 2) and must be analytic within
    several times ``radius`` (a number or (n,)) of each point: derivatives are Cauchy integrals over such circles.
    """
    step = np.broadcast_to(np.asarray(radius, dtype=np.float64), uv.shape[:1])[:, None]
    phases = np.exp(2j * np.pi * np.arange(16) / 16)

    def second(part: int, direction: tuple[float, float]) -> Floats:
        terms = [director(uv + phase * step * np.array(direction))[part] / phase**2 for phase in phases]
        derivative: Floats = 2 * np.mean(terms, axis=0).real / step[:, 0] ** 2
        return derivative

    mixed = (second(1, (1, 1)) - second(1, (1, -1))) / 4
    divergence = (second(0, (1, 0)) - second(0, (0, 1))) / 2 + mixed
    return (material.across**-2 - material.along**-2) / 2 * divergence


@dataclass(frozen=True, eq=False)
class Sample:
    """An exact field on a mesh of the sheet."""

    surface: Surface
    """The target, its vertices on the exact surface."""
    uv: Floats
    """(n_v, 2) the sheet, same triangles."""
    theta: Floats
    """(n_f,) director angle at the centroids [rad]."""


def sample(field: Field, uv: Floats, faces: Ints) -> Sample:
    """Field and target on the triangles ``faces`` (n_f, 3) of the flat points ``uv`` (n_v, 2)."""
    return Sample(Surface(field.map(uv), faces), uv, field.theta(uv[faces].mean(axis=1)))


def sheet(field: Field, edge: float, span: Span | None = None, length: float | None = None) -> tuple[Floats, Ints]:
    """Flat mesh of mean edge about ``edge``: a rectangle ``length`` long, or the disk or ring, with q in ``span``.

    Without ``span`` the outer twentieth of the field and the core of a spiral (a tenth) are left out; without
    ``length`` a rectangle is as long as wide, at most once around.
    """
    (lo, hi), tip = field.limits, field.polar and field.limits[0] == 0
    room = 0.05 * (hi - lo)
    first, last = span or (0.0 if tip else lo + (2 if field.polar else 1) * room, hi - room)
    rows = 1 + max(1, round((last - first) / (edge * np.sqrt(3) / 2)))
    q = np.linspace(first, last, rows)
    if field.polar:
        return rings(q, edge)
    length = min(last - first, 2 * np.pi / field.rate) if length is None else length
    return columns(q, length, max(1, round(length / edge)))


def columns(x: Floats, length: float, cells: int) -> tuple[Floats, Ints]:
    """Rectangle of points (n, 2) in columns at ``x``, every other one shifted by half a cell, with its triangles."""
    whole = np.arange(cells + 1.0)
    kinds = (whole, np.concatenate([[0.0], whole[:-1] + 0.5, [float(cells)]]))
    uv = np.concatenate([np.stack([np.full(len(y), at), y * length / cells], 1) for at, y in zip(x, cycle(kinds))])
    return uv, Delaunay(uv).simplices.astype(np.int64)


def rings(r: Floats, edge: float) -> tuple[Floats, Ints]:
    """Rings of points (n, 2) at the radii ``r``, a single point at 0, with the triangles between them."""
    counts = [max(6, round(2 * np.pi * at / edge)) if at > 0 else 1 for at in r]
    turns = [2 * np.pi * (np.arange(n) + 0.5 * (i % 2)) / n for i, n in enumerate(counts)]
    uv = np.concatenate([at * np.stack([np.cos(t), np.sin(t)], 1) for at, t in zip(r, turns, strict=True)])
    faces = Delaunay(uv).simplices.astype(np.int64)
    return uv, faces[(faces >= counts[0]).any(axis=1)]
