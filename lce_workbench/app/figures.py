"""What the drawings show: figures of the cell in mm, each dimension between two of its points. Knows no FreeCAD.

A figure is drawn three times from this one description: as a TechDraw view, whose dimensions measure the view; as the
thin lines, fills and words beside it; and as DXF at true scale.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from lce_solver.types import Floats

Point = tuple[float, float]
Style = Literal["thin", "hair", "grid", "dashed", "centre", "phantom", "section", "none"]
Hatch = Literal["", "glass", "epoxy", "mylar"]

TEXT = 3.5
"""Height of dimensions and captions on paper [mm]; on A3 printed as A4 it is 2.5 mm."""

WIDE = 0.55 * TEXT
"""Mean width of a character on paper [mm]."""

MARGIN = 12.0
"""For two arrows beside a text between extension lines on paper [mm]."""

ARROW = 8.0
"""From a dimension's end to a text that stands outside on paper [mm]."""

SCALES = tuple(step * 10.0**power for power in range(-2, 6) for step in (1.0, 2.0, 5.0))
"""Scales of ISO 5455."""


@dataclass(frozen=True)
class Dim:
    """A dimension between two points of the figure's outlines."""

    name: str
    a: Point
    b: Point
    axis: Literal["x", "y"]
    at: float
    """Distance of the dimension line from the figure's box on paper: right or above if positive, else left or below
    [mm]."""
    unit: Literal["mm", "um"] = "mm"
    side: Literal[-1, 1] = 1
    """Where the text goes that has no room between the arrows: beyond the right or upper end (1), or the other."""

    @property
    def length(self) -> float:
        """[mm]."""
        return abs(self.b[0] - self.a[0] if self.axis == "x" else self.b[1] - self.a[1])

    @property
    def text(self) -> str:
        """The length in the dimension's unit: to 0.1 um, or to 1 nm."""
        return f"{round(self.length, 4):.9g}" if self.unit == "mm" else f"{micrometres(self.length)} µm"


def micrometres(length: float) -> str:
    """A length [mm] in um, to 1 nm."""
    return f"{round(length * 1e3, 3):.9g}"


@dataclass(frozen=True)
class Balloon:
    """The number of a part, and what it points at."""

    text: str
    tip: Point
    at: tuple[float, float]
    """Middle of the balloon from the figure's middle, on paper [mm]."""


@dataclass(frozen=True, eq=False)
class Stroke:
    """A line or area that no dimension holds."""

    points: Floats
    """(n, 2) [mm]."""
    style: Style = "thin"
    closed: bool = True
    fill: str = ""
    """SVG colour of the area; "" for none."""
    hatch: Hatch = ""
    layer: str = "THIN"
    """In the DXF file."""


@dataclass(frozen=True)
class Label:
    """Words at a point of the figure."""

    text: str
    at: Point
    """[mm]."""
    shift: tuple[float, float] = (0.0, 0.0)
    """On paper, upwards positive [mm]."""
    anchor: Literal["start", "middle", "end"] = "middle"
    size: float = TEXT
    """Height on paper [mm]."""


@dataclass(frozen=True, eq=False)
class Figure:
    """One view."""

    name: str
    """A word; names are unique in a set."""
    caption: str
    outlines: tuple[Floats, ...]
    """Visible edges that are closed: polygons (n, 2) [mm]."""
    dims: tuple[Dim, ...] = ()
    strokes: tuple[Stroke, ...] = ()
    labels: tuple[Label, ...] = ()
    balloons: tuple[Balloon, ...] = ()
    lines: tuple[Floats, ...] = ()
    """Visible edges that are open: (n, 2) [mm]."""

    @property
    def edges(self) -> list[Floats]:
        """All visible edges as runs of points, (n, 2) each.

        Rings begin with their second edge: the first, the lowest of a rectangle, often lies on another part's, and
        FreeCAD 1.0 leaves such edges out, and with them the numbers of the vertices that they would bring.
        """
        return [*self.lines, *(np.concatenate([ring[1:], ring[:2]]) for ring in self.outlines)]

    def vertices(self, near: float) -> Floats:
        """(n, 2) ends of the visible edges [mm], as TechDraw numbers them: those that lie within ``near``, relative to
        the size, are one, where it appears first.
        """
        points = np.concatenate(self.edges)
        same = np.abs(points[:, None] - points).max(axis=2) <= near * max(self.size)
        return np.asarray(points[same.argmax(axis=1) == np.arange(len(points))])

    @property
    def box(self) -> tuple[Floats, Floats]:
        """Lower left and upper right corner of the visible edges, (2,) each [mm]."""
        points = np.concatenate(self.edges)
        return points.min(axis=0), points.max(axis=0)

    @property
    def middle(self) -> Floats:
        """(2,) [mm]."""
        low, high = self.box
        return (low + high) / 2

    @property
    def size(self) -> Floats:
        """(2,) [mm]."""
        low, high = self.box
        return high - low


@dataclass(frozen=True, eq=False)
class Placed:
    """A figure on a sheet."""

    figure: Figure
    scale: float
    """Millimetres on paper for one of the part."""
    at: Point
    """The figure's middle on paper, from the sheet's lower left corner [mm]."""

    def paper(self, points: Floats) -> Floats:
        """Points (n, 2) of the figure [mm] on paper [mm]."""
        return (np.asarray(points) - self.figure.middle) * self.scale + self.at

    def text_at(self, dim: Dim) -> Floats:
        """Middle (2,) of a dimension's text from the view's middle, on paper [mm]."""
        ends = self.paper(np.array([dim.a, dim.b])) - self.at
        along, across = (0, 1) if dim.axis == "x" else (1, 0)
        room, need = dim.length * self.scale, WIDE * len(dim.text)
        found = ends.mean(axis=0)
        found[across] = dim.at + np.sign(dim.at) * self.figure.size[across] * self.scale / 2
        if room < need + MARGIN:
            found[along] += dim.side * (room / 2 + ARROW + need / 2)
        return np.asarray(found)


@dataclass(frozen=True, eq=False)
class Sheet:
    """One page of the set."""

    name: str
    """Of its files."""
    title: str
    subtitle: str
    material: str
    tolerance: str
    paper: Literal["A4", "A3"]
    views: tuple[Placed, ...]
    notes: tuple[str, ...] = ()
    table: tuple[tuple[str, ...], ...] = ()
    """Rows of texts, the first is the heading."""
    table_at: Point = (0.0, 0.0)
    """Its upper left corner on paper [mm]."""
    columns: tuple[float, ...] = ()
    """Widths on paper [mm]."""
    legend: Point | None = None
    """Where the colours of directions are explained: upper left corner on paper [mm]."""

    @property
    def scale(self) -> str:
        """For the title block: that of the first view; the others say their own."""
        return ratio(self.views[0].scale)


def ratio(scale: float) -> str:
    """A scale as it is written."""
    return f"{scale:g}:1" if scale >= 1 else f"1:{1 / scale:g}"


def fitting(figure: Figure, room: tuple[float, float]) -> float:
    """The largest standard scale at which a figure fits into ``room`` on paper [mm]."""
    width, height = figure.size
    return scale_for((float(width), float(height)), room)


def scale_for(size: tuple[float, float], room: tuple[float, float]) -> float:
    """The largest standard scale at which something of this size [mm] fits into ``room`` on paper [mm]."""
    most = min(have / need for have, need in zip(room, size, strict=True) if need > 0)
    return max([scale for scale in SCALES if scale <= most * (1 + 1e-9)], default=SCALES[0])


def rectangle(x0: float, y0: float, x1: float, y1: float) -> Floats:
    """(4, 2) corners, counter-clockwise."""
    return np.array([(x0, y0), (x1, y0), (x1, y1), (x0, y1)], dtype=float)


def spans(rings: Iterable[Floats], y: float) -> list[tuple[float, float]]:
    """Intervals in which the line at ``y`` runs inside polygons (n, 2) with holes."""
    found = [_crossings(np.asarray(ring), y) for ring in rings]
    xs = np.sort(np.concatenate(found))
    return [(float(a), float(b)) for a, b in zip(xs[::2], xs[1::2], strict=True)]


def _crossings(ring: Floats, y: float) -> Floats:
    a, b = ring, np.roll(ring, -1, axis=0)
    hit = (a[:, 1] <= y) != (b[:, 1] <= y)
    a, b = a[hit], b[hit]
    return np.asarray(a[:, 0] + (y - a[:, 1]) * (b[:, 0] - a[:, 0]) / (b[:, 1] - a[:, 1]))


def hatching(outline: Floats, step: float, angle: float) -> list[Floats]:
    """Parallel lines (2, 2) inside a polygon (n, 2), ``step`` apart, at ``angle`` [rad] to the x axis."""
    turn = np.array([(np.cos(angle), -np.sin(angle)), (np.sin(angle), np.cos(angle))])
    turned = np.asarray(outline) @ turn
    first, last = np.ceil(turned[:, 1].min() / step), np.floor(turned[:, 1].max() / step)
    levels = (np.arange(first, last + 1) + 1e-6) * step  # not through a corner
    return [np.array([(a, y), (b, y)]) @ turn.T for y in levels for a, b in spans([turned], y)]


def clipped(rings: Sequence[Floats], low: Point, high: Point) -> list[Floats]:
    """Axis-parallel rectangles (4, 2), cut off at a window; those outside are left out."""
    found = []
    for ring in rings:
        a, b = np.maximum(ring.min(axis=0), low), np.minimum(ring.max(axis=0), high)
        if np.all(b > a):
            found.append(rectangle(*a, *b))
    return found


def zigzag(x: float, low: float, high: float) -> Stroke:
    """The zigzag of a broken edge."""
    d = (high - low) / 40
    steps = [(0, -22), (0, -2), (-2, -1), (2, 1), (0, 2), (0, 22)]
    return Stroke(np.array([x, (low + high) / 2]) + d * np.array(steps), "thin", closed=False)


def extremes(sheet: Floats) -> list[Floats]:
    """The edges (2, 2) of an outline that begin at its left-, right-, lower- and uppermost vertex.

    Dimensions hold there; TechDraw need not project the whole outline, which takes it long.
    """
    order = (sheet[:, 0].argmin(), sheet[:, 0].argmax(), sheet[:, 1].argmin(), sheet[:, 1].argmax())
    return [sheet[[k, (k + 1) % len(sheet)]] for k in order]


def point(at: Floats) -> Point:
    """A point (2,) as plain numbers."""
    return float(at[0]), float(at[1])
