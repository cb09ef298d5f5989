"""Twist that a film can follow: the filter's laws, the cap, and what they cost."""

from dataclasses import replace

import numpy as np
import pytest
from targets import LCE, flat, hill

from lce_solver.bounded import filtered
from lce_solver.design import design
from lce_solver.geometry import face_areas
from lce_solver.types import Severity

QUICK = {"starts": 1, "tolerance": 1e-6}


def finding(plan, name):
    return next(found for found in plan.findings if found.check == name)


def test_filter_keeps_constants_integrals_and_range():
    surface = flat(30, 20)
    uv, area = surface.vertices[:, :2], face_areas(surface)
    noise = np.random.default_rng(2).normal(size=(len(area), 2, 2))
    smooth = filtered(noise, uv, surface.faces, 0.1)
    np.testing.assert_allclose(np.tensordot(area, smooth, 1), np.tensordot(area, noise, 1), atol=1e-12)
    assert noise.min() < smooth.min() < smooth.max() < noise.max()
    np.testing.assert_allclose(filtered(np.ones_like(noise), uv, surface.faces, 0.1), 1)


def test_filter_spreads_over_its_length():
    """A spike becomes a bump whose variance along each axis is the square of the length."""
    surface = flat(60, 42)
    uv, area = surface.vertices[:, :2], face_areas(surface)
    middle = uv[surface.faces].mean(axis=1)
    spike = np.zeros(len(area))
    spike[np.argmin(np.linalg.norm(middle - uv.mean(axis=0), axis=1))] = 1
    for length in (0.08, 0.12):
        bump = area * filtered(spike, uv, surface.faces, length)
        bump /= bump.sum()
        centre = bump @ middle
        np.testing.assert_allclose(bump @ (middle - centre) ** 2, length**2, rtol=0.15)


def test_cap_cuts_and_its_cost_is_told():
    plan = design(hill(), LCE, 20.0, 1.0, **QUICK)
    limit = np.abs(plan.dtheta).max() / 2
    capped = design(hill(), LCE, 20.0, 1.0, **QUICK, twist_limit=limit)
    np.testing.assert_allclose(capped.dtheta, np.clip(plan.dtheta, -limit, limit))
    cost = finding(capped, "twist_cost")
    assert cost.value > finding(plan, "twist_cost").value >= 0
    assert f"{np.sum(np.abs(plan.dtheta) >= limit)} of {len(plan.dtheta)} triangles" in cost.message
    assert finding(design(hill(), LCE, 20.0, 1.0, **QUICK, twist_limit=limit / 20), "twist_cost").severity is (
        Severity.WARNING
    )


def test_pointwise_best_twist_costs_nothing():
    plan = design(hill(), LCE, 20.0, 0.1, **QUICK, twist_filter=0.0)
    assert finding(plan, "twist_cost").value == pytest.approx(0, abs=1e-12)
    assert finding(replace(plan), "twist_share").value ** 2 + plan.bending_left**2 == pytest.approx(1)
