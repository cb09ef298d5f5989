"""The grey relief as a 16-bit height map (PNG) with its scale beside it (JSON)."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np

from lce_workbench.core.job import Output
from lce_workbench.core.relief import Relief
from lce_workbench.core.units import NM, UM

WHITE = 65535
"""The land's face; 0 is the full depth."""

INCH = 25.4
"""[mm]."""


def write_relief(relief: Relief, output: Output, path: Path) -> None:
    """Write ``path``, a PNG, and its JSON. Row 0 is the largest y; brighter is higher, as in an AFM picture.

    Raises
    ------
    OSError
        A file cannot be written.
    """
    from PIL import Image
    from PIL.PngImagePlugin import PngInfo

    scale = scale_of(relief, output)
    grey = np.rint((1 + relief.height / relief.depth) * WHITE).astype(np.uint16)
    text = PngInfo()
    text.add_text("Comment", json.dumps(scale))
    dots = INCH / (output.relief_pixel_nm * NM)
    Image.fromarray(grey[::-1]).save(path, pnginfo=text, dpi=(dots, dots))
    path.with_suffix(".json").write_text(json.dumps(scale, indent=1) + "\n", encoding="ascii")


def scale_of(relief: Relief, output: Output) -> dict[str, float | str]:
    """What turns grey values into nanometres and pixels into micrometres."""
    half = output.relief_pixel_nm * NM / 2
    return {
        "pixel_um": output.relief_pixel_nm / 1000,
        "left_um": round((float(relief.x[0]) - half) / UM, 6),
        "bottom_um": round((float(relief.y[0]) - half) / UM, 6),
        "height_nm_at_0": -round(relief.depth / NM, 6),
        "height_nm_at_65535": 0.0,
        "spot_um": output.relief_spot_um,
        "contrast": output.relief_contrast,
        "note": "approximate: Gaussian spot and resist curve, see lce_workbench/core/relief.py; seen from above, the "
        "sheet's middle is 0, 0; height 0 is the land's face",
    }
