"""Values as colours, with the scale that a legend shows. No matplotlib: FreeCAD's Python may lack it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from lce_solver.types import Floats

MAPS: dict[str, tuple[tuple[float, float, float], ...]] = {
    # blue, dark, orange: both signs and zero are seen on a pale sheet
    "signed": ((0.00, 0.45, 0.80), (0.08, 0.30, 0.48), (0.16, 0.16, 0.18), (0.52, 0.27, 0.06), (0.90, 0.40, 0.00)),
    # matplotlib's twilight, turned so that 0 and 90 degrees have its colours, as the review's maps have
    "cyclic": (
        (0.70, 0.35, 0.32), (0.78, 0.55, 0.43), (0.83, 0.74, 0.68), (0.89, 0.85, 0.89), (0.70, 0.78, 0.81),
        (0.49, 0.63, 0.76), (0.38, 0.46, 0.73), (0.37, 0.26, 0.65), (0.31, 0.10, 0.44), (0.19, 0.08, 0.22),
        (0.34, 0.08, 0.28), (0.56, 0.17, 0.31), (0.70, 0.35, 0.32),
    ),
    # matplotlib's viridis
    "sequential": (
        (0.27, 0.00, 0.33), (0.28, 0.18, 0.48), (0.23, 0.32, 0.55), (0.17, 0.45, 0.56), (0.13, 0.57, 0.55),
        (0.15, 0.68, 0.51), (0.37, 0.79, 0.38), (0.68, 0.86, 0.19), (0.99, 0.91, 0.14),
    ),
}  # fmt: skip
"""Kind of values -> colours at even distances, safe for the colour-blind (red, green, blue in [0, 1], sRGB)."""


@dataclass(frozen=True)
class Scale:
    """What colours mean."""

    title: str
    unit: str
    low: float
    high: float
    kind: str
    """Key of `MAPS`."""

    def colours(self, values: Floats) -> NDArray[np.float32]:
        """(n, 3) red, green and blue of ``values`` (n,); what is out of the scale has the colour of its end."""
        anchors = np.array(MAPS[self.kind])
        span = self.high - self.low
        place = np.clip((np.asarray(values) - self.low) / (span or 1.0), 0, 1) * (len(anchors) - 1)
        at = np.arange(len(anchors))
        return np.stack([np.interp(place, at, channel) for channel in anchors.T], axis=-1).astype(np.float32)


def packed(colours: Any) -> NDArray[np.uint32]:
    """(n,) colours (n, 3) as red, green, blue and full opacity in one number each."""
    parts = np.round(255 * np.asarray(colours)).astype(np.uint32)
    found: NDArray[np.uint32] = parts[..., 0] << 24 | parts[..., 1] << 16 | parts[..., 2] << 8 | 255
    return found
