"""Prisms as shapes of FreeCAD's Part module."""

from __future__ import annotations

from typing import Any

import numpy as np

from lce_solver.types import Floats
from lce_workbench.cad.solids import require_volume
from lce_workbench.core.polyhedron import polyhedron
from lce_workbench.core.prism import Prism


def solid(prism: Prism) -> Any:
    """The prism as a `Part.Shape`: extruded from a face with holes, or made of its faces where it is tapered.

    Raises
    ------
    LceError
        The kernel's volume is not the prism's.
    """
    import Part
    from FreeCAD import Vector

    if prism.upper is None:
        face = Part.Face([_wire(np.insert(ring, 2, prism.z0, axis=1)) for ring in prism.rings])
        shape = face.extrude(Vector(0, 0, prism.z1 - prism.z0))
    else:
        made = polyhedron([prism])
        faces = [Part.Face([_wire(made.points[loop]) for loop in loops]) for loops in made.faces]
        shape = Part.Solid(Part.Shell(faces))
    require_volume(prism.name, prism.volume, shape.Volume)
    return shape


def _wire(points: Floats) -> Any:
    """Closed polygon through points (k, 3)."""
    import Part
    from FreeCAD import Vector

    return Part.makePolygon([Vector(*point) for point in [*points.tolist(), points[0].tolist()]])
