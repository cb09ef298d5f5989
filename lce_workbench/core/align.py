"""From readings of the marks to how the plates lie: shift, rotation and scale of the top plate against the bottom one.

To first order a point (x, y) of the top plate is off by (tx - phi y + s x, ty + phi x + s y). Each cluster gives two of
these numbers; least squares over all clusters gives the four unknowns and how well they are known. The intervals take
the rounding of the readings as independent, as it is once rotation and scale spread them over more than one step; where
all clusters read the same, interpolate between the bars.
"""

from __future__ import annotations

import csv
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.special import chdtrc

from lce_solver.errors import InputError
from lce_solver.types import Floats
from lce_workbench.core.frame import Frame, Rect
from lce_workbench.core.job import Job
from lce_workbench.core.units import UM

PLACES = (
    "lower left", "lower right", "upper right", "upper left",
    "lower middle", "right middle", "upper middle", "left middle",
)  # fmt: skip
"""Names of the clusters, in the order of `Frame.marks`."""

COLUMNS = ("mark", "x_mm", "y_mm", "dx_um", "dy_um", "resolution_um")

CONFIDENCE = 1.959964
"""Half width of the 95 % interval, in standard deviations."""

CONTRADICTION = 0.001
"""Residuals less likely than this mean that a reading is wrong."""

LARGEST = 150.0
"""Capture range of the gauge [um]."""


@dataclass(frozen=True, eq=False)
class Readings:
    """What was read, and what it has to be judged by."""

    at: Floats
    """(n, 2) places of the clusters that were read [mm]."""
    shift: Floats
    """(n, 2) how far the top plate lies from its place there [mm]."""
    resolution: Floats
    """(n,) step of the reading: 1 um for a vernier [mm]."""
    sheet: Rect
    tolerance: float
    """[mm]"""


@dataclass(frozen=True, eq=False)
class Alignment:
    """How the top plate lies; each number with half of its 95 % interval."""

    shift: Floats
    """(2,) along x and y [mm]."""
    rotation: float
    """Counter-clockwise seen from above [rad]; the twist is wrong by as much everywhere."""
    scale: float
    """Top over bottom, less 1."""
    worst: float
    """Largest mismatch on the sheet [mm]."""
    halves: Floats
    """(5,) of shift x, shift y, rotation, scale, worst."""
    unlikely: bool
    """Whether the readings contradict each other."""
    passed: bool
    """Whether they agree and the largest mismatch, with its interval, is within the tolerance."""


def fit(readings: Readings) -> Alignment:
    """Least squares over all readings, errors even within the step of each.

    Raises
    ------
    InputError
        Fewer than two clusters were read.
    """
    if len(np.unique(readings.at, axis=0)) < 2:
        msg = "rotation and scale need the readings of two marks at least; fill in dx_um and dy_um of more lines"
        raise InputError(msg)
    sigma = np.repeat(readings.resolution / np.sqrt(12), 2)
    rows = _effects(readings.at).reshape(-1, 4) / sigma[:, None]
    measured = readings.shift.ravel() / sigma
    covariance = np.linalg.inv(rows.T @ rows)
    found = covariance @ (rows.T @ measured)
    misfit, freedom = float(np.sum((rows @ found - measured) ** 2)), len(measured) - 4
    unlikely = freedom > 0 and bool(chdtrc(freedom, misfit) < CONTRADICTION)
    worst, gradient = _worst(found, readings.sheet)
    variances = [*np.diag(covariance), gradient @ covariance @ gradient]
    halves = CONFIDENCE * np.sqrt(variances)
    good = not unlikely and worst + float(halves[4]) <= readings.tolerance
    return Alignment(found[:2], float(found[2]), float(found[3]), worst, halves, unlikely, good)


def _effects(at: Floats) -> Floats:
    """What shift x, shift y, rotation and scale do at places (n, 2): (n, 2, 4)."""
    x, y = at.T
    one, none = np.ones_like(x), np.zeros_like(x)
    return np.stack([np.stack([one, none, -y, x], axis=1), np.stack([none, one, x, y], axis=1)], axis=1)


def _worst(found: Floats, sheet: Rect) -> tuple[float, Floats]:
    """Largest mismatch on the sheet, at one of its corners, and its gradient by the four unknowns."""
    effects = _effects(sheet.ring)
    off = effects @ found
    size = np.linalg.norm(off, axis=1)
    k = int(size.argmax())
    if size[k] == 0:
        return 0.0, effects[k, 0]
    gradient: Floats = off[k] @ effects[k] / size[k]
    return float(size[k]), gradient


def form(frame: Frame, job: Job, code: str) -> str:
    """A table to fill in, as text: ``dx_um``, ``dy_um`` = the numbers under the bars of the verniers that meet."""
    sheet = " ".join(f"{v:.6f}" for v in (frame.sheet.x0, frame.sheet.y0, frame.sheet.x1, frame.sheet.y1))
    lines = [
        f"# design {code}: read both verniers of each cluster from above; a number left of 0 on x is positive",
        "# dx_um, dy_um: the number under the bars that meet; leave empty what was not read",
        f"# sheet_mm {sheet}",
        f"# tolerance_um {job.marks.tolerance_um:g}",
        ",".join(COLUMNS),
        *(f"{name},{x:.6f},{y:.6f},,,1" for name, (x, y) in zip(PLACES, frame.marks, strict=True)),
    ]
    return "\n".join(lines) + "\n"


def read(path: Path) -> Readings:
    """Read a form that was filled in.

    Raises
    ------
    InputError
        The file is not such a form, or a number in it makes no sense.
    """
    try:
        lines = path.read_text(encoding="utf-8-sig").splitlines()
        notes = [line.strip('#;,\t "') for line in lines if _is_note(line)]
        said = dict(note.split(maxsplit=1) for note in notes if " " in note)
        head, rows = _rows([line for line in lines if line.strip() and not _is_note(line)])
    except (OSError, UnicodeDecodeError, csv.Error) as fault:
        msg = f"{path} cannot be read ({fault}); give the readings.csv that lies beside the masks"
        raise InputError(msg) from None
    missing = [name for name in COLUMNS if name not in head]
    if missing or not {"sheet_mm", "tolerance_um"} <= set(said):
        what = f"the column {missing[0]}" if missing else "the line '# sheet_mm' or '# tolerance_um'"
        msg = f"{path} lacks {what}; fill in the readings.csv that lies beside the masks"
        raise InputError(msg)
    rows = [row for row in rows if row.get("dx_um", "").strip() and row.get("dy_um", "").strip()]
    marks = [row["mark"] for row in rows]
    twice = [mark for k, mark in enumerate(marks) if mark in marks[:k]]
    if twice:
        msg = f"{path} has two lines for {twice[0]!r}; keep one, with the mean of its readings"
        raise InputError(msg)
    values = np.array([[_number(path, row, name) for name in COLUMNS[1:]] for row in rows]).reshape(-1, 5)
    sheet = [_number(path, {"mark": "# sheet_mm", "sheet_mm": v}, "sheet_mm") for v in said["sheet_mm"].split()]
    if len(sheet) != 4:
        msg = f"{path}: '# sheet_mm' needs four numbers; copy the line from the form beside the masks"
        raise InputError(msg)
    tolerance = _number(path, {"mark": "# tolerance_um", **said}, "tolerance_um")
    _refuse_millimetres(path, values)
    return Readings(values[:, :2], values[:, 2:4] * UM, values[:, 4] * UM, Rect(*sheet), tolerance * UM)


def _is_note(line: str) -> bool:
    """Whether a line is none of the table; spreadsheets quote it where it holds their delimiter."""
    return line.lstrip('"').startswith("#")


def _rows(lines: Sequence[str]) -> tuple[list[str], list[dict[str, str]]]:
    """Names of the columns, and the lines by them; where a spreadsheet wrote ; or tabs, a comma is a decimal point."""
    if not lines:
        return [], []
    delimiter = next((sign for sign in ";\t" if sign in lines[0]), ",")
    point = "," if delimiter == "," else "."
    head, *rows = csv.reader(lines, delimiter=delimiter)
    longer = [row[0] for row in rows if any(row[len(head) :])]
    if longer:
        msg = f"line {longer[0]!r} has more columns than the head; write decimals with a point"
        raise csv.Error(msg)
    return head, [dict(zip(head, (value.replace(",", point) for value in row), strict=False)) for row in rows]


RANGES = {
    "dx_um": (-LARGEST, LARGEST),
    "dy_um": (-LARGEST, LARGEST),
    "resolution_um": (0.001, LARGEST),
    "tolerance_um": (0.001, 1000.0),
}
"""What a number of the form may be; places are within a metre [mm]."""


def _number(path: Path, row: Mapping[str, str], name: str) -> float:
    found = row.get(name, "").strip()
    try:
        value = float(found)
    except ValueError:
        value = np.nan
    low, high = RANGES.get(name, (-1000.0, 1000.0))
    if not low <= value <= high:
        msg = (
            f"{path}, line {row['mark']!r}: {name} = {found!r} is not a number from {low:g} to {high:g}; mend the line"
        )
        raise InputError(msg)
    return value


def _refuse_millimetres(path: Path, values: Floats) -> None:
    """Shifts (n, 5), with place and resolution, that are all far below what can be read are in another unit."""
    size, step = np.abs(values[:, 2:4]), values[:, 4:]
    if size.any() and np.all(size < step / 10):
        what = "all shifts are below a tenth of resolution_um"
        msg = f"{path}: {what}; write dx_um and dy_um in um, or a finer resolution_um"
        raise InputError(msg)


def told(found: Alignment) -> dict[str, float | bool]:
    """The result in the units of the bench."""
    values = (*(found.shift / UM), np.degrees(found.rotation), found.scale * 1e6, found.worst / UM)
    halves = found.halves / [UM, UM, np.pi / 180, 1e-6, UM]
    names = ("shift_x_um", "shift_y_um", "rotation_deg", "scale_ppm", "worst_mismatch_um")
    numbers = {name: float(value) for name, value in zip(names, values, strict=True)}
    intervals = {f"{name}_95": float(half) for name, half in zip(names, halves, strict=True)}
    twist = {"dtheta_error_deg": numbers["rotation_deg"], "dtheta_error_deg_95": intervals["rotation_deg_95"]}
    return {**numbers, **intervals, **twist, "readings_agree": not found.unlikely, "passed": found.passed}
