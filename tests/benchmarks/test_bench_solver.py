"""The solver's speed against the paper's local/global, and its accuracy on real meshes.

Run with ``pytest tests/benchmarks/test_bench_solver.py --benchmark-only -s``; ``LCE_MESHES`` may name a folder with
``face.obj``, ``hemisphere.obj`` and ``saddle.obj``. Both methods are the same code with another table entry, from the
same start in the same run: "time to 1 %" is the time that a method needs to come within 1 % of its lowest energy.
From some starts they end in different minima; the energies are printed.
"""

import os
import resource
import sys
import time
from pathlib import Path

import numpy as np
import pytest
from nasty import check_ends

from lce_solver import judge
from lce_solver.contest import compete
from lce_solver.descent import start
from lce_solver.geometry import face_areas, mean_edge
from lce_solver.metric import Stop, descend, flatten, lay_flat, objective
from lce_solver.mirror import even_mesh
from lce_solver.subdivision import refine
from lce_solver.surface import load
from lce_solver.surfaces import SURFACES
from lce_solver.types import Material, Status
from lce_solver.wirtinger import stretched

PEER = Material(0.58, float(-np.log(1.08) / np.log(0.58)))
"""The stretches 0.58 and 1.08 of the public comparison."""
STRETCHES = (PEER.along, PEER.across)
LIMITS = {"face.obj": 0.0145, "hemisphere.obj": 0.0041, "saddle.obj": 0.0006}
"""Best rms of 12 starts: what is published for these meshes, or better."""
REAL = {name: Path(os.environ["LCE_MESHES"]) / name for name in LIMITS} if "LCE_MESHES" in os.environ else {}


def real(name):
    """A real mesh with at least 1000 triangles."""
    surface, _ = load(REAL[name])
    while len(surface.faces) < 1000:
        surface = refine(surface, "loop")
    return surface


TARGETS = {"face": lambda: SURFACES["face"](0.02), **{name: lambda name=name: real(name) for name in REAL}}


def race(surface, angle):
    """Iterations and seconds of both methods to within 1 % of the energy that each ends at, and that energy."""
    rigid = lay_flat(surface)
    stops = {"lbfgs": Stop(1e-8), "local_global": Stop(1e-7, 8000)}
    runs = {method: flatten(rigid, STRETCHES, angle, stop, method=method) for method, stop in stops.items()}
    result = {}
    for method, run in runs.items():
        count = int(np.argmax(run.energy <= 1.01 * run.energy[-1]))
        begin = time.perf_counter()
        flatten(rigid, STRETCHES, angle, Stop(0.0, count), method=method)
        result[method] = (count, time.perf_counter() - begin, run.energy[-1])
    return result


@pytest.mark.parametrize("name", TARGETS)
def test_time_to_one_percent(benchmark, name, capsys):
    surface = TARGETS[name]()
    lines, ratios = [], []
    for angle in np.radians([0, 45, 90]):
        found = race(surface, angle)
        (fast, fast_time, fast_energy), (slow, slow_time, slow_energy) = found["lbfgs"], found["local_global"]
        ratios.append(slow_time / fast_time)
        lines.append(
            f"{name:>15} {len(surface.faces):6d} triangles, start {np.degrees(angle):3.0f} deg: "
            f"L-BFGS {fast:4d} it {fast_time:6.2f} s E {fast_energy:.3e} | "
            f"local/global {slow:5d} it {slow_time:6.2f} s E {slow_energy:.3e} | {ratios[-1]:5.1f} x"
        )
    with capsys.disabled():
        sys.stdout.write("\n".join(["", *lines, ""]))
    rigid = lay_flat(surface)
    benchmark.pedantic(lambda: flatten(rigid, STRETCHES, 0.0), rounds=3)
    assert np.exp(np.mean(np.log(ratios))) > 4


BUDGET = 20
"""So many times our time local/global may spend."""
TURN = 100
"""Iterations of each start of local/global before it is the next start's turn."""


@pytest.mark.parametrize("name", TARGETS)
def test_search_against_local_global(benchmark, name, capsys):
    """Processor time until a sheet within 1 % of the lowest energy is found, from the same twelve starts.

    Ours is the whole competition, to its last tolerance. Local/global goes on with all starts by turns, because nobody
    knows which of them will be best, until one is within 1 % of the lowest energy that we found or `BUDGET` times our
    time is spent; then the ratio is a lower bound.
    """
    surface = TARGETS[name]()
    begin = time.process_time()
    _, starts = benchmark.pedantic(lambda: compete(surface, PEER), rounds=1)
    ours, best = time.process_time() - begin, min(start.energy for start in starts)
    rigid = lay_flat(surface)
    goal = objective(rigid.operator, STRETCHES)
    runs = [start(stretched(rigid.w, STRETCHES, angle)) for angle in np.arange(12) * np.pi / 12]
    theirs, lowest, count = 0.0, np.inf, 0
    while lowest > 1.01 * best and theirs < BUDGET * ours:
        count += TURN
        begin = time.process_time()
        runs = [descend(goal, run, Stop(0.0, count), method="local_global") for run in runs]
        theirs += time.process_time() - begin
        lowest = min(run.history[-1] for run in runs)
    with capsys.disabled():
        sys.stdout.write(
            f"\n{name:>15} {len(surface.faces)} triangles: ours {ours:5.1f} s to E {best:.4e} | local/global, {count} "
            f"iterations of 12 starts, {theirs:6.1f} s to E {lowest:.4e} ({lowest / best - 1:+.1%}) | "
            f"{'more than ' if lowest > 1.01 * best else ''}{theirs / ours:.0f} x\n"
        )
    assert theirs >= BUDGET * ours


@pytest.mark.parametrize("name", REAL)
def test_accuracy_on_real_meshes(benchmark, name, capsys):
    """The smallest rms of twelve starts; the competition's winner may have more, for the twist's sake."""
    surface = real(name)
    (best, *_), starts = benchmark.pedantic(lambda: compete(surface, PEER), rounds=1)
    winner = next(start for start in starts if start.status is Status.CONVERGED)
    rigid, area = lay_flat(surface), face_areas(surface)
    each = [flatten(rigid, STRETCHES, angle) for angle in np.arange(12) * np.pi / 12]
    errors = [judge.stretch_errors(judge.stretches(surface, one.uv, PEER), PEER) for one in (best.flat, *each)]
    lowest = min(judge.rms(error, area) for error in errors)
    with capsys.disabled():
        sys.stdout.write(f"\n{name:>15} lowest rms {lowest:.4%}, winner's {winner.rms:.4%}\n")
    assert winner.flipped == winner.crossings == 0
    assert lowest <= LIMITS[name]


SIZES = {1_000: 15, 4_000: 15, 16_000: 15, 64_000: 90, 100_000: 90} if REAL else {}
"""Triangles, and the seconds that they may take."""


@pytest.mark.parametrize(("triangles", "seconds"), SIZES.items())
def test_twelve_starts_at_every_size(benchmark, triangles, seconds, capsys):
    """Processor seconds of the whole competition on the real face, and the largest memory of the process so far."""
    surface = real("face.obj")
    while len(surface.faces) < triangles * 0.9:
        surface = refine(surface, "loop")
    if len(surface.faces) > 1.2 * triangles:
        surface = even_mesh(surface, mean_edge(surface) * np.sqrt(len(surface.faces) / triangles))
    begin = time.process_time()
    _, starts = benchmark.pedantic(lambda: compete(surface, PEER), rounds=1)
    spent = time.process_time() - begin
    memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 2**20
    last = [start for start in starts if start.triangles == len(surface.faces)]
    with capsys.disabled():
        lowest = min(start.rms for start in last)
        sys.stdout.write(f"\n{len(surface.faces):7d} triangles: {spent:5.1f} s, {memory:.2f} GB, rms {lowest:.3%}\n")
    assert spent < seconds
    assert memory < 2


def test_two_hundred_nasty_meshes(benchmark, tmp_path, capsys):
    counts = benchmark.pedantic(check_ends, (range(200), tmp_path / "nasty.obj"), rounds=1)
    with capsys.disabled():
        sys.stdout.write(f"\n{counts}\n")
    assert sum(counts.values()) == 200
