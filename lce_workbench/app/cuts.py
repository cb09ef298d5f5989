"""The cell cut open: what its prisms show on an upright plane, and how far its parts move when it is taken apart."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from lce_solver.types import Floats
from lce_workbench.core.prism import Colour, Prism

APART = {"bottom": -0.30, "spacer": -0.12, "glue": -0.12, "top": 0.30, "alignment": -0.45}
"""Word in the name of a part -> how far it moves along z, in widths of the plates; the film stays."""


@dataclass(frozen=True, eq=False)
class Cut:
    """Where an upright plane goes through one prism."""

    name: str
    quads: Floats
    """(n, 4, 2) pieces in the plane: x and z, counter-clockwise seen from y = -infinity [mm]."""
    colour: Colour

    @property
    def area(self) -> float:
        """[mm2]"""
        p, q = self.quads, np.roll(self.quads, -1, axis=1)
        return float(0.5 * np.sum(p[..., 0] * q[..., 1] - p[..., 1] * q[..., 0]))


def cut(prisms: Sequence[Prism], y: float) -> tuple[Cut, ...]:
    """What the plane at ``y`` [mm] shows of each prism that it meets.

    A tapered prism is cut at both heights, and its pieces joined: exact unless the taper changes their number.
    """
    found = []
    for prism in prisms:
        below, above = (_inside([ring, *prism.holes], y) for ring in (prism.outline, prism.top))
        if len(below) and len(below) == len(above):
            quads = np.empty((len(below), 4, 2))
            quads[:, 0, 0], quads[:, 1, 0], quads[:, 2, 0], quads[:, 3, 0] = *below.T, *above.T[::-1]
            quads[:, :2, 1], quads[:, 2:, 1] = prism.z0, prism.z1
            found.append(Cut(prism.name, quads, prism.colour))
    return tuple(found)


def _inside(rings: Sequence[Floats], y: float) -> Floats:
    """(n, 2) pieces of the line at ``y`` inside rings and outside their holes, by the even-odd rule [mm]."""
    crossings = []
    for ring in rings:
        p, q = ring, np.roll(ring, -1, axis=0)
        meets = (p[:, 1] <= y) != (q[:, 1] <= y)
        p, q = p[meets], q[meets]
        crossings.append(p[:, 0] + (y - p[:, 1]) / (q[:, 1] - p[:, 1]) * (q[:, 0] - p[:, 0]))
    return np.sort(np.concatenate(crossings)).reshape(-1, 2)


def apart(name: str, width: float) -> float:
    """How far a part of this name moves when the cell is taken apart [mm]; ``width`` of the plates."""
    return next((share * width for word, share in APART.items() if word in name), 0.0)
