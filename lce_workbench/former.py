"""The metric of a former output folder, for a job that differs in the twist alone."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from lce_solver.bounded import retwisted
from lce_solver.design import renewed
from lce_solver.errors import InputError
from lce_solver.twist import second_form
from lce_solver.types import Design, Finding
from lce_workbench.core import jobfile
from lce_workbench.core.job import Job
from lce_workbench.outputs import as_finding, read_design, read_manifest, require_unchanged

ANEW = ("domain", "gap", "partition", "channel_phase", "equilibrium")
"""How the checks begin whose findings the design stage makes anew from the job and the domains."""


def retwist(
    job: Job, inputs: Sequence[Mapping[str, Any]], former: Path
) -> tuple[Iterator[Design], tuple[Finding, ...]]:
    """What solving ``job`` anew would give, in seconds: flat sheet and director of ``former``, and their twist.

    Parameters
    ----------
    inputs : the files that the job names, with their digests.
    former : output folder whose job is the same in all that the metric depends on.

    Raises
    ------
    InputError
        The folder is not ours, was changed, or its metric is of another target, material, size or solver.
    """
    require_unchanged(former, "design.npz")
    manifest, plan = read_manifest(former), read_design(former / "design.npz")
    _require_same_metric(jobfile.load(former / "job.toml"), job, former)
    if [entry["sha256"] for entry in manifest["inputs"]] != [entry["sha256"] for entry in inputs]:
        msg = f"a mesh or curve of the job is not the one that {former} was made from; design without --metric"
        raise InputError(msg)
    form = second_form(plan.surface, plan.uv)
    plan = replace(plan, theta=plan.flattening.theta)  # before it was corrected for its own film
    plan = retwisted(plan, form, **job.sheet.twist)
    kept = [as_finding(record) for record in manifest["findings"] if record["stage"] == "design"]
    kept = [finding for finding in kept if not finding.check.startswith(ANEW)]
    return iter([plan]), renewed(tuple(kept), plan, job.sheet.twist_limit)


def _require_same_metric(former: Job, job: Job, folder: Path) -> None:
    """Refuse a job whose flat sheet or director would be another one than in ``folder``."""
    ours = jobfile.metric_values(job)
    for name, value in jobfile.metric_values(former).items():
        if ours[name] != value:
            msg = f"{name} is {ours[name]!r}, but {folder} was made for {value!r}; design without --metric"
            raise InputError(msg)
