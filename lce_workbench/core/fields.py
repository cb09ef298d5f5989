"""Test fields beside the middle marks, the same on both plates: dose, uniform directors, depth, resolution, pitch.

The film reaches the fields below the sheet, so uniform directors stand there; the others stand above it and stay dry.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from lce_solver.errors import InputError
from lce_solver.types import Finding, Floats, Severity
from lce_workbench.core.frame import BAND_GAP, Frame
from lce_workbench.core.job import ChannelSpec, Job
from lce_workbench.core.shapes import SMALL, Shape, box, grating, join, moved, text, turned

LADDER_UM = (0.6, 0.8, 1.0, 1.2, 1.5, 2.0, 3.0)
"""Line widths of the resolution ladder, each with lands as wide."""

PITCHES_UM = (1.6, 2.0, 2.5, 3.0, 4.0)
"""Of the pitch ladder; lines as wide as the channels, or half the pitch where that is less."""

DIRECTIONS = (0.0, 45.0, 90.0)
"""Of the uniform films [degrees]."""


def directors(spec: ChannelSpec) -> Shape:
    """Three films of 1.2 mm with one director each: they measure the stretches along and across it."""
    pads = [grating(box(-600, -600, 600, 600), np.radians(a), spec, 0.5) for a in DIRECTIONS]
    return _row(pads, 1400)


def dose(spec: ChannelSpec) -> Shape:
    """8 x 5 patches to be written with a dose (columns 1 to 8) and a focus (rows A to E) of their own."""
    patch = grating(box(-100, -100, 100, 100), 0.0, spec, 0.5)
    patches = [moved(patch, 240 * (i - 3.5), 240 * (1.5 - j)) for i in range(8) for j in range(5)]
    columns = [moved(text(str(i + 1), SMALL), 240 * (i - 3.5), 640) for i in range(8)]
    rows = [moved(text("ABCDE"[j], SMALL), -1050, 240 * (1.5 - j)) for j in range(5)]
    return join(*patches, *columns, *rows)


def depth(spec: ChannelSpec) -> Shape:
    """Open areas for the AFM's tip and a long grating to break for the SEM."""
    wide = [moved(box(-w / 2, -300, w / 2, 300), x, 0) for x, w in ((-250, 100), (-130, 50), (-60, 20), (-20, 10))]
    return join(*wide, grating(box(50, -300, 300, 300), 0.0, spec, 0.5))


def resolution(_: ChannelSpec) -> Shape:
    """Lines of decreasing width along x and along y."""
    steps = [_lines(width, 2 * width) for width in LADDER_UM]
    ladder = _row(steps, 150)
    return join(moved(ladder, 0, 150), moved(_row([turned(step) for step in steps], 150), 0, -150))


def pitch(spec: ChannelSpec) -> Shape:
    """Gratings of several pitches."""
    return _row([_lines(min(spec.width_um, p / 2), p, size=201.0) for p in PITCHES_UM], 300)


def _lines(width: float, period: float, size: float = 101.0) -> Shape:
    """A square of lines along x."""
    spec = ChannelSpec(width_um=width, spacing_um=period - width)
    return grating(box(-size / 2, -size / 2, size / 2, size / 2), 0.0, spec)


def _row(shapes: Sequence[Shape], step: float) -> Shape:
    return join(*(moved(shape, step * (i - (len(shapes) - 1) / 2), 0) for i, shape in enumerate(shapes)))


@dataclass(frozen=True)
class Field:
    """One test field."""

    width: float
    """[mm]; all are at most as high as a band."""
    bands: tuple[int, int]
    """Where it may stand, of `Frame.bands`."""
    draw: Callable[[ChannelSpec], Shape]


FIELDS: dict[str, Field] = {
    "directors": Field(4.0, (1, 0), directors),
    "dose": Field(2.2, (2, 3), dose),
    "depth": Field(0.7, (2, 3), depth),
    "resolution": Field(1.1, (3, 2), resolution),
    "pitch": Field(1.5, (3, 2), pitch),
}
"""Every test field; the job names those that are wanted."""


def require_known(wanted: Sequence[str]) -> None:
    """Refuse names of fields that do not exist.

    Raises
    ------
    InputError
        A field does not exist.
    """
    unknown = [name for name in wanted if name not in FIELDS]
    if unknown:
        msg = f"marks.fields: {unknown[0]!r} is unknown; known are {', '.join(FIELDS)}"
        raise InputError(msg)


def places(frame: Frame, wanted: Sequence[str]) -> dict[str, Floats | None]:
    """Middle (2,) of each wanted field [mm]; None where no band has room.

    Raises
    ------
    InputError
        A field does not exist.
    """
    require_known(wanted)
    free = [band.x0 for band in frame.bands]
    found: dict[str, Floats | None] = {}
    for name in wanted:
        field = FIELDS[name]
        room = [k for k in field.bands if free[k] + field.width <= frame.bands[k].x1]
        found[name] = None
        if room:
            k = room[0]
            found[name] = np.array([free[k] + field.width / 2, (frame.bands[k].y0 + frame.bands[k].y1) / 2])
            free[k] += field.width + BAND_GAP
    return found


def fields(frame: Frame, job: Job) -> Shape:
    """The wanted fields that have room, as exposed: (n, 4, 2) seen from above [mm]."""
    found = places(frame, job.marks.fields)
    return join(*(FIELDS[name].draw(job.channels) + at for name, at in found.items() if at is not None))


def left_out(frame: Frame, job: Job) -> tuple[Finding, ...]:
    """Say which wanted fields have no room."""
    missing = [name for name, at in places(frame, job.marks.fields).items() if at is None]
    if not missing:
        return ()
    text = f"no room for the test fields {', '.join(missing)} beside a sheet of {frame.sheet.size[0]:.3g} mm"
    return (Finding("test_fields", Severity.INFO, text, float(len(missing)), 0.0),)
