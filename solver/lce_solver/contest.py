"""Which start wins: all compete on a coarse mesh, the best few are carried to finer ones and compete again there."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from lce_solver import judge
from lce_solver.geometry import face_areas
from lce_solver.levels import carried, levels
from lce_solver.metric import DEFAULT, Rigid, Stop, Stretches, as_complex, flatten, lay_flat, refine
from lce_solver.mirror import twins
from lce_solver.plane import axis_along_x
from lce_solver.twist import bending_left, bending_tensor, pull_back
from lce_solver.types import Flattening, Material, Progress, Start, Surface, silent
from lce_solver.wirtinger import operator

FINALISTS = (3, 1)
"""Starts that go on to the second mesh, and to each further one."""
ROUGH = 1e-6
"""Tolerance on coarse meshes at least: what is left is far below the differences between starts."""
TYPICAL = 300
"""Iterations of one start, for the progress bar only."""
TIE = 1e-6
"""Scores as close as this are equal (symmetric targets); the smaller angle wins, so that the result is repeatable."""
FAVOUR = 0.03
"""A symmetric solution wins over lopsided ones whose score is less than this better."""


@dataclass(frozen=True, eq=False)
class _Runner:
    """A start with its solution on the present mesh."""

    start: Start
    flat: Flattening


def compete(
    surface: Surface, material: Material, starts: int = 12, stop: Stop = DEFAULT, progress: Progress = silent
) -> tuple[Flattening, tuple[Start, ...]]:
    """Minimise from stretches of the plane in ``starts`` directions and take the best.

    The energy has many minima. The best has the smallest rms error x share of bending that twist cannot reach, among
    those that are valid (no flipped triangle, simple outline); if none is, the one with the fewest faults is returned.
    Large meshes are first solved on coarse ones (`levels`), where all but the best `FINALISTS` drop out.

    Returns
    -------
    The best flattening, and one record per start in the order of the angles, each from the finest mesh it came to.
    """
    meshes = levels(surface)
    field = _first_round(meshes[0], material, starts, _stop(stop, last=len(meshes) == 1), _share(progress, meshes, 0))
    records = {runner.start.angle: runner.start for runner in field}
    for k in range(1, len(meshes)):
        chosen = _ranked(field)[: FINALISTS[min(k, len(FINALISTS)) - 1]]
        last = k + 1 == len(meshes)
        field = _next_round(meshes[: k + 1], chosen, material, _stop(stop, last=last), _share(progress, meshes, k))
        records |= {runner.start.angle: runner.start for runner in field}
    progress("flatten", 1.0)
    return _ranked(field)[0].flat, tuple(records.values())


def _first_round(surface: Surface, material: Material, starts: int, stop: Stop, report: Progress) -> list[_Runner]:
    """All starts; of two that are mirror images of each other only the first is solved."""
    rigid = lay_flat(surface)
    judged = _judge(surface, material)
    solved: dict[int, _Runner] = {}
    for k in range(starts):
        mirror = (starts - k) % starts
        angle = k * np.pi / starts
        if rigid.twins is not None and mirror in solved:
            solved[k] = replace(solved[mirror], start=replace(solved[mirror].start, angle=angle))
            continue
        tick = partial(_tell, report, k / starts, 1 / starts)
        symmetric = rigid.twins is not None and mirror == k
        flat = flatten(_kept(rigid, symmetric), _stretches(material), angle, stop, tick=tick)
        solved[k] = _Runner(judged(flat, angle, symmetric), flat)
    return list(solved.values())


def _kept(rigid: Rigid, symmetric: bool) -> Rigid:
    return rigid if symmetric else replace(rigid, twins=None)


def _next_round(
    meshes: list[Surface], field: list[_Runner], material: Material, stop: Stop, report: Progress
) -> list[_Runner]:
    """The solutions on the mesh before the last as starts on the last."""
    coarse, fine = meshes[-2:]
    op, twin, judged = operator(fine), twins(fine), _judge(fine, material)
    result = []
    for k, runner in enumerate(field):
        tick = partial(_tell, report, k / len(field), 1 / len(field))
        w, kept = as_complex(carried(coarse, fine, runner.flat.uv)), None
        if runner.start.symmetric and twin is not None:
            w, kept = axis_along_x(w, twin), twin
        flat = refine(fine, op, w, _stretches(material), stop, twin=kept, tick=tick)
        if _faults(runner.start) == 0 < len(flat.flipped) + len(flat.crossings):  # carried over a seam, say
            kept, rigid = None, replace(lay_flat(fine), twins=None)
            flat = flatten(rigid, _stretches(material), runner.start.angle, stop, tick=tick)
        result.append(_Runner(judged(flat, runner.start.angle, kept is not None), flat))
    return result


def _judge(surface: Surface, material: Material) -> Callable[[Flattening, float, bool], Start]:
    """The record of a flattening of ``surface``."""
    area, bending = face_areas(surface), bending_tensor(surface)

    def record(flat: Flattening, angle: float, symmetric: bool) -> Start:
        errors = judge.stretch_errors(judge.stretches(surface, flat.uv, material), material)
        form = pull_back(bending, judge.jacobians(surface, flat.uv))
        return Start(
            angle=angle,
            status=flat.status,
            rms=judge.rms(errors, area),
            bending_left=bending_left(form, flat.theta, material, area),
            flipped=len(flat.flipped),
            crossings=len(flat.crossings),
            symmetric=symmetric,
            triangles=len(surface.faces),
        )

    return record


def _ranked(field: list[_Runner]) -> list[_Runner]:
    return [field[k] for k in ranking([runner.start for runner in field])]


def ranking(starts: list[Start]) -> list[int]:
    """Indices of the starts from the best to the worst: fewest faults, then smallest score; the first of equals."""
    order = sorted(range(len(starts)), key=lambda k: (_faults(starts[k]), _favoured(starts[k]), k))
    least = starts[order[0]]
    limit = _favoured(least) * (1 + TIE)
    first = min(k for k in order if _faults(starts[k]) == _faults(least) and _favoured(starts[k]) <= limit)
    return [first, *(k for k in order if k != first)]


def _faults(start: Start) -> int:
    return start.flipped + start.crossings


def _favoured(start: Start) -> float:
    return start.score / (1 + FAVOUR) if start.symmetric else start.score


def _stretches(material: Material) -> Stretches:
    return material.along, material.across


def _stop(stop: Stop, *, last: bool) -> Stop:
    return stop if last else replace(stop, tolerance=max(stop.tolerance, ROUGH))


def _share(progress: Progress, meshes: list[Surface], k: int) -> Progress:
    """Progress within round ``k``; a round takes as long as its mesh is large."""
    size = np.array([len(mesh.faces) for mesh in meshes], dtype=np.float64)
    begin, part = size[:k].sum() / size.sum(), size[k] / size.sum()
    return lambda stage, done: progress(stage, float(begin + part * done))


def _tell(report: Progress, done: float, share: float, iteration: int) -> None:
    report("flatten", done + share * iteration / (iteration + TYPICAL))
