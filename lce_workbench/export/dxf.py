"""DXF R2000: closed LWPOLYLINEs in um with 3 decimals (1 nm), streamed in blocks.

ezdxf makes the document around them (header, tables, layers); the entities, a million of them, are formatted in bulk.
"""

from __future__ import annotations

import io
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np

from lce_workbench.core.mask import LAYERS, Mask, Nanometres

BLOCK = 8192
"""Polygons formatted at once."""

MICRONS = 13
"""$INSUNITS of um."""

EMPTY_ENTITIES = "  2\nENTITIES\n"
"""Where the document is opened for the polygons."""


def write(mask: Mask, path: Path) -> None:
    """Write ``mask`` to ``path``, each polygon on the layer of its name.

    Raises
    ------
    OSError
        The file cannot be written.
    """
    count = sum(len(polygons) for groups in mask.layers.values() for polygons in groups)
    before, after, owner, handle = _document(mask, count)
    with path.open("w", encoding="ascii", newline="\n") as file:
        file.write(before)
        for name, groups in mask.layers.items():
            for polygons in groups:
                for start in range(0, len(polygons), BLOCK):
                    block = polygons[start : start + BLOCK]
                    file.write(_polylines(block, name, owner, handle))
                    handle += len(block)
        file.write(after)


def _document(mask: Mask, count: int) -> tuple[str, str, str, int]:
    """Text before and after the polygons, handle of the model space that owns them, first of ``count`` free handles."""
    import ezdxf

    stream = io.StringIO()
    with _fixed_stamps():
        document = ezdxf.new("R2000", units=MICRONS)
        for name, number in LAYERS.items():
            document.layers.add(name, color=number)
        low, high = _extent(mask)
        document.modelspace().reset_extents((*low, 0.0), (*high, 0.0))
        document.set_modelspace_vport(height=1.1 * max(high - low), center=tuple((low + high) / 2))
        handles = document.entitydb.handles
        first = int(str(handles), 16)
        handles.reset(f"{first + count:X}")  # $HANDSEED comes after the polygons
        document.write(stream)
    before, mark, after = stream.getvalue().partition(EMPTY_ENTITIES)
    return before + mark, after, document.modelspace().layout_key, first


@contextmanager
def _fixed_stamps() -> Iterator[None]:
    """Make ezdxf write fixed time stamps and identifiers, so that the bytes depend on the mask alone."""
    from ezdxf import options

    former, options.write_fixed_meta_data_for_testing = options.write_fixed_meta_data_for_testing, True
    try:
        yield
    finally:
        options.write_fixed_meta_data_for_testing = former


def _extent(mask: Mask) -> tuple[np.ndarray, np.ndarray]:
    """Lower left and upper right corner (2,) of everything [um]."""
    groups = [polygons for layer in mask.layers.values() for polygons in layer if len(polygons)]
    low = np.min([polygons.min(axis=(0, 1)) for polygons in groups], axis=0)
    high = np.max([polygons.max(axis=(0, 1)) for polygons in groups], axis=0)
    return low / 1000, high / 1000


def _polylines(polygons: Nanometres, layer: str, owner: str, handle: int) -> str:
    """LWPOLYLINE entities of polygons (n, k, 2) [nm]."""
    n, k, _ = polygons.shape
    entity = (
        f"  0\nLWPOLYLINE\n  5\n%X\n330\n{owner}\n100\nAcDbEntity\n  8\n{layer}\n"
        f"100\nAcDbPolyline\n 90\n{k}\n 70\n1\n" + " 10\n%.3f\n 20\n%.3f\n" * k
    )
    values = np.empty((n, 2 * k + 1), dtype=object)
    values[:, 0] = range(handle, handle + n)
    values[:, 1:] = polygons.reshape(n, 2 * k) / 1000
    return (entity * n) % tuple(values.ravel().tolist())
