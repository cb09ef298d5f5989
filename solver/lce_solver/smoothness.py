"""How much a map changes from one triangle to the next: a quadratic form that keeps the director smooth.

Across an edge the derivatives a and b of one triangle, turned into its neighbour's frame, should be the neighbour's.
The form is the sum of the squared jumps, each with the area share of its two triangles: for a smooth map it falls with
the square of the edge length, so that a fixed weight stops to matter on fine meshes.
"""

from __future__ import annotations

import numpy as np
from scipy import sparse

from lce_solver.topology import half_edges, neighbours
from lce_solver.types import Surface
from lce_solver.wirtinger import Operator, laid_flat


def roughness(surface: Surface, op: Operator) -> sparse.csr_array:
    """(n_v, n_v) symmetric Q: ``Re(conj(w) . Q w)`` is the mean squared jump of (a, b) across inner edges."""
    pairs, _ = neighbours(surface.faces)
    n_f, n_e = len(surface.faces), len(pairs)
    face, corner = pairs % n_f, pairs // n_f
    z, area = laid_flat(surface)
    along = z[face, (corner + 1) % 3] - z[face, corner]  # the shared edge in both frames
    start = half_edges(surface.faces)[:, 0][pairs]
    turn = along[:, 1] / along[:, 0] * np.where(start[:, 0] == start[:, 1], 1, -1)
    share = np.sqrt(area[face].sum(axis=1) / (3 * area.sum()))
    entries = np.concatenate([share, -share * turn / np.abs(turn)])  # dw/dz in the first frame is turn x in the second
    jump = sparse.csr_array((entries, (np.tile(np.arange(n_e), 2), face.T.ravel())), shape=(n_e, n_f))
    of_a = (jump @ op.derivative[:n_f]).tocsr()
    return (2 * (of_a.conj().T @ of_a).real).tocsr()  # the jumps of b are those of a for the conjugate map
