r"""Channels in closed form: in each domain, strips along the director, cut to the longest rectangles that fit.

::

            /\
           /==\        a strip is `width` wide and repeats at `pitch` across the director;
          /====\       its rectangle keeps `guard` away from every edge of the domain
         /======\
        /========\

A strip's half-planes: with x along the director, y across, an edge of outward normal n and offset c bounds the strip's
rectangle by n_x x <= c - guard - n_y y - |n_y| width / 2. So both ends are the tightest of a few affine functions of y,
for any convex domain, without clipping.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from lce_solver.errors import InputError
from lce_solver.types import Finding, Floats, Ints, Severity
from lce_workbench.core.domains import PLATES, Domains, Plate, signed_area
from lce_workbench.core.job import ChannelSpec
from lce_workbench.core.units import UM

Bools = NDArray[np.bool_]

STEPS_PER_MM = 10_000
"""Lengths are whole multiples of 0.1 um, so that every format holds the same geometry."""

MIN_LENGTH = 0.002
"""Shorter channels are left out [mm]."""

BLOCK = 64
"""Domains treated at once: what they need stays in the processor's cache."""

PARALLEL = 1e-9
"""An edge whose normal has a smaller component along the director runs along the channels and bounds none of them."""


@dataclass(frozen=True, eq=False)
class Channels:
    """All channels of one plate, in sheet coordinates seen from above (never mirrored)."""

    plate: Plate
    centre: Floats
    """(n, 2) middle of each channel [mm]."""
    angle: Floats
    """(n_d,) direction of the channels of each domain, in [0, pi) [rad]."""
    length: Floats
    """(n,) a multiple of 1e-4 [mm]."""
    domain: Ints
    """(n,) domain of each channel, ascending; inside a domain the channels follow each other across the director."""
    width: float
    """[mm]"""
    depth: float
    """[mm]"""

    def __len__(self) -> int:
        return len(self.length)

    @property
    def counts(self) -> Ints:
        """(n_d,) channels in each domain."""
        counts: Ints = np.bincount(self.domain, minlength=len(self.angle))
        return counts

    @property
    def areas(self) -> Floats:
        """(n_d,) exposed area of each domain [mm2]."""
        return np.asarray(np.bincount(self.domain, self.length * self.width, len(self.angle)), dtype=np.float64)


@dataclass(frozen=True, eq=False)
class ChannelField:
    """The channels of one plate, made block by block whenever they are asked for.

    So memory does not grow with the plate, and every pass yields the same channels to the bit.
    """

    domains: Domains
    plate: Plate
    spec: ChannelSpec

    def __iter__(self) -> Iterator[Channels]:
        """Yield the channels of `BLOCK` domains at a time, all of each; domains are numbered through."""
        outlines, angle = self.domains.corners, self.domains.angle(self.plate)
        phase = self.domains.phase[:, PLATES.index(self.plate)] if self.spec.align_phase else None
        for first in range(0, len(self.domains), BLOCK):
            rows = slice(first, first + BLOCK)
            centre, length, domain = fill(
                outlines[rows], angle[rows], self.spec, None if phase is None else phase[rows]
            )
            yield Channels(self.plate, centre, angle, length, domain + first, self.spec.width, self.spec.depth)

    @cached_property
    def counts(self) -> Ints:
        """(n_d,) channels in each domain.

        Raises
        ------
        InputError
            No domain is large enough for a single channel.
        """
        counts = np.zeros(len(self.domains), dtype=np.int64)
        for part in self:
            owners, found = np.unique(part.domain, return_counts=True)
            counts[owners] = found
        _refuse_none(int(counts.sum()), self.spec)
        return counts


def hatch(domains: Domains, plate: Plate, spec: ChannelSpec) -> Channels:
    """Fill every domain with channels along its director on ``plate`` (paper, methods: 1 um wide, 2 um pitch).

    All channels at once; `ChannelField` is the way to treat a large plate.

    Raises
    ------
    InputError
        No domain is large enough for a single channel.
    """
    parts = list(ChannelField(domains, plate, spec))
    centre, length, domain = (
        np.concatenate([getattr(part, name) for part in parts]) for name in ("centre", "length", "domain")
    )
    _refuse_none(len(length), spec)
    return Channels(plate, centre, domains.angle(plate), length, domain, spec.width, spec.depth)


def _refuse_none(count: int, spec: ChannelSpec) -> None:
    if not count:
        msg = (
            f"channels.width_um = {spec.width_um:g} with guard_um = {spec.guard_um:g} fits into none of the domains; "
            "make the channels narrower or domains.size_um larger"
        )
        raise InputError(msg)


def corners(channels: Channels, rows: slice = slice(None)) -> Floats:
    """Corners (n, 4, 2) of the channels in ``rows``, counter-clockwise [mm]; the first edge runs along the channel."""
    angle = channels.angle[channels.domain[rows]]
    return rectangles(channels.centre[rows], channels.length[rows], angle, channels.width)


def joined(parts: Sequence[Channels]) -> Channels:
    """Channels of one plate that came in parts."""
    centre, length, domain = (
        np.concatenate([getattr(part, name) for part in parts]) for name in ("centre", "length", "domain")
    )
    return replace(parts[0], centre=centre, length=length, domain=domain)


def slanted(channels: Channels, outlines: Floats, guard: float) -> Floats:
    """Corners (n, 4, 2) of the channels with their ends along the domains' inset borders instead of square [mm].

    Parameters
    ----------
    outlines : (n_d, k, 2) corners of all domains [mm].
    guard : inset of the borders [mm].

    Approximate: where a corner of the border lies inside a strip, the tip beyond the strip's sides is left out.
    """
    angle = channels.angle[channels.domain]
    local = _turn(outlines[channels.domain] - channels.centre[:, None], -angle[:, None])
    half = channels.width / 2
    y = np.broadcast_to([-half, half], (len(channels), 2))
    left, right = _ends(local, y, ChannelSpec(width_um=0.0, guard_um=guard / UM))
    x = np.stack([left[:, 0], right[:, 0], right[:, 1], left[:, 1]], axis=1)
    ring = np.stack([x, np.broadcast_to([-half, -half, half, half], x.shape)], axis=2)
    return np.asarray(_turn(ring, angle[:, None]) + channels.centre[:, None])


def rectangles(centre: Floats, length: Floats, angle: Floats, width: float) -> Floats:
    """Corners (n, 4, 2) of rectangles with middles (n, 2), counter-clockwise; the first edge runs along ``angle``."""
    c, s = np.cos(angle), np.sin(angle)
    polygons = np.empty((len(centre), 4, 2))
    for axis, along, across in ((0, length / 2 * c, -width / 2 * s), (1, length / 2 * s, width / 2 * c)):
        back, front = centre[:, axis] - along, centre[:, axis] + along
        for i, (end, side) in enumerate(((back, -across), (front, -across), (front, across), (back, across))):
            np.add(end, side, out=polygons[:, i, axis])  # by component: twice as fast
    return polygons


def empty_domains(field: ChannelField) -> tuple[Finding, ...]:
    """Report the domains too small for one channel (or folded); they stay empty."""
    empty = np.flatnonzero(field.counts == 0)
    if not len(empty):
        return ()
    shown = ", ".join(map(str, empty[:20])) + (" and more" if len(empty) > 20 else "")
    return (
        Finding(
            "empty_domains",
            Severity.WARNING,
            f"{len(empty)} domains of the {field.plate} plate are too small for one channel and stay empty; "
            f"their rows of domains.csv have channels_{field.plate} = 0",
            value=float(len(empty)),
            limit=0.0,
            where=f"domain {shown}",
        ),
    )


def fill(
    outlines: Floats, angle: Floats, spec: ChannelSpec, phase: Floats | None = None
) -> tuple[Floats, Floats, Ints]:
    """Centres (n, 2), lengths (n,) and domains (n,) of the channels along ``angle`` (m,) in convex outlines (m, k, 2).

    Every domain gets as many strips as the tallest needs; those outside their domain go. They run at the distance
    ``phase`` (m,) to the left of the origin, modulo the pitch; without it they are centred in their domain.
    """
    origin = outlines.mean(axis=1)  # local coordinates, so that no digits are lost at the sheet's rim
    local = _turn(outlines - origin[:, None], -angle[:, None])
    if phase is not None:
        phase = phase - _turn(origin, -angle)[:, 1]
    y, inside = _strips(local, spec, phase)
    left, right = _ends(local, y, spec)
    steps = np.floor((right - left) * STEPS_PER_MM)
    domain, strip = np.nonzero(inside & (steps >= MIN_LENGTH * STEPS_PER_MM))
    pick = domain, strip
    middle = np.stack([(left[pick] + right[pick]) / 2, y[pick]], axis=1)
    return _turn(middle, angle[domain]) + origin[domain], steps[pick] / STEPS_PER_MM, domain


def _turn(points: Floats, angle: Floats) -> Floats:
    """Rotate points (..., 2) counter-clockwise."""
    c, s = np.cos(angle), np.sin(angle)
    x, y = points[..., 0], points[..., 1]
    return np.stack([c * x - s * y, s * x + c * y], axis=-1)


def _strips(local: Floats, spec: ChannelSpec, phase: Floats | None) -> tuple[Floats, Bools]:
    """Mid-lines y (m, k) of strips, centred in each inset outline of (m, c, 2), and which of them it holds (m, k)."""
    low, high = _inset_extent(local, spec.guard)
    spare = 0.0 if phase is None else np.mod(phase - low - spec.width / 2, spec.pitch)
    count = np.floor((high - low - spec.width - spare) / spec.pitch) + 1
    k = np.arange(max(count.max(), 0))
    first = (low + high - (count - 1) * spec.pitch) / 2 if phase is None else low + spec.width / 2 + spare
    return first[:, None] + k * spec.pitch, k < count[:, None]


def _inset_extent(local: Floats, guard: float) -> tuple[Floats, Floats]:
    """Smallest and largest y of each outline (m, k, 2) after its edges moved inwards; (0, -1) where it is folded.

    Each corner moves along its bisector: a - g (n + n') / (1 + n n'), n and n' the normals of its two edges. Where
    edges vanish on the way this reaches too far, and the strips there turn out to have no length.
    """
    normal = _normals(local)
    before = np.roll(normal, 1, axis=1)
    share = np.maximum(1 + np.sum(normal * before, axis=2), PARALLEL)
    y = local[..., 1]
    moved = y - guard * (normal + before)[..., 1] / share
    low = np.maximum(moved.min(axis=1), y.min(axis=1) - abs(guard))
    high = np.minimum(moved.max(axis=1), y.max(axis=1) + abs(guard))
    folded = signed_area(local) <= 0
    return np.where(folded, 0.0, low), np.where(folded, -1.0, high)


def _normals(outlines: Floats) -> Floats:
    """Outward unit normals (m, k, 2) of the edges of counter-clockwise outlines; 0 for an edge without length."""
    edge = np.roll(outlines, -1, axis=1) - outlines
    size = np.linalg.norm(edge, axis=2)[..., None]
    return np.stack([edge[..., 1], -edge[..., 0]], axis=2) / np.where(size > 0, size, 1.0)


def _ends(local: Floats, y: Floats, spec: ChannelSpec) -> tuple[Floats, Floats]:
    """Both ends x (m, k) of the longest rectangle about each mid-line y (m, k); see the head of this file."""
    normal = _normals(local)
    room = np.sum(normal * local, axis=2) - spec.guard - np.abs(normal[..., 1]) * spec.width / 2
    n_x = normal[..., 0]
    safe = np.where(np.abs(n_x) > PARALLEL, n_x, 1.0)
    offset, slope = room / safe, -normal[..., 1] / safe
    ends = []
    for bounds, far, tightest in ((n_x < -PARALLEL, -np.inf, np.maximum), (n_x > PARALLEL, np.inf, np.minimum)):
        a, b = np.where(bounds, offset, far), np.where(bounds, slope, 0.0)
        ends.append(tightest.reduce([a[:, i, None] + b[:, i, None] * y for i in range(local.shape[1])]))
    return ends[0], ends[1]
