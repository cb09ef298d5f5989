"""Polyhedra as boundary representations of STEP, written as they stand: no kernel, time in proportion to the faces."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from lce_solver.types import Floats, Ints
from lce_workbench.cad.part21 import Part21, real, references
from lce_workbench.core.polyhedron import Polyhedron, following

DIRECTION = "@0=DIRECTION('',({x},{y},{z}));\n@1=VECTOR('',@0,1.);\n"

POINT = "@0=CARTESIAN_POINT('',({x},{y},{z}));\n@1=VERTEX_POINT('',@0);\n"

EDGE = "@0=LINE('',#{point:d},#{vector:d});\n@1=EDGE_CURVE('',#{start:d},#{end:d},@0,.T.);\n"

ORIENTED = "@0=ORIENTED_EDGE('',*,*,#{edge:d},.{sense}.);\n"

LOOP = "@0=EDGE_LOOP('',({edges}));\n@1={kind}('',@0,.T.);\n"

FACE = """\
@0=AXIS2_PLACEMENT_3D('',#{point:d},#{normal:d},#{along:d});
@1=PLANE('',@0);
@2=ADVANCED_FACE('{name}',({bounds}),@1,.T.);
"""

SOLID = "@0=CLOSED_SHELL('',({faces}));\n@1=MANIFOLD_SOLID_BREP('{name}',@0);\n"


def write_solids(out: Part21, names: Sequence[str], solids: Sequence[Polyhedron]) -> Ints:
    """Write polyhedra in bulk; return the numbers (n,) of their MANIFOLD_SOLID_BREP."""
    faces = write_faces(out, solids)
    shells = np.split(faces, np.cumsum([len(solid.faces) for solid in solids])[:-1])
    return out.rows(SOLID, len(names), {"name": names, "faces": [references(shell)[1:] for shell in shells]}) + 1


def write_faces(out: Part21, solids: Sequence[Polyhedron], names: Sequence[str] = ()) -> Ints:
    """Write the faces of polyhedra; edges are shared, and so are directions. Returns their numbers (n,)."""
    starts = np.cumsum([0, *(len(solid.points) for solid in solids)])
    points, normals = (np.concatenate([getattr(solid, name) for solid in solids]) for name in ("points", "normals"))
    faces = [[loop + at for loop in face] for solid, at in zip(solids, starts, strict=False) for face in solid.faces]
    loops = [loop for face in faces for loop in face]
    sizes = np.array([len(loop) for loop in loops])
    begin = np.concatenate(loops)
    end = begin[following(sizes)]
    keys, edge = np.unique(np.minimum(begin, end) * len(points) + np.maximum(begin, end), return_inverse=True)
    a, b = np.divmod(keys, len(points))
    along = points[b] - points[a]
    along /= np.linalg.norm(along, axis=1)[:, None]
    directions, index = np.unique(np.concatenate([along, normals]) + 0.0, axis=0, return_inverse=True)
    direction = out.rows(DIRECTION, len(directions), _reals(directions))[index.reshape(-1)]
    point = out.rows(POINT, len(points), _reals(points))
    columns = {"point": point[a], "vector": direction[: len(a)] + 1, "start": point[a] + 1, "end": point[b] + 1}
    curve = out.rows(EDGE, len(a), columns) + 1
    senses = np.where(begin < end, b"T", b"F")
    oriented = np.split(out.rows(ORIENTED, len(edge), {"edge": curve[edge], "sense": senses}), np.cumsum(sizes)[:-1])
    kinds = [kind for face in faces for kind in ["FACE_OUTER_BOUND", *["FACE_BOUND"] * (len(face) - 1)]]
    edges = [references(each)[1:] for each in oriented]
    bound = out.rows(LOOP, len(loops), {"edges": edges, "kind": kinds}) + 1
    count = np.array([len(face) for face in faces])
    first = np.cumsum(count) - count  # loop
    corner = (np.cumsum(sizes) - sizes)[first]
    columns = {"point": point[begin[corner]], "normal": direction[len(a) :], "along": direction[edge[corner]]}
    bounds = [references(each)[1:] for each in np.split(bound, first[1:])]
    made = np.empty(len(faces), dtype=np.int64)
    for pick in (np.flatnonzero(count == 1), *np.flatnonzero(count > 1)[:, None]):  # rows are padded to the longest
        if len(pick):
            texts = {"bounds": [bounds[k] for k in pick], "name": [names[k] for k in pick] if names else ""}
            rows = {name: column[pick] for name, column in columns.items()}
            made[pick] = out.rows(FACE, len(pick), {**rows, **texts}) + 2
    return made


def _reals(vectors: Floats) -> dict[str, list[str]]:
    """Columns of vectors (n, 3)."""
    return {name: [real(value) for value in values.tolist()] for name, values in zip("xyz", vectors.T, strict=True)}
