"""Shipped targets: on the stated surface, a disk, and well meshed at any resolution."""

import numpy as np
import pytest

from lce_solver import surfaces
from lce_solver.face import height, outline
from lce_solver.surface import boundary_loops, check, edge_lengths, face_areas, frames, mean_edge
from lce_solver.surfaces import CAP, HALF_APEX, RUFFLE, SADDLE, SURFACES, TIP, WAVE, ZONE

EDGES = (0.08, 0.04)
CASES = [(name, edge) for name in SURFACES for edge in EDGES]


@pytest.fixture(scope="module")
def targets():
    return {(name, edge): SURFACES[name](edge) for name, edge in CASES}


def angles(surface):
    corner = surface.vertices[surface.faces]
    ahead, behind = np.roll(corner, -1, axis=1) - corner, np.roll(corner, 1, axis=1) - corner
    turn = np.linalg.norm(np.cross(ahead, behind), axis=2)
    return np.degrees(np.arctan2(turn, np.sum(ahead * behind, axis=2)))


def test_the_names_are_those_of_the_job_file():
    assert set(SURFACES) == {"dome", "saddle", "leaf", "cone", "sphere-zone", "face"}


@pytest.mark.parametrize(("name", "edge"), CASES)
def test_a_target_is_a_well_meshed_disk(targets, name, edge):
    surface = targets[name, edge]
    # `check` refuses anything but one oriented disk, and would drop or turn what is superfluous or wrong
    checked = check(surface.vertices, surface.faces)
    np.testing.assert_array_equal(checked.faces, surface.faces)
    assert len(checked.vertices) == len(surface.vertices)
    assert 0.9 * edge < mean_edge(surface) <= edge
    assert np.ptp(surface.vertices, axis=0).max() == pytest.approx(1, rel=0.01)
    assert angles(surface).min() > 28
    assert angles(surface).max() < 120
    length = edge_lengths(surface) / mean_edge(surface)
    assert length.std() < 0.15
    assert 0.5 < length.min() < length.max() < 1.9


@pytest.mark.parametrize(("name", "edge"), CASES)
def test_normals_point_up_or_outwards(targets, name, edge):
    surface = targets[name, edge]
    up = surface.vertices[surface.faces].mean(axis=1) if name == "sphere-zone" else np.array([0, 0, 1.0])
    assert (np.sum(frames(surface)[2] * up, axis=1) > 0).all()


@pytest.mark.parametrize("name", SURFACES)
def test_the_same_request_gives_the_same_mesh(targets, name):
    again = SURFACES[name](EDGES[0])
    np.testing.assert_array_equal(again.vertices, targets[name, EDGES[0]].vertices)
    np.testing.assert_array_equal(again.faces, targets[name, EDGES[0]].faces)


def on_dome(x, y, z):
    radius = 0.5 / np.sin(CAP)
    return x**2 + y**2 + (z + radius * np.cos(CAP)) ** 2 - radius**2


def on_cone(x, y, z):
    """Below the circle of contact the cone, above it the sphere that touches it there."""
    r, contact = np.hypot(x, y), TIP * np.cos(HALF_APEX)
    side = np.cos(HALF_APEX) * (r - contact) + np.sin(HALF_APEX) * z
    ball = r**2 + (z + TIP * np.sin(HALF_APEX)) ** 2 - TIP**2
    return np.where(z < 0, side, ball)


IMPLICIT = {
    "dome": on_dome,
    "saddle": lambda x, y, z: z - SADDLE * (x**2 - y**2),
    "leaf": lambda x, y, z: z - RUFFLE * np.sin(WAVE * x) * np.sinh(WAVE * y),
    "cone": on_cone,
    "sphere-zone": lambda x, y, z: x**2 + y**2 + z**2 - 0.25,
    "face": lambda x, y, z: z - height(np.column_stack([x, y])),
}
RIM = {
    "dome": lambda x, y, z: np.hypot(x, y) - 0.5,
    "saddle": lambda x, y, z: np.hypot(x, y) - 0.5,
    "leaf": lambda x, y, z: np.abs(y) - 0.28 * np.sqrt(1 - (2 * x) ** 2) * (1 - 0.4 * x),
    "cone": lambda x, y, z: np.hypot(x, y) - 0.5,
    "sphere-zone": lambda x, y, z: np.minimum(np.abs(np.abs(y) - 0.5 * np.sin(ZONE)), np.abs(z)),
    "face": lambda x, y, z: np.abs(x) - 0.36 * np.sqrt(1 - (2 * y) ** 2) * (1 + 0.24 * y - 0.2 * y**2),
}


@pytest.mark.parametrize(("name", "edge"), CASES)
def test_vertices_lie_on_the_surface_and_the_rim_on_its_outline(targets, name, edge):
    surface = targets[name, edge]
    np.testing.assert_allclose(IMPLICIT[name](*surface.vertices.T), 0, atol=1e-13)
    (rim,) = boundary_loops(surface.faces)
    np.testing.assert_allclose(RIM[name](*surface.vertices[rim].T), 0, atol=2e-8)  # sqrt(1 - x**2) near its ends


@pytest.mark.parametrize(
    ("name", "area"),
    [
        ("dome", 2 * np.pi * (0.5 / np.sin(CAP)) ** 2 * (1 - np.cos(CAP))),
        ("sphere-zone", np.pi * 0.5 * 2 * 0.5 * np.sin(ZONE)),
        (
            "cone",
            np.pi / np.sin(HALF_APEX) * (0.25 - (TIP * np.cos(HALF_APEX)) ** 2)
            + 2 * np.pi * TIP**2 * (1 - np.sin(HALF_APEX)),
        ),
    ],
)
def test_areas_converge_to_the_exact_ones_at_second_order(targets, name, area):
    coarse, fine = (abs(face_areas(targets[name, edge]).sum() / area - 1) for edge in EDGES)
    assert coarse < 0.02
    assert 3 < coarse / fine < 5.5


def test_the_cone_is_the_one_of_an_azimuthal_director():
    """Circumference x lambda, slant x lambda**-nu: sin(half apex angle) = lambda**(1 + nu)."""
    assert pytest.approx(0.6**1.5) == np.sin(HALF_APEX)


def test_curvature_of_the_leaf_is_negative_and_decays_from_the_edge():
    """K < 0 by second differences; its mean size at the edge is more than 10 times that at the midrib."""
    x, y = np.meshgrid(np.linspace(-0.4, 0.4, 81), np.linspace(-0.2, 0.2, 41))

    def z(x, y):
        return RUFFLE * np.sin(WAVE * x) * np.sinh(WAVE * y)

    h = 1e-4
    zxx, zyy = (z(x + h, y) + z(x - h, y) - 2 * z(x, y)) / h**2, (z(x, y + h) + z(x, y - h) - 2 * z(x, y)) / h**2
    zxy = (z(x + h, y + h) - z(x - h, y + h) - z(x + h, y - h) + z(x - h, y - h)) / (4 * h**2)
    k = zxx * zyy - zxy**2
    assert k.max() < 1e-6
    assert np.abs(k[[0, -1]]).mean() > 10 * np.abs(k[20]).mean()


def test_the_face_has_the_features_of_a_face():
    """Along the profile and across it, from the mesh's own height: what a viewer would name."""

    def z(x, y):
        return height(np.column_stack(np.broadcast_arrays(x, y)))

    y = np.linspace(-0.48, 0.45, 2000)
    profile = z(0.0, y)
    tops = y[1:-1][(np.diff(profile)[:-1] > 0) & (np.diff(profile)[1:] <= 0)]
    chin, lower_lip, upper_lip, nose = tops[:4]  # the hills of the profile, from below
    assert chin < lower_lip < upper_lip < nose
    assert y[profile.argmax()] == nose
    lid, eye, brow = z(0.15, np.array([0.13, 0.086, 0.195]))
    assert lid < eye < brow  # eyeballs bulge in sockets under the brow ridge
    wing, beside = z(np.array([0.06, 0.11]), -0.13)
    assert wing > beside + 0.03
    x = np.linspace(-0.3, 0.3, 61)
    np.testing.assert_allclose(z(x, 0.1), z(-x, 0.1), atol=1e-15)
    assert 0.2 < np.ptp([*height(outline(np.linspace(0, 1, 100))), *profile]) < 0.3


def test_every_target_also_stands_very_coarse():
    for name in SURFACES:
        surface = SURFACES[name](0.4)
        check(surface.vertices, surface.faces)


def test_the_table_is_the_only_list_of_targets():
    assert all(getattr(surfaces, name.replace("-", "_")) is make for name, make in SURFACES.items())
