"""The figures of cell, plates, spacer and domains, from the prisms and the frame. Knows no FreeCAD."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from lce_solver.types import Floats
from lce_workbench.app.figures import (
    Balloon,
    Dim,
    Figure,
    Hatch,
    Label,
    Point,
    Stroke,
    clipped,
    rectangle,
    scale_for,
    spans,
)
from lce_workbench.core.cell import Cell
from lce_workbench.core.domains import Domains, Plate
from lce_workbench.core.frame import MARK_BOX, Frame
from lce_workbench.core.job import Job
from lce_workbench.core.prism import Prism
from lce_workbench.core.units import UM
from lce_workbench.core.workshop import beads, carrier

HATCHES: dict[str, Hatch] = {"glass": "glass", "epoxy": "epoxy", "spacer": "mylar", "glue": ""}
"""Word in a prism's name -> how its section is hatched."""

FILM = "#f3cdd2"
"""Colour of the film in plans and sections."""

MYLAR = "#dfe3e9"
"""Colour of the strips in plans."""

MAP_ROOM = (230.0, 205.0)
"""Of the domain map on paper [mm]."""

GLUE = "#efe9b8"
"""Colour of the glue in plans."""

NUMBERED = 12.0
"""Domains bear their numbers where their edges are so long on paper [mm]; else there are directors and a grid."""


@dataclass(frozen=True, eq=False)
class Subject:
    """What is drawn."""

    job: Job
    frame: Frame
    domains: Domains
    cell: Cell
    code: str
    """Of the design, as on the marks."""

    @property
    def rims(self) -> list[Floats]:
        """Outlines of the sheet and of its holes, (n, 2) each [mm]."""
        return [self.domains.outline, *self.domains.holes]

    @property
    def solid(self) -> list[Prism]:
        """Glass, channel layers, strips and glue as plain blocks: without chamfers and engravings.

        The lands, thinner than a line, are part of their epoxy.
        """
        blocks: dict[str, Prism] = {}
        for prism in self.cell.parts:
            name = prism.name.replace("_land", "_epoxy")
            if any(word in name for word in HATCHES):
                block = blocks.get(name, prism)
                widest = max((block.outline, prism.outline, prism.top), key=np.ptp)
                low, high = min(block.z0, prism.z0), max(block.z1, prism.z1)
                blocks[name] = replace(prism, name=name, outline=widest, upper=None, holes=(), z0=low, z1=high)
        return list(blocks.values())


PLAN_ROOM = (110.0, 160.0)
"""Of the plan on paper [mm]."""


def plan(subject: Subject) -> Figure:
    """The closed cell from above, with the line of section A-A."""
    frame = subject.frame
    plate, (left, right), glue = frame.plate, frame.strips, beads(frame, subject.job)
    x0, y0, x1, y1 = plate.x0, plate.y0, plate.x1, plate.y1
    scale = scale_for(plate.size, PLAN_ROOM)
    return Figure(
        "plan",
        "PLAN",
        (plate.ring, left.ring, right.ring),
        (
            Dim("plate_width", (x0, y1), (x1, y1), "x", 20),
            Dim("plate_height", (x0, y0), (x0, y1), "y", -18),
        ),
        (
            *(Stroke(strip.ring, "none", fill=MYLAR) for strip in frame.strips),
            Stroke(subject.domains.outline, "thin", fill=FILM, layer="SHEET"),
            Stroke(frame.fill.ring, "dashed", layer="FILL"),
            *(Stroke(bead.ring, "thin", fill=GLUE, layer="GLUE") for bead in glue),
            *_boxes(frame.marks),
            Stroke(np.array([(x0, 0.0), (x1, 0.0)]), "section", closed=False, layer="CENTRE"),
        ),
        (
            *_numbers(frame.marks),
            Label("A", (x0, 0.0), (-9, 2.5), size=5.0),
            Label("A", (x1, 0.0), (9, 2.5), size=5.0),
            Label("filling edge", ((x0 + x1) / 2, y0), (0, -8)),
            Label("venting edge", ((x0 + x1) / 2, y1), (0, 5)),
        ),
        tuple(
            Balloon("7", ((bead.x0 + bead.x1) / 2, bead.y1 - 1.0), (scale * x1 + 14.0, scale * bead.y1 + 8.0))
            for bead in glue[1:]
        ),
    )


def section(subject: Subject) -> Figure:
    """The cell cut at y = 0, seen towards +y: x to the right, z up."""
    rings = {prism.name: _cuts(prism) for prism in subject.solid}
    low, high = (rings[name][0] for name in ("bottom_glass", "top_glass"))
    (x0, z0), (_, inner), (x1, z1) = low.min(axis=0), low.max(axis=0), high.max(axis=0)
    edge = subject.frame.strips[0].x1
    return Figure(
        "section_a",
        "SECTION A-A",
        tuple(ring for part in rings.values() for ring in part),
        (
            Dim("cell_thickness", (x1, z0), (x1, z1), "y", 12),
            Dim("glass_thickness", (x0, z0), (x0, inner), "y", -12),
        ),
        (
            Stroke(_film(subject), "none", fill=FILM, layer="SHEET"),
            *(Stroke(ring, "none", hatch=_hatch(name)) for name, part in rings.items() for ring in part),
            Stroke(np.array([edge, 0.0]) + 0.45 * (z1 - z0) * _circle(), "thin"),
        ),
        (Label("B", (edge, z1), (0, 2.5), size=5.0),),
    )


def _circle() -> Floats:
    """(48, 2) points of the unit circle."""
    angle = np.linspace(0, 2 * np.pi, 48, endpoint=False)
    return np.column_stack([np.cos(angle), np.sin(angle)])


def _cuts(prism: Prism) -> list[Floats]:
    """The rectangles in which the plane y = 0 cuts a prism."""
    return [rectangle(a, prism.z0, b, prism.z1) for a, b in spans(prism.rings, 0.0)]


def _film(subject: Subject) -> Floats:
    fill, half = subject.frame.fill, subject.job.sheet.thickness / 2
    return rectangle(fill.x0, -half, fill.x1, half)


def _hatch(name: str) -> Hatch:
    return next((hatch for word, hatch in HATCHES.items() if word in name), "")


DETAIL_ROOM = (150.0, 46.0)
"""Of the detail at the spacer on paper [mm]."""


def detail_scale(subject: Subject) -> float:
    """The standard scale at which the gap and both epoxy layers are 40 mm high at most."""
    return scale_for((0.0, _sandwich(subject)), (1.0, 34.0))


def _sandwich(subject: Subject) -> float:
    """Gap and both epoxy layers [mm]."""
    return subject.job.sheet.thickness + 2 * subject.job.plates.epoxy_um * UM


def detail(subject: Subject) -> Figure:
    """Section A-A at the left strip's inner edge, the glass broken off."""
    scale, edge = detail_scale(subject), subject.frame.strips[0].x1
    half = min(DETAIL_ROOM[0] / 2 / scale, subject.frame.strips[0].size[0])
    reach = _sandwich(subject) / 2 + min(6.0 / scale, subject.job.plates.glass_mm)
    window = (edge - half, -reach), (edge + half, reach)
    rings = {prism.name: clipped(_cuts(prism), *window) for prism in subject.solid}
    rings = {name: part for name, part in rings.items() if part}
    strip, epoxy = rings["spacer_left"][0], rings["bottom_epoxy"][0]
    (x0, z0), (_, z1) = strip.min(axis=0), strip.max(axis=0)
    (_, e0), (e1, _) = epoxy.min(axis=0), epoxy.max(axis=0)
    top = rings["top_epoxy"][0].max(axis=0)[1]
    film = clipped([_film(subject)], *window)
    tips = {
        "1": (edge - 0.5 * half, -reach + 3.0 / scale), "2": (edge - 0.75 * half, (e0 + z0) / 2),
        "3": (edge - 0.5 * half, 0.0), "4": (edge + 0.5 * half, 0.0),
        "5": (edge + 0.75 * half, (z1 + top) / 2), "6": (edge + 0.5 * half, reach - 3.0 / scale),
    }  # fmt: skip
    places = {"1": (-0.4, -1), "2": (-0.9, -1), "3": (-0.6, 1), "4": (0.3, -1), "5": (0.75, 1), "6": (0.35, 1)}
    lift = reach * scale + 11
    return Figure(
        "detail_b",
        "DETAIL B",
        tuple(ring for part in rings.values() for ring in part),
        (
            Dim("gap", (x0, z0), (x0, z1), "y", -10, "um"),
            Dim("layer_bottom", (e1, e0), (e1, z0), "y", 10, "um", side=-1),
            Dim("layer_top", (e1, z1), (e1, top), "y", 10, "um"),
        ),
        (
            *(Stroke(ring, "none", fill=FILM, layer="SHEET") for ring in film),
            *(Stroke(ring, "none", hatch=_hatch(name)) for name, part in rings.items() for ring in part),
            *(_break(x, -reach, reach) for x in (edge - half, edge + half)),
        ),
        balloons=tuple(Balloon(item, tips[item], (x * half * scale, y * lift)) for item, (x, y) in places.items()),
    )


def _break(x: float, low: float, high: float) -> Stroke:
    """The zigzag of a broken edge."""
    d = (high - low) / 40
    steps = [(0, -22), (0, -2), (-2, -1), (2, 1), (0, 2), (0, 22)]
    return Stroke(np.array([x, (low + high) / 2]) + d * np.array(steps), "thin", closed=False)


def plate_face(subject: Subject, plate: Plate) -> Figure:
    """A plate seen on its patterned face: the top plate is mirrored, x -> -x."""
    frame, side = subject.frame, -1.0 if plate == "top" else 1.0
    turn = np.array([side, 1.0])
    marks, sheet = frame.marks * turn, subject.domains.outline * turn
    (x0, y0), (x1, y1) = frame.plate.ring.min(axis=0), frame.plate.ring.max(axis=0)
    lower, upper = (0, 3) if plate == "bottom" else (1, 2)  # of the corners, those that are seen on the left
    low, high = marks[lower], marks[upper]
    west, east, south, north = (_point(edge[0]) for edge in _extremes(sheet))
    return Figure(
        f"{plate}_face",
        "VIEW ON THE PATTERNED FACE" + (", MIRRORED" if plate == "top" else ""),
        (carrier(frame, subject.job, plate) * turn,),
        (
            Dim("plate_width", (x0, y1), (x1, y1), "x", 24),
            Dim("plate_height", (x1, y0), (x1, y1), "y", 26),
            Dim("marks_x", _tip(high, "y"), _tip(marks[5 - upper], "y"), "x", 12),
            Dim("marks_y", _tip(low, "x"), _tip(high, "x"), "y", -14),
            Dim("sheet_width", west, east, "x", -12),
            Dim("sheet_height", south, north, "y", 14),
        ),
        (
            *(Stroke(strip.ring * turn, "phantom", layer="SPACER") for strip in frame.strips),
            *(Stroke(ring * turn, "thin", layer="SHEET") for ring in subject.rims),
            *_boxes(marks),
            *(Stroke(band.ring * turn, "dashed", layer="FIELDS") for band in frame.bands if min(band.size) > 0),
            *_origin(),
        ),
        _numbers(marks),
        lines=(*_extremes(sheet), *(cross for at in marks for cross in _cross(at))),
    )


def _extremes(sheet: Floats) -> list[Floats]:
    """The edges (2, 2) of an outline that begin at its left-, right-, lower- and uppermost vertex.

    Dimensions hold there; TechDraw need not project the whole outline, which takes it long.
    """
    order = (sheet[:, 0].argmin(), sheet[:, 0].argmax(), sheet[:, 1].argmin(), sheet[:, 1].argmax())
    return [sheet[[k, (k + 1) % len(sheet)]] for k in order]


def _point(at: Floats) -> Point:
    return float(at[0]), float(at[1])


HALF = MARK_BOX / 2

UPPER = 6
"""The cluster above the sheet, of `Frame.marks`."""


def _cross(at: Floats) -> list[Floats]:
    """Both lines through the middle of a cluster."""
    return [at + HALF * np.array([(-1, 0), (1, 0)]), at + HALF * np.array([(0, -1), (0, 1)])]


def _tip(at: Floats, axis: str) -> Point:
    """The end of a cluster's vertical line (y), or of its horizontal line (x), where a dimension holds."""
    return (float(at[0]), float(at[1]) + HALF) if axis == "y" else (float(at[0]) - HALF, float(at[1]))


def _boxes(marks: Floats) -> list[Stroke]:
    return [Stroke(rectangle(*(at - HALF), *(at + HALF)), "thin", layer="MARKS") for at in marks]


def _numbers(marks: Floats) -> tuple[Label, ...]:
    """M1 to M8 below their boxes, but M7 above its own: there the sheet is below."""
    return tuple(
        Label(f"M{k + 1}", (x, y + (HALF if k == UPPER else -HALF)), (0.0, 1.0 if k == UPPER else -3.4), size=2.8)
        for k, (x, y) in enumerate(marks.tolist())
    )


def _origin() -> list[Stroke]:
    """A cross at the origin."""
    lines = np.array([(-1, 0), (1, 0)]), np.array([(0, -1), (0, 1)])
    return [Stroke(line, "centre", closed=False, layer="CENTRE") for line in lines]


def plate_side(subject: Subject, plate: Plate) -> Figure:
    """A plate from the side, its patterned face to the right."""
    low, high = subject.frame.plate.y0, subject.frame.plate.y1
    glass = subject.job.plates.glass_mm
    layer = glass + subject.job.plates.epoxy_um * UM + subject.job.channels.depth
    return Figure(
        f"{plate}_side",
        "SIDE VIEW",
        (rectangle(0.0, low, glass, high), rectangle(glass, low, layer, high)),
        (
            Dim("glass", (0.0, high), (glass, high), "x", 12, side=-1),
            Dim("layer", (glass, low), (layer, low), "x", -12, "um"),
        ),
    )


def spacer_strip(subject: Subject) -> Figure:
    """One strip, lying: its length to the right."""
    width, length = subject.frame.strips[0].size
    return Figure(
        "strip",
        "STRIP, 2 PIECES",
        (rectangle(0.0, 0.0, length, width),),
        (
            Dim("strip_length", (0.0, 0.0), (length, 0.0), "x", -12),
            Dim("strip_width", (length, 0.0), (length, width), "y", 12),
        ),
    )


def spacer_edge(subject: Subject) -> Figure:
    """The strip's end face, greatly enlarged and broken off."""
    thickness = subject.job.sheet.thickness
    scale = scale_for((0.0, thickness), (1.0, 20.0))
    width = min(60.0 / scale, subject.frame.strips[0].size[0])
    outline = rectangle(0.0, 0.0, width, thickness)
    return Figure(
        "strip_edge",
        "EDGE OF THE STRIP",
        (outline,),
        (Dim("strip_thickness", (width, 0.0), (width, thickness), "y", 14, "um"),),
        (Stroke(outline, "none", hatch="mylar"), _break(0.0, 0.0, thickness)),
    )


def spacer_place(subject: Subject) -> Figure:
    """Where the strips lie on the plate."""
    plate, (left, right) = subject.frame.plate, subject.frame.strips
    return Figure(
        "strip_place",
        "PLACE ON THE PLATE",
        (plate.ring, left.ring, right.ring),
        (
            Dim("strips_apart", (left.x1, plate.y1), (right.x0, plate.y1), "x", 12),
            Dim("strip_from_edge", (plate.x0, plate.y0), (left.x0, plate.y0), "x", -12, side=-1),
        ),
        tuple(Stroke(strip.ring, "none", fill=MYLAR) for strip in (left, right)),
    )


def domain_map(subject: Subject) -> Figure:
    """Every domain in the colour of its director: few with their numbers, many with the director and a grid."""
    domains, sheet = subject.domains, subject.domains.outline
    west, east, south, north = (_point(edge[0]) for edge in _extremes(sheet))
    strokes = [
        Stroke(ring, "hair", fill=direction_colour(float(angle)), layer="DOMAINS")
        for k, angle in enumerate(domains.theta)
        for ring in [domains.ring(k)]
    ]
    if numbered(subject):
        inside, names = (
            [],
            [Label(str(k), _point(at), (0.0, -1.0), size=2.8) for k, at in enumerate(_middles(domains))],
        )
    else:
        inside, names = _grid(subject)
        inside += _directors(domains)
    return Figure(
        "domain_map",
        "SHEET SEEN FROM ABOVE",
        (),
        (Dim("sheet_width", west, east, "x", 10), Dim("sheet_height", south, north, "y", -12)),
        (*strokes, *inside, *(Stroke(ring, "thin", layer="SHEET") for ring in subject.rims)),
        tuple(names),
        lines=tuple(_extremes(sheet)),
    )


def numbered(subject: Subject) -> bool:
    """Whether there is room for numbers in the domains."""
    edge = float(np.sqrt(np.abs(subject.domains.area).mean() * 4 / np.sqrt(3)))
    return edge * scale_for(subject.frame.sheet.size, MAP_ROOM) >= NUMBERED


COLOUR_STEP = 5
"""Directions nearer than this share a colour [degrees]: few colours make few paths."""


def direction_colour(angle: float) -> str:
    """SVG colour of a line direction [rad]: a pale colour circle of period pi."""
    import colorsys

    step = round(np.degrees(angle) / COLOUR_STEP) * COLOUR_STEP / 180
    red, green, blue = colorsys.hls_to_rgb(step % 1.0, 0.82, 0.75)
    return f"#{round(255 * red):02x}{round(255 * green):02x}{round(255 * blue):02x}"


def _directors(domains: Domains) -> list[Stroke]:
    """A line along each director, within its domain."""
    half = (
        0.35 * np.sqrt(np.abs(domains.area))[:, None] * np.column_stack([np.cos(domains.theta), np.sin(domains.theta)])
    )
    ends = np.stack([domains.centroid - half, domains.centroid + half], axis=1)
    return [Stroke(line, "thin", closed=False, layer="DIRECTORS") for line in ends]


def _middles(domains: Domains) -> Floats:
    """(n, 2) where there is most room in each domain: of a triangle the middle of its inscribed circle [mm]."""
    if domains.polygons.shape[1] > 3:
        return domains.centroid
    corners = domains.corners
    opposite = np.linalg.norm(np.roll(corners, -1, axis=1) - np.roll(corners, 1, axis=1), axis=2)
    return np.asarray((corners * opposite[..., None]).sum(axis=1) / opposite.sum(axis=1)[:, None])


def _grid(subject: Subject) -> tuple[list[Stroke], list[Label]]:
    """Lines at round coordinates, with their values [mm] at the lower and right side."""
    sheet = subject.frame.sheet
    step = next(step for step in (0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0) if max(sheet.size) / step <= 12)
    xs = np.arange(np.ceil(sheet.x0 / step), np.floor(sheet.x1 / step) + 1) * step
    ys = np.arange(np.ceil(sheet.y0 / step), np.floor(sheet.y1 / step) + 1) * step
    lines = [[(x, sheet.y0), (x, sheet.y1)] for x in xs] + [[(sheet.x0, y), (sheet.x1, y)] for y in ys]
    below = [Label(f"{x:g}", (float(x), sheet.y0), (0.0, -5.5)) for x in xs]
    right = [Label(f"{y:g}", (sheet.x1, float(y)), (3.0, -1.2), "start") for y in ys]
    return [Stroke(np.array(line), "grid", closed=False, layer="GRID") for line in lines], below + right
