"""Which start wins: all compete while the director is kept smooth; the best go on to less smoothing and finer meshes.

Smoothing removes most of the energy's minima, and a solution followed to little smoothing ends lower than one that was
never smoothed. Who will be best shows early, so that most starts cost little.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from lce_solver.levels import levels
from lce_solver.metric import DEFAULT, Stop, lay_flat
from lce_solver.runner import Mesh, Report, Runner, advanced, anew, finer_mesh, first_mesh, moved, starting
from lce_solver.types import Flattening, Material, Progress, Stage, Start, Surface, silent


@dataclass(frozen=True)
class Round:
    """A part of the competition."""

    smoothing: float
    """Weight of the roughness, unless the job asks for more."""
    keep: int
    """Starts that go on. Symmetric ones do in any case: it takes them long to show what they are worth."""


ROUNDS = (Round(3.0, 6), Round(0.3, 6), Round(0.03, 3))
"""On the first mesh; the last one comes again on each finer mesh, where it smooths the folds left by the coarser."""
FINALISTS = (3, 1)
"""Starts that go on to the second mesh, and to each further one."""
SKETCH = 1e-3
"""Tolerance of the rounds."""
ROUGH = 1e-6
"""Tolerance until the winner is known: what is left is far below the differences between starts."""
TIE = 1e-6
"""Scores as close as this are equal (symmetric targets); the smaller angle wins, so that the result is repeatable."""
FAVOUR = 0.1
"""A symmetric solution wins over lopsided ones whose score is less than this better."""


@dataclass(frozen=True, eq=False)
class Finalist:
    """A start that came to the job's own mesh and smoothing."""

    start: Start
    flat: Flattening


def compete(
    surface: Surface,
    material: Material,
    starts: int = 12,
    stop: Stop = DEFAULT,
    progress: Progress = silent,
    *,
    smoothing: float = 0.0,
) -> tuple[tuple[Finalist, ...], tuple[Start, ...]]:
    """Minimise from stretches of the plane in ``starts`` directions.

    The energy has many minima. The best has the smallest rms error x share of bending that twist cannot reach, among
    those that are valid (no flipped triangle, simple outline); if none is, the one with the fewest faults is returned.
    Large meshes are first solved on coarse ones (`levels`).

    Parameters
    ----------
    smoothing : weight of the squared `smoothness.jumps` in what is minimised.

    Returns
    -------
    The finalists, the best first (the others are only nearly minima), valid ones only but for the first; and one record
    per start in the order of the angles, each from where it dropped out.
    """
    meshes = levels(surface)
    reports = [_share(progress, meshes, k) for k in range(len(meshes))]
    rigid = lay_flat(meshes[0])
    mesh = first_mesh(rigid, material)
    mirrored = rigid.twins is not None
    field = [
        starting(mesh, rigid, k * np.pi / starts, mirrored and 2 * k % starts == 0)
        for k in range(starts)
        if not mirrored or 2 * k <= starts
    ]
    field, records = _first_rounds(mesh, field, stop, smoothing, _within(reports[0], 0.0, 0.6))
    for k, finer in enumerate(meshes[1:], 1):
        coarse, mesh = mesh, finer_mesh(finer, material)
        field = _ranked(field)[: FINALISTS[min(k, len(FINALISTS)) - 1]]
        field = _next_mesh(coarse, mesh, field, stop, smoothing=smoothing, report=_within(reports[k], 0.0, 0.3))
        records |= _records(field)
    field = _finished(mesh, field, stop, smoothing, _within(reports[-1], 0.6, 1.0))
    records |= _records(field)
    progress("flatten", 1.0)
    best, *others = _ranked(field)
    left = [best, *(runner for runner in others if _faults(runner.start) == 0)]
    finalists = tuple(Finalist(runner.start, mesh.flattening(runner.found)) for runner in left)
    return finalists, _all_starts(records, starts, mirrored)


def _first_rounds(
    mesh: Mesh, field: list[Runner], stop: Stop, smoothing: float, report: Report
) -> tuple[list[Runner], dict[float, Start]]:
    """Those that are left after `ROUNDS`, and the records of all."""
    records: dict[float, Start] = {}
    for k, one in enumerate(ROUNDS):
        part = _within(report, k / len(ROUNDS), (k + 1) / len(ROUNDS))
        field = advanced(mesh, field, max(one.smoothing, smoothing), _loose(stop, SKETCH), part, last=False)
        records |= _records(field)
        order = _ranked(field)
        field = [runner for place, runner in enumerate(order) if place < one.keep or runner.start.symmetric]
    return field, records


def _next_mesh(
    coarse: Mesh, fine: Mesh, field: list[Runner], stop: Stop, *, smoothing: float, report: Report
) -> list[Runner]:
    """The field on the finer mesh, with the folds of the coarser one smoothed."""
    result = []
    for k, runner in enumerate(field):
        part = _within(report, k / len(field), (k + 1) / len(field))
        weight, loose = max(ROUNDS[-1].smoothing, smoothing), _loose(stop, SKETCH)
        (carried,) = advanced(fine, [moved(coarse, fine, runner)], weight, loose, part, last=False)
        if _faults(runner.start) == 0 < _faults(carried.start):
            (carried,) = advanced(fine, [anew(fine, runner)], weight, loose, _unheard, last=False)
        result.append(carried)
    return result


def _finished(mesh: Mesh, field: list[Runner], stop: Stop, smoothing: float, report: Report) -> list[Runner]:
    """The field at the job's smoothing; the winner to the job's tolerance, the others to `ROUGH`."""
    field = advanced(mesh, field, smoothing, _loose(stop, ROUGH), _within(report, 0.0, 0.6), last=False)
    while not (best := _ranked(field)[0]).finished:
        (done,) = advanced(mesh, [best], smoothing, stop, _within(report, 0.6, 1.0), last=True)
        field = [done if runner is best else runner for runner in field]
    return field


def _loose(stop: Stop, tolerance: float) -> Stop:
    return replace(stop, tolerance=max(stop.tolerance, tolerance))


def _records(field: list[Runner]) -> dict[float, Start]:
    return {runner.start.angle: runner.start for runner in field}


def _all_starts(records: dict[float, Start], starts: int, mirrored: bool) -> tuple[Start, ...]:
    """One record per start; of a symmetric target's mirrored starts both have the record of the one that ran."""
    angles = [k * np.pi / starts for k in range(starts)]
    ran = [min(k, starts - k) if mirrored else k for k in range(starts)]
    return tuple(replace(records[angles[j]], angle=angle) for angle, j in zip(angles, ran, strict=True))


def _ranked(field: list[Runner]) -> list[Runner]:
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


def _share(progress: Progress, meshes: list[Surface], k: int) -> Report:
    """Progress on mesh ``k``, which takes as long as it is large."""
    size = np.array([len(mesh.faces) for mesh in meshes], dtype=np.float64)
    begin, part = size[:k].sum() / size.sum(), size[k] / size.sum()
    return lambda done, energy: progress(Stage("flatten", energy), float(begin + part * done))


def _within(report: Report, low: float, high: float) -> Report:
    return lambda done, energy: report(low + (high - low) * done, energy)


def _unheard(done: float, energy: float) -> None:
    """Of work that was not expected."""
