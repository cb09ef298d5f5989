"""Reading the triangles of a mesh file, numbered as in the file."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass
from io import BytesIO
from itertools import pairwise
from pathlib import Path

import numpy as np

from lce_solver.errors import InputError
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
    except OSError as fault:
        msg = f"{path}: the mesh file cannot be read ({fault.strerror}); check the path and its permissions"
        raise InputError(msg) from fault
    if not data.strip():
        msg = f"{path.name}: the file is empty; export the mesh again"
        raise InputError(msg)
    try:
        mesh = READERS[suffix](data)
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
    fan = [(corners[0], *pair) for corners in polygons for pair in pairwise(corners[1:])]
    return RawMesh(np.array(vertices).reshape(-1, 3), np.array(fan, dtype=np.int64).reshape(-1, 3), len(polygons))


def _read_with_trimesh(file_type: str, announced: bytes) -> Callable[[bytes], RawMesh]:
    """A reader that compares the number of triangles with the one that the pattern ``announced`` finds."""

    def reader(data: bytes) -> RawMesh:
        import trimesh  # a slow import that other uses of the solver do not need

        mesh = trimesh.load_mesh(BytesIO(data), file_type=file_type, process=False)
        found = re.search(announced, data) if announced else None
        polygons = int(found[1]) if found else len(mesh.faces)
        return RawMesh(np.array(mesh.vertices, dtype=np.float64), np.array(mesh.faces, dtype=np.int64), polygons)

    return reader


READERS: dict[str, Callable[[bytes], RawMesh]] = {
    ".stl": _read_with_trimesh("stl", b""),
    ".obj": read_obj,
    ".ply": _read_with_trimesh("ply", rb"element face (\d+)"),
    ".off": _read_with_trimesh("off", rb"OFF(?:\s|#[^\n]*\n)*\d+\s+(\d+)\s"),
}
