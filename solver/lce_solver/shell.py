"""Forward simulation: what shape a patterned flat sheet takes when it is heated.

A thin non-Euclidean shell (Koiter energy) is followed from the flat sheet through small steps of temperature. Nothing here knows the
target, so the sheet may buckle into the mirror image or another isometry, as a real one may.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from lce_solver import cholesky
from lce_solver.errors import InputError
from lce_solver.shell_energy import POISSON, Reference, energy, parts, reference, residual_strain, stiffness
from lce_solver.shell_minimise import Minimum, Solve, minimise
from lce_solver.shell_patch import Shell, shell
from lce_solver.types import Floats, HeatingStep, Ints, Material, Prediction, Progress, owned, silent

STEPS = 10
ONSET = 3
"""Step k of n goes to ln(lambda) (k/n)^ONSET. A thin sheet buckles at strains of (thickness/size)^2: where the first steps pass that
point by far, many short waves grow at once and end in a wrong isometry; just above it only the longest one does."""
SETTLED = 1e-4
"""The last step ends when a further iteration saves less than this times (thickness^3 / 12)."""
PASSING = 1e-2
"""The same for the others, times the square of the share of strain: after buckling the energy grows with that."""
FOUNDATION = 0.1
"""The preconditioner holds rigid motions by springs, this many times as stiff per area as the sheet's longest bending wave."""
LIMIT = 1000
"""Iterations in one step."""


@dataclass(frozen=True, eq=False)
class Problem:
    """A sheet with its pattern, ready to be heated."""

    sheet: Shell
    theta: Floats
    """(n_f,) director [rad]."""
    dtheta: Floats
    """(n_f,) twist, top minus bottom [rad]."""
    material: Material
    thickness: float
    """Of the prepared film [mm]."""
    ordering: cholesky.Plan

    def at(self, lambda_: float) -> Reference:
        """What the sheet wants to be when the director's stretch is ``lambda_``."""
        return reference(self.sheet, self.theta, self.dtheta, replace(self.material, lambda_=lambda_), self.thickness)


def problem(uv: Floats, faces: Ints, theta: Floats, dtheta: Floats, material: Material, thickness: float) -> Problem:
    """Prepare the flat mesh ``uv`` (n_v, 2) [mm], ``faces`` (n_f, 3) with ``theta``, ``dtheta`` (n_f,) [rad].

    Raises
    ------
    InputError
        The mesh has flipped triangles or too few vertices, or the thickness is not positive.
    """
    if not (np.isfinite(thickness) and thickness > 0):
        msg = f"the film's thickness is {thickness:g} mm; it must be a positive number, for example 0.1"
        raise InputError(msg)
    sheet = shell(uv, faces)
    theta = owned(theta, "theta", np.float64, len(sheet.faces))
    dtheta = owned(dtheta, "dtheta", np.float64, len(sheet.faces))
    return Problem(sheet, theta, dtheta, material, thickness, cholesky.plan(sheet.uv, sheet.patch))


def predict(
    uv: Floats,
    faces: Ints,
    theta: Floats,
    dtheta: Floats,
    material: Material,
    thickness: float,
    *,
    seed: int,
    imperfection: float = 0.02,
    steps: int = STEPS,
    tolerance: float = SETTLED,
    progress: Progress = silent,
) -> Prediction:
    """Heat the flat sheet from lambda = 1 to the material's, and return the shape it takes.

    Parameters
    ----------
    uv, faces, theta, dtheta, material, thickness
        As for `problem`.
    seed, imperfection
        Every vertex starts off the plane by normal noise of this standard deviation, in units of the thickness.
    steps
        Steps of the heating, denser at its start.
    tolerance
        Energy that a further iteration may still save, in units of Young's modulus x thickness^3 / 12.
    progress
        Called before every iteration; it may raise `Cancelled`.
    """
    given = problem(uv, faces, theta, dtheta, material, thickness)
    height = imperfection * thickness * np.random.default_rng(seed).standard_normal(len(uv))
    shares = (np.arange(1, steps + 1) / steps) ** ONSET
    tolerances = np.append(PASSING * shares[:-1] ** 2, tolerance)
    lambdas = material.lambda_**shares
    return heat(given, np.column_stack([uv, height]), lambdas, tolerances, progress)


def settle(
    given: Problem, start: Floats, *, tolerance: float = SETTLED, progress: Progress = silent
) -> Prediction:
    """Relax the sheet at its final temperature from ``start`` (n_v, 3) [mm]: at the target, this tells the target's own energy."""
    return heat(given, start, np.array([given.material.lambda_]), np.array([tolerance]), progress)


def heat(given: Problem, start: Floats, lambdas: Floats, tolerances: Floats, progress: Progress = silent) -> Prediction:
    """Follow the equilibrium from ``start`` (n_v, 3) [mm] through ``lambdas`` (k,), each to its tolerance (k,)."""
    before = now = np.asarray(start, dtype=np.float64)
    history, frames = [], []
    for step, (lambda_, tolerance) in enumerate(zip(lambdas, tolerances, strict=True)):
        aim = given.at(float(lambda_))
        done = step / len(lambdas)
        found = _relax(given, aim, _extrapolate(given.sheet, aim, before, now), tolerance, _announce(progress, done))
        before, now = now, found.x
        stretching, bending = parts(given.sheet, aim, now)
        history.append(HeatingStep(float(lambda_), stretching, bending, found.iterations, found.status))
        frames.append(now)
    progress("heating", 1.0)
    strain = residual_strain(given.sheet, aim, now)
    return Prediction(now, stretching, bending, strain, found.status, tuple(history), np.array(frames))


def _announce(progress: Progress, done: float) -> Callable[[], None]:
    return lambda: progress("heating", done)


def _extrapolate(sheet: Shell, aim: Reference, before: Floats, now: Floats) -> Floats:
    """Go on as in the last step, if that lowers the energy."""
    ahead = 2 * now - before
    return ahead if energy(sheet, aim, ahead)[0] < energy(sheet, aim, now)[0] else now


def _relax(given: Problem, aim: Reference, start: Floats, tolerance: float, watch: Callable[[], None]) -> Minimum:
    """Minimise at one temperature."""
    sheet = given.sheet
    rigidity = aim.thickness**3 / 12
    area = np.bincount(sheet.faces.ravel(), np.repeat(sheet.area / 3, 3), minlength=len(sheet.uv))
    springs = FOUNDATION * rigidity / sheet.size**4 * area

    def factorise(x: Floats) -> Solve:
        return cholesky.factorise(given.ordering, stiffness(sheet, aim, x), springs)

    return minimise(
        lambda x: energy(sheet, aim, x),
        factorise,
        start,
        tolerance=tolerance * rigidity,
        longest=sheet.edge,
        limit=LIMIT,
        watch=watch,
    )
