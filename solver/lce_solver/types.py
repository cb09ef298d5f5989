"""Data of the inverse problem. Lengths in mm, angles in radians; directors are lines, so angles modulo pi."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from enum import Enum
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from lce_solver.errors import InputError

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

Progress = Callable[[str, float], None]
"""Called with the stage's name (a `Stage` where energy is minimised) and the fraction done in [0, 1]; it may raise
`Cancelled` to stop the work."""


class Stage(str):
    """A stage's name that also tells the energy that is being minimised."""

    energy: float

    def __new__(cls, name: str, energy: float) -> Stage:
        """The name, with the ``energy`` reached."""
        made = super().__new__(cls, name)
        made.energy = energy
        return made


def silent(stage: str, fraction: float) -> None:
    """The `Progress` that tells nobody."""


def owned(value: ArrayLike, name: str, dtype: type, *shape: int | None) -> NDArray[Any]:
    """Return a read-only copy of ``value``; ``None`` in ``shape`` matches any length.

    Raises
    ------
    ValueError
        The array has another shape.
    """
    array: NDArray[Any] = np.array(value, dtype=dtype)
    fits = array.ndim == len(shape) and all(want in (None, have) for want, have in zip(shape, array.shape, strict=True))
    if not fits:
        msg = f"{name}: expected shape {shape}, got {array.shape}"
        raise ValueError(msg)
    array.setflags(write=False)
    return array


class Severity(str, Enum):
    """How much a finding matters; an error makes the exit code 1."""

    INFO = "info"
    WARNING = "warning"
    ERROR = "error"


@dataclass(frozen=True)
class Finding:
    """What one check measured. A finding reports; it never stops the work."""

    check: str
    """Name of the check, a short identifier such as ``twist_limit``."""
    severity: Severity
    message: str
    """One sentence for the user."""
    value: float | None = None
    limit: float | None = None
    unit: str = ""
    where: str = ""
    """The place: a domain, an element, a file."""


LEAST, MOST = 0.05, 20.0
"""Limits of a material's stretches: far beyond what any elastomer does, far from where numbers overflow."""


@dataclass(frozen=True)
class Material:
    """Lengths change by ``lambda_`` along the director and ``lambda_**-nu`` across it (paper, eq. 1)."""

    lambda_: float
    nu: float
    source: str = ""
    """Where the numbers come from, for the report."""

    def __post_init__(self) -> None:
        if not (np.isfinite(self.lambda_) and self.lambda_ > 0):
            msg = f"material.lambda is {self.lambda_:g}; a stretch must be a positive number, for example 0.6"
            raise InputError(msg)
        if not np.isfinite(self.nu):
            msg = f"material.nu is {self.nu:g}; give a finite number, 0.5 conserves volume"
            raise InputError(msg)
        with np.errstate(all="ignore"):  # of what is refused here
            across = float(np.float64(self.lambda_) ** -self.nu)
        if not all(LEAST <= stretch <= MOST for stretch in (self.lambda_, across)):
            msg = (
                f"material.lambda = {self.lambda_:g} with nu = {self.nu:g} stretches by {self.lambda_:g} along and "
                f"{across:g} across the director; give values with both stretches between {LEAST:g} and {MOST:g}"
            )
            raise InputError(msg)
        if self.lambda_ == 1.0 or self.along == self.across:
            msg = (
                f"material.lambda = {self.lambda_:g} with nu = {self.nu:g} stretches alike in all directions, "
                "so there is no director; choose lambda different from 1 (0.6 for a heated LCE)"
            )
            raise InputError(msg)

    @property
    def along(self) -> float:
        """Stretch along the director."""
        return self.lambda_

    @property
    def across(self) -> float:
        """Stretch across the director, in the plane."""
        return float(self.lambda_**-self.nu)

    @property
    def through(self) -> float:
        """Stretch of the thickness, lambda_z: the material is uniaxial about the director."""
        return self.across


@dataclass(frozen=True, eq=False)
class Surface:
    """Target surface: an oriented triangle mesh."""

    vertices: Floats
    """(n_v, 3) positions [any length unit until the design fixes the scale, then mm]."""
    faces: Ints
    """(n_f, 3) vertex indices, counter-clockwise seen from the side that becomes the sheet's top."""

    def __post_init__(self) -> None:
        object.__setattr__(self, "vertices", owned(self.vertices, "vertices", np.float64, None, 3))
        object.__setattr__(self, "faces", owned(self.faces, "faces", np.int64, None, 3))


class Status(str, Enum):
    """Why a solver stopped; the value is the sentence shown to the user."""

    CONVERGED = "converged: the energy no longer decreases"
    ITERATION_LIMIT = "stopped at the iteration limit before the energy settled"
    FLIPPED = "the flat sheet has flipped triangles"
    OVERLAP = "the outline of the flat sheet crosses itself"
    NOT_FINITE = "the energy is not a finite number"
    OUTRUN = "stopped early: other starts were ahead"
    STALLED = "stopped: no step lowers the energy, although it is not yet at a minimum"


@dataclass(frozen=True, eq=False)
class Flattening:
    """A map of the target to the plane with its energy (paper, eq. S3), in the target's own length unit."""

    uv: Floats
    """(n_v, 2) flat coordinates."""
    theta: Floats
    """(n_f,) director angle in the plane, modulo pi [rad]."""
    status: Status
    energy: Floats
    """(k,) history of the last descent: 1/2 sum w_t |sigma - s|^2, w_t the area fraction, + the smoothing's part."""
    iterations: int
    flipped: Ints
    """(k,) indices of triangles with negative area."""
    crossings: Ints
    """(k, 2) pairs of boundary edges (by start vertex) that cross."""

    def __post_init__(self) -> None:
        for name, dtype, shape in (
            ("uv", np.float64, (None, 2)),
            ("theta", np.float64, (None,)),
            ("energy", np.float64, (None,)),
            ("flipped", np.int64, (None,)),
            ("crossings", np.int64, (None, 2)),
        ):
            object.__setattr__(self, name, owned(getattr(self, name), name, dtype, *shape))


@dataclass(frozen=True)
class Start:
    """One start that competed: the direction of the initial stretch and what came of it."""

    angle: float
    """Direction of the initial stretch in the ARAP plane [rad]."""
    status: Status
    rms: float
    """Area rms of the relative error of both stretches."""
    bending_left: float
    """Fraction of the target's bending (Frobenius norm) that twist cannot reach, in [0, 1]."""
    flipped: int
    crossings: int
    symmetric: bool = False
    """Whether the solution of a symmetric target was kept symmetric."""
    triangles: int = 0
    """Size of the finest mesh on which this start was solved; the figures are from there."""
    energy: float = 0.0
    """1/2 sum w_t |sigma - s|^2, w_t the area fraction, where this start ended."""
    iterations: int = 0
    """Of all its descents."""
    winner: bool = False
    """Whether the design is made of it."""
    heated_pct: float = np.inf
    """Distance from the target at which its corrected sheet, heated from flat, ends, rms [% of the diagonal]; infinite
    for starts that were not heated."""

    @property
    def score(self) -> float:
        """What the ranking minimises: rms x bending left (twist can do little where this is large)."""
        return self.rms * self.bending_left


@dataclass(frozen=True, eq=False)
class Design:
    """The flat sheet that morphs into the target, at real size."""

    surface: Surface
    """The target at its real size [mm]."""
    uv: Floats
    """(n_v, 2) flat sheet seen from above, centred on the origin [mm]."""
    theta: Floats
    """(n_f,) director angle, in [0, pi) [rad]."""
    dtheta: Floats
    """(n_f,) twist, theta(top) - theta(bottom), signed [rad]."""
    stretch: Floats
    """(n_f, 2) stretch flat -> target along and across the director, as achieved by the map."""
    material: Material
    thickness: float
    """Prepared thickness of the film [mm]."""
    flattening: Flattening
    bending_left: float
    """Fraction of the target's bending that twist cannot reach."""
    starts: tuple[Start, ...] = ()
    findings: tuple[Finding, ...] = field(default=())

    def __post_init__(self) -> None:
        n_v, n_f = len(self.surface.vertices), len(self.surface.faces)
        for name, shape in (("uv", (n_v, 2)), ("theta", (n_f,)), ("dtheta", (n_f,)), ("stretch", (n_f, 2))):
            object.__setattr__(self, name, owned(getattr(self, name), name, np.float64, *shape))

    @property
    def theta_top(self) -> Floats:
        """(n_f,) director at the top of the film, modulo pi [rad]."""
        return line_angle(self.theta + self.dtheta / 2)

    @property
    def theta_bottom(self) -> Floats:
        """(n_f,) director at the bottom of the film, modulo pi [rad]."""
        return line_angle(self.theta - self.dtheta / 2)


@dataclass(frozen=True)
class HeatingStep:
    """One temperature of the simulated heating; energies are per Young's modulus."""

    lambda_: float
    """Stretch along the director at this temperature."""
    stretching: float
    """[mm^3]"""
    bending: float
    """[mm^3]"""
    iterations: int
    status: Status
    loading: float = 0.0
    """Of the weight, and of the support that gives way [mm^3]."""


@dataclass(frozen=True, eq=False)
class Prediction:
    """The shape that the heated sheet takes."""

    vertices: Floats
    """(n_v, 3) [mm]."""
    stretching: float
    """Stretching energy per Young's modulus [mm^3]."""
    bending: float
    """Bending energy per Young's modulus [mm^3]."""
    residual_strain: float
    """Area rms of the relative error of both stretches, as they are against as the director prescribes them."""
    status: Status
    """Of the last step."""
    history: tuple[HeatingStep, ...]
    frames: Floats
    """(k, n_v, 3) the shape after each step of the heating [mm]; the last is the result."""
    loading: float = 0.0
    """Energy of weight and support per Young's modulus [mm^3]."""

    def __post_init__(self) -> None:
        object.__setattr__(self, "vertices", owned(self.vertices, "vertices", np.float64, None, 3))
        object.__setattr__(self, "frames", owned(self.frames, "frames", np.float64, None, len(self.vertices), 3))

    @property
    def energy(self) -> float:
        """Energy per Young's modulus [mm^3]."""
        return self.stretching + self.bending + self.loading

    @property
    def iterations(self) -> int:
        """Of all steps."""
        return sum(step.iterations for step in self.history)


def line_angle(angle: Floats) -> Floats:
    """Reduce angles of lines to [0, pi). The only place where a director's angle is wrapped."""
    wrapped: Floats = np.mod(angle, np.pi)
    return np.where(wrapped >= np.pi, 0.0, wrapped)  # np.mod(-tiny, pi) rounds up to pi itself
