"""Reading the triangles of a mesh file, numbered as in the file."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np

from lce_solver.errors import InputError
from lce_solver.polygons import triangulated
from lce_solver.types import Floats, Ints


@dataclass(frozen=True, eq=False)
class RawMesh:
    """What a file says, unchecked."""

    vertices: Floats
    """(n_v, 3) positions in the file's unit."""
    faces: Ints
    """(n_f, 3) vertex indices; a polygon has become several triangles."""
    polygons: int
    """Number of faces in the file, before polygons were split."""


def read(path: Path) -> RawMesh:
    """Read an STL, OBJ, PLY or OFF file.

    Raises
    ------
    InputError
        The file is missing, of an unknown format, empty, truncated or not readable.
    """
    suffix = path.suffix.lower()
    if suffix not in READERS:
        msg = f"{path.name}: mesh format {suffix!r} is unknown; export the surface as {', '.join(READERS)}"
        raise InputError(msg)
    try:
        data = path.read_bytes()
    except (OSError, ValueError) as fault:  # ValueError: a null byte in the path
        reason = fault.strerror if isinstance(fault, OSError) else _first_line(fault)
        msg = f"{path}: the mesh file cannot be read ({reason}); check the path and its permissions"
        raise InputError(msg) from fault
    if not data.strip():
        msg = f"{path.name}: the file is empty; export the mesh again"
        raise InputError(msg)
    try:
        mesh = READERS[suffix](data)
    except InputError as fault:
        msg = f"{path.name}: {fault}"
        raise InputError(msg) from fault
    except Exception as fault:  # the readers raise whatever the broken file makes them stumble over
        msg = f"{path.name} is no readable {suffix[1:].upper()} file ({_first_line(fault)}); export the mesh again"
        raise InputError(msg) from fault
    if len(mesh.faces) < mesh.polygons:
        msg = (
            f"{path.name} announces {mesh.polygons} faces and {len(mesh.faces)} could be read; "
            "the file is damaged, export the mesh again"
        )
        raise InputError(msg)
    return mesh


def _first_line(fault: Exception) -> str:
    return (str(fault).splitlines() or [type(fault).__name__])[0].rstrip(".")


def read_obj(data: bytes) -> RawMesh:
    """Positions and polygons of an OBJ file, with the topology of its own position indices.

    trimesh is not used here: it splits vertices where texture coordinates, normals or materials change, which tears
    the mesh apart, and it takes the illegal index 0 and relative indices for something else.
    """
    vertices: list[list[float]] = []
    polygons: list[list[int]] = []
    for number, line in enumerate(data.decode(errors="replace").replace("\\\n", " ").splitlines(), start=1):
        key, *words = line.split("#")[0].split() or [""]
        try:
            if key == "v":
                x, y, z, *_ = map(float, words)
                vertices.append([x, y, z])
            elif key == "f":
                corners = [int(word.split("/")[0]) for word in words]
                polygons.append([i - 1 if i >= 0 else len(vertices) + i for i in corners])
        except ValueError as fault:
            msg = f"line {number}: {fault}"
            raise ValueError(msg) from fault
    points = np.array(vertices, dtype=np.float64).reshape(-1, 3)
    return RawMesh(points, triangulated(points, polygons), len(polygons))


def read_off(data: bytes) -> RawMesh:
    """Positions and polygons of an OFF file; colours are passed over."""
    text = re.sub(r"#[^\n]*", "", data.decode("latin-1"))
    head, *lines = [line.split() for line in text.replace("OFF", "OFF\n", 1).splitlines() if line.strip()]
    if head[0] not in {"OFF", "COFF"}:
        msg = "the word OFF does not stand first"
        raise ValueError(msg)
    n_v, n_f = map(int, lines[0][:2])
    points = np.array([line[:3] for line in lines[1 : n_v + 1]], dtype=np.float64).reshape(n_v, 3)
    rows = [[int(word) for word in line[: int(line[0]) + 1]] for line in lines[n_v + 1 : n_v + n_f + 1]]
    if any(len(row) <= row[0] or min(row[1:], default=0) < 0 or max(row[1:], default=0) >= n_v for row in rows):
        msg = "a face has too few indices or an index out of range"
        raise ValueError(msg)
    return RawMesh(points, triangulated(points, [row[1:] for row in rows]), n_f)


def read_stl(data: bytes) -> RawMesh:
    """Triangles of a binary or text STL file, each with corners of its own.

    trimesh is not used here: it wants the text in UTF-8, and takes a truncated binary file for text.
    """
    count = int.from_bytes(data[80:84], "little")
    if len(data) >= 84 and len(data) == 84 + 50 * count:
        records = np.frombuffer(data, dtype=STL_RECORD, offset=84)
        return _soup(records["corners"].astype(np.float64), count)
    if data.lstrip()[:5].lower() != b"solid" or b"\0" in data:
        msg = f"{len(data)} bytes, where the header's {count} triangles take {84 + 50 * count}: truncated or no STL"
        raise ValueError(msg)
    words = np.array(re.findall(rb"(?im)^\s*vertex\s+(\S+)\s+(\S+)\s+(\S+)", data), dtype=bytes)
    corners = words.reshape(-1, 3).astype(np.float64)
    whole = corners[: len(corners) // 3 * 3]
    return _soup(whole, len(re.findall(rb"(?im)^\s*facet\b", data)))


STL_RECORD = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])


def _soup(corners: Floats, polygons: int) -> RawMesh:
    """Triangles of consecutive corners."""
    points = corners.reshape(-1, 3)
    return RawMesh(points, np.arange(len(points)).reshape(-1, 3), polygons)


def read_ply(data: bytes) -> RawMesh:
    """Positions and polygons of a PLY file, text or binary."""
    import trimesh  # a slow import that other uses of the solver do not need

    header, end, body = data.partition(b"end_header")
    plain = header.decode("latin-1").encode("ascii", "replace") + end + body  # comments in any encoding
    mesh = trimesh.load_mesh(BytesIO(plain), file_type="ply", process=False)
    points, faces = np.array(mesh.vertices, dtype=np.float64), np.array(mesh.faces, dtype=np.int64)
    found = re.search(rb"element face (\d+)", header)
    polygons = int(found[1]) if found else len(faces)
    if len(faces) > polygons:  # trimesh splits concave polygons wrongly
        faces = triangulated(points, _ply_polygons(mesh.metadata["_ply_raw"]["face"]["data"]))
    return RawMesh(points, faces, polygons)


def _ply_polygons(data: Any) -> list[list[int]]:
    """Vertex indices of each face, from the structures that trimesh makes of text and binary files."""
    names = list(data) if isinstance(data, dict) else list(data.dtype.names or ())
    if names:
        name = next((name for name in names if name in {"vertex_index", "vertex_indices"}), names[0])
        data = data[name] if isinstance(data, dict) else data[name]["f1"]
    return [[int(i) for i in face] for face in data]


READERS: dict[str, Callable[[bytes], RawMesh]] = {
    ".stl": read_stl,
    ".obj": read_obj,
    ".ply": read_ply,
    ".off": read_off,
}
