"""Prisms as solids of OpenCASCADE, through cadquery."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from math import isclose
from typing import TYPE_CHECKING

from lce_solver.errors import LceError
from lce_workbench.core.polyhedron import Polyhedron, polyhedron
from lce_workbench.core.prism import Prism, together

if TYPE_CHECKING:
    import cadquery as cq
    from OCP.gp import gp_Pnt
    from OCP.TopoDS import TopoDS_Edge

TOLERANCE = 1e-7
"""OpenCASCADE's own [mm]."""

VOLUME_TOLERANCE = 1e-9
"""Largest accepted relative difference between a kernel's volume and the prism's own."""


def solid(stack: Sequence[Prism]) -> cq.Solid:
    """The body of prisms that stand on each other, see `polyhedron`; nothing is cut, extruded or sewn.

    Edges are shared by the faces that meet there, so the shell is closed as it is made.

    Raises
    ------
    LceError
        The kernel's volume is not that of the prisms.
    """
    import cadquery as cq
    from OCP.BRep import BRep_Builder
    from OCP.Geom import Geom_Plane
    from OCP.gp import gp_Dir, gp_Pnt
    from OCP.TopAbs import TopAbs_REVERSED
    from OCP.TopoDS import TopoDS_Face, TopoDS_Shell, TopoDS_Solid, TopoDS_Wire

    made, builder = polyhedron(stack), BRep_Builder()
    shell, body = TopoDS_Shell(), TopoDS_Solid()
    builder.MakeShell(shell)
    builder.MakeSolid(body)
    points = [gp_Pnt(*point) for point in made.points.tolist()]
    edges = _edges(made, points)
    for loops, normal in zip(made.faces, made.normals.tolist(), strict=True):
        face = TopoDS_Face()
        builder.MakeFace(face, Geom_Plane(points[loops[0][0]], gp_Dir(*normal)), TOLERANCE)
        for loop in loops:
            wire = TopoDS_Wire()
            builder.MakeWire(wire)
            for a, b in pairwise([*loop.tolist(), int(loop[0])]):
                builder.Add(wire, edges[a, b] if a < b else edges[b, a].Oriented(TopAbs_REVERSED))
            wire.Closed(True)
            builder.Add(face, wire)
        builder.Add(shell, face)
    shell.Closed(True)
    builder.Add(body, shell)
    found = cq.Solid(body)
    require_volume(stack[0].name, together(stack)[0], found.Volume())
    return found


def _edges(made: Polyhedron, points: Sequence[gp_Pnt]) -> dict[tuple[int, int], TopoDS_Edge]:
    """The edge between each two points that a face joins, the smaller number first."""
    from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeEdge, BRepBuilderAPI_MakeVertex

    vertices = [BRepBuilderAPI_MakeVertex(point).Vertex() for point in points]
    loops = (loop for face in made.faces for loop in face)
    pairs = {(min(pair), max(pair)) for loop in loops for pair in pairwise([*loop.tolist(), int(loop[0])])}
    return {(a, b): BRepBuilderAPI_MakeEdge(vertices[a], vertices[b]).Edge() for a, b in pairs}


def require_volume(name: str, want: float, volume: float) -> None:
    """Raise `LceError` unless a kernel's ``volume`` of a body is what its prisms say."""
    if not isclose(volume, want, rel_tol=VOLUME_TOLERANCE):
        msg = (
            f"{name}: the CAD kernel finds {volume:.12g} mm3 instead of {want:.12g}; "
            "this is a fault of the program, please report it with the job file"
        )
        raise LceError(msg)
