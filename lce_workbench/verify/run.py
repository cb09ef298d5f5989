"""All checks of one folder."""

from __future__ import annotations

from pathlib import Path

from lce_solver.errors import LceError
from lce_solver.types import Progress, silent
from lce_workbench.outputs import read_manifest
from lce_workbench.verify import masks, papers
from lce_workbench.verify.finding import Findings, error, guarded
from lce_workbench.verify.reference import PLATES, Reference, read

EXPECTED = {
    "design": ["design.npz", "domains.csv", "job.toml"],
    "predict": ["prediction.json", "prediction.npz"],
}
"""What a stage leaves whatever the job says."""


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
    stages = [str(stage) for stage in manifest.get("stages", ())]
    progress("verify: digests", 0.0)
    found = guarded("verify_digest", "manifest.json", papers.digests, folder, manifest)
    found += guarded("verify_files", "manifest.json", papers.contents, folder, stages, EXPECTED)
    try:
        reference = read(folder)
    except LceError as fault:
        return (*found, error("verify_design", "design.npz", f"no design to compare with ({fault})"))
    found += _papers(folder, stages, reference)
    if "mask" in stages:
        found += _masks(folder, reference, progress)
    return found


def _masks(folder: Path, reference: Reference, progress: Progress) -> Findings:
    """Both plates, alone and together."""
    progress("verify: masks", 0.1)
    try:
        columns = papers.table(folder / "domains.csv")
    except LceError:
        columns = {}  # told by the check of the table
    found: Findings = ()
    held = {}
    for plate in PLATES:
        told, held[plate] = masks.check(folder, plate, reference, columns.get(f"channels_{plate}"))
        found += told
    if all(facts.name for facts in held.values()):
        found += guarded("verify_overlay", "mask", masks.both, held, folder / "mask" / "readings.csv")
        sheet = folder / "mask" / "job_sheet.txt"
        found += guarded("verify_job_sheet", "mask/job_sheet.txt", masks.job_sheet, sheet, held)
    return found


def _papers(folder: Path, stages: list[str], reference: Reference) -> Findings:
    found = guarded("verify_design", "design.npz", papers.sheet, reference)
    columns = "domains.csv"
    found += guarded("verify_table", columns, papers.angles, folder / columns, reference)
    if "predict" in stages:
        found += guarded("verify_prediction", "prediction.json", papers.prediction, folder, reference)
    return found
