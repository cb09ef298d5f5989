"""Exact director fields: the metric of the map, the curvature and the judge of both are independent of each other."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
import pytest

from lce_solver.errors import InputError
from lce_solver.field import Field, curvature, sample, sheet
from lce_solver.fields import (
    FIELDS,
    cone,
    cylinder,
    disk,
    paraboloid,
    pseudosphere_cap,
    spherical_cap,
    spherical_zone,
    strip,
)
from lce_solver.types import Floats, Material

MATERIALS = {
    "heated": Material(0.6, 0.5),
    "cooled": Material(1.4, 0.5),
    "peer": Material(0.58, 0.1413),
    "weak": Material(0.8, 0.3),
}
CASES = {
    **FIELDS,
    "saddle strip": lambda m: strip(m, -2.0),
    "lopsided strip": lambda m: strip(m, 0.7, 0.2, 0.3),
    "small cap": lambda m: spherical_cap(m, 1e-3),
    "radial": lambda m: cone(m, 0.0),
    "spiral cone": lambda m: cone(m, 1.0),
    "spiral anticone": lambda m: cone(m, 0.3, 5.0),
    "bump": lambda m: disk(m, lambda p: p, lambda p: 0.3 * np.exp(-(p**2)), 0.8),
    "vase": lambda m: cylinder(m, lambda p: 1 + 0.1 * np.sin(2 * p), lambda p: p, (0.0, 2.0)),
}


@lru_cache
def field_of(case: str, material: str) -> Field:
    return CASES[case](MATERIALS[material])


def points(field: Field, n: int = 60, seed: int = 0) -> Floats:
    """Random points (n, 2) of the sheet, a few per cent inside the limits."""
    rng, (lo, hi) = np.random.default_rng(seed), field.limits
    if field.polar:
        r, t = hi * rng.uniform(0.1, 0.95, n), rng.uniform(-np.pi, np.pi, n)
        return np.stack([r * np.cos(t), r * np.sin(t)], axis=1)
    return np.stack([lo + (hi - lo) * rng.uniform(0.03, 0.97, n), rng.uniform(-2, 2, n)], axis=1)


def jacobian(field: Field, uv: Floats) -> Floats:
    """(n, 3, 2) by complex step: exact to rounding."""
    return np.stack([field.map(uv + 1e-20j * axis).imag / 1e-20 for axis in np.eye(2)], axis=-1)


def metric(material: Material, theta: Floats) -> Floats:
    """R diag(lambda^2, lambda^-2nu) R^T (paper, eq. 1)."""
    n = np.stack([np.cos(theta), np.sin(theta)], axis=1)
    along = n[:, :, None] * n[:, None, :]
    return material.lambda_**2 * along + material.lambda_ ** (-2 * material.nu) * (np.eye(2) - along)


@pytest.mark.parametrize("material", MATERIALS)
@pytest.mark.parametrize("case", CASES)
def test_the_map_stretches_by_the_material_along_the_director(case, material):
    field = field_of(case, material)
    uv = points(field)
    j = jacobian(field, uv)
    np.testing.assert_allclose(np.swapaxes(j, 1, 2) @ j, metric(field.material, field.theta(uv)), atol=1e-8)


@pytest.mark.parametrize("material", MATERIALS)
@pytest.mark.parametrize("case", CASES)
def test_the_directors_curvature_is_the_targets(case, material):
    field = field_of(case, material)
    uv = points(field)
    q = field.radial(uv)
    size = 1e-8 / min(1.0, field.limits[1] ** 2)  # K scales as the inverse square of the size
    np.testing.assert_allclose(field.curvature(uv), field.gaussian(q), rtol=1e-8, atol=size)


def test_the_certificate_refuses_a_wrong_field():
    field = spherical_cap(MATERIALS["heated"])
    uv = points(field)

    def tilted(at):
        c, s = field.director(at)
        return c * np.cos(0.1) - s * np.sin(0.1), s * np.cos(0.1) + c * np.sin(0.1)

    wrong = curvature(tilted, uv, field.material, 0.02 * field.limits[1])
    assert np.abs(wrong - 1).max() > 0.05


def test_curvature_of_theta_of_x_agrees_with_the_one_dimensional_formula():
    """K = -G''/(2 lambda^(2-2nu)) for theta(x) = sin x, derivatives by hand."""
    m, x = Material(0.7, 0.4), np.linspace(-1, 1, 9)
    along, across = m.lambda_**2, m.lambda_ ** (-2 * m.nu)
    t, t1, t2 = np.sin(x), np.cos(x), -np.sin(x)
    g2 = (along - across) * (2 * np.cos(2 * t) * t1**2 + np.sin(2 * t) * t2)
    uv = np.stack([x, x], axis=1)
    found = curvature(lambda at: (np.cos(2 * np.sin(at[:, 0])), np.sin(2 * np.sin(at[:, 0]))), uv, m, 0.1)
    np.testing.assert_allclose(found, -g2 / (2 * along * across), atol=1e-11)


@pytest.mark.parametrize("material", MATERIALS.values(), ids=MATERIALS)
def test_targets_lie_on_the_surfaces_they_are_named_after(material):
    zone, cap = spherical_zone(material, 2.0), spherical_cap(material, 2.0)
    for field in (zone, cap):
        np.testing.assert_allclose(np.linalg.norm(field.map(points(field)), axis=1), 2, rtol=1e-14)
    bowl = paraboloid(material, 3.0)
    x, y, z = bowl.map(points(bowl)).T
    np.testing.assert_allclose(z, -(x**2 + y**2) / 6, atol=1e-13)
    catenoid = cylinder(material)
    x, y, z = catenoid.map(points(catenoid)).T
    np.testing.assert_allclose(np.hypot(x, y), np.cosh(z), rtol=1e-12)
    tractricoid = pseudosphere_cap(material)
    x, y, z = tractricoid.map(points(tractricoid)).T
    rho = np.hypot(x, y)
    np.testing.assert_allclose(z, np.arccosh(1 / rho) - np.sqrt(1 - rho**2), atol=1e-12)


def test_named_fields_agree_with_the_general_constructor():
    material = MATERIALS["heated"]
    cap, general = spherical_cap(material), disk(material, np.sin, np.cos, 1.2)
    uv = points(general)
    np.testing.assert_allclose(general.theta(uv), cap.theta(uv), atol=1e-10)
    shapes = general.map(uv), cap.map(uv)
    distances = [np.linalg.norm(s[:, None] - s[None], axis=2) for s in shapes]  # the longitude's zero is free
    np.testing.assert_allclose(*distances, atol=1e-10)


def test_limits_are_those_of_the_formulae():
    heated = MATERIALS["heated"]
    assert spherical_cap(heated, 2.0).limits[1] ** 2 / 4 == pytest.approx(4 * (0.6**-0.5 - 0.6))  # K r^2 <= 2.76
    zone = spherical_zone(heated)
    rim = zone.map(np.array([[zone.limits[1], 0.0]]))[0]
    assert np.hypot(*rim[:2]) == pytest.approx(0.6**1.5)  # cos(latitude) = lambda^(1 + nu): 62.3 deg
    assert strip(heated, 4.0).limits[1] == pytest.approx(np.sqrt(abs(0.6 - 0.6**-2) / 4))
    apex = cone(heated).map(np.array([[0.0, 0.0], [1.0, 0.0]]))
    assert np.hypot(*apex[1, :2]) / np.linalg.norm(apex[1]) == pytest.approx(0.6**1.5)
    anticone = cone(heated, 0.0)
    angle = np.linspace(0, 2 * np.pi, 20001)
    ring = anticone.map(np.stack([np.cos(angle), np.sin(angle)], axis=1))
    length = np.linalg.norm(np.diff(ring, axis=0), axis=1).sum() / np.linalg.norm(ring[0])
    assert length == pytest.approx(2 * np.pi * 0.6**-1.5, rel=1e-6)
    np.testing.assert_allclose(ring[0], ring[-1], atol=1e-12)


@pytest.mark.parametrize("name", FIELDS)
def test_outside_its_limits_a_field_names_the_bound(name):
    field = FIELDS[name](MATERIALS["heated"])
    outside = np.array([[0.0, 0.0] if field.limits[0] <= 0 else [0.1, 0.0], [1.01 * field.limits[1], 0.0]])
    for function in (field.theta, field.map):
        with pytest.raises(InputError) as caught:
            function(outside)
        assert f"{field.limits[1]:.6g}" in str(caught.value)
        assert field.bound in str(caught.value)
        assert name in str(caught.value)


def test_impossible_targets_are_refused():
    heated = MATERIALS["heated"]
    for make, what in (
        (lambda: strip(heated, 0.0), "curvature"),
        (lambda: strip(heated, 1.0, 1.5), "c0"),
        (lambda: spherical_cap(heated, -1.0), "radius"),
        (lambda: cylinder(heated, span=(-2.0, 2.0)), "2.152"),
        (lambda: cylinder(heated, circumference=0.0), "circumference"),
        (lambda: disk(heated, np.sin, np.cos, 2.0), "rho/r"),
        (lambda: disk(heated, np.cosh, np.positive), "axis"),
    ):
        with pytest.raises(InputError, match=what):
            make()


@pytest.mark.parametrize("name", FIELDS)
def test_samples_have_the_wanted_edge_and_converge_to_the_metric(name):
    field = FIELDS[name](MATERIALS["heated"])
    residual = []
    for edge in (0.1 * field.limits[1], 0.05 * field.limits[1]):
        uv, faces = sheet(field, edge)
        s = sample(field, uv, faces)
        flat, bent = uv[faces], s.surface.vertices[faces]
        du, dx = flat[:, 1:] - flat[:, :1], bent[:, 1:] - bent[:, :1]
        signed = du[:, 0, 0] * du[:, 1, 1] - du[:, 0, 1] * du[:, 1, 0]
        assert (signed > 0).all()
        lengths = np.linalg.norm(flat - np.roll(flat, 1, axis=1), axis=2)
        assert lengths.mean() == pytest.approx(edge, rel=0.12)
        inverse = np.linalg.inv(du)
        found = inverse @ (dx @ np.swapaxes(dx, 1, 2)) @ np.swapaxes(inverse, 1, 2)
        error = np.abs(found - metric(field.material, s.theta)).max(axis=(1, 2))
        residual.append(np.sqrt(np.average(error**2, weights=signed)))
    assert residual[1] < 0.75 * residual[0]
    assert residual[1] < 0.15
