"""Where in the document a finding is: the objects to select, and outlines to show, in the cell's coordinates."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from lce_solver.types import Floats
from lce_workbench.app import cells
from lce_workbench.app.geometry import domains_of
from lce_workbench.app.inspection import marks
from lce_workbench.app.objects import job_of
from lce_workbench.core.domains import SIDE, Domains
from lce_workbench.core.frame import MARK_BOX, Rect
from lce_workbench.core.job import Job


@dataclass(frozen=True, eq=False)
class Place:
    """Something to jump to."""

    objects: tuple[Any, ...]
    """Of the document."""
    outlines: tuple[Floats, ...]
    """Closed lines (n, 3) [mm]."""


def place_of(cell: Any, where: str) -> Place:
    """The place that a finding names: domains, a corner's marks, a point of the sheet, parts, a plate; or none."""
    objects = tuple(dict.fromkeys(_objects(cell, where)))
    if not cells.design_of(cell).File:
        return Place(objects, ())
    job = job_of(cells.sections(cell).values())
    side = SIDE["top"] if "top plate" in where else SIDE["bottom"]
    rings = _rings(cell, job, where)
    height = side * job.sheet.thickness / 2
    outlines = tuple(np.column_stack([ring, np.full(len(ring), height)]) for ring in rings)
    return Place(() if outlines else objects, outlines)


def _objects(cell: Any, where: str) -> Iterator[Any]:
    """Bodies and groups that are named, in words or as prisms."""
    for obj in cell.OutListRecursive:
        if cells.kind_of(obj) == "Body" and re.search(rf"\b{obj.Prisms}\b", where):
            yield obj
        if obj.isDerivedFrom("App::Part") and re.search(rf"\b{obj.Label.lower()}\b", where):
            yield obj


def _rings(cell: Any, job: Job, where: str) -> list[Floats]:
    """Closed lines (n, 2) on the sheet or the plate."""
    design = cells.design_of(cell)
    made_for = cells.made_for(design)
    if named := re.search(r"\bdomains? (\d+(?:, \d+)*)", where):
        domains = domains_of(Path(design.File), job, made_for)
        return [domains.ring(k) for k in map(int, named[1].split(", ")) if k < len(domains)]
    if corner := re.search(r"\bcorner (\d+)", where):
        x, y = marks(cell, job)[int(corner[1])].tolist()
        return [Rect(x, y, x, y).grown(MARK_BOX / 2, MARK_BOX / 2).ring]
    if at := re.search(r"\bat \((-?[\d.]+), (-?[\d.]+)\) mm", where):
        point = np.array([float(at[1]), float(at[2])])
        return [_ring_at(domains_of(Path(design.File), job, made_for), point)]
    return []


def _ring_at(domains: Domains, point: Floats) -> Floats:
    """Outline of the domain whose middle is nearest."""
    return domains.ring(int(np.argmin(np.linalg.norm(domains.centroid - point, axis=1))))
