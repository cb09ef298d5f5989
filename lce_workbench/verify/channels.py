"""The channels as a reader found them, domain by domain, against directions and borders of the design."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.spatial import cKDTree

from lce_solver.types import Finding, Floats, Ints
from lce_workbench.core.job import ChannelSpec
from lce_workbench.verify.finding import error, measured
from lce_workbench.verify.reference import PLATES, Plate, Reference

ROUNDING = 2.0
"""What rounding both ends of a distance to the 1 nm grid can change, 2 x sqrt(1/2), rounded up [nm]."""

STEP = 100.0
"""Lengths are multiples of it [nm]."""

NEAR = 12
"""So many domains around a point are tried."""

SEEN = 20_000
"""Channels that tell which plate a file holds."""

FITS = np.radians(0.02)
"""A plate is recognised by directions that agree so well on average [rad]."""


@dataclass(frozen=True, eq=False)
class Rows:
    """Channels in sheet coordinates seen from above, those that lie in a domain."""

    corners: Floats
    """(4, n) complex [nm]; from corner 0 to 1 it runs along the channel."""
    domain: Ints
    """(n,)"""
    spec: ChannelSpec
    reference: Reference

    @cached_property
    def along(self) -> Floats:
        """(n,) complex, the middle line."""
        p = self.corners
        return np.asarray((p[1] - p[0] + p[2] - p[3]) / 2)

    @cached_property
    def length(self) -> Floats:
        """(n,) [nm]."""
        return np.maximum(np.abs(self.along), 1.0)

    def total(self, values: Floats) -> Floats:
        """(n_d,) sum over the channels of each domain."""
        return np.asarray(np.bincount(self.domain, values, len(self.reference.theta)))

    @cached_property
    def direction(self) -> Floats:
        """(n_d,) complex: twice the angle of the best line through all channels of a domain, by least squares."""
        squares = self.along**2
        return np.asarray(self.total(squares.real) + 1j * self.total(squares.imag))

    @property
    def area(self) -> Floats:
        """(n_d,) exposed area of each domain [mm2]."""
        p = self.corners
        diagonals = (p[2] - p[0]) * np.conj(p[3] - p[1])
        return self.total(np.abs(diagonals.imag) / 2) * 1e-12


def located(points: Floats, reference: Reference) -> Ints:
    """(n,) the domain around each point (n, 2) [mm], -1 where there is none."""
    found = np.full(len(points), -1)
    corners = reference.corners
    near = cKDTree(reference.centres).query(points, k=min(NEAR, len(corners)))[1].reshape(len(points), -1)
    for candidate in near.T:
        open_ = np.flatnonzero(found < 0)
        triangle = corners[candidate[open_]]
        edge = np.roll(triangle, -1, axis=1) - triangle
        to = points[open_, None] - triangle
        inside = np.all(edge[..., 0] * to[..., 1] - edge[..., 1] * to[..., 0] >= 0, axis=1)
        found[open_[inside]] = candidate[open_[inside]]
    return found


def rows(polygons: Floats, plate: Plate, reference: Reference) -> Rows:
    """Channels (n, 4, 2) [nm] with their domains; their long way is the one nearer to the director."""
    domain = located(polygons.mean(axis=1) * 1e-6, reference)
    p = _complex(polygons[domain >= 0])
    domain = domain[domain >= 0]
    wanted = np.exp(1j * reference.angle(plate))[domain]
    one, two = (p[1] - p[0] + p[2] - p[3]), (p[2] - p[1] + p[3] - p[0])
    turned = np.abs((two * np.conj(wanted)).real) * np.abs(one) > np.abs((one * np.conj(wanted)).real) * np.abs(two)
    return Rows(np.where(turned, np.roll(p, -1, axis=0), p), domain, reference.job.channels, reference)


def _complex(polygons: Floats) -> Floats:
    """(k, n) corners x + i y."""
    return np.ascontiguousarray(polygons[..., 0] + 1j * polygons[..., 1]).T


def recognised(polygons: Floats, reference: Reference) -> dict[tuple[Plate, bool], tuple[float, float]]:
    """Plate and mirrored or not -> fraction of channels outside every domain, mean error of their directions [rad].

    ``polygons`` are as they stand in the file.
    """
    some = polygons[:: max(1, len(polygons) // SEEN)]
    found = {}
    for mirror in (False, True):
        seen = some * np.array([-1.0 if mirror else 1.0, 1.0])
        for plate in PLATES:
            held = rows(seen, plate, reference)
            turn = np.exp(-2j * reference.angle(plate))[held.domain]
            off = np.abs(np.angle(held.along**2 * turn) / 2)
            mean = float(np.average(off, weights=held.length)) if len(off) else np.inf
            found[plate, mirror] = 1 - len(off) / len(some), mean
    return found


def identity(name: str, polygons: Floats, plate: Plate, reference: Reference) -> Finding | None:
    """An error when the file holds another plate, or is mirrored when it should not be, or the other way round."""
    fits = {key: off for key, (outside, off) in recognised(polygons, reference).items() if outside < 0.05}
    expected = plate, plate == "top"
    best = min(fits, key=lambda key: fits[key], default=expected)
    if best == expected or fits[best] > FITS or fits.get(expected, np.inf) < 2 * fits[best]:
        return None
    said = {True: "mirrored", False: "as seen from above"}
    text = (
        f"holds the channels of the {best[0]} plate {said[best[1]]}; "
        f"it should hold those of the {plate} plate {said[plate == 'top']}"
    )
    return error("verify_plate", name, text)


def check(name: str, polygons: Floats, plate: Plate, reference: Reference, counts: Floats | None) -> Iterator[Finding]:
    """Measure all channels (n, 4, 2), seen from above.

    Parameters
    ----------
    counts : (n_d,) channels of each domain by `domains.csv`; None if it cannot be read.
    """
    held = rows(polygons, plate, reference)
    outside = len(polygons) - len(held.domain)
    yield measured("verify_channels", name, "channels outside every domain:", outside, 0)
    if counts is not None:
        yield _worst(name, held, "verify_count", "channels more or less than in domains.csv:", _missing(held, counts))
    if len(held.domain):
        yield from _shapes(name, held, plate)
        yield from _places(name, held, plate)


@dataclass(frozen=True, eq=False)
class Deviations:
    """Deviations with their limits and domains."""

    values: Floats
    limits: Floats | float
    domain: Ints
    unit: str = "nm"


def _worst(name: str, held: Rows, check: str, text: str, found: Deviations) -> Finding:
    """The deviation that exceeds its limit most, with the number of domains in which one does."""
    over = found.values - found.limits
    worst = int(np.argmax(np.where(np.isfinite(over), over, np.inf)))
    places = len(np.unique(found.domain[~(over <= 0)]))
    limit = float(np.broadcast_to(found.limits, over.shape)[worst])
    where = f"{name}, {held.reference.place(int(found.domain[worst]))}"
    return measured(check, where, text, float(found.values[worst]), limit, unit=found.unit, places=places)


def _missing(held: Rows, counts: Floats) -> Deviations:
    every = np.arange(len(held.reference.theta))
    return Deviations(np.abs(np.bincount(held.domain, minlength=len(every)) - counts), 0.0, every, "")


def _shapes(name: str, held: Rows, plate: Plate) -> Iterator[Finding]:
    """Direction, width, length, square ends."""
    p, size = held.corners, held.length
    wanted = held.reference.angle(plate)
    full = np.flatnonzero(np.abs(held.direction))
    off = np.degrees(np.angle(held.direction * np.exp(-2j * wanted)) / 2)
    # Rounding turns a channel by up to sqrt(2) nm over its length; weights are the squares of the lengths.
    limits = np.degrees(ROUNDING * held.total(size)[full] / held.total(size**2)[full])
    text = "the channels' direction differs from the design by"
    if len(full):
        yield _worst(name, held, "verify_angle", text, Deviations(np.abs(off[full]), limits, full, "deg"))
    unit = held.along / size
    ends = np.stack([((p[k] - p[0]) * np.conj(unit)).imag for k in (2, 3)])
    skewed = np.abs(((p[3] - p[0]) * np.conj(unit)).real)
    width = held.spec.width_um * 1e3
    for check, text, values, limit in (
        ("verify_width", "a channel's width differs by", np.abs(np.abs(ends) - width).max(axis=0), ROUNDING),
        ("verify_square", "a channel's end is oblique by", skewed, ROUNDING * (1 + width / size)),
        ("verify_length", "a channel's length misses 0.1 um steps by", np.abs(size - np.rint(size / STEP) * STEP), 2.0),
    ):
        yield _worst(name, held, check, text, Deviations(values, limit, held.domain))


def _places(name: str, held: Rows, plate: Plate) -> Iterator[Finding]:
    """Land between neighbours, distance from the border, and that every channel is as long as it can be."""
    centre = held.corners.mean(axis=0)
    line = np.exp(0.5j * np.angle(held.direction))[held.domain]
    across = (centre * np.conj(line)).imag
    order = np.lexsort((across, held.domain))
    same = np.flatnonzero(np.diff(held.domain[order]) == 0)
    if len(same):
        lands = np.diff(across[order])[same] - held.spec.width_um * 1e3
        off = np.abs(lands - held.spec.spacing_um * 1e3)
        text = "the land between two channels differs from the job by"
        yield _worst(name, held, "verify_spacing", text, Deviations(off, ROUNDING, held.domain[order][same]))
    if len(held.reference.phase):
        goal = held.reference.phase[held.domain, PLATES.index(plate)] * 1e6
        pitch = (held.spec.width_um + held.spec.spacing_um) * 1e3
        turns = ((centre * np.exp(-1j * held.reference.angle(plate)[held.domain])).imag - goal) / pitch
        off = np.abs(turns - np.rint(turns)) * pitch
        text = "a channel misses the place that lets it meet its neighbour's by"
        yield _worst(name, held, "verify_phase", text, Deviations(off, ROUNDING, held.domain))
    beyond, room = _room(held)
    text = "a channel comes nearer to its domain's border than the guard by"
    yield _worst(name, held, "verify_border", text, Deviations(beyond, 1.0, held.domain))
    text = "a channel could be longer by"
    yield _worst(name, held, "verify_reach", text, Deviations(room, STEP + 1.0, held.domain))


def _room(held: Rows) -> tuple[Floats, Floats]:
    """How far each channel reaches into the guard (n,), and how much longer it could be at both ends (n,) [nm].

    The latter is a lower bound: each distance from a border may be 1 nm smaller than it was before rounding.
    """
    borders = _complex(held.reference.corners * 1e6)
    unit, guard = held.along / held.length, held.spec.guard_um * 1e3
    nearest, rooms = np.full(len(held.domain), np.inf), np.full((2, len(held.domain)), np.inf)
    for start, end in zip(borders, np.roll(borders, -1, axis=0), strict=True):
        size = np.abs(end - start)
        inward = 1j * (end - start) / np.where(size == 0, 1, size)  # 0 where a polygon repeats its last corner
        normal, origin = inward[held.domain], start[held.domain]
        free = ((held.corners - origin) * np.conj(normal)).real - guard
        free = np.where(normal == 0, np.inf, free)
        nearest = np.minimum(nearest, free.min(axis=0))
        slope = (unit * np.conj(normal)).real
        for k, corners, away in ((0, (0, 3), slope), (1, (1, 2), -slope)):
            bounds = away > 1e-6
            left = np.minimum(free[corners[0]], free[corners[1]]) - 1.0
            rooms[k] = np.where(bounds, np.minimum(rooms[k], left / np.where(bounds, away, 1.0)), rooms[k])
    return -nearest, rooms.sum(axis=0)
