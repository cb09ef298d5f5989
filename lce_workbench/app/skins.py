"""The sheet as it is shown: triangles in space that know where they lie on the flat sheet. Picking is pure geometry."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from lce_solver.types import Floats, Ints
from lce_workbench.core.domains import Domains

EDGE = 1e-6
"""How far beyond its border a triangle or a domain still holds a point, relative to its size."""


@dataclass(frozen=True, eq=False)
class Skin:
    """One shown copy of the sheet."""

    points: Floats
    """(n_v, 3) where it is shown [mm]."""
    faces: Ints
    """(n_f, 3) vertex indices."""
    flat: Floats
    """(n_v, 2) where its vertices lie on the flat sheet [mm]."""
    colours: Floats
    """(n_f, 3) or (n_v, 3) red, green, blue in [0, 1]; (1, 3) for all."""

    def hit(self, origin: Floats, direction: Floats) -> tuple[float, Floats] | None:
        """How far along a ray it is hit first, and where that lies on the flat sheet (2,) [mm]; `None` beside it.

        T. Moeller and B. Trumbore, J. Graphics Tools 2, 21 (1997), for all triangles at once.
        """
        a, b, c = np.moveaxis(self.points[self.faces], 1, 0)
        ab, ac, to = b - a, c - a, origin - a
        across, normal = np.cross(direction, ac), np.cross(to, ab)
        det = np.sum(ab * across, axis=1)
        with np.errstate(divide="ignore", invalid="ignore"):  # triangles seen from their edge
            u, v = np.sum(to * across, axis=1) / det, normal @ direction / det
            away = np.sum(ac * normal, axis=1) / det
        found = np.flatnonzero((u >= -EDGE) & (v >= -EDGE) & (u + v <= 1 + EDGE))
        if not len(found):
            return None
        first = found[np.argmin(away[found])]
        weights = np.array([1 - u[first] - v[first], u[first], v[first]])
        return float(away[first]), weights @ self.flat[self.faces[first]]

    def lift(self, flat: Floats, faces: Ints | None = None) -> Floats:
        """Where points (k, 2) of the flat sheet are shown (k, 3).

        Parameters
        ----------
        faces : (k,) their triangles; without it they are looked for one by one, so leave it out for few points only.
        """
        if faces is None:
            faces = np.array([np.argmax(_barycentric(p, self.flat[self.faces]).min(axis=1)) for p in flat], dtype=int)
        corners = self.faces[faces]
        weights = _barycentric(flat, self.flat[corners])
        shown: Floats = np.einsum("kc,kcx->kx", weights, self.points[corners])
        return shown


def _barycentric(points: Floats, corners: Floats) -> Floats:
    """(k, 3) weights of points (k, 2) or (2,) in triangles (k, 3, 2)."""
    a, ab, ac = corners[:, 0], corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    to = points - a
    area = ab[:, 0] * ac[:, 1] - ab[:, 1] * ac[:, 0]
    area = np.where(area == 0, np.finfo(float).tiny, area)
    u = (to[:, 0] * ac[:, 1] - to[:, 1] * ac[:, 0]) / area
    v = (ab[:, 0] * to[:, 1] - ab[:, 1] * to[:, 0]) / area
    return np.stack([1 - u - v, u, v], axis=1)


def first_hit(skins: Iterable[Skin], origin: Floats, direction: Floats) -> Floats | None:
    """Where on the flat sheet (2,) the nearest of several skins is hit [mm]; `None` beside all of them."""
    hits = [hit for skin in skins if (hit := skin.hit(origin, direction)) is not None]
    return min(hits, key=lambda hit: hit[0])[1] if hits else None


def domain_at(domains: Domains, point: Floats) -> int | None:
    """The domain that holds a point (2,) of the flat sheet; `None` between and beside them."""
    corners = domains.corners
    edge, to = np.roll(corners, -1, axis=1) - corners, point - corners
    left = edge[..., 0] * to[..., 1] - edge[..., 1] * to[..., 0]
    inside = left.min(axis=1) / np.maximum(np.abs(domains.area), np.finfo(float).tiny)
    best = int(np.argmax(inside))
    return best if inside[best] >= -EDGE else None
