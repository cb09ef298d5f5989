"""Bodies as closed triangle meshes: STL and 3MF, for a microprinter and for viewers."""

from __future__ import annotations

import math
import zipfile
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from lce_solver.topology import boundary_loops
from lce_solver.types import Floats, Ints
from lce_workbench.core.polyhedron import polyhedron
from lce_workbench.core.prism import Prism
from lce_workbench.core.relief import Relief

FACET = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("spare", "<u2")])
"""A triangle of a binary STL."""

TURN = 0.7357
"""Of a face while it is triangulated [rad]."""

FINE = 100_000
"""Triangles of the mesh of a relief, about 5 MB."""

EPOCH = (1980, 1, 1, 0, 0, 0)
"""The date of everything: the first one that a zip file can hold."""

PARTS_3MF = {
    "[Content_Types].xml": """\
<?xml version="1.0" encoding="UTF-8"?>
<Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types">
<Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/>
<Default Extension="model" ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/></Types>
""",
    "_rels/.rels": """\
<?xml version="1.0" encoding="UTF-8"?>
<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships">
<Relationship Target="/3D/3dmodel.model" Id="rel0" Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/>
</Relationships>
""",
}

MODEL_3MF = """\
<?xml version="1.0" encoding="UTF-8"?>
<model unit="millimeter" xml:lang="en-US" xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02">
<resources><object id="1" type="model" name="{name}"><mesh><vertices>
{vertices}
</vertices><triangles>
{triangles}
</triangles></mesh></object></resources><build><item objectid="1"/></build></model>
"""


def printed(stack: Sequence[Prism]) -> tuple[Floats, Ints]:
    """Points (n, 3) and triangles (m, 3) of a plate as it stands on a printer's bed: z from 0, patterned face up.

    The plate above the film is turned over about the y axis, as a hand would do it, not mirrored.
    """
    points, triangles = triangulated(sorted(stack, key=lambda prism: prism.z0))
    if stack[0].z0 > 0 or stack[-1].z1 > 0:
        points = points * np.array([-1.0, 1.0, -1.0])
    return points - np.array([0.0, 0.0, points[:, 2].min()]), triangles


def triangulated(stack: Sequence[Prism]) -> tuple[Floats, Ints]:
    """Points (n, 3) and triangles (m, 3), counter-clockwise from outside, of prisms that stand on each other.

    Only the corners are used, so triangles of neighbouring faces meet edge to edge.
    """
    body = polyhedron(stack)
    walls = [face[0] for face in body.faces if len(face) == 1 and len(face[0]) == 4]
    caps = [
        _filled(body.points, face, normal)
        for face, normal in zip(body.faces, body.normals, strict=True)
        if len(face) > 1 or len(face[0]) != 4
    ]
    quads = np.array(walls)
    return body.points, np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]], *caps])


def _filled(points: Floats, face: Sequence[Ints], normal: Floats) -> Ints:
    """Triangles (m, 3) of a horizontal face with holes, by ear clipping.

    It is turned a little first: exactly aligned corners would be left out, and neighbours would no longer meet there.
    """
    from ezdxf.math import Vec2
    from ezdxf.math.triangulation import mapbox_earcut_2d

    c, s = np.cos(TURN), np.sin(TURN)
    turned = points[:, :2] @ np.array([[c, s], [-s, c]])
    number = {tuple(turned[k].tolist()): k for loop in face for k in loop.tolist()}
    rings = [[Vec2(*turned[k].tolist()) for k in loop.tolist()] for loop in face]
    found = np.array([[number[p.x, p.y] for p in ears] for ears in mapbox_earcut_2d(rings[0], rings[1:])])
    q = turned[found]
    a, b = q[:, 1] - q[:, 0], q[:, 2] - q[:, 0]
    upwards = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0] > 0
    return np.where((upwards == (normal[2] > 0))[:, None], found, found[:, ::-1])


def thickened(vertices: Floats, faces: Ints, thickness: float) -> tuple[Floats, Ints]:
    """Closed mesh of a sheet: its mid-surface moved by half the thickness to both sides, and a wall around.

    Parameters
    ----------
    vertices : (n, 3) points of the mid-surface [mm].
    faces : (m, 3) its triangles.
    """
    p = vertices[faces]
    normals = np.zeros_like(vertices)
    np.add.at(normals, faces.ravel(), np.repeat(np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0]), 3, axis=0))
    normals *= thickness / 2 / np.linalg.norm(normals, axis=1)[:, None]
    n, walls = len(vertices), []
    for loop in boundary_loops(faces):
        a, b = loop, np.roll(loop, -1)
        walls += [np.stack([a + n, b + n, b], axis=1), np.stack([a + n, b, a], axis=1)]
    return np.concatenate([vertices + normals, vertices - normals]), np.concatenate([faces, faces[:, ::-1] + n, *walls])


def surface(relief: Relief) -> tuple[Floats, Ints]:
    """Points (n, 3) [mm] and triangles (m, 3) of a relief, each so many pixels apart that they are at most `FINE`."""
    step = max(1, math.ceil(math.sqrt(2 * relief.height.size / FINE)))
    x, y, z = relief.x[::step], relief.y[::step], relief.height[::step, ::step]
    points = np.column_stack([np.tile(x, len(y)), np.repeat(y, len(x)), z.ravel()])
    corner = (np.arange(len(y) - 1)[:, None] * len(x) + np.arange(len(x) - 1)).ravel()
    a, b, c, d = corner, corner + 1, corner + len(x) + 1, corner + len(x)
    return points, np.concatenate([np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)])


def write_stl(points: Floats, triangles: Ints, path: Path) -> None:
    """Write a binary STL [mm].

    Raises
    ------
    OSError
        The file cannot be written.
    """
    rows = np.zeros(len(triangles), dtype=FACET)
    rows["corners"] = corners = points[triangles]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    rows["normal"] = normal / np.maximum(np.linalg.norm(normal, axis=1), np.finfo(float).tiny)[:, None]
    head = f"lce-molds {path.stem} mm".encode("ascii").ljust(80)
    path.write_bytes(head + np.uint32(len(rows)).tobytes() + rows.tobytes())


def write_3mf(points: Floats, triangles: Ints, path: Path) -> None:
    """Write a 3MF (core specification) [mm], always the same bytes for the same mesh.

    Raises
    ------
    OSError
        The file cannot be written.
    """
    vertices = "\n".join(f'<vertex x="{x:.7f}" y="{y:.7f}" z="{z:.7f}"/>' for x, y, z in points.tolist())
    rows = "\n".join(f'<triangle v1="{a}" v2="{b}" v3="{c}"/>' for a, b, c in triangles.tolist())
    model = MODEL_3MF.format(name=path.stem, vertices=vertices, triangles=rows)
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, text in {**PARTS_3MF, "3D/3dmodel.model": model}.items():
            archive.writestr(zipfile.ZipInfo(name, EPOCH), text, zipfile.ZIP_DEFLATED)
