"""Exact solutions and invariances of the forward simulation (sizes about 1 mm, thickness 0.01 to 0.05 mm)."""

from dataclasses import replace

import numpy as np
import pytest
from flatsheets import (
    apart,
    cap_film,
    cone_angle,
    cone_film,
    disk,
    fitted_cone_angle,
    fitted_radius,
    hot,
    quadratic_fit,
    random_state,
    rectangle,
    uniform,
)

from lce_solver import cholesky
from lce_solver.errors import Cancelled, InputError
from lce_solver.shell import film, predict, relax, settle
from lce_solver.shell_energy import energy, parts, reference, stiffness
from lce_solver.shell_patch import shell
from lce_solver.twist import twist
from lce_solver.types import Material, Status

LCE = Material(0.6, 0.5)
COOLED = Material(1.3, 0.4)


# --- operators ---------------------------------------------------------------------------------------------------


def slit_disk():
    """A disk whose border vertices on one ray are doubled: a slit from the rim to the centre."""
    uv, faces = disk(6, jitter=0)
    cut = np.flatnonzero((np.abs(uv[:, 1]) < 1e-9) & (uv[:, 0] > 1e-9))
    twin = {int(v): len(uv) + i for i, v in enumerate(cut)}
    below = uv[faces].mean(axis=1)[:, 1] < 0
    faces = np.where(below[:, None] & np.isin(faces, cut), np.vectorize(lambda v: twin.get(v, v))(faces), faces)
    return np.concatenate([uv, uv[cut]]), faces, twin


@pytest.mark.parametrize("mesh", [disk(1, 0), disk(7, 0.3), rectangle(6, 2, 3, 0.5), slit_disk()[:2]])
def test_second_derivatives_of_quadratic_maps_are_exact_on_every_triangle(mesh):
    sheet = shell(*mesh)
    u, v = mesh[0].T
    curves = (sheet.curves @ np.column_stack([1 + u + u * u, u * v - v, 2 * v * v - u * u])).reshape(3, -1, 3)
    exact = np.array([[2, 0, -2], [0, 0, 4], [0, 1, 0]])
    assert np.abs(curves - exact[:, None]).max() < 1e-10


def test_patches_do_not_reach_across_a_slit():
    uv, faces, twin = slit_disk()
    side = np.where(uv[:, 1] > -1e-9, 1, -1)
    side[list(twin.values())] = -1
    centre = uv[faces].mean(axis=1)
    far = (centre[:, 0] > 0.5) & (np.abs(centre[:, 1]) < 0.3)  # from the tip, so that no way leads around it
    own = np.sign(centre[far, 1])[:, None]
    assert far.sum() > 10
    assert np.all(side[shell(uv, faces).patch[far]] == own)


def test_curvature_of_a_smooth_surface_converges_on_jittered_meshes():
    errors = []
    for rings in (8, 16, 32):
        sheet = shell(*disk(rings, 0.25))
        u, v = sheet.uv.T
        curves = (sheet.curves @ np.sin(2 * u + v)).reshape(3, -1)
        x, y = sheet.uv[sheet.faces].mean(axis=1).T
        exact = -np.sin(2 * x + y) * np.array([[4], [1], [2]])
        errors.append(np.sqrt(np.mean((curves - exact) ** 2)))
    assert np.all(np.log2(np.divide(errors[:-1], errors[1:])) > 0.9)


# --- energy ------------------------------------------------------------------------------------------------------


def test_gradient_is_the_derivative_of_the_energy():
    flat, x, direction = random_state()
    slope = np.vdot(energy(flat.sheet, hot(flat), x)[1], direction)
    errors = []
    for step in (2e-4, 1e-4):
        up, down = (energy(flat.sheet, hot(flat), x + s * step * direction)[0] for s in (1, -1))
        errors.append((up - down) / (2 * step) / slope - 1)
    assert abs(4 * errors[1] - errors[0]) / 3 < 1e-8  # Richardson: what is left is of fourth order
    assert abs(errors[0] / errors[1]) == pytest.approx(4, rel=0.01)


def assembled(flat, x):
    """Dense Hessian, summed triangle by triangle."""
    n = len(x)
    matrix = np.zeros((n, 3, n, 3))
    for nodes, block in zip(flat.sheet.patch, stiffness(flat.sheet, hot(flat), x), strict=True):
        matrix[np.ix_(nodes, range(3), nodes, range(3))] += block.transpose(0, 2, 1, 3)
    return matrix.reshape(3 * n, 3 * n)


def test_stiffness_is_semi_definite_in_any_state():
    flat, x, _ = random_state()
    matrix = assembled(flat, x)
    values = np.linalg.eigvalsh(matrix)
    assert np.abs(matrix - matrix.T).max() < 1e-12 * values[-1]
    assert values[0] > -1e-12 * values[-1]


def test_stiffness_is_the_hessian_where_the_sheet_is_content():
    flat = uniform(disk(4), LCE, 0.3, theta=0.4)
    flat = replace(flat, material=LCE)
    x = affine(flat)
    direction = np.random.default_rng(0).normal(size=x.shape)
    step = 1e-5
    up, down = (energy(flat.sheet, hot(flat), x + s * step * direction)[1] for s in (1, -1))
    exact = assembled(flat, x) @ direction.ravel()
    assert np.abs(((up - down) / (2 * step)).ravel() - exact).max() < 1e-6 * np.abs(exact).max()


def test_energy_does_not_see_rigid_motions_and_scales_as_a_volume():
    flat, x, _ = random_state()
    turn = np.linalg.qr(np.random.default_rng(3).normal(size=(3, 3)))[0]
    turn *= np.sign(np.linalg.det(turn))
    value, gradient = energy(flat.sheet, hot(flat), x)
    moved, turned = energy(flat.sheet, hot(flat), x @ turn.T + (1, 2, 3))
    assert moved == pytest.approx(value, rel=1e-12)
    assert np.abs(turned - gradient @ turn.T).max() < 1e-10 * np.abs(gradient).max()
    larger = film(
        3 * flat.sheet.uv, flat.sheet.faces, flat.theta, flat.dtheta, material=COOLED, thickness=3 * flat.thickness
    )
    assert energy(larger.sheet, hot(larger), 3 * x)[0] == pytest.approx(27 * value, rel=1e-12)


def test_energy_of_a_bent_strip_is_that_of_plate_theory():
    """A sheet rolled to curvature k stores E h^3 k^2 / (24 (1 - nu^2)) per area (incompressible: nu = 1/2)."""
    flat = uniform(rectangle(30, 10, 1, 0.3), Material(1 + 1e-9, 0.0), 0.01)
    k, (u, v) = 0.8, flat.sheet.uv.T
    x = np.column_stack([np.sin(k * u) / k, v, (1 - np.cos(k * u)) / k])
    stretching, bending = parts(flat.sheet, hot(flat), x)
    assert bending == pytest.approx(0.01**3 * k**2 / (24 * 0.75) * 0.3, rel=1e-3)
    assert stretching < 1e-3 * bending


def test_the_twist_of_the_design_is_the_minimiser_of_the_bending_energy():
    """The paper's simpler S5, corrected by its factor 2, is what the Koiter energy wants, at every Poisson ratio."""
    rng = np.random.default_rng(5)
    sheet = shell(*disk(3))
    n = len(sheet.faces)
    theta, form = rng.uniform(0, np.pi, n), rng.normal(size=(n, 2, 2))
    form += form.swapaxes(1, 2)
    best = twist(form, theta, LCE, 0.1)
    wanted = np.stack([form[:, 0, 0], form[:, 1, 1], form[:, 0, 1]], axis=1)

    def left(dtheta, poisson):
        aim = reference(sheet, theta, dtheta, LCE, thickness=0.1, poisson=poisson)
        return np.sum(np.einsum("tij,tj->ti", aim.whitening, wanted - aim.curvature) ** 2, axis=1)

    for poisson in (0.0, 0.3, 0.5):
        low, high = left(best - 0.1, poisson), left(best + 0.1, poisson)
        assert np.allclose(low, high, rtol=1e-9)
        assert np.all(low > left(best, poisson))


# --- exact shapes ------------------------------------------------------------------------------------------------


def affine(flat):
    """The heated shape of a uniform director: stretched along and across it."""
    c, s = np.cos(flat.theta[0]), np.sin(flat.theta[0])
    frame = np.array([[c, -s], [s, c]])
    uv = flat.sheet.uv @ (frame * (flat.material.along, flat.material.across) @ frame.T).T
    return np.column_stack([uv, np.zeros(len(uv))])


@pytest.mark.parametrize("material", [LCE, COOLED])
def test_uniform_director_stretches_the_sheet_and_leaves_it_flat(material):
    flat = uniform(disk(8), material, 0.02, theta=0.7)
    found = predict(flat, seed=0, tolerance=1e-20)
    assert found.status is Status.CONVERGED
    assert apart(found.vertices, affine(flat)) < 1e-10
    assert found.residual_strain < 1e-7  # the root of round-off: eigenvalues of 1 meet
    assert found.energy < 1e-20


def test_circles_heat_into_the_cone():
    flat = cone_film(disk(14))
    found = predict(flat, seed=0)
    assert found.status is Status.CONVERGED
    assert np.degrees(fitted_cone_angle(flat, found.vertices) - cone_angle(flat.material)) == pytest.approx(0, abs=0.1)


def test_the_field_of_constant_curvature_converges_to_a_spherical_cap():
    errors = []
    for rings in (9, 18):
        found = predict(cap_film(disk(rings, jitter=0)), seed=1)
        assert found.status is Status.CONVERGED
        errors.append(abs(fitted_radius(found.vertices) * np.sqrt(2.6) - 1))
    assert errors[1] < 0.0125
    assert np.log2(errors[0] / errors[1]) > 1.5  # the director is sampled once per triangle: second order


def prescribed(flat):
    """b_bar along and across the director: -dtheta (lambda^2 - lambda^-2nu) / (2 h lambda_z)."""
    m = flat.material
    return -flat.dtheta[0] * (m.lambda_**2 - m.lambda_ ** (-2 * m.nu)) / (2 * flat.thickness * m.lambda_**-m.nu)


@pytest.mark.parametrize("sign", [1, -1])
def test_a_narrow_twisted_strip_winds_by_the_prescribed_curvature(sign):
    """b_12 = n . x_12 > 0 turns the cross direction towards the top as one goes along: a right-handed screw."""
    flat = uniform(rectangle(80, 4, 0.6, 0.03), LCE, 0.02, dtheta=sign * 0.05)
    found = predict(flat, seed=0)
    along, across = (flat.sheet.tangents @ found.vertices).reshape(2, -1, 3)
    where = flat.sheet.uv[flat.sheet.faces].mean(axis=1)[:, 0]
    axis = np.linalg.svd(found.vertices - found.vertices.mean(axis=0))[2][0]
    axis *= np.sign(axis @ along.mean(axis=0))
    e2 = across[np.argmin(where)] - axis * (across[np.argmin(where)] @ axis)
    e2 /= np.linalg.norm(e2)
    angle = np.unwrap(np.arctan2(across @ np.cross(axis, e2), across @ e2)[np.argsort(where)])
    inner = np.abs(np.sort(where)) < 0.2
    rate = np.polyfit(np.sort(where)[inner], angle[inner], 1)[0]
    # |x_v| dphi/du = n . x_uv, with |x_v| = lambda^-nu
    assert rate == pytest.approx(prescribed(flat) / LCE.across, rel=0.005)
    assert np.sign(rate) == sign


def test_a_wide_twisted_sheet_rolls_up():
    """It cannot be a saddle, so it rolls about a diagonal, by 1 - nu_e of the prescribed curvature."""
    flat = uniform(rectangle(24, 10, 1.6, 0.7, turn=np.pi / 4), Material(0.9, 0.5), 0.01, dtheta=0.2)
    found = predict(flat, seed=0)
    b11, b22, b12 = quadratic_fit(flat, found.vertices, 0.25)
    stretch = np.diag([1 / flat.material.along, 1 / flat.material.across])
    curvatures = np.linalg.eigvalsh(stretch @ [[b11, b12], [b12, b22]] @ stretch)
    straight, rolled = sorted(curvatures, key=abs)
    twisted = prescribed(flat) / (flat.material.along * flat.material.across)
    assert abs(rolled) == pytest.approx(0.5 * abs(twisted), rel=0.03)
    assert abs(straight) < 0.05 * abs(rolled)


def test_a_symmetric_state_that_is_not_stable_does_not_pass_for_a_minimum():
    """A twisted disk first bends like a saddle; long before the end that costs more than to roll up."""
    flat = uniform(disk(8), Material(0.9, 0.5), 0.01, dtheta=0.08)
    saddle = predict(flat, seed=0, imperfection=0.0, tolerance=1e-3)
    assert predict(flat, seed=0).energy < 0.95 * saddle.energy


@pytest.mark.parametrize("k", [3.0, -3.0])
def test_a_sheet_with_one_curvature_rolls_without_locking(k):
    flat = uniform(rectangle(24, 8, 1, 0.3, jitter=0.25, turn=0.5), Material(1 + 1e-9, 0.0), 0.01)
    e = np.array([np.cos(0.5), np.sin(0.5)])
    aim = replace(hot(flat), curvature=np.tile(k * np.array([e[0] ** 2, e[1] ** 2, e[0] * e[1]]), (len(flat.theta), 1)))
    start = np.column_stack([flat.sheet.uv, 1e-4 * np.random.default_rng(0).standard_normal(len(flat.sheet.uv))])
    found = relax(flat, aim, start, 1e-6)
    b11, b22, b12 = quadratic_fit(flat, found.x, 0.12)
    assert found.status is Status.CONVERGED
    assert (e @ [[b11, b12], [b12, b22]] @ e) / k > 0.995
    assert abs((e @ [[b11, b12], [b12, b22]] @ e) / k - 1) < 0.005


# --- the run -----------------------------------------------------------------------------------------------------


def test_flipped_twist_gives_the_mirror_image_at_the_same_energy():
    flat = film(*disk(9), *swirl(disk(9)), material=LCE, thickness=0.02)
    one = predict(flat, seed=3, tolerance=1e-8)
    other = predict(replace(flat, dtheta=-flat.dtheta), seed=3, tolerance=1e-8)
    mirrored = other.vertices * (1, 1, -1)
    assert other.energy == pytest.approx(one.energy, rel=1e-4)
    assert apart(mirrored, one.vertices) < 1e-2
    assert apart(other.vertices, one.vertices) > 0.1


def swirl(mesh):
    """A smooth director that makes a sheet buckle, and a twist that chooses a side."""
    x, y = mesh[0][mesh[1]].mean(axis=1).T
    return 0.8 * x - 0.6 * y + 0.9, 0.12 + 0.05 * x


def test_same_seed_same_shape():
    flat = cone_film(disk(5))
    assert np.array_equal(predict(flat, seed=4).vertices, predict(flat, seed=4).vertices)


def test_history_tells_the_heating_and_frames_end_in_the_result():
    flat = cone_film(disk(5))
    found = predict(flat, seed=0, steps=7)
    lambdas = [step.lambda_ for step in found.history]
    assert np.all(np.diff(lambdas) < 0)
    assert lambdas[-1] == pytest.approx(0.7)
    assert len(found.frames) == 7
    assert np.array_equal(found.frames[-1], found.vertices)
    assert (found.stretching, found.bending) == parts(flat.sheet, hot(flat), found.vertices)
    assert found.iterations == sum(step.iterations for step in found.history)


@pytest.mark.parametrize("strain", [1e-6, 1e-9, -1e-9, 1e-12])
def test_a_sheet_that_hardly_stretches_stays_flat_at_once(strain):
    """Below the strain of buckling, (thickness / size)^2, and however small, it only stretches and evens out."""
    flat = cone_film(disk(8), material=Material(1 - strain, 0.5), thickness=0.02)
    found = predict(flat, seed=0)
    assert found.status is Status.CONVERGED
    assert found.iterations < 10
    assert apart(found.vertices, np.column_stack([flat.sheet.uv, 0 * flat.sheet.uv[:, 0]])) < 0.02 * flat.thickness


def test_settled_sheet_stays():
    flat = cone_film(disk(6))
    found = predict(flat, seed=0, tolerance=1e-10)
    again = settle(flat, found.vertices)
    assert again.iterations <= 1
    assert again.energy == pytest.approx(found.energy, rel=1e-8)


def test_progress_rises_to_one_and_may_stop_the_run():
    seen = []
    found = predict(cone_film(disk(4)), seed=0, progress=lambda stage, done: seen.append((stage, done)))
    fractions = [done for _, done in seen]
    assert fractions == sorted(fractions)
    assert seen[-1] == ("heating", 1.0)
    assert seen[-2][0].energy == pytest.approx(found.energy, rel=1e-6)  # told before the last step

    def stop(stage, done):
        if done > 0.4:
            raise Cancelled("stopped by the user")

    with pytest.raises(Cancelled):
        predict(cone_film(disk(4)), seed=0, progress=stop)


def test_status_is_honest(monkeypatch):
    flat = cone_film(disk(5))
    monkeypatch.setattr("lce_solver.shell.LIMIT", 3)
    assert predict(flat, seed=0).status is Status.ITERATION_LIMIT
    broken = np.column_stack([flat.sheet.uv, np.full(len(flat.sheet.uv), np.nan)])
    assert settle(flat, broken).status is Status.NOT_FINITE
    crushed = np.column_stack([flat.sheet.uv, np.zeros(len(flat.sheet.uv))])
    tip, *base = flat.sheet.faces[40]
    crushed[tip] = crushed[base].mean(axis=0)
    crushed[tip, 2] = 1e-13
    assert settle(flat, crushed).status is Status.STALLED


def test_mistakes_are_told():
    uv, faces = disk(3)
    with pytest.raises(InputError, match="flipped"):
        shell(uv, faces[:, ::-1])
    with pytest.raises(InputError, match="too few"):
        shell(np.array([(0, 0), (1, 0), (1, 1), (0, 1.0)]), np.array([(0, 1, 2), (0, 2, 3)]))
    for thickness in (0.0, -0.1, np.nan, 1e6):
        with pytest.raises(InputError, match="thickness"):
            film(uv, faces, np.zeros(len(faces)), np.zeros(len(faces)), material=LCE, thickness=thickness)


def test_ordering_is_shared_by_patterns_on_one_mesh():
    flat = cone_film(disk(4))
    assert replace(flat, theta=flat.theta + 0.1).ordering is flat.ordering
    assert isinstance(flat.ordering, cholesky.Plan)
