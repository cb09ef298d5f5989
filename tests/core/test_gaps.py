import numpy as np
import pytest

from lce_workbench.core.gaps import SEEN, smallest_gap


def square(x, y, side=1000.0, turn=0.0):
    corner = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)]) * side / 2
    c, s = np.cos(turn), np.sin(turn)
    return corner @ np.array([[c, s], [-s, c]]) + [x, y]


@pytest.mark.parametrize("offset", [0.0, 18_900.0, 19_400.0, -5e7])
@pytest.mark.parametrize("gap", [-30.0, 0.0, 1.0, 300.0, 499.0])
@pytest.mark.parametrize("turn", [0.0, 0.3])
def test_the_gap_of_two_squares_wherever_the_tiles_lie(gap, offset, turn):
    pair = np.array([square(offset, 7.0), square(offset + 1000 + gap, 7.0), square(offset + 1e5, 0)])
    c, s = np.cos(turn), np.sin(turn)
    assert np.isclose(smallest_gap(pair @ np.array([[c, s], [-s, c]])), gap, atol=1e-6)


def test_far_polygons_have_no_gap_to_speak_of():
    assert smallest_gap(np.array([square(0, 0), square(5000, 0)])) == SEEN
    assert smallest_gap(square(0, 0)[None]) == SEEN


def test_long_oblique_lines():
    """A grating at 30 degrees: each line's box meets many others, the gaps are the lands."""
    x, y = np.array([0, 3e6, 3e6, 0]), np.array([0, 0, 1000, 1000])
    lines = np.stack([np.stack([x, y + 1400 * k], axis=1) for k in range(300)])
    c, s = np.cos(0.5), np.sin(0.5)
    assert np.isclose(smallest_gap(lines @ np.array([[c, s], [-s, c]])), 400)


def test_all_pairs_give_the_same_as_near_ones():
    rng = np.random.default_rng(4)
    many = np.array([square(*rng.uniform(0, 1.5e5, 2), side=2000, turn=rng.uniform(0, 2)) for _ in range(60)])
    pairs = [smallest_gap(many[[i, j]]) for i in range(60) for j in range(i)]
    assert np.isclose(smallest_gap(many), min(pairs))
