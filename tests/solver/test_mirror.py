"""Symmetric targets: their plane is found, their mesh is symmetric vertex by vertex, and so is their sheet."""

from dataclasses import replace

import numpy as np
import pytest
from targets import LCE, hill, line_difference, moved, scaled

from lce_solver.contest import compete
from lce_solver.geometry import face_areas, mean_edge
from lce_solver.metric import Stop
from lce_solver.mirror import clipped, even_mesh, mirror_plane, twins
from lce_solver.surface import check
from lce_solver.surfaces import SURFACES
from lce_solver.topology import boundary_loops

FACE = SURFACES["face"](0.025)


@pytest.mark.parametrize("change", [lambda s: s, moved, lambda s: scaled(s, 1e3)])
def test_plane_of_a_symmetric_target_is_found_wherever_it_lies(change):
    surface = change(FACE)
    plane = mirror_plane(surface)
    image = plane.image(surface.vertices)
    tip = np.argmax(FACE.vertices[:, 2])
    assert np.abs(plane.height(surface.vertices[[tip]])) < mean_edge(surface)  # the nose lies in the plane
    np.testing.assert_allclose(plane.image(image), surface.vertices, atol=1e-9 * np.abs(surface.vertices).max())


def test_lopsided_target_has_no_plane():
    assert mirror_plane(hill()) is None
    assert twins(hill()) is None


def test_half_and_whole_have_the_same_area():
    height = FACE.vertices[:, 0] - 0.0123
    parts = [clipped(FACE, side * height) for side in (1, -1)]
    assert sum(face_areas(part).sum() for part in parts) == pytest.approx(face_areas(FACE).sum(), rel=1e-12)
    for part in parts:
        check(part.vertices, part.faces)


def test_even_mesh_is_its_own_mirror_image():
    surface = even_mesh(moved(FACE), 0.06)
    twin = twins(surface)
    np.testing.assert_array_equal(twin[twin], np.arange(len(twin)))
    assert mean_edge(surface) == pytest.approx(0.06, rel=0.05)
    plane = mirror_plane(surface)
    np.testing.assert_allclose(plane.image(surface.vertices), surface.vertices[twin], atol=2e-5)


@pytest.mark.parametrize("side", [-1, 1])
def test_a_small_hole_of_one_half_stays(side):
    middle = FACE.vertices[FACE.faces].mean(axis=1)
    width = np.ptp(FACE.vertices[:, 0])
    away = np.linalg.norm(middle[:, :2] - (side * 0.25 * width, 0), axis=1)
    pierced = check(FACE.vertices, FACE.faces[away > 0.02 * width])
    assert len(boundary_loops(pierced.faces)) == 2
    assert mirror_plane(pierced) is not None  # too small to be missed
    assert len(boundary_loops(even_mesh(pierced, 0.06).faces)) == 2


def test_symmetric_target_gets_a_symmetric_sheet():
    surface = even_mesh(FACE, 0.06)
    (best,), (start,) = compete(surface, LCE, starts=1, stop=Stop(1e-6))
    flat = best.flat
    assert start.symmetric
    twin = twins(surface)
    u, v = flat.uv.T
    np.testing.assert_allclose(u[twin] - u, 0, atol=1e-9)
    np.testing.assert_allclose(np.ptp(v[twin] + v), 0, atol=1e-9)
    key = {tuple(face): theta for face, theta in zip(np.sort(surface.faces, axis=1).tolist(), flat.theta, strict=True)}
    mirrored = np.array([key[tuple(face)] for face in np.sort(twin[surface.faces], axis=1).tolist()])
    assert line_difference(mirrored, -flat.theta).max() < 1e-6


def test_of_two_mirrored_starts_one_is_solved():
    surface = even_mesh(FACE, 0.08)
    _, starts = compete(surface, LCE, starts=4, stop=Stop(1e-4))
    assert [start.symmetric for start in starts] == [True, False, True, False]
    assert replace(starts[3], angle=starts[1].angle) == starts[1]
    heard = [[], []]
    for count, told in zip((3, 4), heard, strict=True):  # of three starts two run, of four three
        compete(surface, LCE, starts=count, stop=Stop(1e-3, 1), progress=lambda _, done, told=told: told.append(done))
    assert len(heard[0]) < len(heard[1]) < 4 / 3 * len(heard[0]) + 4
