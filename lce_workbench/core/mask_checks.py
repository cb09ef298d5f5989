"""Checks of a mask on the integers that are written, against the design it was made from.

Every check is closed-form and reports what it measured, good or bad. The channel checks run over blocks of channels, so
their memory does not grow with the plate.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from lce_solver.types import Finding, Floats, Severity
from lce_workbench.core.channel_checks import CHANNEL_CHECKS, ROUNDING, Block, Points, cross, keep_worst
from lce_workbench.core.channels import ChannelField
from lce_workbench.core.domains import Domains
from lce_workbench.core.frame import SPILL, Frame
from lce_workbench.core.gaps import smallest_gap
from lce_workbench.core.job import Job
from lce_workbench.core.mask import EXPOSED, Mask, Nanometres, flipped, written
from lce_workbench.core.units import NM

MAX_CORNERS = 4000
"""Corners of a polygon that every reader of GDSII takes."""

MAX_REACH = 1e8
"""Half the side of the largest plate the writer takes, 200 mm [nm]."""

AREA_LOSS = 0.04
"""Largest fraction of the channel area that guards and square ends may cost."""

RUN = 8192
"""Polygons measured at once."""


def check(mask: Mask, field: ChannelField, frame: Frame, job: Job) -> tuple[Finding, ...]:
    """Measure a mask; a finding is an error where it leaves its limit. The channels are gone through once.

    Parameters
    ----------
    field : what ``CHANNELS`` was made of; only the number of channels in each domain is used.
    """
    channels, survey = _channel_findings(mask, field)
    surveys = {name: _survey(mask, name) for name in mask.layers if name != "CHANNELS"} | {"CHANNELS": survey}
    return (
        *channels,
        *_polygon_findings(mask, surveys),
        _border(mask, field.domains),
        *_mark_findings(mask, frame, job),
        *_extent_findings(mask, surveys),
    )


@dataclass(frozen=True)
class Survey:
    """What is measured on the polygons of every layer."""

    turn: float = np.inf
    """Smallest vector product of two consecutive edges [nm2]."""
    edge: float = np.inf
    """Shortest edge [nm]."""
    corners: int = 0
    """Most corners."""
    low: tuple[float, float] = (np.inf, np.inf)
    """Lower left corner of everything [nm]."""
    high: tuple[float, float] = (-np.inf, -np.inf)
    """Upper right corner of everything [nm]."""

    def with_(self, corners: Points) -> Survey:
        """With polygons (k, n) added."""
        side = np.roll(corners, -1, axis=0) - corners
        x, y = corners.real, corners.imag
        return Survey(
            min(self.turn, *(float(cross(side[i - 1], side[i]).min()) for i in range(len(side)))),
            min(self.edge, float(np.abs(side).min())),
            max(self.corners, len(corners)),
            (min(self.low[0], float(x.min())), min(self.low[1], float(y.min()))),
            (max(self.high[0], float(x.max())), max(self.high[1], float(y.max()))),
        )


def _survey(mask: Mask, layer: str) -> Survey:
    survey = Survey()
    for corners in _blocks(mask, layer):
        survey = survey.with_(corners)
    return survey


def _channel_findings(mask: Mask, field: ChannelField) -> tuple[list[Finding], Survey]:
    """The worst value of every channel check, and the area of all channels; also what is measured on any layer."""
    worst: dict[str, tuple[float, int]] = {}
    survey, exposed, first, last = Survey(), 0.0, 0, np.cumsum(field.counts)
    borders, direction = _points(field.domains.corners / NM).T, field.domains.written(mask.plate)
    for corners in _blocks(mask, "CHANNELS"):
        survey = survey.with_(corners)
        domain = np.searchsorted(last, np.arange(first, first + corners.shape[1]), side="right")
        seen = -np.conj(corners[::-1]) if mask.plate == "top" else corners
        keep_worst(worst, Block(corners, seen, domain, borders, direction, field.spec))
        exposed += float(cross(corners[2] - corners[0], corners[3] - corners[1]).sum()) / 2
        first += corners.shape[1]
    found = []
    for name, (value, place) in worst.items():
        item = CHANNEL_CHECKS[name]
        measured = Measurement(value, item.limit(field.spec), item.at_least, item.unit, f"domain {place}")
        found.append(_judged(mask, name, item.quantity, measured, item.severity))
    return [*found, _area(mask, field, exposed)], survey


def _area(mask: Mask, field: ChannelField, exposed: float) -> Finding:
    """Channel area [nm2], from the integers, as a fraction of sheet area x duty."""
    ratio = exposed * NM**2 / (float(np.abs(field.domains.area).sum()) * field.spec.duty)
    text = "channel area / (sheet area x duty)"
    return _judged(mask, "channel_area", text, Measurement(ratio, 1 - AREA_LOSS, True), Severity.WARNING)


def _polygon_findings(mask: Mask, surveys: Mapping[str, Survey]) -> Iterator[Finding]:
    """Convexity, edge length and number of corners of every polygon of every layer."""
    flat = min(surveys, key=lambda name: surveys[name].turn)
    short = min(surveys, key=lambda name: surveys[name].edge)
    rich = max(surveys, key=lambda name: surveys[name].corners)
    for check, text, found in (
        (
            "polygon_convex",
            "smallest turn at a corner (positive: convex, counter-clockwise)",
            Measurement(surveys[flat].turn, 1.0, True, "nm2", flat),
        ),
        ("polygon_edge", "shortest edge of a polygon", Measurement(surveys[short].edge, 1.0, True, "nm", short)),
        (
            "polygon_corners",
            "most corners of a polygon",
            Measurement(surveys[rich].corners, MAX_CORNERS, False, "", rich),
        ),
    ):
        yield _judged(mask, check, text, found)


def _border(mask: Mask, domains: Domains) -> Finding:
    """Domain borders, mirrored back on the top plate, against the design."""
    error = np.zeros(len(domains))
    for group, (rows, rings) in zip(mask.layers["DOMAINS"], domains.rings(), strict=True):
        seen = flipped(group) if mask.plate == "top" else group
        error[rows] = np.abs(seen - rings / NM).max(axis=(1, 2))
    worst = int(error.argmax())
    text = "largest distance of a written domain corner from the design"
    return _judged(mask, "domain_border", text, Measurement(float(error[worst]), 1.0, False, "nm", f"domain {worst}"))


def _mark_findings(mask: Mask, frame: Frame, job: Job) -> Iterator[Finding]:
    """Marks, labels and test fields stay clear of the sheet, of what is filled, of the spacer and of each other."""
    groups = {name: np.concatenate([*mask.layers[name]]) for name in ("MARKS", "LABELS", "TEST")}
    boxes = {name: _boxes(group) for name, group in groups.items()}
    marks, dry = np.concatenate([*boxes.values()]), np.concatenate([boxes["MARKS"], boxes["LABELS"]])
    sheet, fill = (_boxes(written(region.ring[None], mask.plate)) for region in (frame.sheet, frame.fill))
    spacer = np.concatenate([_boxes(group) for group in mask.layers["SPACER"]])
    clear, beside = job.marks.clearance_mm, job.spacer.clearance_mm
    unfilled = max(clear - SPILL, 0.0)
    for name, text, gap, least in (
        ("marks_sheet", "clearance from the sheet to the marks", _gaps(marks, sheet).min(), clear / NM),
        (
            "marks_fill",
            "clearance from the filled area to the marks",
            _gaps(dry, fill).min(),
            unfilled / NM,
        ),
        (
            "marks_spacer",
            "clearance from the marks to the spacer",
            _gaps(marks, spacer).min(),
            beside / NM,
        ),
        (
            "marks_disjoint",
            "smallest gap between two polygons of marks, labels, test fields",
            smallest_gap(np.concatenate([*groups.values()]).astype(np.float64)),
            ROUNDING,
        ),
    ):
        yield _judged(mask, name, text, Measurement(float(gap), least - ROUNDING, True, "nm"))


def _extent_findings(mask: Mask, surveys: Mapping[str, Survey]) -> Iterator[Finding]:
    """Everything lies on the writer's largest plate, and what is exposed lies on this one."""
    reach = max(max(np.abs((*survey.low, *survey.high))) for survey in surveys.values() if survey.corners)
    yield _judged(mask, "extent", "largest coordinate", Measurement(float(reach), MAX_REACH, False, "nm"))
    plate, exposed = surveys["PLATE"], [surveys[name] for name in EXPOSED]
    low = min(min(np.subtract(survey.low, plate.low)) for survey in exposed)
    high = min(min(np.subtract(plate.high, survey.high)) for survey in exposed)
    text = "smallest distance from what is exposed to the plate's edge"
    yield _judged(mask, "plate_margin", text, Measurement(float(min(low, high)), 0.0, True, "nm"))


@dataclass(frozen=True)
class Measurement:
    """A value beside its limit."""

    value: float
    limit: float
    at_least: bool
    unit: str = ""
    place: str = ""


def _judged(mask: Mask, name: str, quantity: str, found: Measurement, severity: Severity = Severity.ERROR) -> Finding:
    """A finding of ``severity`` if the value leaves its limit, else an information."""
    good = found.value >= found.limit if found.at_least else found.value <= found.limit
    bound = "at least" if found.at_least else "at most"
    where = f"{mask.plate} plate" + (f", {found.place}" if found.place else "")
    text = f"{quantity} is {found.value:.6g} {found.unit}".rstrip() + f" ({bound} {found.limit:.6g}; {where})"
    return Finding(name, Severity.INFO if good else severity, text, found.value, found.limit, found.unit, where)


def _blocks(mask: Mask, layer: str) -> Iterator[Points]:
    """Corners (k, n) of a layer's polygons, as they come, at most ``RUN`` of marks at once."""
    for group in mask.layers[layer]:
        size = len(group) if layer == "CHANNELS" else RUN  # a block of channels holds whole domains
        for start in range(0, len(group), size):
            yield np.ascontiguousarray(_points(group[start : start + size]).T)


def _points(polygons: Nanometres | Floats) -> Points:
    """Corners (n, k, 2) as complex numbers (n, k)."""
    points: Points = np.ascontiguousarray(polygons, dtype=np.float64).view(np.complex128)[..., 0]
    return points


def _boxes(polygons: Nanometres) -> Floats:
    """Bounding boxes (n, 4): low x, low y, high x, high y."""
    return np.concatenate([polygons.min(axis=1), polygons.max(axis=1)], axis=1).astype(np.float64)


def _gaps(a: Floats, b: Floats) -> Floats:
    """(n, m) gap between boxes along the axis where it is largest; negative if they overlap."""
    low = np.maximum(a[:, None, :2], b[None, :, :2])
    high = np.minimum(a[:, None, 2:], b[None, :, 2:])
    gaps: Floats = (low - high).max(axis=2)
    return gaps
