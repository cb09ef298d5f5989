"""CIF: one symbol of polygons on a 1 nm grid (symbol scale 1/10 of the format's 10 nm), streamed in blocks."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from lce_workbench.core.digits import Texts, integers, lines
from lce_workbench.core.mask import Mask, Nanometres

LAYERS = {
    "CHANNELS": "CHAN",
    "MARKS": "MARK",
    "LABELS": "LABL",
    "TEST": "TEST",
    "PLATE": "PLAT",
    "DOMAINS": "DOMN",
    "SPACER": "SPCR",
    "SEAM": "SEAM",
}
"""The format's layer names have at most four characters."""


def write(mask: Mask, path: Path) -> None:
    """Write ``mask`` to ``path``.

    Raises
    ------
    OSError
        The file cannot be written.
    """
    with path.open("wb") as file:
        file.write(f"DS 1 1 10;\n9 {mask.name};\n".encode())
        for name, groups in mask.layers.items():
            file.write(f"L {LAYERS[name]};\n".encode())
            file.writelines(_polygons(polygons) for polygons in groups if len(polygons))
        file.write(b"DF;\nC 1;\nE\n")


def _polygons(polygons: Nanometres) -> bytes:
    """P commands of polygons (n, k, 2) [nm]."""
    texts = integers(polygons).reshape(len(polygons), -1)
    pieces: list[bytes | Texts] = [b"P"]
    for column in texts.T:
        pieces += [b" ", np.ascontiguousarray(column)]
    return lines([*pieces, b";\n"])
