"""The numbers that matter, with their limits and how they are printed."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from lce_solver.compare import REACH
from lce_solver.geometry import face_areas
from lce_solver.judge import rms, stretch_errors
from lce_workbench.core.domains import PLATES
from lce_workbench.core.job_sheet import minutes
from lce_workbench.core.units import UM
from lce_workbench.review.data import Review
from lce_workbench.review.measures import anchoring, budget, jumps, sides

Row = dict[str, Any]


def short(value: float) -> float:
    """Ten digits: enough for every use, and the same on every machine."""
    return float(f"{value:.10g}")


def numbers(review: Review) -> list[Row]:
    """One row per number: its name, value, printed form, unit, limit in words, and severity."""
    return [*_shape(review), *_pattern(review), *_sheet(review), *_plates(review)]


def _row(name: str, value: float, shown: str, unit: str, *, limit: str = "", severity: str = "info") -> Row:
    return {"name": name, "value": short(value), "shown": shown, "unit": unit, "limit": limit, "severity": severity}


def _within(*, good: bool) -> str:
    return "info" if good else "warning"


def _found(review: Review, check: str) -> str:
    return next((r["severity"] for r in review.findings if r["check"] == check), "info")


def _shape(review: Review) -> Iterator[Row]:
    if review.prediction is None:
        return
    told = {key: review.prediction.record[key] for key in ("rms_pct", "max_pct")}
    yield _row("Distance from the target, rms", told["rms_pct"], f"{told['rms_pct']:.2f}", "% of diagonal",
               limit=f"≤ {REACH:g}", severity=_found(review, "prediction"))  # fmt: skip
    yield _row("Distance from the target, largest", told["max_pct"], f"{told['max_pct']:.2f}", "% of diagonal")


def _pattern(review: Review) -> Iterator[Row]:
    design = review.design
    miss = 100 * rms(stretch_errors(design.stretch, design.material), face_areas(design.surface))
    yield _row("Stretches miss the material's, rms", miss, f"{miss:.2f}", "%", limit="≤ 5",
               severity=_found(review, "stretch_rms"))  # fmt: skip
    peak = 100 * float(np.abs(review.errors).max())
    yield _row("… largest in a domain", peak, f"{peak:.2f}", "%")
    most = float(np.degrees(np.abs(review.domains.dtheta).max()))
    yield _row("Twist through the film, largest", most, f"{most:.2f}", "°",
               limit=f"≤ {review.job.sheet.twist_limit_deg:g}", severity=_found(review, "twist_limit"))  # fmt: skip
    turn = float(np.degrees(np.percentile(jumps(review.domains), 99)))
    yield _row("Director between neighbours, 99 of 100 below", turn, f"{turn:.1f}", "°")


def _sheet(review: Review) -> Iterator[Row]:
    domains, job = review.domains, review.job
    edge = float(np.mean(sides(domains)[1])) / UM
    width, height = np.ptp(review.design.uv, axis=0)
    yield _row("Domains", len(domains), f"{len(domains)}", "")
    yield _row("… edge, mean", edge, f"{edge:.0f}", "µm", limit="200 to 500", severity=_within(good=200 <= edge <= 500))
    yield _row("Sheet", max(width, height), f"{width:.2f} × {height:.2f}", "mm")
    yield _row("Film = spacer", job.sheet.gap_um, f"{job.sheet.gap_um:g}", "µm", limit="100 or 150",
               severity=_found(review, "gap"))  # fmt: skip


def _plates(review: Review) -> Iterator[Row]:
    job, spec = review.job, review.job.channels
    width, height = review.frame.plate.size
    yield _row("Glass", width, f"{width:g} × {height:g}", "mm")
    sizes = f"{spec.width_um:g}, {spec.spacing_um:g}, {spec.depth_um:g}"
    yield _row("Channels: width, spacing, depth", spec.width_um, sizes, "µm")
    for plate in PLATES:
        count = int(review.columns[f"channels_{plate}"].sum())
        yield _row(f"Channels on the {plate} plate", count, f"{count}", "")
    strong = next(iter(anchoring(spec).values()))
    yield _row("Anchoring, times the paper's", strong, f"{strong:.2f}", "", limit="≥ 1",
               severity=_within(good=strong > 0.999))  # fmt: skip
    plan = budget(review.frame, review.domains, job)
    yield _row("Read-out of the alignment, 95 %", plan.known / UM, f"± {plan.known / UM:.2f}", "µm",
               limit=f"tolerance {job.marks.tolerance_um:g}", severity=_within(good=plan.left > 0))  # fmt: skip
    time = minutes(float(np.prod(review.frame.sheet.size)), min(spec.width_um, spec.spacing_um))
    yield _row("Laser writing, per plate (estimate)", time, f"{time:.0f}", "min")
