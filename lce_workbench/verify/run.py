"""All checks of one folder."""

from __future__ import annotations

from collections.abc import Iterable
from importlib.util import find_spec
from itertools import count
from pathlib import Path
from typing import Any

from lce_solver.errors import EnvironmentFault, InputError
from lce_solver.types import Finding, Progress, silent
from lce_workbench.outputs import read_manifest
from lce_workbench.verify import cells, document, masks, papers, workers
from lce_workbench.verify.finding import Findings, Unreadable, error, guarded
from lce_workbench.verify.reference import PLATES, Plate, Reference, read
from lce_workbench.verify.solids import Part

EXPECTED = {
    "design": ["design.npz", "domains.csv", "job.toml"],
    "predict": ["prediction.json", "prediction.npz"],
}
"""What a stage leaves whatever the job says."""

READERS = {"mask": ("gdstk", "ezdxf"), "cad": ("OCP",)}
"""Stage -> the modules that read what it wrote."""


def verify(folder: Path, progress: Progress = silent) -> Findings:
    """Read the files of an output folder back and compare them with its design; only what its stages made is asked for.

    Raises
    ------
    InputError
        ``folder`` is not an output folder.
    EnvironmentFault
        A reader is missing.
    """
    folder = Path(folder)
    manifest = read_manifest(folder)
    said = manifest.get("stages")
    stages = [str(stage) for stage in said] if isinstance(said, list) else ["design"]
    _require_readers(stages)
    progress("verify: papers", 0.0)
    found = guarded("verify_digest", "manifest.json", papers.digests, folder, manifest)
    found += guarded("verify_files", "manifest.json", papers.contents, folder, stages, EXPECTED)
    try:
        reference = read(folder)
    except Unreadable as fault:
        return (*found, error("verify_design", "design.npz", f"no design to compare with: it {fault}"))
    except InputError as fault:
        return (*found, error("verify_job", "job.toml", f"no job to compare with ({fault})"))
    return (*found, *_papers(folder, stages, reference), *_drawn(folder, stages, reference, progress))


def _require_readers(stages: Iterable[str]) -> None:
    for module in (module for stage in stages for module in READERS.get(stage, ())):
        if find_spec(module) is None:
            msg = f"the reader {module} is missing, so nothing was verified; start ./lce once, which installs it"
            raise EnvironmentFault(msg)


def _papers(folder: Path, stages: list[str], reference: Reference) -> Findings:
    found = guarded("verify_design", "design.npz", papers.sheet, reference)
    columns = "domains.csv"
    found += guarded("verify_table", columns, papers.angles, folder / columns, reference)
    if "predict" in stages:
        found += guarded("verify_prediction", "prediction.json", papers.prediction, folder, reference)
    return found


def _drawn(folder: Path, stages: list[str], reference: Reference, progress: Progress) -> Findings:
    """Masks and CAD files."""
    counts = _counts(folder, len(reference.theta))
    tasks: dict[str, workers.Task] = {}
    if "mask" in stages:
        tasks |= {f"mask/{p}": (masks.check, (folder, p, reference, counts.get(p))) for p in PLATES}
    asked = reference.job.output.freecad and document.program() is not None
    if "cad" in stages and asked:
        tasks[document.NAME] = (document.parts, (folder / document.NAME,))
    if "cad" in stages:  # the quickest come last, so that no processor waits for the other
        tasks |= {name: (cells.read, (folder, name)) for name in cells.readable(folder, reference)}
    step = count()
    got = workers.run(tasks, lambda name: progress(f"verify: {name}", 0.05 + 0.9 * next(step) / len(tasks)))
    found: Findings = ()
    held: dict[Plate, masks.Plates] = {}
    if "mask" in stages:
        found, held = _masks(folder, got)
    if "cad" in stages:
        told, known = cells.check(folder, got, reference, held, counts)
        found += told
        if asked:
            found += guarded("verify_document", document.NAME, _document, got[document.NAME], known)
        elif reference.job.output.freecad:
            found += (document.absent(),)
    progress("verify", 1.0)
    return found


def _document(result: Any, known: dict[str, Part]) -> Iterable[Finding]:
    return document.check(workers.value(result), known)


def _counts(folder: Path, domains: int) -> dict[Plate, Any]:
    """Channels of each domain by `domains.csv`; what is wrong with the table was told before."""
    try:
        columns = papers.table(folder / "domains.csv")
    except Unreadable:
        return {}
    found = {plate: columns[f"channels_{plate}"] for plate in PLATES}
    return found if all(len(column) == domains for column in found.values()) else {}


def _masks(folder: Path, got: dict[str, Any]) -> tuple[Findings, dict[Plate, masks.Plates]]:
    """Both plates, alone and together."""
    found: Findings = ()
    held: dict[Plate, masks.Plates] = {}
    for plate in PLATES:
        try:
            told, held[plate] = workers.value(got[f"mask/{plate}"])
            found += told
        except Unreadable as fault:
            found += (error("verify_mask", f"mask/{plate}.*", str(fault)),)
    if len(held) == len(PLATES) and all(facts.name for facts in held.values()):
        found += guarded("verify_overlay", "mask", masks.both, held, folder / "mask" / "readings.csv")
        sheet = folder / "mask" / "job_sheet.txt"
        found += guarded("verify_job_sheet", "mask/job_sheet.txt", masks.job_sheet, sheet, held)
    return found, held
