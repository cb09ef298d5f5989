"""Designs: size and place of the sheet, invariances, and a finding for everything that can go wrong."""

from dataclasses import replace

import numpy as np
import pytest
from targets import LCE, flat, hill, line_difference, mirrored, moved, patch, ramp, renumbered, scaled, turned_over

from lce_solver import judge
from lce_solver.assess import rough, solved, stretched, twisted
from lce_solver.design import design
from lce_solver.errors import InputError
from lce_solver.geometry import face_areas
from lce_solver.surfaces import SURFACES
from lce_solver.types import Material, Severity, Status

QUARTER = np.pi / 2
EXACT = {"tolerance": 1e-14, "max_iterations": 20000, "starts": 2}


def hill_design(surface=None, **changed):
    return design(surface or hill(), LCE, 20.0, 0.1, **{**EXACT, **changed})


def finding(plan, name):
    return next(found for found in plan.findings if found.check == name)


@pytest.fixture(scope="module")
def plan():
    return hill_design()


@pytest.mark.parametrize("name", SURFACES)
def test_shipped_targets_become_valid_sheets(name):
    plan = design(SURFACES[name](0.06), LCE, 20.0, 0.1, starts=2, tolerance=1e-6)
    assert plan.flattening.status is Status.CONVERGED
    assert len(judge.flipped(plan.uv, plan.surface.faces)) == 0
    assert finding(plan, "stretch_rms").value < 0.05
    assert finding(plan, "stretch_rms").severity is Severity.INFO


def test_sheet_has_its_width_and_lies_around_the_origin(plan):
    low, high = plan.uv.min(axis=0), plan.uv.max(axis=0)
    assert (high - low).max() == pytest.approx(20, rel=1e-14)
    np.testing.assert_allclose(low + high, 0, atol=1e-12)
    areas = [
        np.prod(np.ptp(plan.uv @ [[np.cos(t), -np.sin(t)], [np.sin(t), np.cos(t)]], axis=0))
        for t in np.linspace(-0.2, 0.2, 41)
    ]
    assert np.argmin(areas) == 20  # the axis-parallel rectangle is the smallest
    assert len(judge.flipped(plan.uv, plan.surface.faces)) == 0


def test_sheet_and_target_have_one_scale(plan):
    """lambda and nu fix the area ratio: target over sheet = lambda^(1 - nu)."""
    flat_area = np.linalg.det(np.diff(plan.uv[plan.surface.faces], axis=1)).sum() / 2
    assert face_areas(plan.surface).sum() / flat_area == pytest.approx(0.6**0.5, rel=0.01)
    edge = np.linalg.norm(np.diff(plan.surface.vertices[plan.surface.faces][:, :2], axis=1), axis=2)
    raw = np.linalg.norm(np.diff(hill().vertices[hill().faces][:, :2], axis=1), axis=2)
    assert np.ptp(edge / raw) < 1e-12


def test_sheet_lies_as_the_target_is_seen():
    """A flat rectangle, 2 x 1.4, turned by 20 degrees in its plane: the sheet's x runs along the target's long side."""
    surface = flat()
    c, s = np.cos(np.radians(20)), np.sin(np.radians(20))
    leaning = patch(lambda x, y: (c * x - s * y, s * x + c * y, 0 * x), 8, 6)[1]
    for target in (surface, leaning):
        plan = design(target, LCE, 20.0, 0.1, starts=1)
        slope = np.linalg.lstsq(surface.vertices[:, :2], plan.uv, rcond=None)[0]
        assert slope[0, 0] > 0
        assert slope[1, 1] > 0
        np.testing.assert_allclose([slope[0, 1], slope[1, 0]], 0, atol=1e-6)


def test_sheet_of_an_upright_target_has_x_to_the_right():
    """A wall in the x-z plane that looks towards -y: seen from there, x runs right and z up."""
    plan = design(patch(lambda x, y: (x, 0 * x, y), 8, 6)[1], LCE, 20.0, 0.1, starts=1)
    slope = np.linalg.lstsq(plan.surface.vertices[:, [0, 2]], plan.uv, rcond=None)[0]
    assert np.all(np.diag(slope) > 0)


def test_sheet_of_a_target_that_looks_along_x_has_y_to_the_right():
    plan = design(patch(lambda x, y: (0 * x, x, y), 8, 6)[1], LCE, 20.0, 0.1, starts=1)
    slope = np.linalg.lstsq(plan.surface.vertices[:, [1, 2]], plan.uv, rcond=None)[0]
    assert np.all(np.diag(slope) > 0)


@pytest.mark.parametrize("change", [moved, lambda s: scaled(s, 1e3), lambda s: scaled(s, 1e-3)])
def test_position_and_unit_of_the_target_do_not_matter(plan, change):
    other = hill_design(change(hill()))
    assert line_difference(plan.theta, other.theta, QUARTER).max() < 1e-4
    np.testing.assert_allclose(other.dtheta, plan.dtheta, atol=1e-5)
    np.testing.assert_allclose(other.stretch, plan.stretch, atol=1e-5)
    assert other.bending_left == pytest.approx(plan.bending_left, abs=1e-5)


def test_numbering_of_the_target_does_not_matter(plan):
    surface, faces = renumbered(hill())
    other = hill_design(surface)
    assert line_difference(plan.theta[faces], other.theta).max() < 1e-4
    np.testing.assert_allclose(other.dtheta, plan.dtheta[faces], atol=1e-5)


def test_mirrored_target_mirrors_the_design(plan):
    other = hill_design(mirrored(hill()))
    np.testing.assert_allclose(other.uv, plan.uv * (-1, 1), atol=1e-3)
    assert line_difference(np.pi - plan.theta, other.theta).max() < 1e-4
    np.testing.assert_allclose(other.dtheta, -plan.dtheta, atol=1e-5)


def test_turned_over_target_keeps_its_twist(plan):
    """Seen from below angles change their sign, and so does the order of top and bottom."""
    other = hill_design(turned_over(hill()))
    assert line_difference(-plan.theta, other.theta, QUARTER).max() < 1e-4
    np.testing.assert_allclose(other.dtheta, plan.dtheta, atol=1e-5)


def test_twist_scales_with_thickness_gain_and_size(plan):
    np.testing.assert_allclose(
        design(hill(), LCE, 20.0, 0.2, **EXACT, twist_filter=1.5).dtheta, 2 * plan.dtheta, rtol=1e-12
    )
    np.testing.assert_allclose(hill_design(twist_gain=-3.0).dtheta, -3 * plan.dtheta, rtol=1e-12)
    np.testing.assert_allclose(
        design(hill(), LCE, 40.0, 0.1, **EXACT, twist_filter=6.0).dtheta, plan.dtheta / 2, rtol=1e-9
    )


def test_edge_overdrive_only_raises_the_edge(plan):
    factor = hill_design(edge_overdrive=True).dtheta / plan.dtheta
    assert factor.max() < 6
    assert factor.min() > 1
    middle = np.argmin(np.linalg.norm(plan.uv[plan.surface.faces].mean(axis=1), axis=1))
    corner = np.argmax(np.linalg.norm(plan.uv[plan.surface.faces].mean(axis=1), axis=1))
    assert factor[middle] < 2.5 < 4 < factor[corner]


def test_good_design_has_no_complaints():
    plan = design(hill(), LCE, 200.0, 0.1, starts=2)
    assert {found.check for found in plan.findings} == {
        "length_bound",
        "solver",
        "stretch_rms",
        "stretch_max",
        "twist_limit",
        "twist_share",
        "twist_cost",
        "director_jump",
    }
    assert {found.severity for found in plan.findings} == {Severity.INFO}


def test_share_of_twist_is_what_is_not_left(plan):
    assert finding(plan, "twist_share").value ** 2 + plan.bending_left**2 == pytest.approx(1)


def test_large_twist_is_a_warning_with_its_place():
    plan = design(hill(), LCE, 20.0, 4.0, starts=1)
    found = finding(plan, "twist_limit")
    assert found.severity is Severity.WARNING
    worst = np.argmax(np.abs(plan.dtheta))
    assert found.value == pytest.approx(np.degrees(np.abs(plan.dtheta[worst])))
    assert found.where.startswith(f"triangle {worst} at (")
    assert f"{np.sum(np.abs(plan.dtheta) > np.radians(5))} of {len(plan.dtheta)} triangles" in found.message


def test_material_that_can_not_reach_the_target_is_a_warning():
    """Most of a hemisphere from a sheet that hardly stretches."""
    deep = patch(lambda u, v: (np.sin(u) * np.cos(v), np.sin(v), np.cos(u) * np.cos(v)), 10, 10, 2.6, 2.6)[1]
    plan = design(deep, Material(0.99, 0.5), 20.0, 0.1, starts=1, tolerance=1e-6)
    found = finding(plan, "stretch_rms")
    assert found.severity is Severity.WARNING
    assert found.value > found.limit == 0.05


def test_stretches_far_off_are_an_error(plan):
    found, _ = stretched(replace(plan, stretch=plan.stretch * 1.07))
    assert found.severity is Severity.WARNING
    found, _ = stretched(replace(plan, stretch=plan.stretch * 1.13))
    assert found.severity is Severity.ERROR
    assert found.value > found.limit == 0.1


def test_a_twist_of_a_quarter_turn_is_an_error(plan):
    """The plates cannot tell +91 from -89 degrees."""
    factor = 90 / np.degrees(np.abs(plan.dtheta).max())
    assert twisted(replace(plan, dtheta=plan.dtheta * factor * 0.99)).severity is Severity.WARNING
    found = twisted(replace(plan, dtheta=plan.dtheta * factor * 1.01))
    assert found.severity is Severity.ERROR
    assert found.value > found.limit == 90
    assert "other twist" in found.message


def test_a_cap_that_leaves_no_use_of_twist_is_told():
    weak = Material(0.999, 0.5)
    free = design(hill(6, 5), weak, 20.0, 0.1, starts=1, tolerance=1e-6)
    assert finding(free, "twist_limit").severity is Severity.ERROR
    capped = design(hill(6, 5), weak, 20.0, 0.1, starts=1, tolerance=1e-6, twist_limit=np.radians(5))
    assert finding(capped, "twist_limit").severity is Severity.INFO
    assert finding(capped, "twist_cost").severity is Severity.WARNING
    assert "choose lambda further from 1" in finding(capped, "twist_cost").message


@pytest.mark.parametrize(("lambda_", "nu"), [(1e-300, 0.5), (0.6, 5000.0), (0.6, -5000.0), (30.0, 0.1), (0.9, 1e308)])
def test_absurd_materials_are_refused(lambda_, nu):
    with pytest.raises(InputError, match=r"both stretches between 0\.05 and 20"):
        Material(lambda_, nu)


def test_unfinished_solution_is_an_error():
    plan = hill_design(max_iterations=2)
    assert plan.flattening.status is Status.ITERATION_LIMIT
    assert finding(plan, "solver").severity is Severity.ERROR
    assert "max_iterations" in finding(plan, "solver").message


def test_sheet_that_covers_itself_is_an_error_with_its_place():
    plan = design(ramp(), LCE, 20.0, 0.1, starts=1)
    found = finding(plan, "solver")
    assert plan.flattening.status is Status.OVERLAP
    assert found.severity is Severity.ERROR
    assert found.value == len(plan.flattening.crossings) > 0
    assert found.where.startswith("outline at (")


def test_flipped_triangle_is_an_error_with_its_place(plan):
    flat = replace(plan.flattening, status=Status.FLIPPED, flipped=[7, 9])
    found = solved(replace(plan, flattening=flat))
    assert found.severity is Severity.ERROR
    assert found.value == 2
    assert found.where.startswith("triangle 7 at (")


@pytest.mark.parametrize(("width", "thickness", "name"), [(0.0, 0.1, "width"), (20.0, np.nan, "thickness")])
def test_sizes_must_be_lengths(width, thickness, name):
    with pytest.raises(InputError, match=name):
        design(flat(), LCE, width, thickness)


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("starts", 0),
        ("max_iterations", 0),
        ("tolerance", -1.0),
        ("smoothing", np.nan),
        ("smoothing", 1e9),
        ("twist_limit", -1.0),
        ("twist_limit", np.nan),
        ("twist_filter", np.nan),
        ("twist_gain", np.inf),
    ],
)
def test_settings_out_of_range_are_refused_by_name(name, value):
    with pytest.raises(InputError, match=rf"^{name} is .*; give a number from"):
        design(flat(), LCE, 20.0, 0.1, **{name: value})


def test_director_jump_is_the_turn_across_edges(plan):
    """One triangle turned by 80 degrees is 1 of 160, so a few of 200 edges jump; a turn by 180 degrees is none."""
    theta = plan.theta.copy()
    theta[77] += np.radians(80)
    assert rough(replace(plan, theta=theta)).value > rough(plan).value + 40
    assert rough(replace(plan, theta=plan.theta + np.pi)).value == pytest.approx(rough(plan).value)
