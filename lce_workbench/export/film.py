"""The heating as an animation: glTF 2.0 with a morph target for each step, which any glTF viewer plays."""

from __future__ import annotations

import json
import struct
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from lce_solver.types import Floats, Ints

SECONDS = 0.4
"""From one step of the heating to the next."""
FLOAT, UNSIGNED = 5126, 5125
"""Component types of glTF."""
COLOUR = (0.85, 0.6, 0.3, 1.0)


def write_film(uv: Floats, faces: Ints, frames: Floats, path: Path) -> None:
    """Write the sheet ``uv`` (n_v, 2) [mm] that takes the shapes ``frames`` (k, n_v, 3) [mm] one after the other.

    glTF has its y axis upwards and metres: a node turns and scales the sheet. Without normals in the file, viewers
    shade every triangle by its own, in every shape.

    Raises
    ------
    OSError
        The file cannot be written.
    """
    flat = np.column_stack([uv, np.zeros(len(uv))])
    moves = np.asarray(frames) - flat
    times, weights = SECONDS * np.arange(len(frames) + 1), np.eye(len(frames) + 1)[:, 1:]
    arrays: list[tuple[NDArray[Any], str, int | None]] = [
        (faces.reshape(-1).astype("<u4"), "SCALAR", 34963),
        (flat.astype("<f4"), "VEC3", 34962),
        *((move.astype("<f4"), "VEC3", 34962) for move in moves),
        (times.astype("<f4"), "SCALAR", None),
        (weights.reshape(-1).astype("<f4"), "SCALAR", None),
    ]
    views, accessors = _described(arrays)
    last = len(arrays)
    primitive = {"attributes": {"POSITION": 1}, "indices": 0, "material": 0,
                 "targets": [{"POSITION": 2 + k} for k in range(len(frames))]}  # fmt: skip
    channel = {"sampler": 0, "target": {"node": 0, "path": "weights"}}
    tree = {
        "asset": {"version": "2.0", "generator": "lce-molds"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"name": "sheet", "mesh": 0, "rotation": [-np.sqrt(0.5), 0, 0, np.sqrt(0.5)], "scale": [1e-3] * 3}],
        "meshes": [{"primitives": [primitive], "weights": [0.0] * len(frames)}],
        "materials": [{"doubleSided": True, "pbrMetallicRoughness": {"baseColorFactor": COLOUR, "metallicFactor": 0}}],
        "animations": [
            {"name": "heating", "channels": [channel], "samplers": [{"input": last - 2, "output": last - 1}]}
        ],
        "bufferViews": views,
        "accessors": accessors,
        "buffers": [{"byteLength": sum(array.nbytes for array, *_ in arrays)}],
    }
    path.write_bytes(_container(tree, b"".join(array.tobytes() for array, *_ in arrays)))


def _described(arrays: list[tuple[NDArray[Any], str, int | None]]) -> tuple[list[Any], list[Any]]:
    """Buffer views and accessors of arrays that follow each other; all are of 4-byte numbers, so all are aligned."""
    views, accessors, offset = [], [], 0
    for k, (array, kind, target) in enumerate(arrays):
        views.append(
            {"buffer": 0, "byteOffset": offset, "byteLength": array.nbytes} | ({"target": target} if target else {})
        )
        low, high = (np.atleast_1d(f(array, axis=0)).tolist() for f in (np.min, np.max))
        component = UNSIGNED if array.dtype.kind == "u" else FLOAT
        accessors.append(
            {"bufferView": k, "componentType": component, "count": len(array), "type": kind, "min": low, "max": high}
        )
        offset += array.nbytes
    return views, accessors


def _container(tree: dict[str, Any], data: bytes) -> bytes:
    """A GLB file."""
    text = json.dumps(tree, separators=(",", ":")).encode()
    text += b" " * (-len(text) % 4)
    chunks = struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(data), b"BIN\0") + data
    return struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks
