"""Several finished masks on one plate of the laser writer: our own GDSII read and moved in blocks, never in memory."""

from __future__ import annotations

import struct
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO

import numpy as np
from numpy.typing import NDArray

from lce_solver.errors import InputError
from lce_workbench.core.mask import LAYERS, Nanometres
from lce_workbench.export import gdsii

DICING = 14
"""Layer of the lines where the finished plate is cut; not exposed."""

NAME = "LCE_PLATE"

STREET = 1.0
"""Between two designs [mm]; the saw runs in its middle."""

SAW = 0.1
"""Width of a dicing line [mm]."""

MARGIN = 5.0
"""Free rim of the writer's plate [mm]."""

CHUNK = 65_536
"""Polygons in memory at once."""

HEAD = 16
"""Bytes before the XY record of one of our polygons."""


@dataclass(frozen=True)
class Piece:
    """One mask of one design."""

    design: str
    plate: str
    path: Path
    size: tuple[float, float]
    """Of its glass [mm]."""


@dataclass(frozen=True)
class Placed:
    """A mask with the place of its middle on the common plate [mm]."""

    piece: Piece
    x: float
    y: float


def polygons(path: Path) -> Iterator[tuple[int, Nanometres]]:
    """Layer and polygons (n, k, 2) [nm] of a mask that `gdsii.write` wrote, in its order.

    Raises
    ------
    InputError
        The file is not such a mask.
    """
    with path.open("rb") as file:
        while kind := _passed(file):
            if kind == gdsii.ENDSTR:
                return
            if kind == gdsii.STRNAME:
                yield from _elements(file, path)
    raise _strange(path)


def _passed(file: BinaryIO) -> int:
    """Type of the next record, which is passed over; 0 at the end."""
    start = file.read(4)
    if len(start) < 4:
        return 0
    size, kind = struct.unpack(">HH", start)
    file.seek(size - 4, 1)
    return int(kind)


def _elements(file: BinaryIO, path: Path) -> Iterator[tuple[int, Nanometres]]:
    """Runs of polygons with as many corners on one layer, up to the cell's end."""
    read, seek = file.read, file.seek
    while (start := read(HEAD + 4))[2:4] == struct.pack(">H", gdsii.BOUNDARY):
        size, kind = struct.unpack(">HH", start[HEAD:])
        if kind != gdsii.XY or (size - 4) % 8:
            raise _strange(path)
        corners = (size - 4) // 8
        element = np.dtype([("head", "V20"), ("xy", ">i4", (corners, 2)), ("end", ">u2", (2,))])
        seek(-len(start), 1)
        data = read(CHUNK * element.itemsize)
        found = np.frombuffer(data, element, len(data) // element.itemsize)
        run = _run(found, start)
        seek(run * element.itemsize - len(data), 1)
        yield struct.unpack(">H", start[8:10])[0], found["xy"][:run, :-1].astype(np.int32)
    seek(-len(start), 1)


def _run(found: NDArray[np.void], start: bytes) -> int:
    """How many elements from the first on have its head."""
    same = found["head"].view("V20") == np.frombuffer(start, "V20")[0]
    return len(found) if same.all() else int(np.argmin(same))


def _strange(path: Path) -> InputError:
    return InputError(f"{path} is not a mask of ours; give output folders of `./lce build`, unchanged")


def arranged(pieces: Sequence[Piece], side: float) -> list[Placed]:
    """Places in rows, the highest first, on a square plate of ``side`` [mm].

    Raises
    ------
    InputError
        They do not fit.
    """
    free = side / 2 - MARGIN
    x, y, row, placed = -free, free, 0.0, list[Placed]()
    for piece in sorted(pieces, key=lambda p: (-p.size[1], p.design, p.plate)):
        width, height = (length + STREET for length in piece.size)
        if x + width > free:
            x, y, row = -free, y - row, 0.0
        if x + width > free or y - height < -free:
            msg = (
                f"{piece.design} {piece.plate} ({piece.size[0]:g} x {piece.size[1]:g} mm) does not fit on the plate of "
                f"{side:g} mm beside the others ({STREET:g} mm streets, {MARGIN:g} mm rim); take a larger --size or "
                "fewer designs"
            )
            raise InputError(msg)
        placed.append(Placed(piece, x + width / 2, y - height / 2))
        x, row = x + width, max(row, height)
    return placed


def write(placed: Sequence[Placed], side: float, path: Path) -> int:
    """Write all masks as one flat cell, with dicing lines and the plate's outline; the number of polygons.

    Raises
    ------
    OSError
        The file cannot be written.
    """
    count = 0
    with path.open("wb") as file:
        file.write(gdsii.opening(NAME))
        for item in placed:
            shift = np.rint(np.array([item.x, item.y]) * 1e6).astype(np.int32)
            for layer, found in polygons(item.piece.path):
                file.write(gdsii.boundaries(found + shift, layer).tobytes())
                count += len(found)
            file.write(gdsii.boundaries(_saw(item), DICING).tobytes())
        half = round(side / 2 * 1e6)
        outline = np.array([[(-half, -half), (half, -half), (half, half), (-half, half)]], dtype=np.int32)
        file.write(gdsii.boundaries(outline, LAYERS["PLATE"]).tobytes())
        file.write(gdsii.closing())
    return count


def _saw(item: Placed) -> Nanometres:
    """Four lines (4, 4, 2) around a mask, in the middle of the streets; they meet without overlapping [nm]."""
    x, y = ((length + STREET) / 2 for length in item.piece.size)
    boxes = [(-x - SAW / 2, s * y - SAW / 2, x + SAW / 2, s * y + SAW / 2) for s in (-1, 1)]
    boxes += [(s * x - SAW / 2, -y + SAW / 2, s * x + SAW / 2, y - SAW / 2) for s in (-1, 1)]
    ring = np.array([[(a, b), (c, b), (c, d), (a, d)] for a, b, c, d in boxes]) + np.array([item.x, item.y])
    return np.rint(ring * 1e6).astype(np.int32)
