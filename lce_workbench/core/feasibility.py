"""Which stretch, or which temperature of a measured curve, reaches the target best: known from a coarse mesh."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from lce_solver.contest import compete, ranking
from lce_solver.cut import opened, proposed
from lce_solver.feasible import length_bound
from lce_solver.geometry import mean_edge
from lce_solver.metric import Stop
from lce_solver.mirror import even_mesh
from lce_solver.types import Material, Progress, Start, Surface, silent
from lce_workbench.core import material as materials
from lce_workbench.core.job import Job
from lce_workbench.core.target import trial

LAMBDAS = (0.4, 0.5, 0.55, 0.6, 0.65, 0.7, 0.75, 0.8, 0.85, 0.9)
"""Stretches that are tried when the job has no measured curve; their inverses for a job above 1."""
WEAK = 0.02
"""A stretch this close to 1 does nothing and is left out."""
STARTS = 4
QUICK = Stop(1e-5, 1000)


@dataclass(frozen=True)
class Row:
    """What one material does on the coarse mesh."""

    temperature: float | None
    """Of the curve [degC]."""
    material: Material
    start: Start
    """The best start."""
    length_ratio: float
    """Longest line that the target needs over the longest that a smooth director can have; see `feasible`."""

    @property
    def possible(self) -> bool:
        """Whether the flat sheet is valid."""
        return self.start.flipped == self.start.crossings == 0


@dataclass(frozen=True)
class Survey:
    """All that were tried, and how the job's own material converges."""

    rows: tuple[Row, ...]
    rms_coarse: float
    """Rms error of the stretches with the job's material, on the coarse mesh."""
    rms_fine: float
    """The same with edges half as long."""

    @property
    def factor(self) -> float:
        """By what halving the edges divides the error: near 2 the mesh makes it, near 1 the target is out of reach."""
        return self.rms_coarse / self.rms_fine

    @property
    def best(self) -> Row | None:
        """The valid row with the least error."""
        return min((row for row in self.rows if row.possible), key=lambda row: row.start.rms, default=None)


def survey(job: Job, base: Path, progress: Progress = silent) -> Survey:
    """Solve the job's target on a coarse mesh for many stretches or temperatures, and once on a finer one.

    Raises
    ------
    InputError
        The target or the material cannot be read.
    """
    matter, _ = materials.resolve(job.material, base)
    whole = trial(job, base)
    wanted = list(_candidates(job, base, matter))
    rows = []
    for k, (temperature, candidate) in enumerate(wanted):
        progress(f"lambda {candidate.lambda_:.3f}", k / (len(wanted) + 2))
        surface = _cut(whole, job, candidate)
        bound = length_bound(surface, candidate)
        rows.append(Row(temperature, candidate, _best(surface, candidate), bound.ratio if bound else 0.0))
    progress("refinement", 1 - 2 / (len(wanted) + 2))
    own = _cut(whole, job, matter)
    fine = _cut(even_mesh(whole, mean_edge(whole) / 2), job, matter)
    found = Survey(tuple(rows), _best(own, matter).rms, _best(fine, matter).rms)
    progress("feasibility", 1.0)
    return found


def _candidates(job: Job, base: Path, matter: Material) -> Iterator[tuple[float | None, Material]]:
    if job.material.curve:
        path = base / job.material.curve
        for temperature in materials.temperatures(path):
            found = materials.measured(path, temperature)
            if abs(np.log(found[0])) > WEAK:
                yield temperature, materials.from_curve(path, temperature)
        return
    values = np.array(LAMBDAS) if matter.lambda_ < 1 else 1 / np.array(LAMBDAS[::-1])
    for value in np.unique(np.append(values, matter.lambda_)):
        yield None, Material(float(value), matter.nu, matter.source)


def _cut(surface: Surface, job: Job, matter: Material) -> Surface:
    return opened(surface, proposed(surface, matter)) if job.target.cuts else surface


def _best(surface: Surface, matter: Material) -> Start:
    starts = list(compete(surface, matter, STARTS, QUICK)[1])
    return starts[ranking(starts)[0]]


def table(found: Survey) -> str:
    """The survey as text, a line each."""
    lines = [f"{'T [C]':>7}{'lambda':>8}{'nu':>7}{'rms':>9}{'bending left':>14}{'line length':>13}  sheet"]
    for row in found.rows:
        at = "" if row.temperature is None else f"{row.temperature:g}"
        sheet = "valid" if row.possible else f"{row.start.flipped} flips, {row.start.crossings} crossings"
        lines.append(
            f"{at:>7}{row.material.lambda_:8.3f}{row.material.nu:7.3f}{row.start.rms:9.2%}{row.start.bending_left:14.1%}"
            f"{row.length_ratio:13.0%}  {sheet}"
        )
    lines.append(
        f"edges half as long divide the error of the job's own material by {found.factor:.2f} "
        f"({found.rms_coarse:.2%} to {found.rms_fine:.2%}): near 2 it comes from the mesh, near 1 from the target"
    )
    best = found.best
    at = "" if best is None or best.temperature is None else f" ({best.temperature:g} C)"
    said = (
        "no stretch gives a valid sheet" if best is None else f"lambda = {best.material.lambda_:.3f}{at} comes closest"
    )
    return "\n".join([*lines, f"{said}; coarse mesh, so read the figures against each other", ""])


def told(found: Survey) -> dict[str, Any]:
    """The survey for programs."""
    rows = [
        {
            "temperature_C": row.temperature,
            "lambda": row.material.lambda_,
            "nu": row.material.nu,
            "rms": row.start.rms,
            "bending_left": row.start.bending_left,
            "length_ratio": row.length_ratio,
            "flipped": row.start.flipped,
            "crossings": row.start.crossings,
        }
        for row in found.rows
    ]
    return {"rows": rows, "rms_coarse": found.rms_coarse, "rms_fine": found.rms_fine, "factor": found.factor}
