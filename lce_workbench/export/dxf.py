"""DXF in um with 3 decimals (1 nm), streamed in blocks: R2000 LWPOLYLINE for CAD, R12 POLYLINE for the writer.

All outlines are closed. ezdxf makes the R2000 document around the polygons (header, tables, layers); R12 needs so
little that it stands here. R12 has no unit: the job sheet says um.
"""

from __future__ import annotations

import io
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np

from lce_workbench.core.digits import Texts, hexadecimals, lines, thousandths
from lce_workbench.core.mask import LAYERS, Mask, Nanometres

MICRONS = 13
"""$INSUNITS of um."""

EMPTY_ENTITIES = "  2\nENTITIES\n"
"""Where the R2000 document is opened for the polygons."""


def write(mask: Mask, path: Path) -> None:
    """Write ``mask`` to ``path`` as R2000, each polygon on the layer of its name.

    Raises
    ------
    OSError
        The file cannot be written.
    """
    before, after, owner, handle = _document(mask)
    tail = f"330\n{owner}\n100\nAcDbEntity\n  8\n"

    def polylines(polygons: Nanometres, layer: str) -> bytes:
        nonlocal handle
        handles = hexadecimals(np.arange(handle, handle + len(polygons)))
        handle += len(polygons)
        head = f"\n{tail}{layer}\n100\nAcDbPolyline\n 90\n{polygons.shape[1]}\n 70\n1"
        pieces: list[bytes | Texts] = [b"  0\nLWPOLYLINE\n  5\n", handles, head.encode()]
        return lines([*pieces, *_corners(polygons, b""), b"\n"])

    _stream(mask, path, before.encode(), polylines, after.encode())


def write_r12(mask: Mask, path: Path) -> None:
    """Write ``mask`` to ``path`` as R12, each polygon on the layer of its name.

    Raises
    ------
    OSError
        The file cannot be written.
    """

    def polylines(polygons: Nanometres, layer: str) -> bytes:
        head, vertex = (f"{text}\n8\n{layer}".encode() for text in ("0\nPOLYLINE", "\n0\nVERTEX"))
        return lines([head, b"\n66\n1\n70\n1", *_corners(polygons, vertex), b"\n0\nSEQEND\n"])

    _stream(mask, path, _r12_head(mask).encode(), polylines, b"0\nENDSEC\n0\nEOF\n")


def _stream(mask: Mask, path: Path, before: bytes, polylines: Callable[[Nanometres, str], bytes], after: bytes) -> None:
    with path.open("wb") as file:
        file.write(before)
        for name, groups in mask.layers.items():
            file.writelines(polylines(polygons, name) for polygons in groups if len(polygons))
        file.write(after)


def _corners(polygons: Nanometres, head: bytes) -> Iterator[bytes | Texts]:
    """Group codes 10 and 20 of each corner of polygons (n, k, 2), each corner after ``head``."""
    texts = thousandths(polygons)
    for corner in range(polygons.shape[1]):
        yield head + b"\n10\n"
        yield np.ascontiguousarray(texts[:, corner, 0])
        yield b"\n20\n"
        yield np.ascontiguousarray(texts[:, corner, 1])


def _r12_head(mask: Mask) -> str:
    """Header with the extent, one line type, the layers."""
    _, low, high = _survey(mask)
    corners = "".join(f"9\n${n}\n10\n{x:.3f}\n20\n{y:.3f}\n" for n, (x, y) in (("EXTMIN", low), ("EXTMAX", high)))
    layers = "".join(f"0\nLAYER\n2\n{name}\n70\n0\n62\n{color}\n6\nCONTINUOUS\n" for name, color in LAYERS.items())
    return (
        f"0\nSECTION\n2\nHEADER\n9\n$ACADVER\n1\nAC1009\n{corners}0\nENDSEC\n"
        "0\nSECTION\n2\nTABLES\n0\nTABLE\n2\nLTYPE\n70\n1\n"
        "0\nLTYPE\n2\nCONTINUOUS\n70\n0\n3\nSolid line\n72\n65\n73\n0\n40\n0.0\n0\nENDTAB\n"
        f"0\nTABLE\n2\nLAYER\n70\n{len(LAYERS)}\n{layers}0\nENDTAB\n0\nENDSEC\n0\nSECTION\n2\nENTITIES\n"
    )


def _document(mask: Mask) -> tuple[str, str, str, int]:
    """Text before and after the polygons, handle of the model space that owns them, their first free handle."""
    import ezdxf

    count, low, high = _survey(mask)
    stream = io.StringIO()
    with fixed_stamps():
        document = ezdxf.new("R2000", units=MICRONS)
        for name, number in LAYERS.items():
            document.layers.add(name, color=number)
        document.modelspace().reset_extents((*low, 0.0), (*high, 0.0))
        document.set_modelspace_vport(height=1.1 * max(high - low), center=tuple((low + high) / 2))
        handles = document.entitydb.handles
        first = int(str(handles), 16)
        handles.reset(f"{first + count:X}")  # $HANDSEED comes after the polygons
        document.write(stream)
    before, mark, after = stream.getvalue().partition(EMPTY_ENTITIES)
    return before + mark, after, document.modelspace().layout_key, first


@contextmanager
def fixed_stamps() -> Iterator[None]:
    """Make ezdxf write fixed time stamps and identifiers, so that the bytes depend on the mask alone."""
    from ezdxf import options

    former, options.write_fixed_meta_data_for_testing = options.write_fixed_meta_data_for_testing, True
    try:
        yield
    finally:
        options.write_fixed_meta_data_for_testing = former


def _survey(mask: Mask) -> tuple[int, np.ndarray, np.ndarray]:
    """Number of polygons, lower left and upper right corner (2,) of everything [um]."""
    count, low, high = 0, np.full(2, np.inf), np.full(2, -np.inf)
    for polygons in (polygons for layer in mask.layers.values() for polygons in layer if len(polygons)):
        count += len(polygons)
        low = np.minimum(low, [polygons[..., i].min() for i in (0, 1)])  # by component: many times as fast
        high = np.maximum(high, [polygons[..., i].max() for i in (0, 1)])
    return count, low / 1000, high / 1000
