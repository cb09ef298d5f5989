"""What is measured on every channel as it is written, in closed form: width, length, lands, inset, direction."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from lce_solver.types import Floats, Ints, Severity
from lce_workbench.core.channels import MIN_LENGTH
from lce_workbench.core.job import ChannelSpec
from lce_workbench.core.units import NM

ROUNDING = 2.0
"""What rounding two corners to the 1 nm grid can change in a distance, 2 x sqrt(1/2), rounded up [nm]."""

MAX_TURN = 1e-3
"""Largest error of a domain's direction [degrees]; the twist is a few degrees."""

Points = NDArray[np.complex128]
"""Points of the plane as x + i y [nm]: the product of conj(a) and b holds their scalar and vector products."""


@dataclass(frozen=True, eq=False)
class Block:
    """Channels of whole domains."""

    written: Points
    """(4, n) corners on the master."""
    seen: Points
    """(4, n) the same corners in sheet coordinates seen from above."""
    domain: Ints
    """(n,) domain of each channel."""
    borders: Points
    """(k, n_d) corners of all domains, seen from above."""
    direction: Floats
    """(n_d,) angle of the channels that all domains should have on the master [rad]."""
    spec: ChannelSpec

    @cached_property
    def turned(self) -> tuple[Floats, Floats, Ints]:
        """Error of each domain's written direction (n,) [rad], mean length of its channels (n,) [nm], the domain (n,).

        The direction is the best fit to all corners of all channels: each channel counts with its length squared, for
        rounding turns it by an angle that falls with its length.
        """
        p = self.written
        along = (p[1] - p[0] + p[2] - p[3]) / 2
        domain, starts, number = np.unique(self.domain, return_index=True, return_counts=True)
        mean = np.add.reduceat(along**2, starts) * np.exp(-2j * self.direction[domain])
        return np.abs(np.angle(mean)) / 2, np.add.reduceat(size(along), starts) / number, domain


Measured = tuple[Floats, Ints]
"""Measured values and the domain of each."""


@dataclass(frozen=True)
class Check:
    """A quantity with its limit."""

    measure: Callable[[Block], Measured]
    limit: Callable[[ChannelSpec], float]
    at_least: bool
    """Whether the limit is a lower one."""
    unit: str
    quantity: str
    severity: Severity = Severity.ERROR
    """Of a value beyond the limit."""


def width_error(block: Block) -> Measured:
    """Largest deviation of each channel's width, at both its ends [nm]."""
    p = block.seen
    along = p[1] - p[0]
    ends = np.stack([cross(along, p[2] - p[0]), cross(along, p[3] - p[0])]) / size(along)
    return np.abs(ends - block.spec.width / NM).max(axis=0), block.domain


def length(block: Block) -> Measured:
    """Length of each channel's shorter side [nm]."""
    p = block.seen
    return np.minimum(np.abs(p[1] - p[0]), np.abs(p[2] - p[3])), block.domain


def spacing(block: Block) -> Measured:
    """Land between neighbours of one domain, where they face each other [nm]."""
    same = block.domain[1:] == block.domain[:-1]
    lower, upper = block.seen[2:, :-1][:, same], block.seen[:2, 1:][:, same]
    end = size(lower[0] - lower[1])
    a, b = (upper - lower[1]) * np.conj((lower[0] - lower[1]) / end)  # real: along the lower one, imaginary: across
    first, last = np.maximum(a.real, 0.0), np.minimum(b.real, end)
    slope = (b.imag - a.imag) / np.maximum(b.real - a.real, 1.0)
    gap = a.imag + np.minimum(slope * (first - a.real), slope * (last - a.real))
    return np.where(first < last, gap, np.inf), block.domain[1:][same]


def inset(block: Block) -> Measured:
    """Distance of each channel from the nearest edge of its domain, negative outside [nm]."""
    first = int(block.domain[0])
    local = block.domain - first
    borders = block.borders[:, first : int(block.domain[-1]) + 1]
    nearest = np.full(len(local), np.inf)
    for start, end in zip(borders, np.roll(borders, -1, axis=0), strict=True):
        along = (end - start) / np.abs(end - start)
        offset, x, y = cross(along, start)[local], along.real[local], along.imag[local]
        for corner in block.seen:
            np.minimum(nearest, x * corner.imag - y * corner.real - offset, out=nearest)
    return nearest, block.domain


def angle_error(block: Block) -> Measured:
    """Error of each domain's written direction as a sideways shift of its channels' ends, on average [nm].

    Rounding shifts both ends of every channel by up to sqrt(1/2) nm, so it cannot shift their average by more than
    `ROUNDING`, however long the channels are.
    """
    angle, size, domain = block.turned
    return angle * size, domain


def direction_error(block: Block) -> Measured:
    """Error of each domain's written direction [degrees]; rounding makes it large where a domain is a speck."""
    angle, _, domain = block.turned
    return np.degrees(angle), domain


CHANNEL_CHECKS: dict[str, Check] = {
    "channel_width": Check(width_error, lambda _: ROUNDING, False, "nm", "largest error of a channel's width"),
    "channel_length": Check(length, lambda _: MIN_LENGTH / NM - ROUNDING, True, "nm", "shortest channel"),
    "channel_spacing": Check(
        spacing, lambda spec: (spec.pitch - spec.width) / NM - ROUNDING, True, "nm", "narrowest land inside a domain"
    ),
    "channel_inset": Check(
        inset, lambda spec: spec.guard / NM - ROUNDING, True, "nm", "smallest distance from a channel to its border"
    ),
    "channel_angle": Check(
        angle_error, lambda _: ROUNDING, False, "nm", "largest error of a domain's direction, at its channels' ends"
    ),
    "domain_angle": Check(
        direction_error,
        lambda _: MAX_TURN,
        False,
        "degrees",
        "largest error of a domain's written direction",
        Severity.WARNING,
    ),
}
"""Measured on every channel. Lands between channels of different domains are at least two insets wide."""


def keep_worst(worst: dict[str, tuple[float, int]], block: Block) -> None:
    """Put each check's worst value in ``block``, with its domain, into ``worst`` where that is better."""
    for name, item in CHANNEL_CHECKS.items():
        values, domain = item.measure(block)
        if len(values):
            i = int(np.argmin(values) if item.at_least else np.argmax(values))
            found = float(values[i]), int(domain[i])
            worst[name] = (min if item.at_least else max)(worst.get(name, found), found)


def cross(a: Points, b: Points) -> Floats:
    """Vector product of a and b: positive if b points to the left of a."""
    product: Floats = a.real * b.imag - a.imag * b.real
    return product


def size(a: Points) -> Floats:
    """Lengths of vectors, at least 1 nm: a collapsed edge is for `polygon_edge` to report and must not divide by 0."""
    return np.maximum(np.abs(a), 1.0)
