"""Forward simulation: what shape a patterned flat sheet takes when it is heated.

A thin non-Euclidean shell (Koiter energy) is followed from the flat sheet through small steps of temperature. Nothing
here knows the target, so the sheet may buckle into the mirror image or another isometry, as a real one may.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from lce_solver import cholesky
from lce_solver.errors import InputError
from lce_solver.load import Load, vertex_areas
from lce_solver.shell_energy import Reference, energy, parts, reference, residual_strain, stiffness
from lce_solver.shell_minimise import Minimum, Solve, minimise
from lce_solver.shell_patch import Shell, shell
from lce_solver.types import Design, Floats, HeatingStep, Ints, Material, Prediction, Progress, Stage, owned, silent

STEPS = 10
ONSET = 2
"""Step k of n goes to lambda^((k/n)^ONSET). A thin sheet buckles at strains of (thickness / size)^2. Where the first
step goes far beyond, many short waves grow at once, and a sheet without twist ends in a wrong isometry. The path of
heating is part of the answer: of a sheet with several isometries, another path may find another one. `heat` follows
any path."""
SETTLED = 1e-6
"""The last step ends when a further iteration would save less than this times thickness^3 / 12. At 1e-4 a symmetric
state that is not stable could pass for a minimum: what then grows from the imperfection saves no more at first."""
PASSING = 1e-2
"""The same for the others, times the square of the share of the strain: a sheet about to buckle has little to save."""
FOUNDATION = 0.1
"""Springs hold rigid motions in the preconditioner, in units of the stiffness of the sheet's longest bending wave."""
LIMIT = 1000
"""Iterations in one step."""


@dataclass(frozen=True, eq=False)
class Film:
    """A patterned flat sheet, ready to be heated. With `dataclasses.replace` the same mesh takes another pattern."""

    sheet: Shell
    theta: Floats
    """(n_f,) director [rad]."""
    dtheta: Floats
    """(n_f,) twist, top minus bottom [rad]."""
    material: Material
    thickness: float
    """As prepared [mm]."""
    ordering: cholesky.Plan
    load: Load | None = None
    """Weight and support, or none: then the film floats freely."""

    def __post_init__(self) -> None:
        if not 0 < self.thickness < self.sheet.size:
            msg = (
                f"the film's thickness is {self.thickness:g} mm; "
                f"give a positive length below the sheet's size ({self.sheet.size:.3g} mm), for example 0.1"
            )
            raise InputError(msg)
        for name in ("theta", "dtheta"):
            object.__setattr__(self, name, owned(getattr(self, name), name, np.float64, len(self.sheet.faces)))

    def at(self, lambda_: float) -> Reference:
        """What the film wants to be when the stretch along the director is ``lambda_``."""
        material = replace(self.material, lambda_=lambda_)
        return reference(self.sheet, self.theta, self.dtheta, material, thickness=self.thickness)

    def energy(self, aim: Reference, x: Floats) -> tuple[float, Floats]:
        """Energy of shell and load per Young's modulus [mm^3] of ``x`` (n_v, 3) [mm], and its gradient (n_v, 3)."""
        value, gradient = energy(self.sheet, aim, x)
        if self.load is None:
            return value, gradient
        more, pull = self.load.energy(x)
        return value + more, gradient + pull

    def stiffness(self, aim: Reference, x: Floats) -> Floats:
        """Positive semi-definite Hessian of each triangle with its share of the load's, (n_f, 6, 6, 3, 3)."""
        element = stiffness(self.sheet, aim, x)
        if self.load is not None:
            each = (self.load.stiffness(x) / vertex_areas(self.sheet))[self.sheet.faces] * self.sheet.area[:, None] / 3
            for corner in range(3):
                element[:, corner, corner, 2, 2] += each[:, corner]
        return element


def film(uv: Floats, faces: Ints, theta: Floats, dtheta: Floats, *, material: Material, thickness: float) -> Film:
    """Prepare the flat mesh ``uv`` (n_v, 2) [mm], ``faces`` (n_f, 3) with ``theta``, ``dtheta`` (n_f,) [rad].

    Raises
    ------
    InputError
        The mesh has flipped triangles or too few vertices, or the thickness [mm] is not positive.
    """
    sheet = shell(uv, faces)
    return Film(sheet, theta, dtheta, material, thickness, cholesky.plan(sheet.uv, sheet.patch))


def film_of(design: Design) -> Film:
    """Prepare the sheet of a design."""
    pattern = design.uv, design.surface.faces, design.theta, design.dtheta
    return film(*pattern, material=design.material, thickness=design.thickness)


def predict(
    flat: Film,
    *,
    seed: int,
    imperfection: float = 0.02,
    steps: int = STEPS,
    tolerance: float = SETTLED,
    progress: Progress = silent,
    former: Heated | None = None,
    keep: Callable[[Heated], None] = lambda _: None,
) -> Prediction:
    """Heat the flat film from lambda = 1 to its material's, and return the shape that it takes.

    Parameters
    ----------
    seed, imperfection : every vertex starts off the plane by normal noise, of this deviation in units of the thickness.
    steps : of the heating, denser at its start.
    tolerance : energy that a further iteration may still save, in units of Young's modulus x thickness^3 / 12.
    progress : called before every iteration.
    former, keep : as for `heat`.
    """
    uv = flat.sheet.uv
    height = imperfection * flat.thickness * np.random.default_rng(seed).standard_normal(len(uv))
    shares = (np.arange(1, steps + 1) / steps) ** ONSET
    tolerances = np.append(PASSING * shares[:-1] ** 2, tolerance)
    start, lambdas = np.column_stack([uv, height]), flat.material.lambda_**shares
    return heat(flat, start, lambdas, tolerances, progress=progress, former=former, keep=keep)


def settle(flat: Film, start: Floats, *, tolerance: float = SETTLED, progress: Progress = silent) -> Prediction:
    """Relax the hot film from ``start`` (n_v, 3) [mm]; from the target this gives the energy to compare others with."""
    return heat(flat, start, np.array([flat.material.lambda_]), np.array([tolerance]), progress=progress)


@dataclass(frozen=True, eq=False)
class Heated:
    """What is done of a heating: all that the next step depends on."""

    history: tuple[HeatingStep, ...] = ()
    frames: tuple[Floats, ...] = ()
    """(n_v, 3) the shape after each step [mm]."""


def heat(
    flat: Film,
    start: Floats,
    lambdas: Floats,
    tolerances: Floats,
    *,
    progress: Progress = silent,
    former: Heated | None = None,
    keep: Callable[[Heated], None] = lambda _: None,
) -> Prediction:
    """Follow the equilibrium from ``start`` (n_v, 3) [mm] through ``lambdas`` (k,), each to its tolerance (k,).

    ``keep`` is given what is done after each step; as ``former`` of a later call with the same arguments it is not done
    again, and the result is the same to the last bit.
    """
    done = former or Heated()
    for step in range(len(done.frames), len(lambdas)):
        before, now = (start, start, *done.frames)[-2:]
        aim = flat.at(float(lambdas[step]))
        ahead = _extrapolate(flat, aim, before, now)
        found = relax(flat, aim, ahead, tolerances[step], watch=partial(_tell, progress, step / len(lambdas)))
        own, loading = parts(flat.sheet, aim, found.x), flat.load.energy(found.x)[0] if flat.load else 0.0
        told = HeatingStep(float(lambdas[step]), *own, found.iterations, found.status, loading)
        done = Heated((*done.history, told), (*done.frames, found.x))
        keep(done)
    progress("heating", 1.0)
    last, shape = done.history[-1], done.frames[-1]
    strain = residual_strain(flat.sheet, flat.at(float(lambdas[-1])), shape)
    frames = np.array(done.frames)
    return Prediction(shape, last.stretching, last.bending, strain, last.status, done.history, frames, last.loading)


def _tell(progress: Progress, fraction: float, energy: float) -> None:
    """Progress of a minimisation."""
    progress(Stage("heating", energy), fraction)


def _extrapolate(flat: Film, aim: Reference, before: Floats, now: Floats) -> Floats:
    """Go on as in the last step, if that lowers the energy."""
    ahead = 2 * now - before
    return ahead if flat.energy(aim, ahead)[0] < flat.energy(aim, now)[0] else now


def relax(
    flat: Film, aim: Reference, start: Floats, tolerance: float, *, watch: Callable[[float], None] = lambda _: None
) -> Minimum:
    """Minimise the energy against ``aim`` from ``start`` (n_v, 3) [mm]; ``tolerance`` as for `predict`."""
    sheet = flat.sheet
    rigidity = aim.thickness**3 / 12
    springs = FOUNDATION * rigidity / sheet.size**4 * vertex_areas(sheet)

    def factorise(x: Floats) -> Solve:
        return cholesky.factorise(flat.ordering, flat.stiffness(aim, x), springs)

    return minimise(
        lambda x: flat.energy(aim, x),
        factorise,
        start,
        tolerance=tolerance * rigidity,
        longest=sheet.edge,
        limit=LIMIT,
        watch=watch,
    )
