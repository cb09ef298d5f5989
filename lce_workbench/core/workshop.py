"""What a workshop asks for: chamfers, a handling notch, an engraved name, glue beads, an alignment frame."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np

from lce_solver.errors import InputError
from lce_solver.types import Floats
from lce_workbench.core.domains import Plate
from lce_workbench.core.frame import MARK_BOX, Frame, Rect
from lce_workbench.core.job import Job
from lce_workbench.core.shapes import text, turned
from lce_workbench.core.units import UM

PIXEL = 100.0
"""Side of one dot of the engraved letters [um]."""

BRIDGE = 5.0
"""Left standing around each run of dots, so that letters have neither islands nor corners that touch [um]."""

MARGIN = 0.2
"""Between the engraved letters and the flat's edge [mm]."""

NAMES: dict[Plate, str] = {"bottom": "BOTTOM", "top": "TOP"}


def carrier(frame: Frame, job: Job, plate: Plate) -> Floats:
    """Outline (4 or 5, 2) of a plate, counter-clockwise: the glass, less its handling notch.

    Raises
    ------
    InputError
        The notch would reach marks, glue or spacer.
    """
    ring, cut = frame.plate.ring, job.plates.notch_mm
    if not cut:
        return ring
    room = _notch_room(frame, job)
    if cut > room:
        msg = f"plates.notch_mm = {cut:g} would cut into marks, glue or spacer; at most {room:.2f} is free here"
        raise InputError(msg)
    if plate == "bottom":
        return np.array([ring[0] + (cut, 0), *ring[1:], ring[0] + (0, cut)])
    return np.array([ring[0], ring[1] - (cut, 0), ring[1] + (0, cut), *ring[2:]])


def _notch_room(frame: Frame, job: Job) -> float:
    """The longest leg of a triangle at the lower left corner that meets nothing [mm]."""
    near = [frame.marks[0] - MARK_BOX / 2, frame.strips[0].ring[0], *(bead.ring[0] for bead in beads(frame, job)[:1])]
    return float(min(np.sum(point - frame.plate.ring[0]) for point in near))


def inset(ring: Floats, distance: float) -> Floats:
    """A convex outline (n, 2), counter-clockwise, with its edges moved inwards."""
    edge = np.roll(ring, -1, axis=0) - ring
    normal = np.stack([edge[:, 1], -edge[:, 0]], axis=1) / np.linalg.norm(edge, axis=1)[:, None]
    before = np.roll(normal, 1, axis=0)
    share = 1 + np.sum(normal * before, axis=1)
    return np.asarray(ring - distance * (normal + before) / share[:, None])


def release(frame: Frame, job: Job) -> float:
    """How far the patterned face stays back behind the edge of the glass, so that the plate leaves its form [mm].

    Raises
    ------
    InputError
        The taper would reach the marks.
    """
    back = job.plates.epoxy_um * UM * math.tan(math.radians(job.plates.release_deg))
    half = np.array(frame.plate.size) / 2
    room = float((half - np.abs(frame.marks).max(axis=0)).min()) - MARK_BOX / 2
    if back > room:
        msg = (
            f"plates.release_deg = {job.plates.release_deg:g} narrows the patterned face by {back:.3g} mm, into the "
            f"marks; {room:.3g} mm are free, so make the taper steeper, the epoxy thinner, or the plate larger"
        )
        raise InputError(msg)
    return back


def require_room(frame: Frame, job: Job) -> None:
    """Refuse a notch, a taper, a chamfer or letters that do not fit, before anything is drawn.

    Raises
    ------
    InputError
        As `carrier`, `release` and `glass_levels`.
    """
    carrier(frame, job, "bottom")
    release(frame, job)
    glass_levels(job)


def glass_levels(job: Job) -> list[tuple[float, float, float, float, bool]]:
    """Layers of the glass from inside: both depths below the outer face, inset at each, and whether it is engraved.

    Raises
    ------
    InputError
        Chamfer or engraving is deeper than the glass.
    """
    glass, chamfer, depth = job.plates.glass_mm, job.plates.chamfer_mm, job.plates.engraving_um * UM
    for name, value in (("chamfer_mm", chamfer), ("engraving_um", depth)):
        if value >= glass:
            msg = f"plates.{name} is not less than the glass, plates.glass_mm = {glass:g}; make it smaller"
            raise InputError(msg)
    cuts = sorted({0.0, chamfer, depth, glass}, reverse=True)
    return [
        (low, high, max(0.0, chamfer - low), max(0.0, chamfer - high), low <= depth) for low, high in pairwise(cuts)
    ]


def engraved(frame: Frame, job: Job, plate: Plate, code: str) -> list[Floats]:
    """Rectangles (4, 2) of the plate's name along its left edge, seen from above [mm]; legible from outside.

    Raises
    ------
    InputError
        The glue edge is too narrow for the letters.
    """
    if not job.plates.engraving_um:
        return []
    left = frame.plate.x0 + job.plates.chamfer_mm
    right = float(frame.marks[0][0]) - MARK_BOX / 2
    need = 7 * PIXEL * UM + 2 * MARGIN
    if right - left < need:
        msg = (
            f"plates.engraving_um: the letters need {need:g} mm beside the marks, but {right - left:.2g} mm are free; "
            "make spacer.glue_mm larger"
        )
        raise InputError(msg)
    letters = turned(text(f"{NAMES[plate]} {code}", PIXEL))
    if plate == "bottom":  # read from below
        letters = letters * np.array([-1.0, 1.0])
    return [inset(_upright(ring), BRIDGE * UM) + np.array([(left + right) / 2, 0.0]) for ring in letters]


def _upright(ring: Floats) -> Floats:
    """The rectangle from its lower left corner, counter-clockwise."""
    (x0, y0), (x1, y1) = ring.min(axis=0), ring.max(axis=0)
    return np.array([(x0, y0), (x1, y0), (x1, y1), (x0, y1)])


def beads(frame: Frame, job: Job) -> tuple[Rect, ...]:
    """The left and the right glue bead, if any, outside the marks; the open edges stay free."""
    room = job.spacer.glue_mm
    width = min(job.spacer.bead_mm, room)
    if not width:
        return ()
    (left, low), (right, high) = frame.marks[0] - MARK_BOX / 2, frame.marks[2] + MARK_BOX / 2
    margin = (room - width) / 2
    return (
        Rect(float(left) - margin - width, float(low), float(left) - margin, float(high)),
        Rect(float(right) + margin, float(low), float(right) + margin + width, float(high)),
    )


def alignment_frame(frame: Frame, job: Job) -> tuple[Floats, Floats] | None:
    """Outline and opening of the frame that both plates stand in, if the job asks for one."""
    wall, play = job.plates.frame_mm, job.plates.frame_clearance_um * UM
    return (frame.plate.grown(wall + play, wall + play).ring, frame.plate.grown(play, play).ring) if wall else None
