"""Weight of the film, and a plate that it lies on. Energies are per Young's modulus, as the shell's."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from lce_solver.geometry import shared
from lce_solver.shell_patch import Shell
from lce_solver.types import Floats, owned

GRAVITY = 9.80665
"""[m/s^2]"""
LAYER = 0.05
"""Over so much of the thickness the plate's push grows by the factor e. A push that sets in at once, stiff beside the
weight as a real plate's, leaves a minimiser no step that is neither too long nor too short."""
DEEPEST = 300.0
"""Layers beyond which the push grows no more: numbers stay finite."""


@dataclass(frozen=True, eq=False)
class Load:
    """Vertical forces on the vertices: a constant pull downwards, and a push upwards that fades with the height."""

    weight: Floats
    """(n_v,) pull on each vertex, per Young's modulus [mm^2]."""
    push: Floats
    """(n_v,) push on each vertex at z = 0, per Young's modulus [mm^2]."""
    layer: float
    """Height over which the push falls to 1/e [mm]."""

    def __post_init__(self) -> None:
        for name in ("weight", "push"):
            object.__setattr__(self, name, owned(getattr(self, name), name, np.float64, None))

    def energy(self, x: Floats) -> tuple[float, Floats]:
        """Energy per Young's modulus [mm^3] of the shape ``x`` (n_v, 3) [mm] and its gradient (n_v, 3)."""
        pushed = self._pushed(x)
        gradient = np.zeros_like(x)
        gradient[:, 2] = self.weight - pushed
        return float(self.weight @ x[:, 2] + self.layer * pushed.sum()), gradient

    def stiffness(self, x: Floats) -> Floats:
        """(n_v,) second derivative along z [mm]."""
        return self._pushed(x) / self.layer

    def _pushed(self, x: Floats) -> Floats:
        pushed: Floats = self.push * np.exp(np.minimum(-x[:, 2] / self.layer, DEEPEST))
        return pushed


def vertex_areas(sheet: Shell) -> Floats:
    """(n_v,) a third of the flat triangles about each vertex [mm^2]."""
    return shared(sheet.area, sheet.faces, len(sheet.uv))


def specific_weight(density: float, modulus: float) -> float:
    """Weight per volume over Young's modulus [1/mm], of a ``density`` [kg/m^3] and a ``modulus`` [MPa]."""
    return density * GRAVITY * 1e-9 / modulus


def on_plate(sheet: Shell, thickness: float, pull: float) -> Load:
    """A film of ``thickness`` [mm] as prepared, with the `specific_weight` ``pull`` [1/mm], lying on a plate.

    z = 0 is where the film's middle lies when it is flat. Heating keeps the film's mass. Approximate: no friction, no
    adhesion, and the plate gives way by a `LAYER` each time the pressure grows by the factor e. What a
    load bends is too soft where triangles are irregular, whatever their size: by 2 to 5 % on the mesher's, within 1 %
    on a lattice, stretched or not, but several times more on a square grid whose diagonals run both ways.
    """
    weight = pull * thickness * vertex_areas(sheet)
    return Load(weight, weight, LAYER * thickness)
