"""Studies: the heating simulated many times, each time with another fault. On a Dask cluster or in this process."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import repeat
from pathlib import Path
from typing import Any

import numpy as np

from lce_solver.compare import Verdict, compare
from lce_solver.errors import InputError
from lce_solver.shell import predict
from lce_solver.types import Design, Finding, Progress, Severity, silent
from lce_workbench.cluster import client, each
from lce_workbench.core import jobfile
from lce_workbench.core.domains import Domains
from lce_workbench.core.job import PredictionSpec
from lce_workbench.core.perturb import IMPERFECTION, STUDIES, Bench, bench
from lce_workbench.divided import read_domains
from lce_workbench.export.study import KINDS
from lce_workbench.outputs import (
    as_record,
    read_design,
    read_manifest,
    require_unchanged,
    staged,
    write_manifest,
)
from lce_workbench.stages import fabricable

Row = dict[str, Any]

SECONDS = 1.5
"""Of a processor for a sample of 1000 triangles, about; the time grows in proportion."""
SAMPLES, MOST = 40, 1_000_000


def study(
    out: Path, name: str, samples: int = SAMPLES, *, scheduler: str | None = None, progress: Progress = silent
) -> Finding:
    """Study the design of the output folder ``out``: `studies/NAME.csv`, `.json` and `.png` in it.

    Parameters
    ----------
    samples : how many; each round gives every value of the study's table another seed.
    scheduler : address of a Dask scheduler; without it the samples are computed in this process. Same numbers.

    Raises
    ------
    LceError
        A fault that leaves ``out`` as it was: the study is unknown, the folder is not ours, nobody schedules.
    """
    _require(name, samples)
    require_unchanged(out, "design.npz")
    job, plan = jobfile.load(out / "job.toml"), fabricable(read_design(out / "design.npz"))
    common = plan, read_domains(out / "design.npz"), job.prediction
    with staged(out, replaced=[f"studies/{name}.{kind}" for kind in KINDS]) as folder:
        rows = []
        for row in computed(common, name, samples, scheduler):
            progress(f"study {name}", len(rows) / samples)
            rows.append(row)
        table = summary(name, rows)
        (folder / "studies").mkdir(exist_ok=True)
        for kind, write in KINDS.items():
            write(name, rows, table, folder / "studies" / f"{name}.{kind}")
        found = _told(name, table)
        former = {key: value for key, value in read_manifest(out).items() if key != "files"}
        kept = [record for record in former["findings"] if record["stage"] != f"study {name}"]
        write_manifest(folder, {**former, "findings": [*kept, as_record(found, f"study {name}")]})
    return found


def _require(name: str, samples: int) -> None:
    if name not in STUDIES:
        msg = f"study {name!r} is unknown; known are {', '.join(STUDIES)}"
        raise InputError(msg)
    if samples < (least := len(STUDIES[name].values)):
        msg = f"--samples {samples} is fewer than the {least} values of the study {name}; give at least {least}"
        raise InputError(msg)
    if samples > MOST:
        msg = f"--samples {samples} is too many; give at most {MOST}"
        raise InputError(msg)


def estimate(out: Path, name: str, samples: int) -> str:
    """What a study of so many samples costs, told before it starts."""
    _require(name, samples)
    triangles = len(read_design(out / "design.npz").theta)
    seconds = SECONDS * samples * triangles / 1000
    return f"{samples} samples of {triangles} triangles, about {seconds:.0f} s of one processor in all"


def computed(
    common: tuple[Design, Domains, PredictionSpec], name: str, samples: int, scheduler: str | None = None
) -> Iterator[Row]:
    """The rows of a study one after the other: on the workers of a scheduler, or in this process."""
    with client(scheduler) as workers:
        # on the workers a task of its own, not data of ours: it is made again when the worker that holds it dies
        at = bench(*common) if workers is None else workers.submit(bench, *common, pure=False)
        yield from each(workers, sample, repeat(at), repeat(name), range(samples))


def sample(at: Bench, name: str, number: int) -> Row:
    """One sample of a study: its values, its seed, and what came of them. A pure function of its arguments."""
    values = STUDIES[name].values
    turn, place = divmod(number, len(values))
    seed, value = at.spec.seed + turn, values[place]
    film = STUDIES[name].fault(at, np.random.default_rng([seed, place]), **value)
    imperfection = value.get(IMPERFECTION, at.spec.imperfection)
    found = predict(film, seed=seed, imperfection=imperfection, steps=at.spec.steps)
    judged = compare(at.plan, found)
    return {
        "sample": number,
        **value,
        "seed": seed,
        "rms_pct": judged.rms_pct,
        "max_pct": judged.max_pct,
        "mirror_rms_pct": judged.mirror_rms_pct,
        "scaled_rms_pct": judged.scaled_rms_pct,
        "mirrored": judged.mirrored,
        "reached": judged.verdict is Verdict.TARGET and not judged.mirrored,
        "verdict": judged.verdict.name.lower(),
        "energy_mm3": found.energy,
    }


def summary(name: str, rows: Sequence[Row]) -> list[Row]:
    """One row for each value of a study: the share that reaches the target unmirrored, and the distances."""
    table = []
    for place, value in enumerate(STUDIES[name].values):
        own = rows[place :: len(STUDIES[name].values)]
        rms = [row["rms_pct"] for row in own]
        table.append(
            {
                **value,
                "samples": len(own),
                "reached": float(np.mean([row["reached"] for row in own])),
                "mirrored": float(np.mean([row["mirrored"] for row in own])),
                "rms_pct_median": float(np.median(rms)),
                "rms_pct_max": max(rms),
            }
        )
    return table


def _told(name: str, table: Sequence[Row]) -> Finding:
    """How many of the samples arrive, value by value."""
    shares = "; ".join(
        f"{row['reached'] * row['samples']:.0f} of {row['samples']} at {', '.join(f'{v:g}' for v in value.values())}"
        for value, row in zip(STUDIES[name].values, table, strict=True)
    )
    total = float(np.average([row["reached"] for row in table], weights=[row["samples"] for row in table]))
    text = f"study {name}, {STUDIES[name].axis}: the simulated sheet reaches the target unmirrored in {shares}"
    return Finding("study", Severity.INFO, text, total, where=f"studies/{name}.csv")
