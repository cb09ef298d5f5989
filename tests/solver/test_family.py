"""Steering within the family of solutions: the gradient, and a saddle whose twist comes to carry its bending."""

from dataclasses import replace

import numpy as np
import pytest
from targets import COOLED, LCE, flat, hill

from lce_solver import judge
from lce_solver.family import bent_of, left, steer
from lce_solver.geometry import face_areas
from lce_solver.metric import Stop, as_complex, flatten, lay_flat
from lce_solver.mirror import even_mesh
from lce_solver.surfaces import SURFACES
from lce_solver.twist import bending_left, second_form
from lce_solver.types import Status
from lce_solver.wirtinger import operator


def flattened(surface, material, angle=0.0):
    stretches = material.along, material.across
    return flatten(replace(lay_flat(surface), twins=None), stretches, angle, Stop(1e-7, 3000))


@pytest.mark.parametrize("material", [LCE, COOLED])
def test_what_is_left_is_that_of_the_twist_and_its_gradient_the_derivative(material):
    surface = hill()
    op, bent = operator(surface), bent_of(surface)
    found = flattened(surface, material)
    w = as_complex(found.uv)
    rng = np.random.default_rng(0)
    way = rng.normal(size=len(w)) + 1j * rng.normal(size=len(w))
    step = 1e-6 * np.abs(w).max()
    value, gradient = left(op, w, bent)
    up, down = (left(op, w + s * step * way, bent)[0] for s in (1, -1))
    assert (up - down) / (2 * step) == pytest.approx(np.real(np.vdot(gradient, way)), rel=1e-6)
    # of a fixed mean curvature and another director only this part changes
    other = flattened(surface, material, angle=1.3)
    both = [
        bending_left(second_form(surface, one.uv), one.theta, material, face_areas(surface)) ** 2
        for one in (found, other)
    ]
    change = left(op, as_complex(other.uv), bent)[0] - value
    assert abs(change) > 1e-3
    assert change == pytest.approx(both[1] - both[0], rel=0.05)


def test_the_saddle_gets_a_twist_that_carries_its_bending():
    surface = SURFACES["saddle"](0.06)
    before = flattened(surface, LCE, angle=np.pi / 2)
    after = steer(surface, before, LCE)
    area = face_areas(surface)
    (rms_before, before_left), (rms_after, after_left) = (
        [
            judge.rms(judge.stretch_errors(judge.stretches(surface, one.uv, LCE), LCE), area),
            bending_left(second_form(surface, one.uv), one.theta, LCE, area),
        ]
        for one in (before, after)
    )
    assert before_left > 0.2
    assert after_left < 0.15
    assert rms_after < 1.3 * rms_before
    assert after.status is Status.CONVERGED
    assert not len(judge.flipped(after.uv, surface.faces))


def test_a_flat_target_has_nothing_to_steer_and_faults_are_left_alone():
    surface = flat()
    found = flattened(surface, LCE)
    assert np.array_equal(steer(surface, found, LCE).uv, found.uv)
    broken = replace(found, status=Status.FLIPPED)
    assert steer(hill(), broken, LCE) is broken


def test_a_symmetric_sheet_stays_symmetric():
    surface = even_mesh(SURFACES["saddle"](0.08), 0.08)
    rigid = lay_flat(surface)
    assert rigid.twins is not None
    found = steer(surface, flatten(rigid, (LCE.along, LCE.across), 0.0, Stop(1e-6)), LCE)
    w = as_complex(found.uv)
    assert np.abs(w[rigid.twins] - w.conj()).max() < 1e-9 * np.abs(w).max()
