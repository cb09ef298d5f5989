"""OASIS (SEMI P39): one flat cell of polygons on a 1 nm grid, streamed in blocks; the compact archive.

Every polygon is the same row of unsigned integers of 7 bits a byte; the bytes that small numbers do not need go by a
mask. No compressed blocks, so that the bytes depend on the mask alone and not on a version of zlib.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from lce_workbench.core.mask import LAYERS, Mask, Nanometres

MAGIC = b"%SEMI-OASIS\r\n"

# record numbers, point-list type and flags used
START, END, CELL, POLYGON = 1, 2, 14, 21
ANY_DELTAS = 4
POINTS_X_Y, LAYER_DATATYPE = 0b00111000, 0b00000011

END_LENGTH = 256
"""The last record fills as many bytes."""


def write(mask: Mask, path: Path) -> None:
    """Write ``mask`` to ``path``: 1000 grid steps a um, no names but the cell's, no properties.

    Raises
    ------
    OSError
        The file cannot be written.
    """
    with path.open("wb") as file:
        file.write(MAGIC + bytes([START]) + _string("1.0") + bytes([0]) + _unsigned(1000) + bytes(13))
        file.write(bytes([CELL]) + _string(mask.name))
        for name, groups in mask.layers.items():
            file.writelines(_polygons(polygons, LAYERS[name]) for polygons in groups if len(polygons))
        file.write(_end())


def _polygons(polygons: Nanometres, layer: int) -> bytes:
    """POLYGON records of polygons (n, k, 2): layer, datatype, k - 1 steps from corner to corner, first corner."""
    n, k, _ = polygons.shape
    steps = np.diff(polygons, axis=1)
    head = [POLYGON, POINTS_X_Y | LAYER_DATATYPE, layer, 0, ANY_DELTAS, *_unsigned(k - 1)]
    fields = np.empty((n, len(head) + 2 * k), dtype=np.uint32)
    fields[:, : len(head)] = head
    # a step in any direction: the lowest bit says so, the next holds the sign of x; y is an ordinary signed integer
    fields[:, len(head) : -2 : 2] = _signed(steps[..., 0]) << np.uint32(1) | np.uint32(1)
    fields[:, len(head) + 1 : -2 : 2] = _signed(steps[..., 1])
    fields[:, -2:] = _signed(polygons[:, 0])
    return _packed(fields)


def _signed(values: NDArray[np.int32]) -> NDArray[np.uint32]:
    """Signed integers: magnitude above a sign bit."""
    return np.abs(values).astype(np.uint32) << np.uint32(1) | (values < 0).astype(np.uint32)


def _packed(fields: NDArray[np.uint32]) -> bytes:
    """Unsigned integers, seven bits a byte, low first; the high bit says that more follow."""
    octets = np.empty((*fields.shape, 5), dtype=np.uint8)
    needed = np.empty(octets.shape, dtype=bool)
    needed[..., 0] = True
    for place in range(5):  # by place: several times as fast
        rest = fields >> np.uint32(7 * place)
        more = rest > 127
        octets[..., place] = (rest & np.uint32(127)) | more * np.uint32(128)
        needed[..., place + 1 : place + 2] = more[..., None]
    return octets[needed].tobytes()


def _unsigned(value: int) -> bytes:
    return _packed(np.array([value], dtype=np.uint32))


def _string(text: str) -> bytes:
    return _unsigned(len(text)) + text.encode("ascii")


def _end() -> bytes:
    """END with a padding string that makes it 256 bytes, without a checksum."""
    padding = END_LENGTH - 4
    return bytes([END]) + _unsigned(padding) + bytes(padding) + bytes([0])
