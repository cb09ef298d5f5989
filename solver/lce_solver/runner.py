"""One start of the competition on one mesh: how it goes on, what it is worth, how it moves to a finer mesh."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from scipy import sparse

from lce_solver import judge
from lce_solver.descent import Minimum, start
from lce_solver.geometry import face_areas
from lce_solver.levels import carried
from lce_solver.metric import (
    Objective,
    Rigid,
    Stop,
    Stretches,
    as_complex,
    as_points,
    descend,
    flattening,
    lay_flat,
    objective,
)
from lce_solver.mirror import twins
from lce_solver.plane import axis_along_x
from lce_solver.smoothness import jumps
from lce_solver.twist import bending_left, bending_tensor, pull_back
from lce_solver.types import Flattening, Floats, Ints, Material, Start, Status, Surface
from lce_solver.wirtinger import Operator, energy, operator, stretched

Report = Callable[[float, float], None]
"""Called with the fraction done and the energy of the descent that is running."""

TYPICAL = 100
"""Iterations of one descent, for the progress bar only."""


@dataclass(frozen=True, eq=False)
class Mesh:
    """What all starts share on one mesh of the target."""

    surface: Surface
    material: Material
    operator: Operator
    jumps: sparse.csr_array
    """As `smoothness.jumps`."""
    bending: Floats
    """As `twist.bending_tensor`."""
    twins: Ints | None
    """(n_v,) each vertex's mirror image, if the mesh is symmetric vertex by vertex."""

    @property
    def stretches(self) -> Stretches:
        """Wanted stretches along and across the director."""
        return self.material.along, self.material.across

    def objective(self, smoothing: float) -> Objective:
        """What is minimised with this weight of the jumps."""
        return objective(self.operator, self.stretches, self.jumps, smoothing)

    def flattening(self, found: Minimum) -> Flattening:
        """The sheet that a descent found."""
        return flattening(self.surface, self.operator, found, self.stretches)


def first_mesh(rigid: Rigid, material: Material) -> Mesh:
    """The mesh on which all starts are stretched from the rigid map."""
    return _mesh(rigid.surface, material, rigid.operator, rigid.twins)


def finer_mesh(surface: Surface, material: Material) -> Mesh:
    """A mesh on which solutions of a coarser one go on."""
    return _mesh(surface, material, operator(surface), twins(surface))


def _mesh(surface: Surface, material: Material, op: Operator, twin: Ints | None) -> Mesh:
    return Mesh(surface, material, op, jumps(surface), bending_tensor(surface), twin)


@dataclass(frozen=True, eq=False)
class Runner:
    """A start with its solution so far."""

    start: Start
    found: Minimum
    finished: bool = False
    """Whether it came to the job's own smoothing and tolerance."""


def starting(mesh: Mesh, rigid: Rigid, angle: float, symmetric: bool) -> Runner:
    """The rigid map, stretched in the direction ``angle``."""
    blank = Start(angle, Status.OUTRUN, np.inf, 1.0, 0, 0, symmetric, len(mesh.surface.faces))
    return Runner(blank, start(stretched(rigid.w, mesh.stretches, angle)))


def advanced(
    mesh: Mesh, field: list[Runner], smoothing: float, stop: Stop, report: Report, *, last: bool
) -> list[Runner]:
    """All runners after a descent with this smoothing; the ``last`` one goes on with the one before."""
    goal, result = mesh.objective(smoothing), []
    for k, runner in enumerate(field):
        tick = partial(_tell, report, k / len(field), 1 / len(field))
        twin = mesh.twins if runner.start.symmetric else None
        begin = runner.found if last else start(runner.found.x)
        found = descend(goal, begin, stop, twin=twin, tick=tick)
        steps = runner.start.iterations + len(found.history) - max(len(begin.history), 1)
        record = replace(runner.start, iterations=steps)
        result.append(_judged(mesh, Runner(record, found, finished=last)))
    return result


def _tell(report: Report, done: float, share: float, iteration: int, value: float) -> None:
    report(done + share * iteration / (iteration + TYPICAL), value)


def _judged(mesh: Mesh, runner: Runner) -> Runner:
    """With the record of where it stands."""
    flat, area = mesh.flattening(runner.found), face_areas(mesh.surface)
    jacobian = judge.jacobians(mesh.surface, flat.uv)
    errors = judge.stretch_errors(judge.principal(jacobian, mesh.material), mesh.material)
    valid = flat.status in {Status.CONVERGED, Status.ITERATION_LIMIT}
    record = replace(
        runner.start,
        status=Status.OUTRUN if valid and not runner.finished else flat.status,
        rms=judge.rms(errors, area),
        bending_left=bending_left(pull_back(mesh.bending, jacobian), flat.theta, mesh.material, area),
        flipped=len(flat.flipped),
        crossings=len(flat.crossings),
        triangles=len(mesh.surface.faces),
        energy=energy(mesh.operator, runner.found.x, mesh.stretches)[0],
    )
    return replace(runner, start=record)


def moved(coarse: Mesh, fine: Mesh, runner: Runner) -> Runner:
    """The runner on a finer mesh."""
    w = as_complex(carried(coarse.surface, fine.surface, as_points(runner.found.x)))
    symmetric = runner.start.symmetric and fine.twins is not None
    if symmetric and fine.twins is not None:
        w = axis_along_x(w, fine.twins)
    return Runner(replace(runner.start, symmetric=symmetric), start(w))


def anew(fine: Mesh, runner: Runner) -> Runner:
    """The same start from the finer mesh's own rigid map: what was carried may be folded at a seam, say."""
    rigid = lay_flat(fine.surface)
    blank = replace(runner.start, symmetric=False, flipped=0, crossings=0)
    return Runner(blank, start(stretched(rigid.w, fine.stretches, runner.start.angle)))
