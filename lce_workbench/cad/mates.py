"""The cell put together by its named faces and marks, as in a workshop: where do its parts come to lie?

cadquery solves for the places. The files keep the prisms' own: their bytes do not hang on a solver's last digits.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from lce_solver.types import Floats
from lce_workbench.cad.glb import assembly
from lce_workbench.core.cell import Cell
from lce_workbench.core.domains import PLATES
from lce_workbench.core.frame import Frame
from lce_workbench.core.job import Job
from lce_workbench.core.marks import MARKS
from lce_workbench.core.prism import Prism, bodies
from lce_workbench.core.units import UM
from lce_workbench.core.workshop import alignment_frame, beads

if TYPE_CHECKING:
    import cadquery as cq

GAUGE = 0.2
"""Half the side of the square that holds the gauge of a cluster [mm]."""

AWAY = (7.0, -4.0, 3.0), (0.0, 0.0, 1.0), 20.0
"""Where the loose parts wait: shift [mm], axis and angle [deg] of a turn."""

DIAGONAL = (0, 2)
"""The corners whose marks align the plates."""

Mate = tuple[Any, ...]
"""Arguments of `cadquery.Assembly.constrain`; ``part?datum`` names what `_named` tags."""


def gauges(cell: Cell, frame: Frame) -> Floats:
    """(2, 8, 2) centres of the gauges as they are cut into the bottom and the top land [mm]."""
    lands = {part.name: part for part in cell.parts}
    at = frame.marks + np.array(MARKS["gauge"].at) * UM
    return np.array([[_centre(lands[f"{plate}_land"], corner) for corner in at] for plate in PLATES])


def _centre(land: Prism, corner: Floats) -> Floats:
    """Centre of the box of the recesses around a point; far away if there are none."""
    near = [ring for ring in land.holes if np.all(np.abs(ring - corner) < GAUGE)]
    points = np.concatenate(near) if near else np.full((1, 2), 1e3 * (land.z0 + 1))
    return np.asarray((points.min(axis=0) + points.max(axis=0)) / 2)


def mates(frame: Frame, job: Job) -> Iterator[Mate]:
    """What holds the cell together: every part lies on another one, the plates by their marks, the rest by rulers."""
    yield "bottom_plate/bottom_land", "Fixed"
    walls = alignment_frame(frame, job)
    glue = dict(zip(("glue_left", "glue_right"), (bead.ring[0] for bead in beads(frame, job)), strict=False))
    strips = {"spacer_left": frame.strips[0].ring[0], "spacer_right": frame.strips[1].ring[0]}
    for part, corner in {**strips, **glue, "sheet": frame.sheet.ring[0]}.items():
        yield from _on(f"{part}?below", "bottom_plate/bottom_land?above", 180.0)
        yield from _ruled(part, corner - frame.plate.ring[0])
    for part in strips:
        yield from _on("top_plate/top_land?below", f"{part}?above", 180.0)
    for corner in DIAGONAL:
        yield f"top_plate/top_land?gauge_{corner}", f"bottom_plate/bottom_land?gauge_{corner}", "PointOnLine"
    if walls:
        yield from _on("alignment_frame?below", "bottom_plate/bottom_glass?below", 0.0)
        yield from _ruled("alignment_frame", walls[0].min(axis=0) - frame.plate.ring[0])


def _on(face: str, other: str, angle: float) -> Iterator[Mate]:
    """Two faces in one plane, their normals so many degrees apart."""
    yield face, other, "Axis", angle
    yield face, other, "PointInPlane", 0.0


def _ruled(part: str, corner: Floats) -> Iterator[Mate]:
    """A part parallel to the bottom glass, its lower left corner so far (2,) from the glass's [mm]."""
    yield f"{part}?left", "bottom_plate/bottom_glass?left", "Axis", 0.0
    for side, distance in zip(("left", "front"), corner.tolist(), strict=True):
        yield f"{part}?{side}", f"bottom_plate/bottom_glass?{side}", "PointInPlane", -distance


def mated(cell: Cell, frame: Frame, job: Job) -> tuple[float, str]:
    """How far off its place in the cell any part comes to lie when it is mated to its neighbours [mm], and which."""
    import cadquery as cq

    loose = [replace(part, group=part.group if part.group.endswith("_plate") else "") for part in cell.parts]
    root = assembly("cell", loose)
    stacks = {"/".join(filter(None, (stack[0].group, name))): stack for name, stack in bodies(loose).items()}
    for name in stacks:
        root.objects[name].obj = _named(root.objects[name].obj)
    for plate, centres in zip(PLATES, gauges(cell, frame), strict=True):
        for corner in DIAGONAL:
            line = cq.Edge.makeLine(*(cq.Vector(*centres[corner].tolist(), z) for z in (0, 1)))
            _tag(root.objects[f"{plate}_plate/{plate}_land"].obj, f"gauge_{corner}", line)
    shift, axis, degrees = AWAY
    for part in root.children:
        if part.name != "bottom_plate":
            part.loc = cq.Location(cq.Vector(*shift), cq.Vector(*axis), degrees)
    for mate in mates(frame, job):
        root.constrain(*mate)
    root.solve()
    placed = {name: root.objects[name.partition("/")[0]] for name in stacks}
    return max((_off(placed[name], stack), placed[name].name) for name, stack in stacks.items())


def _named(solid: cq.Solid) -> cq.Workplane:
    """A solid whose lower and upper face bear names, and the planes that touch it from the left and the front."""
    import cadquery as cq

    part = cq.Workplane(obj=solid)
    part.faces("<Z").tag("below")
    part.faces(">Z").tag("above")
    low = cq.Vector(*np.min([corner.toTuple() for corner in solid.Vertices()], axis=0).tolist())
    for name, outwards in (("left", (-1, 0, 0)), ("front", (0, -1, 0))):
        _tag(part, name, cq.Face.makePlane(1, 1, low, outwards))
    return part


def _tag(part: cq.Workplane, name: str, shape: cq.Shape) -> None:
    part.newObject([shape]).tag(name)


def _off(placed: cq.Assembly, stack: Sequence[Prism]) -> float:
    """How far the corners of a body were moved with its assembly [mm]."""
    matrix = placed.loc.wrapped.Transformation()
    turn = np.array([[matrix.Value(i, j) for j in (1, 2, 3, 4)] for i in (1, 2, 3)])
    rings = [(ring, z) for prism in stack for ring, z in ((prism.outline, prism.z0), (prism.top, prism.z1))]
    points = np.concatenate([np.insert(ring, 2, z, axis=1) for ring, z in rings])
    return float(np.abs(points @ turn[:, :3].T + turn[:, 3] - points).max())
