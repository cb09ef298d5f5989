"""Functions of one variable as Chebyshev series: integrals and inverses to rounding, for real and complex arguments."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.polynomial import Chebyshev
from numpy.typing import NDArray
from scipy.optimize import brentq

Numbers = NDArray[Any]
"""Real or complex array: complex where a derivative is taken."""
Profile = Callable[[Numbers], Numbers]
"""An analytic function of one coordinate, elementwise."""
Span = tuple[float, float]

DEGREES = (15, 31, 63, 127, 255)
"""Tried in turn; odd, so that no node falls on the middle, where a disk has its centre."""


def interpolant(function: Profile, span: Span) -> Chebyshev:
    """Series of ``function`` on ``span``, of the lowest degree that reaches rounding."""
    for degree in DEGREES:
        series = Chebyshev.interpolate(function, degree, domain=list(span))
        size = np.abs(series.coef)
        if size[-4:].max() <= 1e-14 * size.max():
            break
    return series.trim(1e-15 * size.max())


def integral(function: Profile, span: Span) -> Profile:
    """Integral of ``function`` from the middle of ``span``; square roots that vanish at its ends do no harm."""
    mid, half = (span[0] + span[1]) / 2, (span[1] - span[0]) / 2
    series = interpolant(lambda t: function(mid + half * np.sin(t)) * half * np.cos(t), (-np.pi / 2, np.pi / 2)).integ()
    return lambda q: series(np.arcsin((q - mid) / half)) - series(0.0)


def inverse(function: Profile, span: Span) -> tuple[Chebyshev, Span]:
    """Inverse of a function that grows on ``span``, and the range on which it is defined."""
    lo, hi = (float(function(np.array(end))) for end in span)

    def roots(values: Numbers) -> Numbers:
        return np.array([brentq(lambda p, v=v: float(function(np.array(p))) - v, *span, xtol=1e-15) for v in values])

    return interpolant(roots, (lo, hi)), (lo, hi)


@dataclass(frozen=True, eq=False)
class Meridian:
    """Profile curve of a surface of revolution."""

    radius: Chebyshev
    """Distance from the axis at the curve's parameter p."""
    height: Chebyshev
    span: Span
    """Range of p."""

    @classmethod
    def of(cls, radius: Profile, height: Profile, span: Span) -> Meridian:
        """Meridian of two analytic functions of p."""
        return cls(interpolant(radius, span), interpolant(height, span), span)

    def speed(self, p: Numbers) -> Numbers:
        """Arc length per unit of p."""
        return np.sqrt(self.radius.deriv()(p) ** 2 + self.height.deriv()(p) ** 2)

    def gaussian(self, p: Numbers) -> Numbers:
        """Gauss curvature of the surface."""
        r1, z1, r2, z2 = (f(p) for f in (*map(Chebyshev.deriv, self.curves), *(f.deriv(2) for f in self.curves)))
        curvature: Numbers = z1 * (r1 * z2 - z1 * r2) / (self.radius(p) * (r1**2 + z1**2) ** 2)
        return curvature

    @property
    def curves(self) -> tuple[Chebyshev, Chebyshev]:
        """Radius and height."""
        return self.radius, self.height
