"""All checks of one folder."""

from __future__ import annotations

from pathlib import Path

from lce_solver.errors import LceError
from lce_solver.types import Progress, silent
from lce_workbench.outputs import read_manifest
from lce_workbench.verify import papers
from lce_workbench.verify.finding import Findings, error, guarded
from lce_workbench.verify.reference import Reference, read

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
    found = guarded("verify_digest", "manifest.json", lambda: papers.digests(folder, manifest))
    found += guarded("verify_files", "manifest.json", lambda: papers.contents(folder, stages, EXPECTED))
    try:
        reference = read(folder)
    except LceError as fault:
        return (*found, error("verify_design", "design.npz", f"no design to compare with ({fault})"))
    return (*found, *_papers(folder, stages, reference))


def _papers(folder: Path, stages: list[str], reference: Reference) -> Findings:
    found = guarded("verify_design", "design.npz", lambda: papers.sheet(reference))
    columns = "domains.csv"
    found += guarded("verify_table", columns, lambda: papers.angles(papers.table(folder / columns), reference))
    if "predict" in stages:
        found += guarded("verify_prediction", "prediction.json", lambda: papers.prediction(folder, reference))
    return found
