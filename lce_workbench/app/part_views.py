"""The figures of the cell's parts alone: plates and spacer strips. Knows no FreeCAD."""

from __future__ import annotations

import numpy as np

from lce_solver.types import Floats
from lce_workbench.app.cell_views import HALF, MYLAR, Subject, boxes, numbers
from lce_workbench.app.figures import Dim, Figure, Point, Stroke, extremes, point, rectangle, scale_for, zigzag
from lce_workbench.core.domains import Plate
from lce_workbench.core.units import UM
from lce_workbench.core.workshop import carrier


def plate_face(subject: Subject, plate: Plate) -> Figure:
    """A plate seen on its patterned face: the top plate is mirrored, x -> -x."""
    frame, side = subject.frame, -1.0 if plate == "top" else 1.0
    turn = np.array([side, 1.0])
    marks, sheet = frame.marks * turn, subject.domains.outline * turn
    (x0, y0), (x1, y1) = frame.plate.ring.min(axis=0), frame.plate.ring.max(axis=0)
    lower, upper = (0, 3) if plate == "bottom" else (1, 2)  # of the corners, those that are seen on the left
    low, high = marks[lower], marks[upper]
    west, east, south, north = (point(edge[0]) for edge in extremes(sheet))
    bands = [band for band in frame.bands if min(band.size) > 0 and subject.job.marks.fields]
    return Figure(
        f"{plate}_face",
        "VIEW ON THE PATTERNED FACE" + (", MIRRORED" if plate == "top" else ""),
        (_notch_last(carrier(frame, subject.job, plate), plate) * turn,),
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
            *boxes(marks),
            *(Stroke(band.ring * turn, "dashed", layer="FIELDS") for band in bands),
            *_origin(),
        ),
        numbers(marks),
        lines=(*extremes(sheet), *(cross for at in marks for cross in _cross(at))),
    )


def _notch_last(ring: Floats, plate: Plate) -> Floats:
    """The outline (n, 2) of a plate, whose other corners have the same numbers in a view with a notch and without."""
    return np.roll(ring, 3 - len(ring), axis=0) if plate == "top" else ring


def _tip(at: Floats, axis: str) -> Point:
    """The end of a cluster's vertical line (y), or of its horizontal line (x), where a dimension holds."""
    return (float(at[0]), float(at[1]) + HALF) if axis == "y" else (float(at[0]) - HALF, float(at[1]))


def _cross(at: Floats) -> list[Floats]:
    """Both lines through the middle of a cluster."""
    return [at + HALF * np.array([(-1, 0), (1, 0)]), at + HALF * np.array([(0, -1), (0, 1)])]


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
        (Dim("strip_thickness", (width, 0.0), (width, thickness), "y", 14, "um", side=-1),),
        (Stroke(outline, "none", hatch="mylar"), zigzag(0.0, 0.0, thickness)),
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
