"""Weight and plate: derivatives, equilibrium, beam theory."""

from dataclasses import replace

import numpy as np
import pytest
from flatsheets import HOT, apart, cap_film, disk, rectangle, triangulated, uniform
from scipy import sparse
from scipy.sparse.linalg import spsolve

from lce_solver.load import Load, on_plate, specific_weight, vertex_areas
from lce_solver.mesher import mesh
from lce_solver.shell import predict, relax
from lce_solver.shell_patch import shell
from lce_solver.types import Material, Status

LCE = Material(0.6, 0.5)


def resting(flat, pull):
    return replace(flat, load=on_plate(flat.sheet, flat.thickness, pull))


def hot(flat):
    return flat.at(flat.material.lambda_)


def random_state():
    rng = np.random.default_rng(1)
    flat = resting(uniform(disk(4), LCE, 0.1, theta=0.3, dtheta=0.1), 0.3)
    x = np.column_stack([flat.sheet.uv, 0.005 * rng.normal(size=len(flat.sheet.uv))])
    return flat, x, rng.normal(size=x.shape)


def test_gradient_is_the_derivative_of_the_energy():
    flat, x, direction = random_state()
    slope = np.vdot(flat.energy(hot(flat), x)[1], direction)
    errors = []
    for step in (2e-6, 1e-6):
        up, down = (flat.energy(hot(flat), x + s * step * direction)[0] for s in (1, -1))
        errors.append((up - down) / (2 * step) / slope - 1)
    assert abs(errors[1]) < 1e-5
    own = flat.load.energy(x)[1]
    up, down = (flat.load.energy(x + s * 1e-7 * direction)[0] for s in (1, -1))
    assert (up - down) / 2e-7 == pytest.approx(np.vdot(own, direction), rel=1e-7)


def test_stiffness_holds_that_of_the_plate():
    flat, x, direction = random_state()
    bare = replace(flat, load=None)
    more = np.zeros((len(x), len(x)))
    blocks = flat.stiffness(hot(flat), x) - bare.stiffness(hot(flat), x)
    for nodes, block in zip(flat.sheet.patch, blocks, strict=True):
        more[np.ix_(nodes, nodes)] += block[:, :, 2, 2]
    step = 1e-7 * direction * [0, 0, 1]
    change = flat.load.energy(x + step)[1][:, 2] - flat.load.energy(x)[1][:, 2]
    assert np.allclose(more @ step[:, 2], change, rtol=1e-3, atol=1e-15)


def test_weight_is_density_times_gravity():
    """A cubic metre of water on 1 MPa: 9806.65 N."""
    assert specific_weight(1000.0, 1.0) * 1e9 == pytest.approx(9806.65)
    sheet = uniform(rectangle(8, 8, 20.0, 20.0), LCE, 0.1).sheet
    load = on_plate(sheet, 0.1, specific_weight(1200.0, 1.0))
    assert load.weight.sum() == pytest.approx(1200 * 9.80665 * 0.02**2 * 1e-4 * 1.0)  # 0.47 mN over 1 N/mm^2
    assert vertex_areas(sheet).sum() == pytest.approx(400)


def test_a_heavy_sheet_of_one_director_stays_flat_on_the_plate():
    flat = resting(uniform(disk(7), LCE, 0.02, theta=0.7), 1e-3)
    found = predict(flat, seed=0, tolerance=1e-14)
    assert found.status is Status.CONVERGED
    assert np.abs(found.vertices[:, 2]).max() < 1e-8
    c, s = np.cos(0.7), np.sin(0.7)
    turn = np.array([[c, -s], [s, c]])
    flat_shape = flat.sheet.uv @ (turn * (LCE.along, LCE.across) @ turn.T).T
    assert apart(found.vertices, np.column_stack([flat_shape, 0 * flat_shape[:, 0]])) < 1e-7


def strip(columns, rows, jitter=0.1):
    """Nearly equilateral triangles of a strip of length 1 along x."""
    edge = 1 / columns
    even, odd = np.arange(columns + 1) * edge - 0.5, np.r_[-0.5, (np.arange(columns) + 0.5) * edge - 0.5, 0.5]
    lines = [(odd if j % 2 else even, (j - rows / 2) * edge * np.sqrt(0.75)) for j in range(rows + 1)]
    points = np.array([(x, y) for line, y in lines for x in line])
    inner = np.all(np.abs(points) < points.max(axis=0) * (1 - 1e-9), axis=1)
    points[inner] += jitter * edge * np.random.default_rng(0).uniform(-1, 1, (inner.sum(), 2))
    return triangulated(points)


def test_a_supported_strip_sags_as_a_beam():
    """Ends on two supports: 5 q L^4 / (384 E I) in the middle (Timoshenko), I = width thickness^3 / 12."""
    pull, thickness = 5e-6, 0.02
    flat = uniform(strip(40, 4), Material(1 + 1e-9, 0.0), thickness)
    x = flat.sheet.uv[:, 0]
    end = np.abs(x) > 0.4999
    weight = pull * thickness * vertex_areas(flat.sheet)
    flat = replace(flat, load=Load(weight, weight.sum() * end / end.sum(), 0.05 * thickness))
    found = relax(flat, hot(flat), np.column_stack([flat.sheet.uv, 0 * x]), 1e-11)
    assert found.status is Status.CONVERGED
    z = found.x[:, 2]
    middle = np.polyfit(x, z, 4)[-1]  # the beam's line is of fourth order
    assert middle - z[end].mean() == pytest.approx(-5 * pull * 12 / (384 * thickness**2), rel=0.02)


def square(stretch, edge):
    """The mesher's triangles, stretched as a director along x stretches those of a target, in a unit square."""
    size = np.sqrt([stretch, 1 / stretch])

    def outline(t):
        x, y = (-0.5, 0.5, 0.5, -0.5, -0.5), (-0.5, -0.5, 0.5, 0.5, -0.5)
        return np.column_stack([np.interp(t % 1, (0, 0.25, 0.5, 0.75, 1), side) for side in (x, y)])

    made = mesh(lambda uv: np.column_stack([uv * size, 0 * uv[:, 0]]), outline, edge, corners=(0, 0.25, 0.5, 0.75))
    return made.vertices[:, :2] / size, made.faces


@pytest.mark.parametrize("stretch", [1.0, HOT.across / HOT.along])
def test_a_supported_square_sags_as_a_plate(stretch):
    """0.0040624 q a^4 / D in the middle (Timoshenko, Poisson's ratio 0.3), on triangles as designs have them.

    The quadratic patches are exact for bending that the sheet wants, not for bending that a load forces on irregular
    triangles: 2 to 5 % too soft, whatever the size.
    """
    sheet, poisson = shell(*square(stretch, 0.07)), 0.3
    plate = np.array([[1, poisson, 0], [poisson, 1, 0], [0, 0, 2 * (1 - poisson)]])
    stiff = sheet.curves.T @ sparse.kron(plate, sparse.diags(sheet.area)) @ sheet.curves
    free = np.flatnonzero(np.abs(sheet.uv).max(axis=1) < 0.5 - 1e-9)
    sag = spsolve(stiff.tocsc()[free][:, free], vertex_areas(sheet)[free])
    assert 1.0 < sag.max() / 0.0040624 < 1.05


def test_the_plate_carries_the_weight_and_a_heavy_cap_is_lower():
    flat = cap_film(disk(7))
    heights = []
    for pull in (1e-7, 3e-5):
        heavy = resting(flat, pull)
        found = predict(heavy, seed=1)
        assert found.status is Status.CONVERGED
        push = (heavy.load.push - heavy.load.energy(found.vertices)[1][:, 2]).sum()
        assert push == pytest.approx(heavy.load.weight.sum(), rel=0.02)
        assert found.vertices[:, 2].min() > -0.5 * flat.thickness
        heights.append(np.ptp(found.vertices[:, 2]))
    free = predict(flat, seed=1)
    light = predict(resting(flat, 1e-7), seed=1)
    assert apart(light.vertices, free.vertices) < 0.02
    assert heights[1] < 0.99 * heights[0]
