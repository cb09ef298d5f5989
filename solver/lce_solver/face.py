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
    # name: (start, control, end), heights, widths
    "forehead": ((-0.07, 0.33), (0.0, 0.35), (0.07, 0.33), (0.02, 0.02, 0.02), (0.10, 0.10)),
    "nose bridge": ((0.0, 0.13), (0.0, 0.02), (0.0, -0.095), (0.022, 0.055, 0.075), (0.026, 0.036)),
    "nose tip": ((0.0, -0.10), (0.0, -0.11), (0.0, -0.12), (0.022, 0.022, 0.022), (0.032, 0.032)),
    "philtrum": ((0.0, -0.185), (0.0, -0.20), (0.0, -0.235), (-0.006, -0.006, -0.006), (0.013, 0.013)),
    "muzzle": ((-0.06, -0.28), (0.0, -0.28), (0.06, -0.28), (0.03, 0.035, 0.03), (0.055, 0.055)),
    "upper lip": ((-0.085, -0.272), (0.0, -0.238), (0.085, -0.272), (0.004, 0.020, 0.004), (0.015, 0.015)),
    "mouth line": ((-0.125, -0.288), (0.0, -0.276), (0.125, -0.288), (-0.016, -0.022, -0.016), (0.012, 0.012)),
    "lower lip": ((-0.075, -0.305), (0.0, -0.335), (0.075, -0.305), (0.004, 0.024, 0.004), (0.018, 0.018)),
    "chin groove": ((-0.06, -0.365), (0.0, -0.355), (0.06, -0.365), (-0.010, -0.020, -0.010), (0.022, 0.022)),
    "chin": ((-0.03, -0.43), (0.0, -0.435), (0.03, -0.43), (0.04, 0.045, 0.04), (0.045, 0.045)),
}
RIGHT: dict[str, Stroke] = {
    # the same on both sides
    "brow": ((0.05, 0.165), (0.15, 0.225), (0.27, 0.135), (0.020, 0.034, 0.016), (0.028, 0.030)),
    "socket": ((0.10, 0.095), (0.15, 0.10), (0.20, 0.09), (-0.050, -0.045, -0.030), (0.040, 0.040)),
    "eyeball": ((0.125, 0.088), (0.15, 0.090), (0.175, 0.088), (0.032, 0.036, 0.032), (0.026, 0.026)),
    "upper lid": ((0.085, 0.080), (0.15, 0.155), (0.22, 0.078), (0.006, 0.014, 0.006), (0.012, 0.012)),
    "lower lid": ((0.095, 0.072), (0.15, 0.035), (0.215, 0.074), (0.004, 0.008, 0.004), (0.012, 0.012)),
    "wing": ((0.058, -0.125), (0.060, -0.135), (0.056, -0.15), (0.026, 0.026, 0.022), (0.020, 0.020)),
    "nostril": ((0.020, -0.165), (0.028, -0.168), (0.036, -0.168), (-0.012, -0.012, -0.012), (0.014, 0.014)),
    "cheekbone": ((0.15, -0.02), (0.20, 0.0), (0.27, 0.04), (0.030, 0.030, 0.020), (0.050, 0.045)),
    "cheek": ((0.16, -0.12), (0.19, -0.16), (0.18, -0.20), (0.012, 0.012, 0.010), (0.055, 0.055)),
    "smile line": ((0.088, -0.125), (0.12, -0.17), (0.150, -0.26), (-0.012, -0.012, -0.006), (0.018, 0.020)),
    "mouth corner": ((0.128, -0.288), (0.132, -0.290), (0.136, -0.294), (-0.008, -0.008, -0.008), (0.018, 0.018)),
    "temple": ((0.28, 0.22), (0.29, 0.25), (0.29, 0.28), (-0.015, -0.015, -0.015), (0.05, 0.05)),
}


def face(edge: float) -> Surface:
    """A face with brow, eyes, nose, lips, cheeks and chin, 1 high; features from three edges at ``edge = 0.0175``."""
    return mesh(lambda xy: np.column_stack([xy, height(xy)]), outline, edge)


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
    return -0.085 * x**2 - 0.055 * x**4 - 0.03 * y**2 - 0.04 * y**4


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
