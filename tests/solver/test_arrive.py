"""The correction by simulation: its derivatives, and sheets that arrive where the closed form does not bring them."""

from dataclasses import replace

import numpy as np
import pytest
from deep import DEEP
from flatsheets import hot, random_state
from targets import LCE

from lce_solver.arrive import LARGEST, Correction, arrive, heated
from lce_solver.compare import Verdict, align, compare
from lce_solver.design import design, renewed
from lce_solver.shell import film_of, predict, settle
from lce_solver.shell_energy import bias, energy, hessian, pattern_forces
from lce_solver.surfaces import SURFACES
from lce_solver.types import Material, Severity, Surface

LIMIT = np.deg2rad(5.0)


def scattered(flat, blocks):
    """Sum of the triangles' (n_f, 6, 3) forces at the vertices."""
    total = np.zeros((len(flat.sheet.uv), 3))
    np.add.at(total, flat.sheet.patch, blocks)
    return total


def test_hessian_is_the_derivative_of_the_gradient_in_any_state():
    flat, x, way = random_state()
    step = 1e-6
    up, down = (energy(flat.sheet, hot(flat), x + s * step * way)[1] for s in (1, -1))
    exact = scattered(flat, np.einsum("tijab,tjb->tia", hessian(flat.sheet, hot(flat), x), way[flat.sheet.patch]))
    assert np.abs((up - down) / (2 * step) - exact).max() < 1e-8 * np.abs(exact).max()


def test_pattern_forces_are_the_derivative_of_the_gradient():
    flat, x, _ = random_state()
    unit = replace(flat, dtheta=np.ones_like(flat.dtheta))
    way, step = np.random.default_rng(2).normal(size=(len(flat.theta), 2)), 1e-6

    def gradient(s):
        changed = replace(flat, theta=flat.theta + s * way[:, 0], dtheta=flat.dtheta + s * way[:, 1])
        return energy(flat.sheet, hot(changed), x)[1]

    exact = scattered(flat, np.einsum("tjxp,tp->tjx", pattern_forces(flat.sheet, hot(flat), hot(unit), x), way))
    assert np.abs((gradient(step) - gradient(-step)) / (2 * step) - exact).max() < 1e-8 * np.abs(exact).max()


def test_bias_is_the_cost_of_the_mirror_image():
    flat, x, _ = random_state()
    plain, twisted = hot(replace(flat, dtheta=0 * flat.dtheta)), hot(flat)
    here, mirrored = (energy(flat.sheet, twisted, x * (1, 1, sign))[0] for sign in (1, -1))
    bent = energy(flat.sheet, plain, x)[0] - energy(flat.sheet, replace(plain, thickness=0.0), x)[0]
    assert bias(flat.sheet, plain, twisted, x).sum() == pytest.approx((mirrored - here) / bent, rel=1e-9)


@pytest.fixture(scope="module")
def dome():
    """A dome of 20 mm: no twist can carry its bending, so the closed form leaves its side to chance."""
    return design(SURFACES["dome"](0.07), LCE, 20.0, 0.1, starts=2, twist_limit=LIMIT)


@pytest.fixture(scope="module")
def told():
    """What the correction tells of its progress: stages and shares."""
    return []


@pytest.fixture(scope="module")
def arrived(dome, told):
    return arrive(dome, "full", LIMIT, lambda stage, share: told.append((stage, share)))


def test_progress_rises_within_each_round_and_tells_the_energy(arrived, told):
    """The correction is most of a design's time: nobody should wait at a bar that stands still."""
    shares = np.array([share for _, share in told])
    assert {str(stage) for stage, _ in told} == {"equilibrium"}
    assert np.all(np.diff(shares) >= 0)
    assert len(np.unique(shares[shares < 0.25])) > 10  # the first of four rounds
    assert shares[-1] == 1.0
    assert all(stage.energy > 0 for stage, _ in told[:-1])


def test_the_predicted_move_is_that_of_the_equilibrium(dome):
    """The derivative of the heated shape with respect to the pattern, against heating the changed pattern."""
    work = Correction(dome, film_of(dome), LIMIT, (0, 1), np.zeros_like(dome.theta), -np.inf)
    change = np.zeros((len(dome.uv), 2))
    start = settle(work.film, dome.surface.vertices, tolerance=1e-13)
    at = work.state(start.vertices, change)
    moved, changed = work.step(at)
    small = 1e-2
    there = settle(work.pattern(small * changed), at.x + small * moved, tolerance=1e-13).vertices
    ones = np.ones(len(there))
    actual = align(there, at.x, ones).moved - at.x
    expected = align(at.x + small * moved, at.x, ones).moved - at.x
    assert np.linalg.norm(actual - expected) < 0.05 * np.linalg.norm(actual)
    assert work.state(there, small * changed).misfit < at.misfit


def test_a_dome_arrives_and_on_its_own_side(dome, arrived):
    made, said = arrived
    before = heated(dome, film_of(dome))
    found = [compare(made, predict(film_of(made), seed=seed)) for seed in (2, 3, 4)]
    assert all(one.verdict is Verdict.TARGET for one in found)
    assert max(one.rms_pct for one in found) < 0.5 * min(before.rms, before.mirror)
    assert np.abs(made.dtheta).max() <= LIMIT
    assert said.severity is Severity.INFO
    assert said.value < 0.1
    assert heated(dome, film_of(made)).firm
    assert not before.firm
    assert np.array_equal(made.uv, dome.uv)
    assert {one.check for one in renewed(made.findings, made, LIMIT)} == {one.check for one in dome.findings}


def test_a_correction_holds_the_side(dome):
    """Nearer to the target there is a design that leaves the side to chance."""
    at = heated(dome, film_of(dome)).onset
    change = np.zeros((len(dome.uv), 2))
    work = Correction(dome, film_of(dome), LIMIT, (0, 1), np.zeros_like(dome.theta), -np.inf).sided(
        at, change, 0.1, hold=True
    )
    assert at.favour < 0.01
    favours = []
    for held in (work, replace(work, least=-np.inf)):
        start = held.state(settle(held.pattern(change), dome.surface.vertices).vertices, change)
        favours.append(held.lever @ held.pattern(held.along(start, *held.step(start)).change).dtheta)
    assert favours[0] == pytest.approx(0.1, rel=1e-3)
    assert favours[1] < 0.08


def test_twist_alone_leaves_the_director(dome):
    made, _ = arrive(dome, "dtheta", LIMIT)
    np.testing.assert_allclose(made.theta, dome.theta, atol=1e-12)
    assert not np.array_equal(made.dtheta, dome.dtheta)


def test_a_film_too_thick_for_its_target_is_told():
    surface = SURFACES["dome"](0.07)
    x, y, _ = surface.vertices.T
    bumps = 0.06 * np.cos(9 * x) * np.cos(9 * y + 1)
    plan = design(Surface(np.column_stack([x, y, bumps]), surface.faces), LCE, 20.0, 2.0, starts=1, twist_limit=LIMIT)
    _, said = arrive(plan, "full", LIMIT)
    assert said.severity is Severity.WARNING
    assert "its director misses" in said.message or "make the sheet wider" in said.message


def test_a_twist_that_the_limit_cuts_off_is_told():
    """Only twist can roll up a rectangle, and here it may not be large enough."""
    limit = np.deg2rad(1.0)
    plan = design(DEEP["scroll"](0.2), LCE, 20.0, 0.1, starts=1, twist_limit=limit)
    _, said = arrive(plan, "full", limit)
    assert said.severity is Severity.WARNING
    assert "its twist is cut off at 1 deg" in said.message


def test_a_sheet_that_cannot_leave_its_plane_is_left_alone():
    plan = design(SURFACES["dome"](0.1), Material(1 - 1e-6, 0.5), 20.0, 0.1, starts=1, twist_limit=LIMIT)
    made, said = arrive(plan, "full", LIMIT)
    assert made is plan
    assert "stays flat" in said.message
    assert np.ptp(predict(film_of(plan), seed=1).vertices[:, 2]) < 0.1


def test_large_sheets_are_left_alone(dome, monkeypatch):
    monkeypatch.setattr("lce_solver.arrive.LARGEST", 100)
    made, said = arrive(dome, "full", LIMIT)
    assert made is dome
    assert "not corrected" in said.message
    assert len(dome.theta) < LARGEST
