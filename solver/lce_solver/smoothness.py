"""How much a map changes from one triangle to the next: a quadratic term that keeps the director smooth.

Across an edge the derivatives a and b of one triangle, turned into its neighbour's frame, should be the neighbour's.
The term is the sum of the squared jumps, each with the area share of its two triangles: for a smooth map it falls with
the square of the edge length, so that a fixed weight stops to matter on fine meshes.
"""

from __future__ import annotations

import numpy as np
from scipy import sparse

from lce_solver.topology import half_edges, neighbours
from lce_solver.types import Surface
from lce_solver.wirtinger import laid_flat


def jumps(surface: Surface) -> sparse.csr_array:
    """(2 n_e, 2 n_f) complex: derivatives (a, b) to their jumps across the inner edges.

    The sum of the squared results is an average: each jump counts by the share of the area that its edge stands for.
    """
    pairs, _ = neighbours(surface.faces)
    n_f, n_e = len(surface.faces), len(pairs)
    face, corner = pairs % n_f, pairs // n_f
    z, area = laid_flat(surface)
    along = z[face, (corner + 1) % 3] - z[face, corner]  # the shared edge in both frames
    start = half_edges(surface.faces)[:, 0][pairs]
    turn = along[:, 1] / along[:, 0] * np.where(start[:, 0] == start[:, 1], 1, -1)
    share = np.sqrt(area[face].sum(axis=1) / (3 * area.sum()))
    entries = np.concatenate([share, -share * turn / np.abs(turn)])  # dw/dz in the first frame is turn x in the second
    of_a = sparse.csr_array((entries, (np.tile(np.arange(n_e), 2), face.T.ravel())), shape=(n_e, n_f))
    return sparse.csr_array(sparse.block_diag([of_a, of_a.conj()], format="csr"))
