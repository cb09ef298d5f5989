"""A polygon with holes between two heights: what every part of the mold and the cell is made of."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from lce_solver.types import Floats

Colour = tuple[float, float, float]

SIMPSON = np.array([1.0, 4.0, 1.0]) / 6
"""Weights of the lower, the middle and the upper section: exact for cubics, which moments of a tapered prism are."""


@dataclass(frozen=True, eq=False)
class Prism:
    """A polygon with holes between two heights. Rings that run the other way round are turned."""

    name: str
    """ASCII; layers of one body share a name, and so do the channels of one domain, which become one product."""
    outline: Floats
    """(n, 2) counter-clockwise [mm]."""
    holes: tuple[Floats, ...]
    """Each (k, 2), clockwise, as both CAD kernels need them [mm]."""
    z0: float
    """Lower face [mm]."""
    z1: float
    """Upper face [mm]."""
    colour: Colour
    opacity: float = 1.0
    group: str = ""
    """The assembly that it belongs to; "" is the cell itself."""
    upper: Floats | None = None
    """(n, 2) the outline at z1 where it differs: edges parallel to those of `outline`, for chamfers and tapers [mm]."""

    def __post_init__(self) -> None:
        if not self.z1 > self.z0:
            msg = f"{self.name}: z1 = {self.z1} must lie above z0 = {self.z0}"
            raise ValueError(msg)
        object.__setattr__(self, "outline", _turned(self.outline, 1))
        if self.upper is not None:
            object.__setattr__(self, "upper", _turned(self.upper, 1))
        object.__setattr__(self, "holes", tuple(_turned(hole, -1) for hole in self.holes))

    @property
    def rings(self) -> tuple[Floats, ...]:
        """The outline and the holes."""
        return (self.outline, *self.holes)

    @property
    def top(self) -> Floats:
        """(n, 2) the outline at z1 [mm]."""
        return self.outline if self.upper is None else self.upper

    @property
    def area(self) -> float:
        """Area of the lower face [mm2]."""
        return float(self._sections[0, 0])

    @property
    def volume(self) -> float:
        """[mm3]."""
        return float(SIMPSON @ self._sections[:, 0]) * (self.z1 - self.z0)

    @property
    def centroid(self) -> Floats:
        """(3,) centre of mass [mm]."""
        sections, heights = self._sections, np.array([self.z0, (self.z0 + self.z1) / 2, self.z1])
        moments = np.column_stack([sections[:, 1:], sections[:, 0] * heights])
        return np.asarray(SIMPSON @ moments / (SIMPSON @ sections[:, 0]))

    @cached_property
    def _sections(self) -> Floats:
        """(3, 3) area and first moments of the lower, the middle and the upper section."""
        inner = np.sum([np.zeros(3), *map(_moments, self.holes)], axis=0)
        if self.upper is None:
            return np.tile(_moments(self.outline) + inner, (3, 1))
        outlines = (self.outline, (self.outline + self.upper) / 2, self.upper)
        return np.array([_moments(outline) + inner for outline in outlines])


def together(stack: Sequence[Prism]) -> tuple[float, Floats]:
    """Volume [mm3] and centroid (3,) [mm] of several prisms."""
    volumes = np.array([prism.volume for prism in stack])
    return float(volumes.sum()), np.asarray(volumes @ [prism.centroid for prism in stack] / volumes.sum())


def bodies(prisms: Sequence[Prism]) -> dict[str, list[Prism]]:
    """Name -> the prisms that bear it, from below: layers of one body."""
    found: dict[str, list[Prism]] = {}
    for prism in sorted(prisms, key=lambda prism: prism.z0):
        found.setdefault(prism.name, []).append(prism)
    return {name: found[name] for name in dict.fromkeys(prism.name for prism in prisms)}


def _turned(ring: Floats, sign: int) -> Floats:
    """The ring, counter-clockwise for ``sign`` +1, clockwise for -1; read-only."""
    turned = np.array(ring if _moments(ring)[0] * sign > 0 else ring[::-1])
    turned.setflags(write=False)
    return turned


def _moments(ring: Floats) -> Floats:
    """Signed area and first moments (3,) of a polygon, by the shoelace formula about its first corner."""
    p = ring - ring[0]
    q = np.concatenate([p[1:], p[:1]])
    cross = p[:, 0] * q[:, 1] - p[:, 1] * q[:, 0]
    area = cross.sum() / 2
    return np.array([area, *(cross @ (p + q) / 6 + area * ring[0])])
