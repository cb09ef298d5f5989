"""Prisms as shapes of FreeCAD's Part module."""

from __future__ import annotations

from typing import Any

from lce_solver.types import Floats
from lce_workbench.cad.solids import require_volume
from lce_workbench.core.cell import Prism


def solid(prism: Prism) -> Any:
    """The prism as a `Part.Shape`, extruded from a face with holes.

    Raises
    ------
    LceError
        The kernel's volume is not the prism's.
    """
    import Part
    from FreeCAD import Vector

    def wire(ring: Floats) -> Any:
        points = [Vector(x, y, prism.z0) for x, y in ring.tolist()]
        return Part.makePolygon([*points, points[0]])

    shape = Part.Face([wire(ring) for ring in prism.rings]).extrude(Vector(0, 0, prism.z1 - prism.z0))
    require_volume(prism, shape.Volume)
    return shape
