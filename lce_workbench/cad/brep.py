"""A prism as a boundary representation of STEP, written as it stands: no kernel, and no cost that grows with its holes.

The shell of a prism is known beforehand: a wall for each edge of a ring, and two caps whose bounds are the rings.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from lce_solver.types import Floats, Ints
from lce_workbench.cad.part21 import Part21, real, references
from lce_workbench.core.prism import Prism

CORNER = """\
@0=CARTESIAN_POINT('',({x},{y},{z0}));
@1=CARTESIAN_POINT('',({x1},{y1},{z1}));
@2=VERTEX_POINT('',@0);
@3=VERTEX_POINT('',@1);
@4=DIRECTION('',({dx},{dy},0.));
@5=VECTOR('',@4,1.);
@6=LINE('',@0,@5);
@7=LINE('',@1,@5);
@8=LINE('',@0,#{up:d});
@9=EDGE_CURVE('',@2,>2,@6,.T.);
@10=EDGE_CURVE('',@3,>3,@7,.T.);
@11=EDGE_CURVE('',@2,@3,@8,.T.);
@12=ORIENTED_EDGE('',*,*,@9,.T.);
@13=ORIENTED_EDGE('',*,*,>11,.T.);
@14=ORIENTED_EDGE('',*,*,@10,.F.);
@15=ORIENTED_EDGE('',*,*,@11,.F.);
@16=EDGE_LOOP('',(@12,@13,@14,@15));
@17=FACE_OUTER_BOUND('',@16,.T.);
@18=DIRECTION('',({nx},{ny},{nz}));
@19=AXIS2_PLACEMENT_3D('',@0,@18,@4);
@20=PLANE('',@19);
@21=ADVANCED_FACE('',(@17),@20,.T.);
@22=ORIENTED_EDGE('',*,*,@9,.F.);
@23=ORIENTED_EDGE('',*,*,@10,.T.);
"""
"""A corner, the edges from it to the next one (``>``) of its ring and upwards, and the wall over the first of them.

With the material on an edge's left, for outlines and holes alike, the wall's outward normal is d x up.
"""

SIZE = CORNER.count("\n")
FACE, LOW, HIGH = 21, 22, 23
"""Statements of a corner: its wall, and its edges as the lower and upper cap use them."""

BOUND = "@0=EDGE_LOOP('',({edges}));\n@1={kind}('',@0,.T.);\n"

SLANTED = "@0=DIRECTION('',({x},{y},{z}));\n@1=VECTOR('',@0,1.);\n"

CAP = """\
@0=CARTESIAN_POINT('',(0.,0.,{z}));
@1=AXIS2_PLACEMENT_3D('',@0,#11,#12);
@2=PLANE('',@1);
@3=ADVANCED_FACE('',({bounds}),@2,.{sense}.);
"""

SOLID = """\
@0=CLOSED_SHELL('',({faces}));
@1=MANIFOLD_SOLID_BREP('{name}',@0);
"""


def write_solids(out: Part21, prisms: Sequence[Prism]) -> Ints:
    """Write prisms; return the numbers (n,) of their MANIFOLD_SOLID_BREP."""
    rings = [ring for prism in prisms for ring in prism.rings]
    low, following = np.concatenate(rings), _following(rings)
    high = np.concatenate([ring for prism in prisms for ring in (prism.top, *prism.holes)])
    sizes = [sum(map(len, prism.rings)) for prism in prisms]
    heights = {name: [getattr(prism, name) for prism in prisms] for name in ("z0", "z1")}
    rise = np.repeat(np.subtract(heights["z1"], heights["z0"]), sizes)
    along, up = low[following] - low, np.column_stack([high - low, rise])
    along /= np.linalg.norm(along, axis=1)[:, None]
    outward = np.cross(np.insert(along, 2, 0.0, axis=1), up)
    outward /= np.linalg.norm(outward, axis=1)[:, None]
    columns = {
        **_reals({"x": low[:, 0], "y": low[:, 1], "x1": high[:, 0], "y1": high[:, 1]}),
        **_reals({"dx": along[:, 0], "dy": along[:, 1], "nx": outward[:, 0], "ny": outward[:, 1], "nz": outward[:, 2]}),
        **{name: np.repeat([*map(real, values)], sizes) for name, values in heights.items()},
        "up": _vectors(out, up),
        ">": following,
    }
    corners = np.split(out.rows(CORNER, len(low), columns), np.cumsum(sizes)[:-1])
    return np.array([_shell(out, prism, first) for prism, first in zip(prisms, corners, strict=True)])


def _vectors(out: Part21, up: Floats) -> Ints:
    """(n,) number of the VECTOR along each edge upwards (n, 3); those that stand upright share one."""
    found = np.full(len(up), 14)
    slanted = np.any(up[:, :2] != 0, axis=1)
    if slanted.any():
        unit = up[slanted] / np.linalg.norm(up[slanted], axis=1)[:, None]
        found[slanted] = out.rows(SLANTED, len(unit), _reals(dict(zip("xyz", unit.T, strict=True)))) + 1
    return found


def _shell(out: Part21, prism: Prism, corners: Ints) -> int:
    """Write caps and solid over the rows of `CORNER` of a prism; return the solid's number."""
    caps = (_cap(out, prism, corners + LOW, -1), _cap(out, prism, corners + HIGH, 1))
    return out.add(SOLID, name=prism.name, faces=references(np.array([*(corners + FACE), *caps]))[1:]) + 1


def _following(rings: Sequence[Floats]) -> Ints:
    """(n,) index of the corner after each corner of the rings, laid end to end."""
    ends = np.cumsum([len(ring) for ring in rings])
    following = np.arange(1, ends[-1] + 1)
    following[ends - 1] = [0, *ends[:-1]]
    return following


def _cap(out: Part21, prism: Prism, edges: Ints, side: int) -> int:
    """Write the lower (``side`` -1) or upper (+1) face over its edges, ring after ring; return its number."""
    bounds = []
    for i, ring in enumerate(np.split(edges, np.cumsum([len(ring) for ring in prism.rings])[:-1])):
        kind = "FACE_BOUND" if i else "FACE_OUTER_BOUND"
        bounds.append(out.add(BOUND, edges=references(ring[::side])[1:], kind=kind) + 1)
    z, sense = (real(prism.z1), "T") if side > 0 else (real(prism.z0), "F")
    return out.add(CAP, z=z, bounds=references(np.array(bounds))[1:], sense=sense) + 3


def _reals(columns: Mapping[str, Floats]) -> dict[str, list[str]]:
    return {name: [real(value) for value in values.tolist()] for name, values in columns.items()}
