"""The bound on the length of director lines, on surfaces where it is known in closed form."""

from dataclasses import replace

import numpy as np
import pytest
from targets import cap

from lce_solver.feasible import bounded, feasible_lambda, gaussian_curvature, length_bound, longest
from lce_solver.surfaces import SURFACES
from lce_solver.types import Material, Severity, Surface

MATTER = Material(0.6, 0.5, "test")


@pytest.mark.parametrize("degrees", [40, 60, 75, 90])
def test_a_cap_reaches_the_bound_at_the_angle_of_the_formula(degrees):
    ratio = length_bound(cap(degrees), MATTER).ratio
    assert ratio == pytest.approx(2 * np.radians(degrees) / longest(1.0, MATTER), rel=0.06)


def test_the_bound_of_the_unit_sphere_is_that_of_the_riccati_equation():
    q = 0.6**-1.5
    assert longest(1.0, MATTER) == pytest.approx(np.pi * np.sqrt(1 - q**-2), rel=1e-14)
    flat = np.pi * np.sqrt(0.6**-2 - 0.6)  # pi / k in the flat sheet; lines along the director shrink by lambda
    assert longest(1.0, MATTER) == pytest.approx(0.6 * flat, rel=1e-14)
    assert longest(-1.0, MATTER) == pytest.approx(0.6**-0.5 * flat, rel=1e-14)


def test_a_steep_cap_is_a_warning_that_names_a_lambda_that_does():
    surface = cap(85)
    found = bounded(surface, MATTER)
    assert found.severity is Severity.WARNING
    assert "target.cuts" in found.message
    bound = length_bound(surface, MATTER)
    better = feasible_lambda(bound, MATTER)
    assert better < MATTER.lambda_
    assert f"lambda = {better:.3f}" in found.message
    at_best = replace(bound, limit=longest(bound.curvature, Material(better, 0.5, "test")))
    assert at_best.ratio == pytest.approx(1.0, rel=1e-12)
    assert bounded(cap(50), MATTER).severity is Severity.INFO


def test_for_more_than_half_a_sphere_no_lambda_does():
    bound = length_bound(cap(100), MATTER)
    assert feasible_lambda(bound, MATTER) is None


@pytest.mark.parametrize("nu", [-0.999, -0.999999])
def test_no_lambda_is_named_that_no_material_has(nu):
    """Near nu = -1 all lengths change alike, and only absurd lambdas reach the contrast of the others."""
    target = SURFACES["face"](0.1)
    bound = length_bound(target, Material(0.6, nu))
    assert bound.ratio > 1
    assert feasible_lambda(bound, Material(0.6, nu)) is None
    assert "no lambda would do" in bounded(target, Material(0.6, nu)).message


@pytest.mark.parametrize("lambda_", [0.6, 1 / 0.6])
@pytest.mark.parametrize("name", ["dome", "saddle"])
def test_the_feasible_lambda_is_on_the_same_side_of_1(name, lambda_):
    matter = Material(lambda_, 0.5, "test")
    bound = length_bound(SURFACES[name](0.06), matter)
    better = feasible_lambda(bound, matter)
    assert abs(np.log(better)) < abs(np.log(lambda_))
    assert np.sign(np.log(better)) == np.sign(np.log(lambda_))


def test_the_ratio_knows_no_size_and_no_place():
    surface = cap(60, edge=0.1)
    turn, _ = np.linalg.qr(np.random.default_rng(3).standard_normal((3, 3)))
    moved = Surface(surface.vertices @ (turn * np.sign(np.linalg.det(turn))) * 7 + [1, 2, 3], surface.faces)
    assert length_bound(moved, MATTER).ratio == pytest.approx(length_bound(surface, MATTER).ratio, rel=1e-6)


def test_curvature_is_right_and_a_flat_target_has_no_bound():
    assert gaussian_curvature(cap(50, radius=2.0)) == pytest.approx(0.25, rel=0.03)
    uv = cap(50).vertices * [1, 1, 0]
    assert length_bound(Surface(uv, cap(50).faces), MATTER) is None
    assert "flat" in bounded(Surface(uv, cap(50).faces), MATTER).message


def test_a_closed_surface_has_lines_of_any_length():
    lower = cap(90, edge=0.15)
    n = len(lower.vertices)
    rim = np.abs(lower.vertices[:, 2]) < 1e-9
    twin = np.where(rim, np.arange(n), n - 1 + np.cumsum(~rim))
    ball = Surface(
        np.vstack([lower.vertices, lower.vertices[~rim] * [1, 1, -1]]),
        np.vstack([lower.faces, twin[lower.faces][:, ::-1]]),
    )
    assert length_bound(ball, MATTER).ratio == np.inf
