"""Directors at vertices against closed forms: one order better than per triangle, and in the right sense."""

import numpy as np
import pytest
from targets import COOLED, LCE, line_difference

from lce_solver import mesher
from lce_solver.directors import sampled, vertex_lines
from lce_solver.field import sample, sheet
from lce_solver.fields import FIELDS, spherical_zone
from lce_solver.geometry import mean_edge
from lce_solver.topology import boundary_loops
from lce_solver.types import Surface


def error(field, uv, faces, keep=slice(None)):
    """(n,) angles between the vertex directors and the closed form [deg], at the vertices ``keep``."""
    found = vertex_lines(Surface(field.map(uv), faces), uv, field.material)
    np.testing.assert_allclose(np.abs(found), 1, rtol=1e-12)
    return np.degrees(line_difference(np.angle(found) / 2, field.theta(uv)))[keep]


def rms(values):
    return float(np.sqrt(np.mean(values**2)))


def cap(edge):
    """A round cap of the unit sphere, 50 degrees to its rim, and its sheet, cut out of the exact spherical zone."""
    half_angle = np.radians(50)

    def embed(disk):
        sigma = half_angle * np.linalg.norm(disk, axis=1, keepdims=True)
        return np.hstack([half_angle * np.sinc(sigma / np.pi) * disk, np.cos(sigma)])

    def circle(t):
        return np.column_stack([np.cos(2 * np.pi * t), np.sin(2 * np.pi * t)])

    mesh, field = mesher.mesh(embed, circle, edge), spherical_zone(LCE)
    x, y, z = mesh.vertices.T
    top = field.place(np.array(field.limits[1]), np.array(0.0))[2]
    along = field.limits[1] * y / top  # equal areas: x of the sheet is proportional to the height on the sphere
    return field, np.column_stack([along, (np.arctan2(x, z) - field.turn(along)) / field.rate]), mesh.faces


def test_cap_is_met_within_three_hundredths_of_a_degree():
    field, uv, faces = cap(0.0402)
    assert 1700 < len(uv) < 1800
    rim = np.zeros(len(uv), dtype=bool)
    rim[np.concatenate(boundary_loops(faces))] = True
    assert rms(error(field, uv, faces, ~rim)) < 0.015
    assert error(field, uv, faces).max() < 0.1


@pytest.mark.parametrize("name", ["strip", "cylinder", "spherical cap", "disk"])
@pytest.mark.parametrize("material", [LCE, COOLED])
def test_second_order_up_to_the_rim(name, material):
    field, found = FIELDS[name](material), []
    size = np.ptp(sheet(field, 0.3)[0][:, 0])
    for edge in (0.04 * size, 0.01 * size):
        uv, faces = sheet(field, edge)
        found.append((mean_edge(Surface(field.map(uv), faces)), rms(error(field, uv, faces))))
    (coarse, large), (fine, small) = found
    assert np.log(large / small) / np.log(coarse / fine) > 1.5, found


def test_turning_the_sheet_turns_the_lines():
    field, uv, faces = cap(0.15)
    target, turn = Surface(field.map(uv), faces), 0.7
    before = vertex_lines(target, uv, LCE)
    after = vertex_lines(target, uv @ [[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]], LCE)
    np.testing.assert_allclose(after, before * np.exp(2j * turn), atol=1e-9)


def test_sampling_is_exact_for_linear_values_and_closest_outside():
    uv, faces = sheet(FIELDS["cylinder"](LCE), 0.1)
    rng, (low, high) = np.random.default_rng(2), (uv.min(axis=0), uv.max(axis=0))
    points = rng.uniform(low, high, (50, 2))
    values = uv @ (0.3, -2.0) + 1j * uv @ (1.0, 0.5) + 4
    np.testing.assert_allclose(sampled(values, uv, faces, points), points @ (0.3, -2.0) + 1j * points @ (1, 0.5) + 4)
    corner = sampled(uv @ (1.0, 1.0), uv, faces, np.array([high + 5]))
    assert corner[0] == pytest.approx(high.sum())


def test_between_vertices_lines_are_second_order_too():
    field = FIELDS["spherical zone"](LCE)
    found = []
    for edge in (0.1, 0.025):
        uv, faces = sheet(field, edge)
        exact = sample(field, uv, faces)
        middle = sampled(vertex_lines(exact.surface, uv, LCE), uv, faces, uv[faces].mean(axis=1))
        found.append(rms(line_difference(np.angle(middle) / 2, exact.theta)))
    assert np.log(found[0] / found[1]) / np.log(4) > 1.5
