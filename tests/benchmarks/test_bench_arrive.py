"""Do sheets arrive? The default job, corrected by simulation, heated from flat.

LCE_MESHES=FOLDER python -m pytest tests/benchmarks/test_bench_arrive.py -o addopts=--import-mode=importlib \
    --benchmark-only --benchmark-json=arrive.json

The time is that of the correction; the distances are in the record, in % of the diagonal. Shipped targets are heated
from ten imperfections of 0.02 thicknesses; ``LCE_MESHES`` may name a folder with further meshes; `deep.DEEP` are
targets deeper than a hemisphere or with an overhang.
"""

import os
from dataclasses import replace
from pathlib import Path

import pytest
import trimesh
from deep import DEEP

from lce_solver.arrive import arrive
from lce_solver.compare import compare
from lce_solver.design import design
from lce_solver.shell import film_of, predict, settle
from lce_workbench.core import jobfile, material, target
from lce_workbench.core.job import Job, Target

SHIPPED = {"face": 0.3, "dome": 0.1, "saddle": 0.3, "leaf": 0.3}
"""Largest rms distance from the target [% of the diagonal]."""
MESHES = {"face.obj": 1.0, "hemisphere.obj": 0.15, "saddle.obj": 0.08}
FOLDER = Path(os.environ.get("LCE_MESHES", ""))
REACHED = 2.0
"""A deep target that ends further away must say why [% of the diagonal]."""


def corrected(benchmark, job, base):
    """The design of a job, corrected as `build` does it, and what that says."""
    matter, _ = material.resolve(job.material, base)
    goal, _ = target.resolve(job, matter, base)
    plan = design(goal, matter, width=job.sheet.width_mm, **job.sheet.twist)
    made, said = benchmark.pedantic(arrive, (plan, job.prediction.correct, job.sheet.twist_limit), rounds=1)
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


@pytest.mark.parametrize("lambda_", [0.6, 0.5])
@pytest.mark.parametrize("name", DEEP)
def test_deep(benchmark, name, lambda_, tmp_path):
    surface = DEEP[name](0.02)
    trimesh.Trimesh(surface.vertices, surface.faces, process=False).export(tmp_path / "target.obj")
    job = default(mesh="target.obj")
    job = replace(job, material=replace(job.material, preset="", lambda_=lambda_, nu=0.5))
    made, said = corrected(benchmark, job, tmp_path)
    found = predict(film_of(made), seed=2)
    judged = compare(made, found, settle(film_of(made), made.surface.vertices))
    facts = {one.check: one.value for one in made.findings}
    benchmark.extra_info.update(
        rms_pct=judged.rms_pct,
        verdict=judged.verdict.name,
        stretch_rms=facts["stretch_rms"],
        length_bound=facts["length_bound"],
    )
    assert judged.rms_pct <= REACHED or said.severity == "warning"
