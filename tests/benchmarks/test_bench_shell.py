"""Heating flat disks into the cone and the cap: accuracy, time and memory against the number of triangles.

python -m pytest tests/benchmarks/test_bench_shell.py -o addopts=--import-mode=importlib --benchmark-only -s

Compare ratios: on a busy machine times are noise. OPENBLAS_NUM_THREADS=1 keeps threads from waiting for each other.
"""

import resource

import numpy as np
import pytest
from flatsheets import cap_film, cone_angle, cone_film, disk, fitted_cone_angle, fitted_radius

from lce_solver.shell import predict
from lce_solver.shell_energy import energy, stiffness
from lce_solver.types import Status

RINGS = {"1 k": 13, "4 k": 26, "16 k": 53, "50 k": 91}
DEGREES = {"1 k": 0.5, "4 k": 0.2, "16 k": 0.1, "50 k": 0.1}
"""Largest error of the cone's half angle."""
PERCENT = {"1 k": 3.0, "4 k": 0.7, "16 k": 0.3, "50 k": 0.1}
"""Largest error of the cap's radius."""


def heated(benchmark, flat):
    found = benchmark.pedantic(predict, (flat,), {"seed": 1}, rounds=1)
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e6
    benchmark.extra_info.update(triangles=len(flat.theta), iterations=found.iterations, peak_GB=round(peak, 2))
    assert found.status is Status.CONVERGED
    return found


@pytest.mark.parametrize("size", RINGS)
def test_cone(benchmark, size):
    flat = cone_film(disk(RINGS[size]))
    error = np.degrees(fitted_cone_angle(flat, heated(benchmark, flat).vertices) - cone_angle(flat.material))
    benchmark.extra_info["degrees"] = round(float(error), 4)
    assert abs(error) < DEGREES[size]


@pytest.mark.parametrize("size", RINGS)
def test_cap(benchmark, size):
    error = fitted_radius(heated(benchmark, cap_film(disk(RINGS[size]))).vertices) * np.sqrt(2.6) - 1
    benchmark.extra_info["percent"] = round(100 * float(error), 3)
    assert abs(error) < PERCENT[size] / 100


@pytest.mark.parametrize("what", [energy, stiffness])
def test_evaluation(benchmark, what):
    """Energy with gradient, and the triangles' stiffness, of 16 k triangles."""
    flat = cone_film(disk(RINGS["16 k"]))
    x = np.column_stack([flat.sheet.uv, 0.2 * flat.sheet.uv[:, 0] ** 2])
    benchmark(what, flat.sheet, flat.at(0.7), x)
