"""What is drawn, and the figures of the closed cell, from its prisms and the frame. Knows no FreeCAD."""

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
    Stroke,
    clipped,
    rectangle,
    scale_for,
    spans,
    zigzag,
)
from lce_workbench.core.cell import Cell
from lce_workbench.core.domains import Domains
from lce_workbench.core.frame import MARK_BOX, Frame
from lce_workbench.core.job import Job
from lce_workbench.core.prism import Prism
from lce_workbench.core.units import UM
from lce_workbench.core.workshop import beads

HATCHES: dict[str, Hatch] = {"glass": "glass", "epoxy": "epoxy", "spacer": "mylar", "glue": ""}
"""Word in a prism's name -> how its section is hatched."""

FILM = "#f3cdd2"
"""Colour of the film in plans and sections."""

MYLAR = "#dfe3e9"
"""Colour of the strips in plans."""

GLUE = "#efe9b8"
"""Colour of the glue in plans."""


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
            *boxes(frame.marks),
            Stroke(np.array([(x0, 0.0), (x1, 0.0)]), "section", closed=False, layer="CENTRE"),
        ),
        (
            *numbers(frame.marks),
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
            *(zigzag(x, -reach, reach) for x in (edge - half, edge + half)),
        ),
        balloons=tuple(Balloon(item, tips[item], (x * half * scale, y * lift)) for item, (x, y) in places.items()),
    )


HALF = MARK_BOX / 2

UPPER = 6
"""The cluster above the sheet, of `Frame.marks`."""


def boxes(marks: Floats) -> list[Stroke]:
    """Around the clusters, whose middles are ``marks`` (n, 2) [mm]."""
    return [Stroke(rectangle(*(at - HALF), *(at + HALF)), "thin", layer="MARKS") for at in marks]


def numbers(marks: Floats) -> tuple[Label, ...]:
    """M1 to M8 below their boxes, but M7 above its own: there the sheet is below."""
    return tuple(
        Label(f"M{k + 1}", (x, y + (HALF if k == UPPER else -HALF)), (0.0, 1.0 if k == UPPER else -2.7), size=2.8)
        for k, (x, y) in enumerate(marks.tolist())
    )
