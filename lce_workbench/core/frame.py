"""Where things lie on the plates: sheet, marks, spacer strips, glass. All in the sheet's coordinates, seen from above.

::

    +---------------------- plate ----------------------+   ^ y
    |  M  |strip|           M             |strip|  M    |   |
    |     |strip|  ..................     |strip|       |   |
    |     |strip|  .+----- sheet ---+.    |strip|       |   +--> x
    |  M  |strip|  .|               |.    |strip|  M    |
    |     |strip|  .+---------------+.    |strip|       |   The lower and upper edges between the strips
    |     |strip|  .......fill.......     |strip|       |   stay open: filling (below) and venting (above).
    |  M  |strip|           M             |strip|  M    |
    +---------------------------------------------------+

The marks at the sides lie behind the strips, where the glass stays dry: in air they scatter, filled they vanish. The
material flows in over the mark below the sheet, so that one is read before filling.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from lce_solver.errors import InputError
from lce_solver.types import Floats
from lce_workbench.core.job import Job

MARK_BOX = 1.5
"""Side of the square that holds one cluster of marks [mm]."""

SPILL = 1.0
"""The material fills so much more than the sheet, below and above [mm]."""

EDGE = 1.0
"""From the marks to the glass edge, below and above [mm]."""

BAND_GAP = 0.25
"""Between marks and test fields [mm]."""

GLASS = ((25.0, 25.0), (25.0, 75.0), (75.0, 25.0), (50.0, 50.0), (100.0, 100.0), (150.0, 150.0), (200.0, 200.0))
"""Standard carriers, width x height [mm], in the order of preference."""


@dataclass(frozen=True)
class Rect:
    """Axis-parallel rectangle [mm]."""

    x0: float
    y0: float
    x1: float
    y1: float

    @property
    def size(self) -> tuple[float, float]:
        """Width and height [mm]."""
        return self.x1 - self.x0, self.y1 - self.y0

    @property
    def ring(self) -> Floats:
        """(4, 2) corners, counter-clockwise [mm]."""
        return np.array([(self.x0, self.y0), (self.x1, self.y0), (self.x1, self.y1), (self.x0, self.y1)])

    def grown(self, dx: float, dy: float) -> Rect:
        """The rectangle with its sides moved outwards."""
        return Rect(self.x0 - dx, self.y0 - dy, self.x1 + dx, self.y1 + dy)


@dataclass(frozen=True, eq=False)
class Frame:
    """The regions of both plates."""

    sheet: Rect
    """Bounding box of the flat sheet."""
    marks: Floats
    """(8, 2) centres of the mark clusters: the corners from the lower left, counter-clockwise, then the middles of the
    lower, right, upper and left side [mm]."""
    fill: Rect
    """What the material has to fill: between the strips, a little more than the sheet."""
    bands: tuple[Rect, Rect, Rect, Rect]
    """Free places for test fields, beside the middle marks: lower left, lower right, upper left, upper right."""
    strips: tuple[Rect, Rect]
    """Left and right spacer strip."""
    plate: Rect
    """Glass, both plates alike."""


def arrange(uv: Floats, job: Job) -> Frame:
    """Lay out the plates around the flat sheet.

    Parameters
    ----------
    uv : (n, 2) points of the flat sheet [mm].

    Raises
    ------
    InputError
        The glass is too small for sheet, marks, strips and glue edges.
    """
    (x0, y0), (x1, y1) = uv.min(axis=0), uv.max(axis=0)
    sheet = Rect(float(x0), float(y0), float(x1), float(y1))
    widened = max(0.0, (MARK_BOX - sheet.size[0]) / 2)  # room for the middle marks between the strips
    inner = sheet.grown(widened + job.spacer.clearance_mm, 0.0)
    outer = inner.grown(job.spacer.strip_mm, 0.0)
    reach = job.marks.clearance_mm + MARK_BOX / 2
    ring = outer.grown(job.spacer.clearance_mm + MARK_BOX / 2, 0.0).grown(0.0, reach).ring
    rim = outer.grown(job.spacer.clearance_mm + MARK_BOX + job.spacer.glue_mm, 0.0)
    plate = _glass(rim.grown(0.0, job.marks.clearance_mm + MARK_BOX + EDGE), job)
    strips = (
        Rect(outer.x0, plate.y0, inner.x0, plate.y1),
        Rect(inner.x1, plate.y0, outer.x1, plate.y1),
    )
    marks = np.concatenate([ring, (ring + np.roll(ring, -1, axis=0)) / 2])
    fill = inner.grown(0.0, SPILL)
    return Frame(sheet, marks, fill, _bands(marks, sheet), strips, plate)


def _bands(marks: Floats, sheet: Rect) -> tuple[Rect, Rect, Rect, Rect]:
    """Free places below and above the sheet, on either side of the middle marks."""
    half = MARK_BOX / 2
    (x, lower), upper = marks[4], marks[6][1]
    left, right = (sheet.x0, x - half - BAND_GAP), (x + half + BAND_GAP, sheet.x1)

    def band(sides: tuple[float, float], y: float) -> Rect:
        return Rect(sides[0], y - half, sides[1], y + half)

    return band(left, lower), band(right, lower), band(left, upper), band(right, upper)


def _glass(needed: Rect, job: Job) -> Rect:
    """The carrier, centred on the origin: the job's own, or the first standard one that holds ``needed``."""
    half_x = max(-needed.x0, needed.x1)
    half_y = max(-needed.y0, needed.y1)
    own = _own(job)
    if own != (None, None):
        width, height = own[0] or 2 * half_x, own[1] or 2 * half_y
        if width < 2 * half_x or height < 2 * half_y:
            msg = (
                f"the plate of {width:g} x {height:g} mm is too small: sheet, marks, spacer and glue "
                f"edges need {2 * half_x:.1f} x {2 * half_y:.1f} mm; take a larger plate or a smaller sheet.width_mm"
            )
            raise InputError(msg)
        return Rect(-width / 2, -height / 2, width / 2, height / 2)
    for width, height in GLASS:
        if width >= 2 * half_x and height >= 2 * half_y:
            return Rect(-width / 2, -height / 2, width / 2, height / 2)
    msg = (
        f"sheet.width_mm = {job.sheet.width_mm:g} needs a plate of {2 * half_x:.1f} x {2 * half_y:.1f} mm, "
        f"larger than the writer's {GLASS[-1][0]:g} x {GLASS[-1][1]:g} mm; make the sheet smaller"
    )
    raise InputError(msg)


def _own(job: Job) -> tuple[float | None, float | None]:
    """Width and height that the job asks for, by name or by number."""
    plates = job.plates
    given = plates.width_mm, plates.height_mm
    if plates.carrier == "auto":
        return given
    if given != (None, None):
        msg = f"plates.carrier = {plates.carrier} fixes the glass; leave out plates.width_mm and plates.height_mm"
        raise InputError(msg)
    width, height = plates.carrier.split("x")
    return float(width), float(height)
