"""Bumps up and down on one sheet: each decides for itself while it buckles, and only the twist can tell it where to."""

from dataclasses import replace

import numpy as np
import pytest
from targets import LCE, patch

from lce_solver.compare import align, compare, vertex_areas
from lce_solver.design import design
from lce_solver.shell import film_of, predict

LIMIT = np.deg2rad(5.0)
PEAKS = np.array([(-0.45, -0.45, 1), (0.45, -0.45, -1), (-0.45, 0.45, -1), (0.45, 0.45, 1)])
"""x, y and side of each bump, on a square from -1 to 1."""


def bumps(x, y):
    return x, y, sum(0.3 * side * np.exp(-8 * ((x - a) ** 2 + (y - b) ** 2)) for a, b, side in PEAKS)


@pytest.fixture(scope="module")
def plan():
    """The closed form: nothing here is corrected by simulation."""
    return design(patch(bumps, 18, 18, width=2.0, height=2.0)[1], LCE, 20.0, 0.1, starts=2, twist_limit=LIMIT)


def heated(plan, twist, seed):
    return predict(film_of(replace(plan, dtheta=twist * plan.dtheta)), seed=seed)


def place(plan, points):
    """Where ``points`` (n, 3) of the target are in its parameters, (n, 2)."""
    corner = plan.surface.vertices[:, :2].min()
    return points[:, :2] / abs(corner)


def sides(plan, found):
    """(4,) height of each bump over its surroundings, in units of the target's."""
    target, faces = plan.surface.vertices, plan.surface.faces
    moved = align(found.vertices, target, vertex_areas(target, faces)).moved
    away = np.linalg.norm(place(plan, target)[:, None] - PEAKS[:, :2], axis=2)
    return [
        (moved[near, 2].mean() - moved[about, 2].mean()) / (target[near, 2].mean() - target[about, 2].mean())
        for near, about in zip(away.T < 0.2, abs(away.T - 0.55) < 0.1, strict=True)
    ]


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_every_bump_takes_its_side(plan, seed):
    found = heated(plan, 1.0, seed)
    assert compare(plan, found).rms_pct < 1
    np.testing.assert_allclose(sides(plan, found), 1, atol=0.1)


def test_the_flipped_twist_turns_all_of_them_over_at_the_same_energy(plan):
    found = heated(plan, -1.0, 1)
    assert compare(plan, found).mirror_rms_pct < 1
    assert found.energy == pytest.approx(heated(plan, 1.0, 1).energy, rel=1e-4)


def test_without_twist_chance_decides_for_each(plan):
    for seed in (1, 2):
        found = compare(plan, heated(plan, 0.0, seed))
        assert min(found.rms_pct, found.mirror_rms_pct) > 2


def test_one_bump_whose_twist_is_flipped_turns_over_alone(plan):
    """The metric does not tell the two sides apart."""
    centres = plan.surface.vertices[plan.surface.faces].mean(axis=1)
    own = (np.sign(place(plan, centres)) == np.sign(PEAKS[1, :2])).all(axis=1)
    assert np.array_equal(np.sign(sides(plan, heated(plan, np.where(own, -1.0, 1.0), 1))), [1, -1, 1, 1])
