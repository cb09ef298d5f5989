"""GDSII: one flat cell of boundaries on a 1 nm grid, streamed in blocks.

The bytes depend on the mask alone: the time stamps, which the format demands, are fixed.
"""

from __future__ import annotations

import struct
from pathlib import Path

import numpy as np

from lce_workbench.core.mask import LAYERS, Mask, Nanometres

STAMP = (2000, 1, 1, 0, 0, 0) * 2
"""Modification and access time."""

# record type and data type of the records used, GDSII stream format release 6
HEADER, BGNLIB, LIBNAME, UNITS, ENDLIB = 0x0002, 0x0102, 0x0206, 0x0305, 0x0400
BGNSTR, STRNAME, ENDSTR = 0x0502, 0x0606, 0x0700
BOUNDARY, LAYER, DATATYPE, XY, ENDEL = 0x0800, 0x0D02, 0x0E02, 0x1003, 0x1100


def write(mask: Mask, path: Path) -> None:
    """Write ``mask`` to ``path``: database unit 1 nm, user unit 1 um, no text, no references.

    Raises
    ------
    OSError
        The file cannot be written.
    """
    with path.open("wb") as file:
        file.write(opening(mask.name))
        for name, groups in mask.layers.items():
            file.writelines(boundaries(polygons, LAYERS[name]).tobytes() for polygons in groups)
        file.write(closing())


def opening(cell: str) -> bytes:
    """Library and cell heads."""
    stamp = struct.pack(">12H", *STAMP)
    return b"".join(
        (
            _record(HEADER, struct.pack(">H", 600)),
            _record(BGNLIB, stamp),
            _record(LIBNAME, _even(b"LCE")),
            _record(UNITS, _real8(1e-3) + _real8(1e-9)),
            _record(BGNSTR, stamp),
            _record(STRNAME, _even(cell.encode("ascii"))),
        )
    )


def closing() -> bytes:
    """Ends of cell and library."""
    return _record(ENDSTR) + _record(ENDLIB)


def _record(kind: int, data: bytes = b"") -> bytes:
    """One record: length, type, data."""
    return struct.pack(">HH", len(data) + 4, kind) + data


def _even(name: bytes) -> bytes:
    """Strings are padded to an even length."""
    return name + b"\0" * (len(name) % 2)


def _real8(value: float) -> bytes:
    """Eight bytes of the format's real: sign, exponent of 16 in excess 64, 56 bits of fraction in [1/16, 1)."""
    exponent = 64
    while value < 1 / 16:
        value, exponent = value * 16, exponent - 1
    return bytes([exponent]) + round(value * 2**56).to_bytes(7, "big")


def boundaries(polygons: Nanometres, layer: int) -> np.ndarray:
    """BOUNDARY elements of polygons (n, k, 2) as one structured array; the format repeats the first corner."""
    n, k, _ = polygons.shape
    element = np.dtype(
        [("head", ">u2", (8,)), ("xy_head", ">u2", (2,)), ("xy", ">i4", (k + 1, 2)), ("end", ">u2", (2,))], align=False
    )
    records = np.zeros(n, dtype=element)
    records["head"] = (4, BOUNDARY, 6, LAYER, layer, 6, DATATYPE, 0)
    records["xy_head"] = (4 + 8 * (k + 1), XY)
    records["xy"][:, :k] = polygons
    records["xy"][:, k] = polygons[:, 0]
    records["end"] = (4, ENDEL)
    return records
