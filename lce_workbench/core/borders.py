"""Where domains of any shape border on each other."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from lce_solver.types import Floats, Ints
from lce_workbench.core.domains import Domains

BESIDE = 1e-3
"""A border's neighbour is looked for so far outside its middle [mm]."""

CANDIDATES = 16
"""Among so many domains with the nearest centres."""


@dataclass(frozen=True, eq=False)
class Borders:
    """Pairs of neighbouring domains, each once."""

    pair: Ints
    """(n, 2) the domains, the smaller number first."""
    start: Floats
    """(n, 2) one end of an edge of the first that the second lies on [mm]."""
    end: Floats
    """(n, 2) its other end [mm]."""

    @property
    def length(self) -> Floats:
        """(n,) length of the edge [mm]."""
        return np.asarray(np.linalg.norm(self.end - self.start, axis=1))


def borders(domains: Domains) -> Borders:
    """The domain beyond the middle of every edge of every domain; of a pair, the edge of the one that comes first."""
    start, end, owner = _edges(domains)
    along = end - start
    outward = np.stack([along[:, 1], -along[:, 0]], axis=1) / np.linalg.norm(along, axis=1)[:, None]
    found, outside = locate(domains, (start + end) / 2 + BESIDE * outward)
    other = (outside <= 0) & (found != owner)
    pair = np.sort(np.stack([owner, found], axis=1)[other], axis=1)
    _, once = np.unique(pair, axis=0, return_index=True)
    return Borders(pair[once], start[other][once], end[other][once])


def _edges(domains: Domains) -> tuple[Floats, Floats, Ints]:
    """Both ends (n, 2) of every edge, and the domain (n,) that it is of."""
    found = []
    for rows, rings in domains.rings():
        ends = rings, np.roll(rings, -1, axis=1)
        found.append((*(end.reshape(-1, 2) for end in ends), np.repeat(rows, rings.shape[1])))
    order = np.argsort(np.concatenate([owner for *_, owner in found]), kind="stable")
    start, end, owner = (np.concatenate(part)[order] for part in zip(*found, strict=True))
    return start, end, owner


def locate(domains: Domains, points: Floats) -> tuple[Ints, Floats]:
    """The domain (n,) that holds each of ``points`` (n, 2), or the one nearest to it; how far outside (n,) [mm]."""
    count = min(CANDIDATES, len(domains))
    near = np.asarray(cKDTree(domains.centroid).query(points, k=count)[1], dtype=np.int64).reshape(len(points), count)
    corners = domains.corners
    edge = np.roll(corners, -1, axis=1) - corners
    normal = np.stack([edge[..., 1], -edge[..., 0]], axis=2) / np.linalg.norm(edge, axis=2)[..., None]
    offset = np.sum(normal * corners, axis=2)
    found, outside, left = near[:, 0].copy(), np.full(len(points), np.inf), np.arange(len(points))
    for column in near.T:
        k = column[left]
        beyond = np.max(np.einsum("nkc,nc->nk", normal[k], points[left]) - offset[k], axis=1)
        nearer = beyond < outside[left]
        found[left[nearer]], outside[left[nearer]] = k[nearer], beyond[nearer]
        left = left[outside[left] > 0]
    return found, outside
