"""The grey relief of a plate as the laser writes it: rounded channels instead of the prisms' sharp corners.

Approximate, one model for all steps of the process: the writing spot is a Gaussian of 1/e2 diameter d, so the dose is
the binary pattern convolved with a normal distribution of deviation sigma = d / 4; dose 1 is that in the middle of a
wide pad and clears the whole depth. The resist answers with D^g / (D^g + (1 - D)^g), g its contrast: 1 is a linear
(grey-tone) resist, large g a threshold at half the dose. Diffraction, reflow and the shrinkage of casts are left out.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.special import erf

from lce_solver.types import Floats
from lce_workbench.core.channels import Channels
from lce_workbench.core.frame import Rect
from lce_workbench.core.job import RELIEF_UM, Output
from lce_workbench.core.units import NM, UM

REACH = 6.0
"""The dose of a channel is left out so many deviations away from it (1e-9 of it)."""


@dataclass(frozen=True, eq=False)
class Relief:
    """Heights on a grid of square pixels, in sheet coordinates seen from above."""

    x: Floats
    """(nx,) middles of the pixels [mm]."""
    y: Floats
    """(ny,) the same, ascending [mm]."""
    height: Floats
    """(ny, nx) above the land's face, from -depth to 0, away from the plate's body [mm]."""
    depth: float
    """Of a wide pad [mm]."""


def relief(channels: Channels, window: Rect, output: Output) -> Relief:
    """The surface of a plate in a window.

    Parameters
    ----------
    channels : all that come within `REACH` deviations of the window.
    """
    pixel = output.relief_pixel_nm * NM
    x, y = (_middles(low, high, pixel) for low, high in ((window.x0, window.x1), (window.y0, window.y1)))
    found = dose(channels, x, y, output.relief_spot_um * UM / 4)
    return Relief(x, y, -channels.depth * cleared(found, output.relief_contrast), channels.depth)


def _middles(low: float, high: float, pixel: float) -> Floats:
    return low + pixel * (np.arange(max(1, round((high - low) / pixel))) + np.float64(0.5))


def dose(channels: Channels, x: Floats, y: Floats, sigma: float) -> Floats:
    """(ny, nx) the pattern convolved with the spot, in closed form: a product of error functions for each rectangle."""
    found = np.zeros((len(y), len(x)))
    angle = channels.angle[channels.domain]
    along = np.column_stack([np.cos(angle), np.sin(angle)])
    half = np.abs(along) * channels.length[:, None] / 2 + np.abs(along[:, ::-1]) * channels.width / 2 + REACH * sigma
    low, high = channels.centre - half, channels.centre + half
    columns, rows = (np.searchsorted(grid, [low[:, i], high[:, i]]).T for i, grid in enumerate((x, y)))
    for k in range(len(channels)):
        (i, j), (m, n) = columns[k].tolist(), rows[k].tolist()
        u, v = x[i:j] - channels.centre[k, 0], (y[m:n] - channels.centre[k, 1])[:, None]
        c, s = along[k]
        found[m:n, i:j] += _box(c * u + s * v, channels.length[k], sigma) * _box(c * v - s * u, channels.width, sigma)
    return found


def _box(t: Floats, size: float, sigma: float) -> Floats:
    """An interval of this size about 0, convolved with a normal distribution."""
    root = np.sqrt(2.0) * sigma
    return np.asarray(erf((t + size / 2) / root) - erf((t - size / 2) / root)) / 2


def cleared(dose: Floats, contrast: float) -> Floats:
    """Share of the depth that a dose clears."""
    kept, gone = np.clip(1 - dose, 0, 1) ** contrast, np.clip(dose, 0, 1) ** contrast
    return np.asarray(gone / (gone + kept))


def near(channels: Channels, window: Rect, sigma: float) -> Channels:
    """Those whose dose reaches into the window, by their middles and half-lengths."""
    grown = window.grown(REACH * sigma, REACH * sigma)
    half = (channels.length + channels.width)[:, None] / 2
    corners = np.array([(grown.x0, grown.y0), (grown.x1, grown.y1)])
    keep = np.all((channels.centre + half > corners[0]) & (channels.centre - half < corners[1]), axis=1)
    names = ("centre", "length", "domain")
    return replace(channels, **{name: getattr(channels, name)[keep] for name in names})


def window_of(output: Output, centre: Floats) -> Rect:
    """The job's window, or a square of 30 um about ``centre`` (2,)."""
    if output.step_window_um:
        (x0, y0), (x1, y1) = np.sort(np.array(output.step_window_um).reshape(2, 2), axis=0) * UM
        return Rect(float(x0), float(y0), float(x1), float(y1))
    x, y = centre.tolist()
    return Rect(x, y, x, y).grown(RELIEF_UM * UM / 2, RELIEF_UM * UM / 2)
