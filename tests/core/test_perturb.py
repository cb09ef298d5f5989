"""Faults of film, plates and material: exact where the outcome is known."""

from dataclasses import replace

import numpy as np
import pytest
from sheets import design

from lce_solver.types import line_angle
from lce_workbench.core.domains import partition
from lce_workbench.core.job import PredictionSpec
from lce_workbench.core.overlap import shared_area
from lce_workbench.core.perturb import IMPERFECTION, STUDIES, bench, misaligned


def at(plan):
    return bench(plan, partition(plan), PredictionSpec())


@pytest.fixture(scope="module")
def plain():
    return at(design(12, 14))


def lines_apart(a, b):
    return np.abs(line_angle(a - b + np.pi / 2) - np.pi / 2)


def film(plain, name, seed=0, **value):
    return STUDIES[name].fault(plain, np.random.default_rng(seed), **value)


def test_shared_area_of_a_triangle_and_what_covers_it():
    """Squares tile the plane: their shares of any triangle add up to its area; each is checked against sampling."""
    rng = np.random.default_rng(1)
    triangle = np.array([(0.13, 0.21), (2.71, 0.64), (1.02, 2.83)])
    squares = np.array([[(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)] for i in range(3) for j in range(3)], float)
    share = shared_area(np.repeat(triangle[None], 9, axis=0), squares)
    twice = np.linalg.det(triangle[1:] - triangle[0])
    assert share.sum() == pytest.approx(twice / 2, rel=1e-12)
    weight = rng.dirichlet((1, 1, 1), 200_000)
    cell = np.floor(weight @ triangle).astype(int)
    counted = np.bincount(3 * cell[:, 0] + cell[:, 1], minlength=9) / len(cell) * twice / 2
    assert np.abs(share - counted).max() < 0.01
    assert shared_area(triangle[None], squares[:1] - 5) == 0
    assert shared_area(triangle[None], triangle[None]) == pytest.approx(twice / 2, rel=1e-12)


def test_the_share_is_that_of_both_ways_round():
    rng = np.random.default_rng(2)
    one, other = rng.normal(size=(2, 500, 3, 2))
    for p in (one, other):
        flipped = np.linalg.det(p[:, 1:] - p[:, :1]) < 0
        p[flipped] = p[flipped][:, ::-1]
    assert np.allclose(shared_area(one, other), shared_area(other, one), atol=1e-12)


def test_every_study_holds_the_plain_film(plain):
    for study in STUDIES.values():
        films = [study.fault(plain, np.random.default_rng(0), **value) for value in study.values]
        same = [
            lines_apart(found.theta, plain.film.theta).max() < 1e-9
            and np.abs(found.dtheta - plain.film.dtheta).max() < 1e-9
            and found.material == plain.film.material
            and found.thickness == plain.film.thickness
            for found in films
        ]
        assert same.count(True) == (len(films) if IMPERFECTION in study.values[0] else 1)


def test_a_turned_plate_turns_its_directors():
    """Where the director is the same everywhere, a turn by phi adds phi to the twist and half of it to the director."""
    plan = design(12, 14)
    plan = replace(plan, theta=np.full_like(plan.theta, 0.4), dtheta=np.full_like(plan.dtheta, 0.03))
    found = misaligned(at(plan), np.array([0.01, -0.02]), 0.02)
    assert np.abs(found.dtheta - 0.05).max() < 1e-12
    assert lines_apart(found.theta, 0.41).max() < 1e-12


def test_a_shifted_plate_brings_the_neighbours_directors():
    """Of a smooth field the shift d changes the top direction by -d . grad of it, in the mean over the sheet."""
    plan = design(40, 46, twist=0.0)
    uv = plan.uv[plan.surface.faces].mean(axis=1)
    slope = np.array([0.3, -0.2])
    plan = replace(plan, theta=np.mod(0.7 + uv @ slope, np.pi))
    shift = np.array([0.011, 0.017])
    found = misaligned(at(plan), shift, 0.0)
    inner = np.all(np.abs(uv) < 0.8, axis=1)
    assert found.dtheta[inner].mean() == pytest.approx(-shift @ slope, rel=0.02)
    turned = line_angle(found.theta - plan.theta + np.pi / 2) - np.pi / 2
    assert turned[inner].mean() == pytest.approx(-shift @ slope / 2, rel=0.02)


def test_a_whole_period_is_the_neighbours_pattern():
    """Shifted by the period of a mosaic, every triangle gets exactly the top direction of the one a period before."""
    plan = design(10, 10, width=2.0, height=2.0, jitter=0.0)
    centre = plan.uv[plan.surface.faces].mean(axis=1)
    period = np.array([0.0, 0.4])  # two rows: the lattice is staggered
    found = misaligned(at(plan), period, 0.0)
    top, nominal = found.theta + found.dtheta / 2, plan.theta + plan.dtheta / 2
    pair = np.abs(centre[:, None] - period - centre).sum(axis=2) < 1e-9
    here, before = np.nonzero(pair)
    assert len(here) > 100
    assert lines_apart(top[here], nominal[before]).max() < 1e-9


def test_rounding_acts_on_what_each_master_says(plain):
    found = film(plain, "rounding", step_deg=5.0)
    for sign in (-1, 1):
        written = np.degrees(found.theta + sign * found.dtheta / 2) / 5
        assert np.abs(written - np.round(written)).max() < 1e-9
    assert lines_apart(found.theta, plain.film.theta).max() < np.deg2rad(2.5) + 1e-9


def test_noise_has_the_deviation_that_was_asked(plain):
    noise = line_angle(film(plain, "director_noise", deviation_deg=3).theta - plain.film.theta + 1) - 1
    assert np.degrees(noise).std() == pytest.approx(3, rel=0.15)
    again = line_angle(film(plain, "director_noise", deviation_deg=3).theta - plain.film.theta + 1) - 1
    assert np.array_equal(noise, again)


def test_material_and_thickness(plain):
    assert film(plain, "lambda", percent=20).material.lambda_ == pytest.approx(0.52)
    assert film(plain, "nu", change=0.1).material.nu == pytest.approx(0.6)
    assert film(plain, "gap", percent=-50).thickness == pytest.approx(0.05)


def test_twist_is_multiplied_everywhere_and_near_the_edge(plain):
    assert np.array_equal(film(plain, "twist", gain=-1.0, overdrive=0.0).dtheta, -plain.film.dtheta)
    factor = film(plain, "twist", gain=1.0, overdrive=1.0).dtheta / plain.film.dtheta
    inner = np.abs(plain.plan.uv[plain.plan.surface.faces].mean(axis=1))
    distance = np.min(np.ptp(plain.plan.uv, axis=0) / 2 - inner, axis=1)  # of a rectangle about the origin
    assert np.abs(factor - (1 + 5 * np.exp(-distance / 2))).max() < 1e-9
