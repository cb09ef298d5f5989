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
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from meshes import write_obj
from nasty import check_ends
from scipy.spatial.transform import Rotation
from targets import LCE, cap, line_difference

from lce_solver import judge
from lce_solver.choice import arriving
from lce_solver.compare import align, vertex_areas
from lce_solver.contest import compete
from lce_solver.descent import start
from lce_solver.design import design
from lce_solver.directors import vertex_line_field
from lce_solver.geometry import face_areas, mean_edge
from lce_solver.levels import carried
from lce_solver.metric import Stop, descend, flatten, lay_flat, objective
from lce_solver.mirror import even_mesh
from lce_solver.shell import film_of, predict
from lce_solver.subdivision import refine
from lce_solver.surface import load
from lce_solver.surfaces import SURFACES
from lce_solver.topology import boundary_loops, neighbours
from lce_solver.types import Material, Status, Surface
from lce_solver.wirtinger import stretched
from lce_workbench import stages
from lce_workbench.core import target
from lce_workbench.core.job import Job, MaterialSpec, Target

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


BUDGET = {"face.obj": 20, "hemisphere.obj": 20, "face": 1}
"""So many times our time local/global may spend, and needs more; the shipped face is easy for it."""
TURN = 100
"""Iterations of each start of local/global before it is the next start's turn."""


@pytest.mark.parametrize("name", [name for name in BUDGET if name in TARGETS])
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
    while lowest > 1.01 * best and theirs < BUDGET[name] * ours:
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
    assert theirs >= BUDGET[name] * ours


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


@pytest.mark.parametrize("name", ["face.obj"] if REAL else [])
def test_smooth_directors(benchmark, name, capsys):
    """With ``solver.smoothing`` at 0.02: the 99th percentile of the director's turn across edges, and the rms error."""
    surface = real(name)
    (best, *_), _ = benchmark.pedantic(lambda: compete(surface, PEER, smoothing=0.02), rounds=1)
    pairs, _ = neighbours(surface.faces)
    jump = np.degrees(np.percentile(line_difference(*best.flat.theta[pairs.T % len(surface.faces)]), 99))
    with capsys.disabled():
        sys.stdout.write(f"\n{name:>15} 99 of 100 jumps below {jump:.2f} deg at rms {best.start.rms:.4%}\n")
    assert jump <= 15
    assert best.start.rms <= 0.0147


def test_cap_converges(benchmark, capsys):
    """A cap of 50 degrees: the rms error halves with the edge."""
    caps = [cap(50, edge) for edge in (0.0796, 0.0398, 0.0199)]
    found = benchmark.pedantic(lambda: [compete(surface, LCE)[0][0].start.rms for surface in caps], rounds=1)
    with capsys.disabled():
        for surface, rms in zip(caps, found, strict=True):
            sys.stdout.write(f"\n{len(surface.vertices):6d} vertices: rms {rms:.4%}")
        sys.stdout.write("\n")
    assert abs(len(caps[1].vertices) - 1775) < 20
    assert found[1] <= 0.00185
    assert 0.9 < np.log2(found[0] / found[1]) < 1.2
    assert 0.9 < np.log2(found[1] / found[2]) < 1.2


@pytest.mark.parametrize("name", [*SURFACES, *REAL])
def test_every_target_is_a_simple_sheet(benchmark, name):
    """No flipped triangle and no crossing outline, by the judge, at the domains of the default job."""
    spec = Target(mesh=str(REAL[name])) if name in REAL else Target(surface=name)
    job = replace(Job(), target=spec)
    goal, _ = target.resolve(job, LCE, Path())
    plan = benchmark.pedantic(lambda: design(goal, LCE, job.sheet.width_mm, **job.sheet.twist), rounds=1)
    benchmark.extra_info["triangles"] = len(plan.theta)
    assert plan.flattening.status is Status.CONVERGED
    assert len(judge.flipped(plan.uv, plan.surface.faces)) == 0
    for loop in boundary_loops(plan.surface.faces):
        assert len(judge.crossings(plan.uv, np.stack([loop, np.roll(loop, -1)], axis=1))) == 0


RESOLUTIONS = (600, 2_400, 12_000, 48_000, 192_000)
"""Triangles of the same face as it is read."""


def scans():
    """The face at five resolutions: the finest have the facets of the third."""
    area = face_areas(SURFACES["face"](0.02)).sum()
    found = [SURFACES["face"](float(np.sqrt(4 / np.sqrt(3) * area / count))) for count in RESOLUTIONS[:3]]
    for _ in RESOLUTIONS[3:]:
        found.append(refine(found[-1], "midpoint"))
    return found


def solved(surface, pose, path):
    """Design of a scan that lies somewhere, its target turned back around its middle, and what the sheet heats into."""
    rotation = Rotation.random(random_state=pose).as_matrix() if pose else np.eye(3)
    write_obj(path, surface.vertices @ rotation.T + pose, surface.faces)
    spec = MaterialSpec(preset="rm82-pdt-1to1")
    job = replace(Job(), target=Target(mesh=str(path)), material=spec, domains=replace(Job().domains, size_um=500.0))
    plans, _ = stages.solved(stages.Run(path.parent, job, path.parent))
    plan, _ = arriving(plans, "full", job.sheet.twist_limit)
    points, weights = plan.surface.vertices, vertex_areas(plan.surface.vertices, plan.surface.faces)
    back = Surface((points - np.average(points, axis=0, weights=weights)) @ rotation, plan.surface.faces)
    return plan, back, predict(film_of(plan), seed=1).vertices


def difference(one, other):
    """Of two designs, rms: the director's angle [deg], the sheet and the heated shape [% of their diagonals]."""
    (plan, here, shape), (plan_2, there, shape_2) = one, other
    lines = vertex_line_field(plan_2)
    values = np.column_stack([plan_2.uv, lines.real, lines.imag, shape_2, shape_2[:, 2]])
    on = np.column_stack([carried(there, here, values[:, k : k + 2]) for k in (0, 2, 4, 6)])
    w, v = ((p - p.mean(axis=0)) @ (1, 1j) for p in (plan.uv, on[:, :2]))
    turn = np.vdot(v, w) / abs(np.vdot(v, w))
    angle = np.degrees(np.angle(vertex_line_field(plan) * (on[:, 2:4] @ (1, -1j)) * turn**-2) / 2)
    heated = align(on[:, 4:7], shape, vertex_areas(shape, here.faces)).rms / np.linalg.norm(np.ptp(shape, axis=0))
    sheet = np.sqrt(np.mean(np.abs(v * turn - w) ** 2)) / np.linalg.norm(np.ptp(plan.uv, axis=0))
    return float(np.sqrt(np.mean(angle**2))), 100 * float(sheet), 100 * heated


def test_resolution_and_motion_of_the_input_leave_no_trace(benchmark, tmp_path, capsys):
    """Five resolutions in five poses, and the third in all poses, against the third in its own."""
    faces = scans()
    cases = [(2, 0), (2, 1), (2, 2), (2, 3), (2, 4), (0, 1), (1, 2), (3, 3), (4, 4)]
    runs = benchmark.pedantic(lambda: [solved(faces[k], pose, tmp_path / "scan.obj") for k, pose in cases], rounds=1)
    apart = np.array([difference(runs[0], run) for run in runs])
    with capsys.disabled():
        for (k, pose), row in zip(cases, apart, strict=True):
            said = "{:.2f} deg, sheet {:.3f} %, heated {:.3f} %".format(*row)
            sys.stdout.write(f"\n{RESOLUTIONS[k]:7d} triangles, pose {pose}: directors {said}")
        sys.stdout.write("\n")
    assert (apart <= SAME_DESIGN).all()


SAME_DESIGN = (5.0, 2.0, 1.5)
"""Differences that resampling may make: directors [deg], sheets and heated shapes [% of the diagonal], rms."""


def test_two_hundred_nasty_meshes(benchmark, tmp_path, capsys):
    counts = benchmark.pedantic(check_ends, (range(200), tmp_path / "nasty.obj"), rounds=1)
    with capsys.disabled():
        sys.stdout.write(f"\n{counts}\n")
    assert sum(counts.values()) == 200
