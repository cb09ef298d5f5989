"""Prisms as solids of OpenCASCADE, through cadquery."""

from __future__ import annotations

from math import isclose
from typing import TYPE_CHECKING

from lce_solver.errors import LceError
from lce_solver.types import Floats
from lce_workbench.core.cell import Prism

if TYPE_CHECKING:
    import cadquery as cq

VOLUME_TOLERANCE = 1e-9
"""Largest accepted relative difference between a kernel's volume and the prism's own."""


def solid(prism: Prism) -> cq.Solid:
    """Extrude the face with its holes; nothing is cut.

    Raises
    ------
    LceError
        The kernel's volume is not the prism's.
    """
    import cadquery as cq
    from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeFace
    from OCP.gp import gp_Dir, gp_Pln, gp_Pnt

    outer, *holes = (_wire(ring, prism.z0).wrapped for ring in prism.rings)
    builder = BRepBuilderAPI_MakeFace(gp_Pln(gp_Pnt(0, 0, prism.z0), gp_Dir(0, 0, 1)), outer, True)
    for hole in holes:  # some 50 times faster than Face.makeFromWires, which repairs what is right already
        builder.Add(hole)
    shape = cq.Solid.extrudeLinear(cq.Face(builder.Face()), cq.Vector(0, 0, prism.z1 - prism.z0))
    require_volume(prism, shape.Volume())
    return shape


def require_volume(prism: Prism, volume: float) -> None:
    """Raise `LceError` unless a kernel's ``volume`` is the prism's."""
    if not isclose(volume, prism.volume, rel_tol=VOLUME_TOLERANCE):
        msg = (
            f"{prism.name}: the CAD kernel finds {volume:.12g} mm3 instead of {prism.volume:.12g}; "
            "this is a fault of the program, please report it with the job file"
        )
        raise LceError(msg)


def _wire(ring: Floats, z: float) -> cq.Wire:
    import cadquery as cq

    return cq.Wire.makePolygon([cq.Vector(x, y, z) for x, y in ring.tolist()], close=True)
