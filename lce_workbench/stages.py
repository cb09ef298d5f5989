"""The stages: what each makes from what the one before wrote."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from itertools import chain, repeat
from pathlib import Path
from typing import Any

import numpy as np

from lce_solver.choice import arriving
from lce_solver.compare import REACH, Comparison, Verdict, compare, placed
from lce_solver.cut import seams
from lce_solver.design import designs, renewed
from lce_solver.errors import SolverError
from lce_solver.shell import film_of, predict, settle
from lce_solver.types import Design, Finding, Material, Progress, Severity, Surface, silent
from lce_workbench import checkpoint
from lce_workbench.cluster import client, each
from lce_workbench.core import align, jobfile, material, target
from lce_workbench.core.cell import Cell, choose, select, wanted
from lce_workbench.core.channels import ChannelField, Channels, joined
from lce_workbench.core.closed import closed
from lce_workbench.core.domains import PLATES, Plate
from lce_workbench.core.fields import left_out
from lce_workbench.core.frame import arrange
from lce_workbench.core.job import Job
from lce_workbench.core.job_sheet import job_sheet
from lce_workbench.core.marks import fingerprint
from lce_workbench.core.partition import FOLDED, divide
from lce_workbench.core.replication import replicated
from lce_workbench.core.sampling import as_made
from lce_workbench.core.units import UM
from lce_workbench.core.weight import loaded
from lce_workbench.core.workshop import require_room
from lce_workbench.divided import arrays, read_domains
from lce_workbench.export.film import write_film
from lce_workbench.export.outlines import OUTLINES
from lce_workbench.export.pictures import write_pictures
from lce_workbench.export.table import write_table
from lce_workbench.former import retwist
from lce_workbench.freecad_child import run_freecad
from lce_workbench.outputs import as_record, digest, read_design, told, write_design, write_prediction
from lce_workbench.plates import Sheet, expose, measure

Findings = tuple[Finding, ...]

OFF = 1.25
"""Domains as many times larger or smaller than asked for are made anew, at the scale that the first design showed."""
FILM = "prediction_film.glb"
"""The heating as an animation."""


@dataclass(frozen=True)
class Run:
    """One stage at work: where it writes, what it was asked, whom it tells."""

    folder: Path
    job: Job
    base: Path
    """Folder that the job's file names are relative to."""
    progress: Progress = silent
    metric: Path | None = None
    """Output folder whose flat sheet and director are taken, or `None`: they are solved."""
    scheduler: str | None = None
    """Address of the Dask scheduler whose workers draw the masks, or `None`: this process does."""
    out: Path | None = None
    """The output folder itself, if ``folder`` is to take its place."""


def run_design(run: Run) -> Findings:
    """Solve the inverse problem: `job.toml`, `design.npz`, `domains.csv`."""
    job = run.job
    plans, said = solved(run) if run.metric is None else retwist(job, inputs(job, run.base), run.metric)
    if job.prediction.correct == "off":
        result = next(plans)
        said = (*said, *result.findings)
    else:
        result, told = arriving(plans, job.prediction.correct, job.sheet.twist_limit, run.progress)
        said = (*renewed((*said, *result.findings), result, job.sheet.twist_limit), told)
    require_room(arrange(result.uv, job), job)  # a plate that is too small is told before anything is drawn
    (run.folder / "job.toml").write_text(jobfile.dump(rebased(job, run.base, run.folder)), encoding="utf-8")
    domains, divided = divide(result, job)
    plain = job.domains.kind == "triangles" and not job.channels.align_phase
    write_design(result, run.folder / "design.npz", {} if plain else arrays(domains))
    fields = {plate: ChannelField(domains, plate, job.channels) for plate in PLATES}
    choose(domains, fields, wanted(domains, job.output))  # told before anything else is computed
    write_table(domains, [fields[plate].counts for plate in PLATES], run.folder / "domains.csv")
    return (*said, *target.sized(result, job), *divided, *sheet_findings(job))


def solved(run: Run) -> tuple[Iterator[Design], Findings]:
    """The designs of the job, the best first, and what was found before."""
    job = run.job
    matter, said = material.resolve(job.material, run.base)
    goal, told = target.resolve(job, matter, run.base)
    plans = designed(goal, matter, run)
    first = next(plans)
    off = target.off_size(first, job)
    if job.target.remesh and not 1 / OFF <= off <= OFF:
        goal, told = target.resolve(job, matter, run.base, times=1 / off)
        plans = designed(goal, matter, run)
        first = next(plans)
    return chain([first], plans), (*said, *told)


def designed(goal: Surface, matter: Material, run: Run) -> Iterator[Design]:
    """The designs of one target at the job's width, the best first."""
    job = run.job
    return designs(
        goal,
        matter,
        width=job.sheet.width_mm,
        **job.sheet.twist,
        starts=job.solver.starts,
        tolerance=job.solver.tolerance,
        max_iterations=job.solver.max_iterations,
        smoothing=job.solver.smoothing,
        progress=run.progress,
    )


def rebased(job: Job, base: Path, folder: Path) -> Job:
    """The job with its file names relative to ``folder``, so that `job.toml` can be built again from there."""

    def moved(name: str) -> str:
        return os.path.relpath(os.path.realpath(base / name), os.path.realpath(folder)) if name else ""

    return replace(
        job,
        target=replace(job.target, mesh=moved(job.target.mesh)),
        material=replace(job.material, curve=moved(job.material.curve)),
    )


def sheet_findings(job: Job) -> Findings:
    """Values that are allowed but unusual."""
    found = []
    if job.sheet.gap_um not in {100.0, 150.0}:
        text = (
            f"sheet.gap_um = {job.sheet.gap_um:g} is not a stock Mylar thickness; the paper's films are 100 or 150 um"
        )
        found.append(Finding("gap", Severity.WARNING, text, job.sheet.gap_um, unit="um"))
    if not 200 <= job.domains.size_um <= 500:
        text = f"domains.size_um = {job.domains.size_um:g} is outside the 200 to 500 um that align well"
        found.append(Finding("domain_size", Severity.WARNING, text, job.domains.size_um, unit="um"))
    return tuple(found)


def run_predict(run: Run) -> Findings:
    """Heat the sheet and compare it with the target: `prediction.npz`, `prediction.json`."""
    plan, spec = fabricable(read_design(run.folder / "design.npz")), run.job.prediction
    film = loaded(film_of(as_made(plan, read_domains(run.folder / "design.npz"))), spec)
    how = {"seed": spec.seed, "imperfection": spec.imperfection, "steps": spec.steps}
    with checkpoint.resumed(checkpoint.place(run.out or run.folder), checkpoint.key(film, spec)) as (former, keep):
        found = predict(film, **how, progress=run.progress, former=former, keep=keep)
        start = plan.surface.vertices if film.load is None else placed(plan, found)
        judged = compare(plan, found, settle(film, start, progress=run.progress))
    write_prediction(found, judged, run.folder)
    if spec.film:
        write_film(film.sheet.uv, film.sheet.faces, found.frames, run.folder / FILM)
    return (predicted(judged),)


def predicted(judged: Comparison) -> Finding:
    """Whether the heated sheet takes the target shape; else a warning, for another path may end elsewhere."""
    known = {Verdict.TARGET: Severity.INFO, Verdict.NOT_CONVERGED: Severity.ERROR}
    severity = known.get(judged.verdict, Severity.WARNING)
    text = (
        f"{judged.verdict.value} ({judged.rms_pct:.2g}% rms, {judged.max_pct:.2g}% at most, of the target's diagonal)"
    )
    return Finding("prediction", severity, text, judged.rms_pct, REACH, "%")


def run_mask(run: Run) -> Findings:
    """Draw both plates: `mask/bottom.*`, `mask/top.*`."""
    plan = fabricable(read_design(run.folder / "design.npz"))
    domains, frame = read_domains(run.folder / "design.npz"), arrange(plan.uv, run.job)
    folder = run.folder / "mask"
    folder.mkdir()
    code = fingerprint(domains, run.job.channels)
    (folder / "readings.csv").write_text(align.form(frame, run.job, code), encoding="ascii")
    found: list[Finding] = [*left_out(frame, run.job), *replicated(run.job.plates.replications)]
    sheet, masks = Sheet(frame, domains, run.job, plan.uv[seams(plan.surface).reshape(-1, 2)]), run.job.output.masks
    sheet.mask("bottom")  # what it refuses is told before any file is written
    pairs = [(plate, name) for plate in PLATES for name in masks]
    with client(run.scheduler) as workers:
        files = each(workers, expose, repeat(sheet), *zip(*pairs, strict=True), repeat(folder))
        for k, name in enumerate(files):
            run.progress(f"mask {name}", k / len(pairs))
        measured = dict(zip(PLATES, each(workers, measure, repeat(sheet), PLATES), strict=True))
    found += [finding for findings, _ in measured.values() for finding in findings]
    counted = {plate: total for plate, (_, total) in measured.items()}
    output = run.job.output
    if output.pictures:
        drawn = {plate: sheet.mask(plate) for plate in PLATES}
        write_pictures(frame, domains, drawn, folder, (output.overlay_x_um * UM, output.overlay_y_um * UM))
    (folder / "job_sheet.txt").write_text(job_sheet(frame, run.job, counted, code), encoding="ascii")
    run.progress("mask", 1.0)
    return tuple(found)


def fabricable(plan: Design) -> Design:
    """The design itself, when a mold can be made of it.

    Raises
    ------
    SolverError
        The flat sheet is folded or overlaps itself.
    """
    status = plan.flattening.status
    if status in FOLDED:
        msg = (
            f"{status.value}, so no mold can be made of it; `./lce design` writes the design to look at, "
            "then try a larger piece of the target's rim, a stronger lambda, or more solver.starts"
        )
        raise SolverError(msg)
    return plan


def run_cad(run: Run) -> Findings:
    """Build the cell: `cad/*.step`, `cad/cell.glb`, `cad/cell.FCStd`."""
    from lce_workbench.cad.checks import check as measure
    from lce_workbench.cad.step import write_cad

    job, folder = run.job, run.folder / "cad"
    plan = fabricable(read_design(run.folder / "design.npz"))
    folder.mkdir()
    domains = read_domains(run.folder / "design.npz")
    cell = closed(plan, domains, job)
    fields = {plate: ChannelField(domains, plate, job.channels) for plate in PLATES}
    solids: dict[Plate, Iterable[Channels]] = dict(fields)
    if job.output.step == "chosen":
        solids = {plate: [select(part, cell.chosen) for part in field] for plate, field in fields.items()}
    expected = _expected(cell, solids, job)
    run.progress("cad: " + "; ".join(finding.message for finding in expected), 0.0)
    write_cad(cell, solids, job, folder, lambda stage, done: run.progress(stage, 0.7 * done))
    write_outlines(cell, plan, run)
    if job.output.relief:
        write_reliefs(cell, fields, run)
    run.progress("cad: checks", 0.7)
    found = measure(cell, solids, arrange(plan.uv, job), job, folder)
    if job.output.freecad:
        run.progress("cad/cell.FCStd", 0.9)
        run_freecad("document", run.folder, run.folder / "cad" / "cell.FCStd")
    run.progress("cad", 1.0)
    return (*expected, *found)


def _expected(cell: Cell, solids: Mapping[Plate, Iterable[Channels]], job: Job) -> Findings:
    """What each level of detail will cost."""
    from lce_workbench.cad.instances import estimate

    way = "exact" if job.output.step == "exact" else job.output.step_instances
    counts = {
        "comb": sum(len(prism.holes) for prism in (*cell.parts, *cell.combs)),
        "domain": len(cell.domains) if "domains" in job.output.cad else 0,
        way: sum(len(part) for parts in solids.values() for part in parts),
    }
    return tuple(estimate(kind, count) for kind, count in counts.items() if count)


def write_outlines(cell: Cell, plan: Design, run: Run) -> None:
    """Write the drawings of `OUTLINES`, and the heated sheet if it was predicted."""
    from lce_workbench.cad.meshes import thickened, write_stl

    folder, wanted_files = run.folder / "cad", run.job.output.cad
    for name, write in OUTLINES.items():
        if name in wanted_files:
            with told(folder / f"outlines.{name}"):
                write(cell, folder / f"outlines.{name}")
    prediction, path = run.folder / "prediction.npz", folder / "sheet_actuated.stl"
    if "sheet" in wanted_files and prediction.is_file():
        heated = np.load(prediction)["vertices"]
        with told(path):
            write_stl(*thickened(heated, plan.surface.faces, plan.thickness * plan.material.across), path)


def write_reliefs(cell: Cell, fields: Mapping[Plate, ChannelField], run: Run) -> None:
    """Write the rounded surface of both plates in a window: height map, its scale, mesh."""
    from lce_workbench.cad.meshes import surface, write_stl
    from lce_workbench.core.relief import near, relief, window_of
    from lce_workbench.export.relief import write_relief

    output = run.job.output
    window = window_of(output, cell.domains.centroid[cell.chosen[0]])
    for plate, field in fields.items():
        path = run.folder / "cad" / f"relief_{plate}.png"
        parts = [near(part, window, output.relief_spot_um * UM / 4) for part in field]
        made = relief(joined(parts), window, output)
        with told(path):
            write_relief(made, output, path)
            write_stl(*surface(made), path.with_suffix(".stl"))


def run_drawings(run: Run) -> Findings:
    """Draw cell, parts and pattern for the workshop: `drawings/*.pdf`, `.svg`, `.dxf`."""
    fabricable(read_design(run.folder / "design.npz"))
    if run.job.output.drawings:
        run.progress("drawings", 0.0)
        run_freecad("drawings", run.folder, run.folder / "drawings" / "drawings.pdf")
    run.progress("drawings", 1.0)
    return ()


def run_review(run: Run) -> Findings:
    """Read the files back and report on everything: `report.html`, `report.pdf`, `report.json`."""
    from lce_workbench.review.data import assemble
    from lce_workbench.review.write import write_review
    from lce_workbench.verify import verify

    checked = verify(run.folder, lambda stage, done: run.progress(stage, 0.6 * done))
    review = assemble(run.folder, [as_record(finding, "review") for finding in checked])
    write_review(review, run.folder, lambda stage, done: run.progress(stage, 0.6 + 0.4 * done))
    return checked


STAGES: dict[str, Callable[[Run], Findings]] = {
    "design": run_design,
    "predict": run_predict,
    "mask": run_mask,
    "cad": run_cad,
    "drawings": run_drawings,
    "review": run_review,
}
"""The stages in the order of the work."""

OUTPUTS = {
    "design": (),
    "predict": ("prediction.npz", "prediction.json", FILM),
    "mask": ("mask",),
    "cad": ("cad",),
    "drawings": ("drawings",),
    "review": ("report.html", "report.pdf", "report.json"),
}
"""What a stage writes anew in a kept folder."""


def inputs(job: Job, base: Path) -> list[dict[str, Any]]:
    """The files that the job names, with their digests."""
    named = [name for name in (job.target.mesh, job.material.curve) if name]
    return [{"path": name, **digest(base / name)} for name in named]
