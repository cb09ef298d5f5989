"""The jumps against their definition, and what smoothing does to a real design."""

import numpy as np
import pytest
from targets import LCE, flat, hill, moved

from lce_solver.contest import compete
from lce_solver.judge import jacobians
from lce_solver.metric import Stop, as_points, lay_flat, objective
from lce_solver.plane import convex_map
from lce_solver.smoothness import jumps
from lce_solver.surfaces import SURFACES
from lce_solver.topology import neighbours
from lce_solver.types import line_angle
from lce_solver.wirtinger import operator, stretched

STRETCHES = (LCE.along, LCE.across)


def test_on_a_flat_target_jumps_are_those_of_the_slopes():
    """In the plane no frame turns, so the jump of the 2 x 2 slope says it all: |da|^2 + |db|^2 = |dJ|^2 / 2."""
    surface = flat()
    w = convex_map(surface) @ (1, 1j)
    slope = np.linalg.inv(jacobians(surface, as_points(w))[:, :2])
    pairs, _ = neighbours(surface.faces)
    first, second = pairs.T % len(surface.faces)
    corners = surface.vertices[surface.faces]
    area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1) / 2
    share = (area[first] + area[second]) / (3 * area.sum())
    expected = share @ ((slope[first] - slope[second]) ** 2).sum(axis=(1, 2)) / 2
    jump = jumps(surface) @ (operator(surface).derivative @ w)
    assert np.vdot(jump, jump).real == pytest.approx(expected)


def test_a_uniform_stretch_has_no_jumps_and_bending_a_strip_changes_none():
    for surface in (flat(), moved(flat())):
        w = stretched(lay_flat(surface).w, STRETCHES, 0.4)
        jump = jumps(surface) @ (operator(surface).derivative @ w)
        assert np.abs(jump).max() < 1e-6


def test_gradient_of_the_smoothed_energy_is_the_derivative():
    surface = hill(4, 3)
    goal = objective(operator(surface), STRETCHES, jumps(surface), 0.7)
    w = convex_map(surface) @ (1, 1j)
    _, gradient = goal(w)
    for unit in (1, 1j):
        for vertex in range(len(w)):
            nudge = 1e-5 * unit * (np.arange(len(w)) == vertex)
            slope = (goal(w + nudge)[0] - goal(w - nudge)[0]) / 2e-5
            assert slope == pytest.approx((gradient[vertex] * np.conj(unit)).real, abs=1e-7 * np.abs(gradient).max())


def test_smoothing_halves_the_jumps_and_costs_little():
    surface = SURFACES["face"](0.05)
    found = {}
    for smoothing in (0.0, 0.02, 0.5):
        (best, *_), starts = compete(surface, LCE, starts=2, stop=Stop(1e-6), smoothing=smoothing)
        pairs, _ = neighbours(surface.faces)
        first, second = best.flat.theta[pairs.T % len(surface.faces)]
        turn = line_angle(first - second)
        jump = np.degrees(np.percentile(np.minimum(turn, np.pi - turn), 99))
        found[smoothing] = jump, min(start.rms for start in starts)
    assert found[0.5][0] < found[0.02][0] < found[0.0][0], found
    assert found[0.02][1] < 1.15 * found[0.0][1], found
    assert found[0.5][1] > found[0.02][1], found
