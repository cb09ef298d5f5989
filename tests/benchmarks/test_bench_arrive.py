"""Do sheets arrive? Shipped targets with the default job, corrected, heated from flat from ten imperfections of 0.02 h.

python -m pytest tests/benchmarks/test_bench_arrive.py -o addopts=--import-mode=importlib --benchmark-only

The time is that of the correction; the distances are in the record (--benchmark-json), in % of the diagonal.
"""

from dataclasses import replace
from pathlib import Path

import pytest

from lce_solver.arrive import arrive
from lce_solver.compare import compare
from lce_solver.design import design
from lce_solver.shell import film_of, predict
from lce_workbench.core import material, target
from lce_workbench.core.job import Job, MaterialSpec, Target

LIMITS = {"face": 0.3, "dome": 0.1, "saddle": 0.3, "leaf": 0.3}
"""Largest rms distance from the target [% of the diagonal]."""


@pytest.mark.parametrize("name", LIMITS)
def test_arrival(benchmark, name):
    job = replace(Job(), target=Target(surface=name), material=MaterialSpec(preset="rm82-pdt-1to1"))
    matter, _ = material.resolve(job.material, Path())
    goal, _ = target.resolve(job, matter, Path())
    plan = design(goal, matter, width=job.sheet.width_mm, **job.sheet.twist)
    made, said = benchmark.pedantic(arrive, (plan, "full", job.sheet.twist_limit), rounds=1)
    found = [compare(made, predict(film_of(made), seed=seed)) for seed in range(1, 11)]
    distances = [one.rms_pct for one in found]
    benchmark.extra_info.update(triangles=len(made.theta), rms_pct=distances, said=said.message)
    assert max(distances) <= LIMITS[name]
    assert not any(one.mirrored for one in found)
