"""A target taken from the document: any mesh, or a face of a part, meshed fine enough for the domains."""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import Any

from lce_solver.errors import InputError
from lce_workbench.app import cells
from lce_workbench.app.objects import job_of

FINER = 0.8
"""Triangles of a meshed face against domains: it is resampled to the domains' size afterwards. FreeCAD's mesher
halves edges until they are short enough: with 0.5 a plane face takes it ten times as long."""


def take(target: Any) -> None:
    """Store the mesh of ``target.Source`` in the target's own file, unless it is there already.

    Raises
    ------
    InputError
        The source has neither a mesh nor a face.
    """
    obj, names = target.Source[0], target.Source[1]
    points, facets = topology(obj, [name for name in names if name], fineness(target))
    target.Surface, target.Mesh = "", f"{obj.Label}.off"
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "target.off"
        path.write_text(off(points, facets), encoding="ascii")
        if cells.digest(str(path)) != cells.digest(target.File):
            target.File = str(path)


def fineness(target: Any) -> float:
    """Edge of a face's triangles as a part of the face's size."""
    job = job_of(target.Sizes)
    return FINER * job.domains.size / job.sheet.width_mm


def topology(obj: Any, names: list[str], part: float) -> tuple[Any, Any]:
    """Points and triangles of a mesh, or of faces of a shape; ``part`` is the edge relative to the size."""
    if hasattr(obj, "Mesh"):
        return obj.Mesh.Topology
    shape = getattr(obj, "Shape", None)
    if shape is None or not shape.Faces:
        msg = f"{obj.Label} has neither a mesh nor a face; choose a mesh, or one face of a part, as target"
        raise InputError(msg)
    import MeshPart
    import Part

    chosen = [shape.getElement(name) for name in names] or [shape]
    whole = Part.makeCompound(chosen)
    mesh = MeshPart.meshFromShape(Shape=whole, MaxLength=part * whole.BoundBox.DiagonalLength)
    return mesh.Topology


def off(points: Any, facets: Any) -> str:
    """An OFF file; numbers read back the same."""
    lines = ["OFF", f"{len(points)} {len(facets)} 0"]
    lines += [f"{p.x!r} {p.y!r} {p.z!r}" for p in points]
    lines += [f"3 {a} {b} {c}" for a, b, c in facets]
    return "\n".join(lines) + "\n"
