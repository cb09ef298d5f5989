"""Scans coarser than the mesh that is wanted of them: the smooth surface that their facets stand for."""

from __future__ import annotations

import numpy as np

from lce_solver.geometry import mean_edge
from lce_solver.remesh import closest, corners
from lce_solver.subdivision import MOST_FACES, loop_limit, refine
from lce_solver.topology import boundary_loops
from lce_solver.types import Surface

MEANT = 0.05
"""Facets are meant, as those of a roof are, if the smooth surface is farther from them than this part, rms, of the
surface's thinnest extent."""


def rounded(surface: Surface, edge: float) -> tuple[Surface, float]:
    """Loop's surface near the vertices, its edges at most ``edge`` long in the mean; corners of the rim stay.

    Loop's surface alone lies inside every bulge, by an amount of the order of the squared edges. The control mesh is
    therefore moved by that amount the other way ("twicing": Tukey, Exploratory Data Analysis, 1977), which takes most
    of it back, and not the whole noise of a scan as interpolation would.

    Returns
    -------
    The surface, and its rms distance from the facets, within which the scan says nothing. If the mesh is fine enough,
    its facets are `MEANT`, or are slivers of which `MOST_FACES` would come, the surface as it is and zero.
    """
    times = mean_edge(surface) / edge
    if times <= 1 or len(surface.faces) * times**2 > MOST_FACES:
        return surface, 0.0
    rims = boundary_loops(surface.faces)
    fixed = np.concatenate([np.empty(0, np.int64), *(rim[corners(surface.vertices[rim], edge)] for rim in rims)])
    points = surface.vertices - surface.vertices.mean(axis=0)  # so that rounding does not depend on where it lies
    outward = points - loop_limit(surface.faces, len(points)) @ points
    outward[fixed] = 0.0
    smooth = Surface(surface.vertices + outward, surface.faces)
    while mean_edge(smooth) > edge:
        finer = refine(smooth, "loop")
        kept = np.array(finer.vertices)
        kept[fixed] = smooth.vertices[fixed]
        smooth = Surface(kept, finer.faces)
    apart = smooth.vertices - closest(smooth.vertices, surface.vertices, surface.faces)
    known = float(np.sqrt(np.mean(np.sum(apart**2, axis=1))))
    relief = np.ptp(points @ np.linalg.svd(points, full_matrices=False)[2].T, axis=0).min()
    meant = known > MEANT * relief
    return (surface, 0.0) if meant else (smooth, known)
