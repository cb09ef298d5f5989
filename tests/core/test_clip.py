"""Convex pieces along a concave outline, against gdstk's boolean."""

import gdstk
import numpy as np
import pytest

from lce_workbench.core.clip import blunted, cut, inside
from lce_workbench.core.domains import signed_area

TURN = 2 * np.pi * np.arange(60) / 60
STAR = (1 + 0.5 * np.cos(5 * TURN))[:, None] * np.stack([np.cos(TURN), np.sin(TURN)], axis=1)
ELL = np.array([(-1, -1), (1, -1), (1, 0), (0, 0), (0, 1), (-1, 1)], dtype=float)
SQUARE = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)], dtype=float)
HOLES = [0.4 * STAR[::-1] - 0.3, 0.2 * ELL[::-1] + 0.6]
SHEETS = {"star": [STAR], "ell": [ELL], "square": [SQUARE], "holes": [SQUARE, *HOLES]}


def convex(ring):
    edge = np.roll(ring, -1, axis=0) - ring
    after = np.roll(edge, -1, axis=0)
    return (edge[:, 0] * after[:, 1] - edge[:, 1] * after[:, 0] > -1e-12).all()


def scattered(n, size, seed):
    """Convex polygons of 3 to 7 corners."""
    rng = np.random.default_rng(seed)
    turn = np.sort(rng.uniform(0, 2 * np.pi, (n, 7)), axis=1)
    turn[: n // 2, 3:] = turn[: n // 2, 2:3]
    ring = np.stack([np.cos(turn), np.sin(turn)], axis=2) * rng.uniform(0.3, 1, (n, 1, 1)) * size
    return ring + rng.uniform(-1.4, 1.4, (n, 1, 2))


@pytest.mark.parametrize("name", SHEETS)
@pytest.mark.parametrize("size", [0.08, 0.5, 3.0])
def test_pieces_are_convex_and_cover_the_common_part(name, size):
    polygons, (outline, *holes) = scattered(60, size, 3), SHEETS[name]
    found = cut(polygons, (outline, *holes))
    area = np.zeros(len(polygons))
    area[found.whole] = signed_area(polygons[found.whole])
    for piece, owner in zip(found.pieces, found.owner, strict=True):
        assert convex(piece)
        area[owner] += signed_area(piece[None])[0]
    sheet = gdstk.boolean(gdstk.Polygon(outline), [gdstk.Polygon(hole) for hole in holes], "not", precision=1e-9)
    want = [
        sum(p.area() for p in gdstk.boolean(gdstk.Polygon(ring), sheet, "and", precision=1e-9)) for ring in polygons
    ]
    np.testing.assert_allclose(area, want, atol=1e-7)


def test_an_edge_along_the_outline_cuts_nothing():
    tiles = np.array([[(x, y), (x + 1, y), (x + 1, y + 1), (x, y + 1)] for x in (-1, 0) for y in (-1, 0)], dtype=float)
    found = cut(tiles, [ELL])
    assert len(found.whole) + len(found.pieces) == 3
    assert sum(signed_area(p[None])[0] for p in found.pieces) + len(found.whole) == pytest.approx(3)


def test_inside():
    points = np.random.default_rng(1).uniform(-1.6, 1.6, (2000, 2))
    assert np.array_equal(inside(points, [STAR]), gdstk.inside(points, gdstk.Polygon(STAR)))


def test_blunt_corners_go_and_the_ring_stays_convex_and_inside():
    turn = np.sort(np.random.default_rng(2).uniform(0, 2 * np.pi, 400))
    ring = np.stack([np.cos(turn), np.sin(turn)], axis=1)
    fewer = blunted(ring, 0.02)
    assert 5 < len(fewer) < 40
    assert convex(fewer)
    assert set(map(tuple, fewer)) <= set(map(tuple, ring))
