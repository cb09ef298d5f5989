"""Do sheets arrive? The default job, corrected by simulation, heated from flat.

LCE_MESHES=FOLDER python -m pytest tests/benchmarks/test_bench_arrive.py -o addopts=--import-mode=importlib \
    --benchmark-only --benchmark-json=arrive.json

The time is that of design and correction; the distances are in the record, in % of the diagonal. Shipped targets are
heated from ten imperfections of 0.02 thicknesses; ``LCE_MESHES`` may name a folder with further meshes; `deep.DEEP`
are targets deeper than a hemisphere or with an overhang, here on about 1000 triangles of 0.8 mm.
"""

import os
from dataclasses import replace
from pathlib import Path

import pytest
from deep import DEEP

from lce_solver.choice import arriving
from lce_solver.compare import compare
from lce_solver.design import designs
from lce_solver.shell import film_of, predict
from lce_solver.types import Material
from lce_workbench.core import jobfile, material, target
from lce_workbench.core.job import Job, Target

SHIPPED = {"face": 0.3, "dome": 0.1, "saddle": 0.3, "leaf": 0.3}
"""Largest rms distance from the target [% of the diagonal]."""
MESHES = {"face.obj": 1.0, "hemisphere.obj": 0.15, "saddle.obj": 0.08}
FOLDER = Path(os.environ.get("LCE_MESHES", ""))
REACHED = {"mushroom": 0.6, "stairs": 0.6, "finger": 0.5, "bell": 0.5, "cap 120": 0.5, "scroll": 0.6}
"""Deep targets with their lambda; all but those of `MISSED` end within 2 % of their targets."""
MISSED = {"scroll": "its twist is cut off"}
"""What is said of the one that does not."""


def corrected(benchmark, job, base):
    """The design of a job, corrected as `build` does it, and what that says."""
    matter, _ = material.resolve(job.material, base)
    goal, _ = target.resolve(job, matter, base)
    plans = designs(goal, matter, width=job.sheet.width_mm, **job.sheet.twist)
    made, said = benchmark.pedantic(arriving, (plans, job.prediction.correct, job.sheet.twist_limit), rounds=1)
    benchmark.extra_info.update(triangles=len(made.theta), said=said.message)
    return made, said


def default(**goal):
    return jobfile.with_default_material(replace(Job(), target=Target(**goal)))


@pytest.mark.parametrize("name", SHIPPED)
def test_shipped(benchmark, name):
    made, _ = corrected(benchmark, default(surface=name), Path())
    found = [compare(made, predict(film_of(made), seed=seed)) for seed in range(1, 11)]
    benchmark.extra_info["rms_pct"] = [one.rms_pct for one in found]
    assert max(one.rms_pct for one in found) <= SHIPPED[name]
    assert not any(one.mirrored for one in found)


@pytest.mark.parametrize("name", [name for name in MESHES if (FOLDER / name).is_file()])
def test_meshes(benchmark, name):
    made, _ = corrected(benchmark, default(mesh=name), FOLDER)
    found = [compare(made, predict(film_of(made), seed=seed)) for seed in (1, 2, 3)]
    benchmark.extra_info["rms_pct"] = [one.rms_pct for one in found]
    assert max(one.rms_pct for one in found) <= MESHES[name]
    assert not any(one.mirrored for one in found)


@pytest.mark.parametrize(("name", "lambda_"), REACHED.items())
def test_deep(benchmark, name, lambda_):
    limit = Job().sheet.twist_limit
    plans = designs(DEEP[name](0.07), Material(lambda_, 0.5), 20.0, 0.1, twist_limit=limit)
    made, said = benchmark.pedantic(arriving, (plans, "full", limit), rounds=1)
    judged = compare(made, predict(film_of(made), seed=2))
    benchmark.extra_info.update(triangles=len(made.theta), rms_pct=judged.rms_pct, said=said.message)
    if name in MISSED:
        assert said.severity == "warning"
        assert MISSED[name] in said.message
    else:
        assert judged.rms_pct <= 2.0
