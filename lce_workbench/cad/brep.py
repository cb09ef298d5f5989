"""A prism as a boundary representation of STEP, written as it stands: no kernel, and no cost that grows with its holes.

The shell of a prism is known beforehand: a wall for each edge of a ring, and two caps whose bounds are the rings.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from lce_solver.types import Floats, Ints
from lce_workbench.cad.part21 import Part21, real, references
from lce_workbench.core.cell import Prism

CORNER = """\
@0=CARTESIAN_POINT('',({x},{y},{z0}));
@1=CARTESIAN_POINT('',({x},{y},{z1}));
@2=VERTEX_POINT('',@0);
@3=VERTEX_POINT('',@1);
@4=DIRECTION('',({dx},{dy},0.));
@5=VECTOR('',@4,1.);
@6=LINE('',@0,@5);
@7=LINE('',@1,@5);
@8=LINE('',@0,#14);
@9=EDGE_CURVE('',@2,>2,@6,.T.);
@10=EDGE_CURVE('',@3,>3,@7,.T.);
@11=EDGE_CURVE('',@2,@3,@8,.T.);
@12=ORIENTED_EDGE('',*,*,@9,.T.);
@13=ORIENTED_EDGE('',*,*,>11,.T.);
@14=ORIENTED_EDGE('',*,*,@10,.F.);
@15=ORIENTED_EDGE('',*,*,@11,.F.);
@16=EDGE_LOOP('',(@12,@13,@14,@15));
@17=FACE_OUTER_BOUND('',@16,.T.);
@18=DIRECTION('',({dy},{minus_dx},0.));
@19=AXIS2_PLACEMENT_3D('',@0,@18,@4);
@20=PLANE('',@19);
@21=ADVANCED_FACE('',(@17),@20,.T.);
@22=ORIENTED_EDGE('',*,*,@9,.F.);
@23=ORIENTED_EDGE('',*,*,@10,.T.);
"""
"""A corner, the edges from it to the next one (``>``) of its ring and upwards, and the wall over the first of them.

With the material on an edge's left, for outlines and holes alike, the wall's outward normal is (dy, -dx).
"""

SIZE = CORNER.count("\n")
FACE, LOW, HIGH = 21, 22, 23
"""Statements of a corner: its wall, and its edges as the lower and upper cap use them."""

BOUND = "@0=EDGE_LOOP('',({edges}));\n@1={kind}('',@0,.T.);\n"

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
    points, following = np.concatenate(rings), _following(rings)
    along = points[following] - points
    along /= np.linalg.norm(along, axis=1)[:, None]
    sizes = [sum(map(len, prism.rings)) for prism in prisms]
    columns = {
        **{name: _reals(values) for name, values in zip("xy", points.T, strict=True)},
        **{name: _reals(values) for name, values in zip(("dx", "dy"), along.T, strict=True)},
        "minus_dx": _reals(-along[:, 0]),
        **{name: np.repeat([real(getattr(prism, name)) for prism in prisms], sizes) for name in ("z0", "z1")},
        ">": following,
    }
    corners = np.split(out.rows(CORNER, len(points), columns), np.cumsum(sizes)[:-1])
    return np.array([_shell(out, prism, first) for prism, first in zip(prisms, corners, strict=True)])


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


def _reals(values: Floats) -> list[str]:
    return [real(value) for value in values.tolist()]
