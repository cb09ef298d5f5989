"""Which parameters each result is made from, besides the design: when another one changes, it stays current."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import fields
from typing import Any

from lce_workbench.core.job import Job
from lce_workbench.core.jobfile import TWIST_KEYS, toml_name

TWIST = (*(f"sheet.{key}" for key in TWIST_KEYS), "prediction.correct")
"""What the design depends on and its metric does not."""

USES: dict[str, tuple[str, ...]] = {
    "prediction": (
        *TWIST, "prediction.seed", "prediction.imperfection", "prediction.steps", "prediction.plate",
        "prediction.density_kg_m3", "prediction.modulus_MPa",
    ),
    "mask": (
        *TWIST, "channels", "marks",
        "plates.carrier", "plates.width_mm", "plates.height_mm", "plates.replications",
        "spacer.strip_mm", "spacer.clearance_mm", "spacer.glue_mm",
        "output.masks", "output.pictures", "output.overlay_x_um", "output.overlay_y_um", "output.writer_um",
    ),
    "review": ("sheet", "channels", "plates", "marks", "spacer", "prediction", "output"),
}  # fmt: skip
"""Result -> parameters, or sections with all of theirs."""


def values(job: Job, names: Iterable[str]) -> dict[str, Any]:
    """Name as in the job file -> value of some parameters; a section's name stands for all of its own."""
    wanted = set(names)
    return {
        f"{part.name}.{toml_name(f)}": getattr(getattr(job, part.name), f.name)
        for part in fields(job)
        for f in fields(getattr(job, part.name))
        if not wanted.isdisjoint({part.name, f"{part.name}.{toml_name(f)}"})
    }


def sections(names: Iterable[str]) -> tuple[str, ...]:
    """The sections that hold some parameters, in the job's order."""
    wanted = {name.partition(".")[0] for name in names}
    return tuple(part.name for part in fields(Job) if part.name in wanted)
