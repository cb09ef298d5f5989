"""Coarse meshes of a target, and maps carried from a coarse mesh to a finer one."""

from __future__ import annotations

import igl
import numpy as np

from lce_solver.errors import LceError
from lce_solver.geometry import mean_edge
from lce_solver.mirror import even_mesh
from lce_solver.types import Floats, Surface

SMALL = 6000
"""Triangles up to which all starts compete on the mesh itself."""
RATIO = 4
"""Triangles of a mesh over those of the next coarser one."""


def levels(surface: Surface) -> list[Surface]:
    """Meshes of the same target, the coarsest first and ``surface`` last, each with `RATIO` times the triangles.

    A target whose necks or holes a coarse mesh would close is solved on fine meshes only.
    """
    found = [surface]
    edge = mean_edge(surface)
    while len(found[0].faces) > SMALL:
        edge *= np.sqrt(RATIO)
        try:
            found.insert(0, even_mesh(found[0], edge))
        except LceError:
            break
    return found


def carried(coarse: Surface, fine: Surface, uv: Floats) -> Floats:
    """(n, 2) flat coordinates of the fine mesh's vertices: the closest coarse triangle's linear map, extended."""
    _, triangle, _ = igl.point_mesh_squared_distance(
        *(np.array(values, order="C") for values in (fine.vertices, coarse.vertices, coarse.faces))
    )
    corner = coarse.faces[triangle]
    origin = coarse.vertices[corner[:, 0]]
    sides = np.stack([coarse.vertices[corner[:, k]] - origin for k in (1, 2)], axis=2)
    share = np.einsum("nij,nj->ni", np.linalg.pinv(sides), fine.vertices - origin)
    moved: Floats = uv[corner[:, 0]] + sum(share[:, [k - 1]] * (uv[corner[:, k]] - uv[corner[:, 0]]) for k in (1, 2))
    return moved
