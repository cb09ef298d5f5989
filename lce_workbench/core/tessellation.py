"""Convex tessellations of the flat sheet: hexagons, and the Voronoi cells of points that are their centres of mass.

At the rim, and at holes, a cell is cut along it into convex pieces. Specks are left out: at a concave corner of the rim
these are thin wedges.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from scipy.spatial import Voronoi

from lce_solver.errors import InputError
from lce_solver.types import Floats, Ints
from lce_workbench.core.clip import Cut, blunted, cut, distinct, inside
from lce_workbench.core.domains import signed_area

SPECK = 0.05
"""Pieces smaller than this share of a whole hexagon are left out."""

BLUNT = 1e-4
"""A corner this close to the line between its neighbours is left out [mm]; the guard of the channels is wider."""

ROUNDS = 100
"""Steps of Lloyd's method."""

SETTLED = 1e-2
"""Lloyd's method ends when no centre moves by more than this share of the size."""

ROOT3 = np.sqrt(3)


def hexagons(rims: Sequence[Floats], size: float) -> list[Floats]:
    """Regular hexagons, ``size`` from centre to centre, one of them about the origin, cut at the rim.

    Parameters
    ----------
    rims : (n, 2) of the sheet, the outline first, then those of its holes [mm].

    Returns
    -------
    Convex pieces (k, 2), counter-clockwise [mm].

    Raises
    ------
    InputError
        The sheet is too small for one.
    """
    corner = np.pi / 3 * (np.arange(6) + 0.5)
    one = size / ROOT3 * np.stack([np.cos(corner), np.sin(corner)], axis=1)
    cells = lattice(rims[0], size)[:, None] + one
    return _pieces(cells, cut(cells, rims), size)


def voronoi(rims: Sequence[Floats], size: float) -> list[Floats]:
    """Cells of a centroidal Voronoi tessellation by Lloyd's method, as many as hexagons of ``size`` would be.

    It starts from the hexagons' centres inside the sheet: in the middle the cells stay near hexagons, at the rim they
    adapt to it (Du, Faber, Gunzburger, SIAM Review 41, 637 (1999)). Arguments, result and errors as for `hexagons`.
    """
    seeds = lattice(rims[0], size)
    seeds = seeds[inside(seeds, rims)]
    for _ in range(ROUNDS):
        cells = _cells(seeds, rims[0])
        found = cut(cells, rims)
        centres, kept = _centres(cells, found)
        moved = np.linalg.norm(centres - seeds[kept], axis=1).max(initial=0.0)
        seeds = centres
        if moved < SETTLED * size:
            break
    cells = _cells(seeds, rims[0])
    return _pieces(cells, cut(cells, rims), size)


TESSELLATIONS: dict[str, Callable[[Sequence[Floats], float], list[Floats]]] = {"hexagons": hexagons, "voronoi": voronoi}
"""Ways to divide a sheet of given rims into pieces of given size."""


def lattice(outline: Floats, size: float) -> Floats:
    """Centres (n, 2) of hexagons that cover the outline's box, one of them the origin, symmetric about both axes."""
    reach = np.abs(outline).max(axis=0) + size
    columns, rows = np.ceil(reach / [size, size * ROOT3 / 2]).astype(int)
    i, j = np.meshgrid(np.arange(-columns - 1, columns + 1), np.arange(-rows, rows + 1))
    return np.stack([(i + (j % 2) / 2) * size, j * size * ROOT3 / 2], axis=2).reshape(-1, 2)


def _cells(seeds: Floats, outline: Floats) -> Floats:
    """Voronoi cells (n, k, 2), corners of those with fewer than k repeated; far points around close the outer ones."""
    turn = 2 * np.pi * np.arange(64) / 64
    far = 8 * np.abs(outline).max() * np.stack([np.cos(turn), np.sin(turn)], axis=1)
    found = Voronoi(np.concatenate([seeds, far]))
    regions = [found.regions[found.point_region[i]] for i in range(len(seeds))]
    most = max(map(len, regions))
    cells = found.vertices[np.array([region + region[-1:] * (most - len(region)) for region in regions])]
    around = np.arctan2(cells[..., 1] - seeds[:, None, 1], cells[..., 0] - seeds[:, None, 0])
    ordered: Floats = np.take_along_axis(cells, np.argsort(around, axis=1, kind="stable")[..., None], axis=1)
    return ordered


def _centres(cells: Floats, found: Cut) -> tuple[Floats, Ints]:
    """Centres of mass (m, 2) of the cells as they are cut, and which have one (m,)."""
    moments = np.zeros((len(cells), 3))
    moments[found.whole] = _moments(cells[found.whole])
    for piece, i in zip(found.pieces, found.owner.tolist(), strict=True):
        moments[i] += _moments(piece[None])[0]
    kept = np.flatnonzero(moments[:, 0] > 0)
    return moments[kept, 1:] / moments[kept, :1], kept


def _moments(polygons: Floats) -> Floats:
    """Area and first moments (n, 3) of polygons (n, k, 2)."""
    base, p, q = polygons[:, :1], polygons[:, 1:-1], polygons[:, 2:]
    triangles = np.stack([np.broadcast_to(base, p.shape), p, q], axis=2)
    share = signed_area(triangles.reshape(-1, 3, 2)).reshape(p.shape[:2])
    first = np.einsum("nk,nkc->nc", share, triangles.mean(axis=2))
    return np.column_stack([share.sum(axis=1), first])


def _pieces(cells: Floats, found: Cut, size: float) -> list[Floats]:
    """Whole cells, then those at the rim; without blunt corners and specks."""
    rings = [blunted(distinct(ring), BLUNT) for ring in (*cells[found.whole], *found.pieces)]
    least = SPECK * size**2 * ROOT3 / 2
    kept = [ring for ring in rings if float(signed_area(ring[None])[0]) > least]
    if not kept:
        msg = f"domains.size_um = {size * 1e3:g} is larger than the sheet; make the domains smaller"
        raise InputError(msg)
    return kept
