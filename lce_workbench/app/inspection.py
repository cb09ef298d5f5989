"""What is measured on the document's bodies: whether the cell is what the parameters say, and whether any two parts, or
a part and a mark that has to be seen, are in each other's way. Bodies that were moved by hand are met where they are.
"""

from __future__ import annotations

from dataclasses import replace
from itertools import combinations
from pathlib import Path
from typing import Any

import numpy as np

from lce_solver.types import Finding, Floats, Severity
from lce_workbench.app import cells, works
from lce_workbench.app.geometry import is_rough, stored
from lce_workbench.app.objects import is_fine, job_of, prisms_of
from lce_workbench.cad.checks import SAME, judged
from lce_workbench.core.frame import MARK_BOX, arrange
from lce_workbench.core.job import Job
from lce_workbench.core.units import NM, UM

SHARED = 1e-9
"""A common volume below this is the kernel's rounding [mm3]."""

Shapes = dict[str, Any]
"""Name of a body's prisms -> its `Part.Shape`, in the cell's coordinates."""


def inspected(cell: Any) -> tuple[Finding, ...]:
    """Measure the bodies of a cell that has plates."""
    bodies = [obj for obj in works.bodies(cell) if not obj.Shape.isNull()]
    parts = {obj.Prisms: placed(cell, obj) for obj in bodies if not obj.Prisms.startswith("channels")}
    job = job_of(cells.sections(cell).values())
    return (
        _current([*cells.sections(cell).values(), *bodies]),
        _corrected(cell, job),
        _kernel(bodies),
        _gap(parts, job),
        _aligned(cell, job, marks(cell, job)),
        _interference(parts),
        _marks(parts, marks(cell, job)),
    )


def placed(cell: Any, obj: Any) -> Any:
    """The shape of a body where it stands in the cell. What has a field of holes is taken without them: a kernel takes
    minutes to cut it, and what is in a hole is in the way as well.
    """
    shape = _filled(obj) if is_fine(obj.Shape) else obj.Shape.copy()
    shape.Placement = cell.getGlobalPlacement().inverse() * obj.getGlobalPlacement()
    return shape


def _filled(obj: Any) -> Any:
    """The solid of a body without its holes."""
    from lce_workbench.cad.part import solid

    return solid([replace(prism, holes=()) for prism in prisms_of(obj)])


def marks(cell: Any, job: Job) -> Floats:
    """(n, 2) middles of the clusters of marks [mm]."""
    design = cells.design_of(cell)
    return arrange(stored(Path(design.File), job, cells.made_for(design)).uv, job).marks


def _current(objects: list[Any]) -> Finding:
    """Parameters and bodies that FreeCAD could not compute."""
    bad = [obj for obj in objects if not obj.isValid()]
    why = "".join(f"{obj.Label}: {obj.getStatusString()}; " for obj in bad)
    names = " ".join(obj.Prisms if cells.kind_of(obj) == "Body" else obj.Section for obj in bad)
    return judged("body_state", f"{why}parameters and bodies that could not be computed:", len(bad), 0.0, where=names)


def _corrected(cell: Any, job: Job) -> Finding:
    """Whether the twist was corrected for the film as it is now."""
    if is_rough(job, cells.made_for(cells.design_of(cell))):
        text = "the twist follows the film by the formula alone; Predict, Mask or Export corrects it by the heating"
        return Finding("twist_corrected", Severity.WARNING, text)
    return Finding("twist_corrected", Severity.INFO, "the twist is the one that was solved for this film")


def _kernel(bodies: list[Any]) -> Finding:
    """Volume of every body against its prisms' own, relative; and validity."""
    worst, where = max((_deviation(obj), obj.Prisms) for obj in bodies)
    return judged("body_volume", f"{len(bodies)} bodies differ from their prisms by up to", worst, SAME, where=where)


def _deviation(obj: Any) -> float:
    """Relative difference of the volume; infinite if the shape is not valid; a field of holes takes too long to ask."""
    volume, valid = sum(prism.volume for prism in prisms_of(obj)), is_fine(obj.Shape) or obj.Shape.isValid()
    return abs(obj.Shape.Volume / volume - 1) if valid else float("inf")


def _gap(parts: Shapes, job: Job) -> Finding:
    """Between the epoxy faces, against the spacer."""
    gap = parts["top_land"].BoundBox.ZMin - parts["bottom_land"].BoundBox.ZMax
    text = f"the gap between the epoxy faces is {gap / UM:.6f} um; from the spacer it differs by"
    off = abs(gap - job.sheet.thickness) / NM
    return judged("body_gap", text, off, 1.0, unit="nm", where="top_land and bottom_land")


def _aligned(cell: Any, job: Job, middles: Floats) -> Finding:
    """How far apart sideways the marks of the plates stand, which may have been moved by hand."""
    from FreeCAD import Vector

    at = {obj.Prisms: obj.getGlobalPlacement() for obj in works.bodies(cell)}
    shift = at["bottom_land"].inverse() * at["top_land"]
    moved = np.array([tuple(shift.multVec(Vector(x, y, 0.0)))[:2] for x, y in middles.tolist()])
    apart = np.linalg.norm(moved - middles, axis=1) / UM
    worst = int(apart.argmax())
    where = f"corner {worst}, top_land and bottom_land" if apart[worst] > job.marks.tolerance_um else ""
    text = "the marks of the plates stand apart by up to"
    return judged("plates_aligned", text, float(apart[worst]), job.marks.tolerance_um, unit="um", where=where)


def _interference(parts: Shapes) -> Finding:
    """The largest volume that two parts share."""
    shared = [(common(parts[a], parts[b]), f"{a} and {b}") for a, b in combinations(parts, 2)]
    worst, where = max(shared, key=lambda one: one[0])
    where = where if worst > SHARED else ""
    text = f"{where} share" if where else f"of {len(shared)} pairs of parts the one that shares most shares"
    return judged("interference", text, worst, SHARED, unit="mm3", where=where)


def _marks(parts: Shapes, middles: Floats) -> Finding:
    """The largest volume of the gap above a cluster of marks that a part fills: the microscope has to see through."""
    import Part
    from FreeCAD import Vector

    low, high = parts["bottom_land"].BoundBox.ZMax, parts["top_land"].BoundBox.ZMin
    filled = [(0.0, "")]
    for k, (x, y) in enumerate(middles.tolist()):
        at = Vector(x - MARK_BOX / 2, y - MARK_BOX / 2, min(low, high))
        column = Part.makeBox(MARK_BOX, MARK_BOX, max(abs(high - low), NM), at)
        filled += [(common(column, shape), f"corner {k}, {name}") for name, shape in parts.items() if name in IN_GAP]
    worst, where = max(filled, key=lambda one: one[0])
    text = f"{len(middles)} clusters of marks are seen through the gap; parts fill above one at most"
    return judged("marks_seen", text, worst, SHARED, unit="mm3", where=where if worst > SHARED else "")


IN_GAP = ("spacer_left", "spacer_right", "glue_left", "glue_right", "sheet")
"""Prisms between the plates."""


def common(a: Any, b: Any) -> float:
    """Volume that two shapes share [mm3]; shapes that only touch share none."""
    one, other = a.BoundBox, b.BoundBox
    low = np.maximum((one.XMin, one.YMin, one.ZMin), (other.XMin, other.YMin, other.ZMin))
    high = np.minimum((one.XMax, one.YMax, one.ZMax), (other.XMax, other.YMax, other.ZMax))
    return float(a.common(b).Volume) if np.all(high - low > NM) else 0.0
