"""The film as a solid, computed without plate or shell theory, judges sign and size of the twist's curvature."""

import numpy as np
import pytest
import solid
from flatsheets import HOT, quadratic_fit, rectangle, uniform

from lce_solver.compare import align
from lce_solver.shell import predict, relax
from lce_solver.shell_energy import reference
from lce_solver.types import Material

THICKNESS, THETA = 0.1, 0.6


def heated(columns, rows, length, width, material, dtheta):
    """A uniform film as a solid, heated from flat: the body and its shape (n, 3)."""
    size = length, width, THICKNESS
    body = solid.solid(columns, rows, size, lambda x, _: 0 * x + THETA, lambda x, _: 0 * x + dtheta, material)
    frame = np.array([[np.cos(THETA), -np.sin(THETA)], [np.sin(THETA), np.cos(THETA)]])
    flat = body.nodes[:, :2] @ (frame * (material.along, material.across) @ frame.T)
    return body, solid.settle(body, np.column_stack([flat, material.across * body.nodes[:, 2]]))


def test_forces_and_stiffness_of_the_solid_are_derivatives():
    body = solid.solid(2, 1, (2.0, 1.0, 0.4), lambda x, y: x - y, lambda x, y: x * y, HOT)
    rng = np.random.default_rng(0)
    x, way = body.nodes + 0.02 * rng.normal(size=body.nodes.shape), rng.normal(size=body.nodes.shape)
    _, gradient, blocks = solid.state(body, x)
    step = 1e-5
    up, down = (solid.state(body, x + s * step * way) for s in (1, -1))
    assert np.vdot(gradient, way) == pytest.approx((up[0] - down[0]) / (2 * step), rel=1e-6)
    exact = np.zeros_like(x)
    np.add.at(exact, body.bricks, np.einsum("mij,mj->mi", blocks, way[body.bricks].reshape(-1, 81)).reshape(-1, 27, 3))
    assert np.abs((up[1] - down[1]) / (2 * step) - exact).max() < 1e-6 * np.abs(exact).max()


@pytest.mark.parametrize(
    ("lambda_", "dtheta"), [(0.98, 0.02), (0.6, 0.02), (0.6, -0.02), (1.3, 0.02)], ids=lambda v: f"{v:g}"
)
def test_a_twisted_solid_bends_as_prescribed_and_to_that_side(lambda_, dtheta):
    """The second form of a small sheet, which need not stretch: b_12 of the shell's reference, nothing on the diagonal.

    The top (+z) is at theta + dtheta / 2, b = n . x_ij with n to the top. A wrong sign, a missing lambda_z (up to
    29 %) or a factor of 2 would show.
    """
    material = Material(lambda_, 0.5)
    body, x = heated(2, 2, 0.6, 0.6, material, dtheta)
    flat = uniform(rectangle(4, 4, 0.6, 0.6, jitter=0.0), material, THICKNESS, THETA, dtheta)
    wanted = flat.at(lambda_).curvature[0]
    found = quadratic_fit(flat, x[body.middle], 1.0)
    assert np.abs(found - wanted).max() < 0.006 * np.abs(wanted).max()


def test_solid_and_shell_take_the_same_shape():
    """A sheet too wide to stay a saddle: both start flat, both roll up about the same diagonal to the same side."""
    body, x = heated(5, 4, 2.0, 1.5, HOT, 0.05)
    flat = uniform(rectangle(10, 8, 2.0, 1.5, jitter=0.0), HOT, THICKNESS, THETA, 0.05)
    aim = reference(flat.sheet, flat.theta, flat.dtheta, HOT, thickness=THICKNESS, poisson=solid.POISSON)
    shell = relax(flat, aim, predict(flat, seed=1).vertices, 1e-6).x
    ones, diagonal = np.ones(len(shell)), np.linalg.norm(np.ptp(shell, axis=0))
    same, mirror = (align(x[body.middle], shell, ones, reflect=flip).rms / diagonal for flip in (False, True))
    assert same < 0.002
    assert mirror > 0.02
