"""Prisms as shapes of FreeCAD's Part module."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from typing import Any

import numpy as np

from lce_solver.types import Floats
from lce_workbench.cad.solids import require_volume
from lce_workbench.core.polyhedron import polyhedron
from lce_workbench.core.prism import Prism


def solid(stack: Sequence[Prism]) -> Any:
    """The body of prisms that stand on each other, as a `Part.Solid`.

    A single straight prism is extruded from a face with holes, which takes a tenth of the time of sewing its faces; its
    volume is the area that the kernel finds for that face, times the height.

    Raises
    ------
    LceError
        The kernel's volume is not that of the prisms.
    """
    import Part

    first = stack[0]
    if len(stack) == 1 and first.upper is None:
        shape, volume = _extruded(tuple(ring.tobytes() for ring in first.rings), first.z0, first.z1)
    else:
        made = polyhedron(stack)
        shape = Part.Solid(Part.Shell([_face([made.points[loop] for loop in loops]) for loops in made.faces]))
        volume = shape.Volume
    require_volume(first.name, sum(prism.volume for prism in stack), volume)
    return shape


@lru_cache(maxsize=1024)
def _extruded(rings: tuple[bytes, ...], z0: float, z1: float) -> tuple[Any, float]:
    """The solid over a section between two heights, and its volume. The same for the same values: see `same`."""
    from FreeCAD import Vector

    section, area = _section(rings)
    return section.translated(Vector(0, 0, z0)).extrude(Vector(0, 0, z1 - z0)), area * (z1 - z0)


@lru_cache(maxsize=1024)
def _section(rings: tuple[bytes, ...]) -> tuple[Any, float]:
    """The plane face inside rings (k, 2) at z = 0, and its area.

    The same face for the same rings: a window that has drawn it once need not mesh it again, which for a land with
    its hundreds of holes takes longer than all the rest.
    """
    face = _face([np.insert(np.frombuffer(ring).reshape(-1, 2), 2, 0.0, axis=1) for ring in rings])
    return face, face.Area


def same(shape: Any, solids: Sequence[Any]) -> bool:
    """Whether a shape consists of these very solids, wherever it stands: then it need not be drawn again."""
    found = shape.Solids
    return len(found) == len(solids) and all(map(type(shape).isPartner, found, solids))


def _face(rings: Sequence[Floats]) -> Any:
    """A plane face with its outline first, through points (k, 3) each."""
    import Part
    from FreeCAD import Vector

    return Part.Face(
        [Part.makePolygon([Vector(*point) for point in [*ring.tolist(), ring[0].tolist()]]) for ring in rings]
    )
