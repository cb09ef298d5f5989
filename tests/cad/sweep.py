"""Cells of random jobs, made and measured as the pipeline does it, with few marks."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
from sheets import design

from lce_solver.types import Finding, Floats
from lce_workbench.cad.checks import check
from lce_workbench.cad.step import write_cad
from lce_workbench.core.cell import assemble, select
from lce_workbench.core.channels import hatch
from lce_workbench.core.domains import PLATES, Plate, partition
from lce_workbench.core.frame import Frame, arrange
from lce_workbench.core.job import ChannelSpec, Job, Marks, Output, Plates, Sheet, Spacer
from lce_workbench.core.marks import MARKS, Wanted, cross, windows
from lce_workbench.core.shapes import moved


def random_job(rng: np.random.Generator) -> Job:
    """A job with every option of the cell somewhere in its range."""
    width, spacing = rng.uniform(2.0, 8.0, 2)
    glass = rng.uniform(0.5, 3.0)
    sometimes = rng.integers(0, 2, 5).astype(bool)
    return replace(
        Job(),
        sheet=Sheet(gap_um=float(rng.uniform(20, 300))),
        channels=ChannelSpec(width, spacing, float(rng.uniform(0.1, 3.0)), float(rng.uniform(0.4, 3.0))),
        plates=Plates(
            carrier=str(rng.choice(["auto", "25x75", "75x25", "50x50"])),
            glass_mm=float(glass),
            epoxy_um=float(rng.uniform(5, 500)),
            chamfer_mm=float(sometimes[0] * rng.uniform(0.05, 0.4)),
            release_deg=float(sometimes[1] * rng.uniform(1, 30)),
            notch_mm=float(sometimes[2] * rng.uniform(0.5, 2.0)),
            engraving_um=float(sometimes[3] * rng.uniform(20, 400)),
            frame_mm=float(sometimes[4] * rng.uniform(1, 8)),
            frame_clearance_um=float(rng.uniform(0, 200)),
        ),
        marks=Marks(clearance_mm=float(rng.uniform(0.5, 3.0)), tolerance_um=float(rng.uniform(3, 20))),
        spacer=Spacer(*(float(v) for v in rng.uniform((1, 0.3, 2.0, 0.2), (4, 2.0, 3.0, 2.0)))),
        output=Output(step_domains=(int(rng.integers(96)),), cad=("sheet",)),
    )


def gauges(frame: Frame, plate: Plate, job: Job) -> list[Floats]:
    """The gauge of each cluster alone: reading hundreds of recesses back takes a kernel seconds."""
    draw = cross if plate == "top" else windows
    shape = moved(draw(Wanted(job.marks)), *MARKS["gauge"].at)
    return [ring + corner for corner in frame.marks for ring in shape]


def swept(seed: int, folder: Path) -> tuple[Finding, ...]:
    """The findings of the cad stage for the job of a seed, on a small sheet."""
    rng = np.random.default_rng(seed)
    job = random_job(rng)
    plan = replace(
        design(6, 8, width=rng.uniform(1.0, 2.0), height=rng.uniform(1.0, 2.0), seed=seed),
        thickness=job.sheet.thickness,
    )
    domains = partition(plan)
    frame = arrange(plan.uv, job)
    channels = {plate: hatch(domains, plate, job.channels) for plate in PLATES}
    cell = assemble(frame, job, domains, {plate: gauges(frame, plate, job) for plate in PLATES}, channels)
    solids = {plate: [select(part, cell.chosen)] for plate, part in channels.items()}
    write_cad(cell, solids, job, folder)
    return check(cell, solids, frame, job, folder)
