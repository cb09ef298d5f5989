"""Curvature and twist against geometry that can be worked out by hand."""

import numpy as np
import pytest
from targets import COOLED, LCE, flat, hill, patch

from lce_solver.geometry import face_areas
from lce_solver.twist import (
    bending_left,
    edge_distance,
    edge_factor,
    in_director_frame,
    second_form,
    twist,
    twisted_form,
)

THICKNESS = 0.1


def sphere(u, v):
    """Normal outwards: curvature -1 in all directions."""
    return np.sin(u) * np.cos(v), np.sin(v), np.cos(u) * np.cos(v)


def torus(u, v):
    ring = 2 + np.cos(1 + u)
    return ring * np.sin(v / 2), -np.sin(1 + u), ring * np.cos(v / 2)


def saddle(u, v):
    return u, v, 0.4 * (u**2 - v**2) + 0.2 * u**3


def exact_form(embed, uv):
    """(n, 2, 2) second form of an embedding, by central differences of a smooth function."""
    step = 1e-3
    u, v = uv.T

    def at(i, j):
        return np.stack(embed(u + i * step, v + j * step), axis=1)

    normal = np.cross(at(1, 0) - at(-1, 0), at(0, 1) - at(0, -1))
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    uu = at(1, 0) - 2 * at(0, 0) + at(-1, 0)
    vv = at(0, 1) - 2 * at(0, 0) + at(0, -1)
    cross = (at(1, 1) - at(1, -1) - at(-1, 1) + at(-1, -1)) / 4
    form = np.stack([uu, cross, cross, vv], axis=1) / step**2
    return np.einsum("fki,fi->fk", form, normal).reshape(-1, 2, 2)


@pytest.mark.parametrize("embed", [sphere, torus, saddle])
def test_second_form_converges_on_irregular_meshes(embed):
    """First order up to the edge, in the mean and at the worst triangle."""
    mean, worst = [], []
    for n in (10, 20, 40):
        uv, surface = patch(embed, n, n, width=1.6, height=1.6)
        exact = exact_form(embed, uv[surface.faces].mean(axis=1))
        error = np.linalg.norm(second_form(surface, uv) - exact, axis=(1, 2))
        size = np.sqrt(np.mean(exact**2) * 4)
        mean.append(np.sqrt(np.mean(error**2)) / size)
        worst.append(error.max() / size)
    assert np.log2(mean[0] / mean[2]) / 2 > 0.9, mean
    assert np.log2(worst[0] / worst[2]) / 2 > 0.7, worst
    assert mean[2] < 0.03


def test_quadratic_graph_is_fitted_exactly_at_its_flat_point():
    """Where the tangent plane is the plane of projection the fit is the function itself."""
    uv, surface = patch(lambda x, y: (x, y, 1e-6 * (x**2 - 3 * x * y + 2 * y**2)), 8, 8)
    form = second_form(surface, uv)
    np.testing.assert_allclose(form, np.tile([[2e-6, -3e-6], [-3e-6, 4e-6]], (len(form), 1, 1)), rtol=1e-6)


def test_flat_target_has_no_bending():
    surface = flat()
    form = second_form(surface, surface.vertices[:, :2])
    assert np.abs(form).max() < 1e-12
    assert bending_left(form, np.zeros(len(form)), LCE, face_areas(surface)) == 0


def test_second_form_turns_with_the_sheet():
    uv, surface = patch(saddle, 10, 8)
    c, s = np.cos(0.7), np.sin(0.7)
    turn = np.array([[c, -s], [s, c]])
    np.testing.assert_allclose(
        second_form(surface, uv @ turn.T), turn @ second_form(surface, uv) @ turn.T, rtol=0, atol=1e-12
    )


def test_sign_and_size_by_hand():
    """The sheet (u, v) with its director along u becomes z = k x y, k = 0.01 / mm.

    f = (0.6 u, v / sqrt(0.6), k x y), so b_uv = k * 0.6 / sqrt(0.6) = 0.0077460. With h = 0.1, lambda_z = 1.290994
    and lambda^2 - lambda^(-2 nu) = 0.36 - 1.666667 = -1.306667 the twist is 2 * 0.1 * 1.290994 / 1.306667 * 0.0077460
    = +1.53061e-3. The sign is right: the top, turned by +, contracts towards +45 deg and pulls that diagonal up;
    z = k x y rises along +45 deg.
    """
    uv, surface = patch(lambda x, y: (0.6 * x, y / np.sqrt(0.6), 0.01 * 0.6 * x * y / np.sqrt(0.6)), 20, 20)
    form = second_form(surface, uv)
    dtheta = twist(form, np.zeros(len(form)), LCE, THICKNESS)
    np.testing.assert_allclose(dtheta, 1.53061e-3, rtol=2e-4)
    across = twist(form, np.full(len(form), np.pi / 2), LCE, THICKNESS)
    np.testing.assert_allclose(across, -dtheta, rtol=1e-9)


@pytest.mark.parametrize("material", [LCE, COOLED])
def test_prescribed_form_is_the_slope_of_the_metric(material):
    """b-bar = -1/2 da/dzeta, zeta = lambda_z z, for a director that turns through the thickness."""
    theta, dtheta, step = 0.4, 0.03, 1e-6

    def metric(z):
        angle = theta + dtheta * z / THICKNESS
        c, s = np.cos(angle), np.sin(angle)
        turn = np.array([[c, -s], [s, c]])
        return turn @ np.diag([material.along**2, material.across**2]) @ turn.T

    slope = (metric(step) - metric(-step)) / (2 * step * material.through)
    form = twisted_form(np.array([dtheta]), np.array([theta]), material, THICKNESS)[0]
    np.testing.assert_allclose(form, -slope / 2, atol=1e-9)


@pytest.mark.parametrize("material", [LCE, COOLED])
def test_twist_minimises_the_distance_of_the_forms(material):
    rng = np.random.default_rng(7)
    form = rng.normal(size=(50, 2, 2))
    form = form + form.transpose(0, 2, 1)
    theta = rng.uniform(0, np.pi, 50)
    best = twist(form, theta, material, THICKNESS)

    def distance(dtheta):
        return ((twisted_form(dtheta, theta, material, THICKNESS) - form) ** 2).sum(axis=(1, 2))

    for change in (1e-4, -1e-4, 0.1):
        assert np.all(distance(best + change) > distance(best))
    left = in_director_frame(form - twisted_form(best, theta, material, THICKNESS), theta)
    np.testing.assert_allclose(left[:, 0, 1], 0, atol=1e-12)


def test_share_of_bending_out_of_reach():
    """z = x y bends along the diagonals: twist reaches all of it from a director along x, nothing from 45 degrees."""
    saddle_form = np.tile([[0.0, 1.0], [1.0, 0.0]], (4, 1, 1))
    area = np.array([1.0, 2.0, 3.0, 4.0])
    assert bending_left(saddle_form, np.zeros(4), LCE, area) == pytest.approx(0, abs=1e-12)
    assert bending_left(saddle_form, np.full(4, np.pi / 4), LCE, area) == pytest.approx(1)


def test_share_is_measured_on_the_target():
    """The share does not depend on how much the sheet stretches, only on the curvatures of the heated shape."""
    curvature = np.array([[-1.0, 0.5], [0.5, -1.0]])  # along and across the director: 2 of 2.5 are on the diagonal
    for material in (LCE, COOLED):
        stretch = np.diag([material.along, material.across])
        left = bending_left((stretch @ curvature @ stretch)[None], np.zeros(1), material, np.ones(1))
        assert left == pytest.approx(np.sqrt(2 / 2.5))


def test_distance_to_the_edge_of_a_rectangle():
    surface = flat(width=2.0, height=1.4)
    uv = surface.vertices[:, :2]
    x, y = uv[surface.faces].mean(axis=1).T
    expected = np.minimum(1 - np.abs(x), 0.7 - np.abs(y))
    np.testing.assert_allclose(edge_distance(uv, surface.faces), expected, atol=1e-12)
    np.testing.assert_allclose(edge_factor(uv, surface.faces), 1 + 5 * np.exp(-expected / 2), atol=1e-12)


def test_twist_of_a_bent_sheet_uses_its_own_metric():
    """On half the sheet the same target takes four times the twist: b-tilde is quadratic in the derivative of f."""
    surface = hill()
    uv = surface.vertices[:, :2]
    theta = np.full(len(surface.faces), 0.3)
    one = twist(second_form(surface, uv), theta, LCE, THICKNESS)
    half = twist(second_form(surface, uv / 2), theta, LCE, THICKNESS)
    np.testing.assert_allclose(half, 4 * one, rtol=1e-9)
