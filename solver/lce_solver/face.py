"""The demo's target: a human face as a height field, a sum of Gaussian strokes on a vaulted oval.

x runs to the viewer's right, y up, z towards the viewer. The face is 1 high and symmetric in x.
"""

from __future__ import annotations

import numpy as np

from lce_solver.mesher import mesh
from lce_solver.types import Floats, Surface

Point = tuple[float, float]
Stroke = tuple[Point, Point, Point, tuple[float, float, float], tuple[float, float]]
"""Start, control point and end of a quadratic Bezier curve; height there at start, middle, end; width at start and end
(standard deviations across the curve)."""

MIDDLE: dict[str, Stroke] = {
    # name: start, control, end; heights; widths
    "forehead": ((-0.07, 0.31), (0.0, 0.33), (0.07, 0.31), (0.020, 0.022, 0.020), (0.10, 0.10)),
    "nose bridge": ((0.0, 0.13), (0.0, 0.02), (0.0, -0.090), (0.020, 0.052, 0.070), (0.029, 0.044)),
    "nose tip": ((0.0, -0.10), (0.0, -0.105), (0.0, -0.11), (0.028, 0.028, 0.028), (0.039, 0.039)),
    "philtrum": ((0.0, -0.185), (0.0, -0.20), (0.0, -0.235), (-0.005, -0.006, -0.004), (0.016, 0.016)),
    "muzzle": ((-0.05, -0.28), (0.0, -0.28), (0.05, -0.28), (0.030, 0.036, 0.030), (0.060, 0.060)),
    "upper lip": ((-0.085, -0.272), (0.0, -0.232), (0.085, -0.272), (0.002, 0.017, 0.002), (0.019, 0.019)),
    "mouth line": ((-0.110, -0.288), (0.0, -0.277), (0.110, -0.288), (-0.008, -0.019, -0.008), (0.015, 0.015)),
    "lower lip": ((-0.070, -0.300), (0.0, -0.342), (0.070, -0.300), (0.002, 0.021, 0.002), (0.021, 0.021)),
    "chin groove": ((-0.05, -0.372), (0.0, -0.367), (0.05, -0.372), (-0.005, -0.012, -0.005), (0.026, 0.026)),
    "chin": ((-0.04, -0.425), (0.0, -0.435), (0.04, -0.425), (0.036, 0.044, 0.036), (0.050, 0.050)),
}
RIGHT: dict[str, Stroke] = {
    # these are mirrored to the left
    "brow": ((0.05, 0.165), (0.15, 0.230), (0.27, 0.135), (0.018, 0.030, 0.014), (0.030, 0.034)),
    "socket": ((0.10, 0.090), (0.15, 0.095), (0.20, 0.085), (-0.042, -0.038, -0.024), (0.045, 0.045)),
    "eyeball": ((0.130, 0.084), (0.15, 0.086), (0.170, 0.084), (0.036, 0.040, 0.036), (0.033, 0.033)),
    "upper lid": ((0.080, 0.072), (0.15, 0.148), (0.225, 0.068), (-0.004, -0.010, -0.003), (0.0145, 0.0145)),
    "lower lid": ((0.085, 0.068), (0.15, 0.022), (0.220, 0.064), (-0.003, -0.008, -0.003), (0.0145, 0.0145)),
    "wing": ((0.062, -0.120), (0.064, -0.130), (0.060, -0.14), (0.022, 0.023, 0.021), (0.023, 0.023)),
    "nostril": ((0.026, -0.168), (0.030, -0.168), (0.034, -0.168), (-0.011, -0.011, -0.011), (0.018, 0.018)),
    "cheekbone": ((0.15, -0.02), (0.20, 0.0), (0.27, 0.04), (0.026, 0.030, 0.022), (0.055, 0.050)),
    "cheek": ((0.16, -0.12), (0.19, -0.16), (0.18, -0.20), (0.012, 0.012, 0.010), (0.055, 0.055)),
    "smile line": ((0.092, -0.135), (0.12, -0.18), (0.148, -0.26), (-0.010, -0.010, -0.006), (0.020, 0.024)),
    "mouth corner": ((0.118, -0.288), (0.122, -0.290), (0.126, -0.292), (-0.006, -0.006, -0.006), (0.020, 0.020)),
    "temple": ((0.28, 0.22), (0.29, 0.25), (0.29, 0.28), (-0.015, -0.015, -0.015), (0.06, 0.06)),
}


def face(edge: float) -> Surface:
    """The face. Its narrowest strokes (lids, mouth line) are about one edge wide at ``edge = 0.0175``."""

    def embed(xy: Floats) -> Floats:
        return np.column_stack([xy, height(xy)])

    return mesh(embed, outline, edge)


def outline(t: Floats) -> Floats:
    """The oval of the face: forehead broad, chin narrow."""
    turn = 2 * np.pi * t
    x, y = np.cos(turn), np.sin(turn)
    return np.column_stack([0.36 * x * (1 + 0.12 * y - 0.05 * y**2), 0.5 * y])


def height(xy: Floats) -> Floats:
    """(n,) height of the face over the points ``xy`` (n, 2)."""
    z = _vault(xy)
    for at, high, width in zip(*_SPOTS, strict=True):
        z += high * np.exp(-np.sum((xy - at) ** 2, axis=1) / (2 * width**2))
    return np.asarray(z)


def _vault(xy: Floats) -> Floats:
    """The skull without features: flat in front, turning back towards the ears."""
    x, y = (xy / (0.36, 0.5)).T
    return np.asarray(-0.105 * x**2 - 0.055 * x**4 - 0.03 * y**2 - 0.04 * y**4)


def _spots(stroke: Stroke) -> tuple[Floats, Floats, Floats]:
    """Round Gaussians along a stroke, so close that their sum has no ripple: points (k, 2), heights, widths (k,)."""
    *ends, heights, widths = stroke
    start, control, end = np.array(ends)
    length = float(np.linalg.norm(control - start) + np.linalg.norm(end - control))
    n = int(np.ceil(length / (1.3 * min(widths)))) + 1
    t = np.linspace(0, 1, n)[:, None]
    at = (1 - t) ** 2 * start + 2 * t * (1 - t) * control + t**2 * end
    width = np.interp(t[:, 0], (0, 1), widths)
    # overlapping neighbours add up: normalise so that the ridge of a long stroke has the stated height
    gap = max(length / (n - 1), 1e-9)
    overlap = np.exp(-((np.arange(-8, 9)[:, None] * gap) ** 2) / (2 * width**2))
    inside = np.abs(np.arange(-8, 9)) <= n - 1
    return at, np.interp(t[:, 0], (0, 0.5, 1), heights) / overlap[inside].sum(axis=0), width


def _all_spots() -> tuple[Floats, Floats, Floats]:
    right = [_spots(stroke) for stroke in RIGHT.values()]
    left = [(at * (-1, 1), high, width) for at, high, width in right]
    at, high, width = zip(*[_spots(stroke) for stroke in MIDDLE.values()], *right, *left, strict=True)
    return np.concatenate(at), np.concatenate(high), np.concatenate(width)


_SPOTS = _all_spots()
