"""Files of a mask. A new format is one module with ``write(mask, path)`` and one line here."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from lce_workbench.core.mask import Mask
from lce_workbench.export import cif, dxf, gdsii, oasis

EXPORTERS: dict[str, Callable[[Mask, Path], None]] = {
    "gds": gdsii.write,
    "oas": oasis.write,
    "dxf": dxf.write,
    "r12.dxf": dxf.write_r12,
    "cif": cif.write,
}
"""Writer of each format, by file name extension; `OSError` if the file cannot be written."""
