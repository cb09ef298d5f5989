"""Whether a smooth director can exist at all: a bound on the length of its lines, known before anything is solved.

Along a director line the splay s obeys ``ds/dl = -s^2 + c``, ``c = K / (lambda^2nu - lambda^-2)``; where c is below
-k^2 it runs to infinity within pi / k. So where the Gauss curvature of the target exceeds K0 > 0 (lambda < 1), no line
is longer than ``pi sqrt((1 - q^-2) / K0)`` on the target, q > 1 the ratio of both stretches; where it is below
-K0 < 0, no line across the director is longer than ``pi sqrt((q^2 - 1) / K0)``. A line through a point reaches at
least as far as the rim of the region, on both sides.
"""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, replace

import igl
import numpy as np

from lce_solver.errors import InputError, SolverError
from lce_solver.geometry import evened
from lce_solver.topology import boundary_loops
from lce_solver.twist import bending_tensor
from lce_solver.types import Finding, Floats, Ints, Material, Severity, Surface

LEVELS = (0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 0.98)
"""Curvatures, as shares of the largest, for which the region beyond is measured."""
TOP = 0.99
"""The largest curvature is this quantile, so that a few odd vertices do not set it."""
SIZES = (1.0, 0.9, 1.1, 0.8, 1.2, 0.7, 1.3, 0.6, 1.4)
"""Tried in turn when distances are prepared."""
EVEN = 4
"""Rounds of averaging that take the noise of the mesh out of its curvature."""


@dataclass(frozen=True, eq=False)
class LengthBound:
    """The tightest place of a target; lengths in the target's unit."""

    curvature: float
    """Gauss curvature that the region around the place has at least, in size [1 / length^2]."""
    length: float
    """Every line through the place is at least this long inside the region."""
    limit: float
    """No smooth line can be longer there."""
    place: Floats
    """(3,) the middle of the region."""

    @property
    def ratio(self) -> float:
        """Above 1 no smooth director exists."""
        return self.length / self.limit


def gaussian_curvature(surface: Surface) -> Floats:
    """(n_v,) Gauss curvature at the vertices, evened out over a few edges [1 / length^2]."""
    form = bending_tensor(surface)
    squares = np.einsum("fij,fji->f", form, form)
    value: Floats = (np.trace(form, axis1=1, axis2=2) ** 2 - squares) / 2
    return evened(surface, value, EVEN)


def longest(curvature: float, material: Material) -> float:
    """Bound on the length of a line, on the target, where the Gauss curvature is ``curvature`` or beyond."""
    q = max(material.along / material.across, material.across / material.along)
    contrast = 1 - q**-2 if curvature > 0 else q**2 - 1
    return float(np.pi * np.sqrt(contrast / abs(curvature)))


def length_bound(surface: Surface, material: Material) -> LengthBound | None:
    """The place of the target where a director line comes closest to the bound; None if the target is flat.

    Distances are geodesic, from the heat method, so good to some per cent.
    """
    curvature = gaussian_curvature(surface)
    distance = _distances(surface)
    loops = boundary_loops(surface.faces)
    rim = np.concatenate(loops) if loops else np.empty(0, np.int64)
    found = []
    for sign in (1.0, -1.0):
        top = float(np.quantile(sign * curvature, TOP))
        for level in (top * share for share in LEVELS if top > 0):
            outside = np.union1d(rim, np.flatnonzero(sign * curvature < level))
            if len(outside) < len(curvature):
                reach = distance(outside)
                middle = int(np.argmax(reach))
                limit = longest(sign * level, material)
                found.append(LengthBound(sign * level, 2 * float(reach[middle]), limit, surface.vertices[middle]))
    return max(found, key=lambda bound: bound.ratio, default=None)


def _distances(surface: Surface) -> Callable[[Ints], Floats]:
    """Function from vertices to the (n_v,) geodesic distances from them; infinite from none."""
    vertices, faces = np.array(surface.vertices, order="C"), np.array(surface.faces, order="C")
    data, size = _factored(vertices, faces)

    def distance(sources: Ints) -> Floats:
        if len(sources) == 0:
            return np.full(len(vertices), np.inf)
        found = np.asarray(igl.heat_geodesics_solve(data, np.array(sources))) / size
        reach: Floats = found - found[sources].mean()
        return reach

    return distance


def _factored(vertices: Floats, faces: Ints) -> tuple[igl.HeatGeodesicsData, float]:
    """The heat method's matrices of the mesh, and the size that it was given for them.

    libigl factors a singular matrix whose last pivot is rounding, and gives up when that is not positive: about one
    mesh in five. At another size it rounds otherwise.
    """
    for size in SIZES:
        data = igl.HeatGeodesicsData()
        with suppress(RuntimeError):
            igl.heat_geodesics_precompute(size * vertices, faces, data)
            return data, size
    msg = "distances on the target cannot be computed; repair its smallest triangles or let target.remesh be true"
    raise SolverError(msg)


def feasible_lambda(bound: LengthBound, material: Material) -> float | None:
    """The lambda, on the same side of 1 and with the same nu, whose bound the target just meets; None if none does.

    Or if only one does that no material has.
    """
    reach = bound.length / np.pi * np.sqrt(abs(bound.curvature))
    squared = 1 / (1 - reach**2) if bound.curvature > 0 else 1 + reach**2
    if not 1 < squared < np.inf:
        return None
    power = np.sign(np.log(material.along)) / (2 + 2 * material.nu)
    with suppress(InputError, OverflowError):
        return replace(material, lambda_=float(squared) ** float(power)).lambda_
    return None


def bounded(surface: Surface, material: Material) -> Finding:
    """The length bound as a finding (lengths in mm): a warning with length, place and remedy where it is exceeded."""
    bound = length_bound(surface, material)
    if bound is None:
        return Finding("length_bound", Severity.INFO, "the target is flat: director lines may be of any length")
    where = "target at ({:.2f}, {:.2f}, {:.2f}) mm".format(*bound.place)
    along = (bound.curvature > 0) == (material.along < material.across)
    text = (
        f"lines {'along' if along else 'across'} a smooth director are at least {bound.length:.2f} mm long where the "
        f"target is curved most, and can be {bound.limit:.2f} mm"
    )
    if bound.ratio >= 1:
        better = feasible_lambda(bound, material)
        remedy = f"lambda = {better:.3f} would just do" if better else "no lambda would do"
        text += f": expect a defect of the director or a miss there; {remedy}, or cut the target open (target.cuts)"
    severity = Severity.WARNING if bound.ratio >= 1 else Severity.INFO
    return Finding("length_bound", severity, text, bound.ratio, 1.0, where=where)
