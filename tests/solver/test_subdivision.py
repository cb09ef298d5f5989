"""Refinement: what each scheme keeps, and the limits that Loop's scheme has in closed form."""

import meshes
import numpy as np
import pytest

from lce_solver.errors import InputError
from lce_solver.subdivision import MOST_FACES, SCHEMES, refine
from lce_solver.surface import boundary_loops, check, edges, face_areas, frames, mean_edge, subdivide, vertex_normals
from lce_solver.surfaces import dome
from lce_solver.topology import half_edges
from lce_solver.types import Surface


def tilted_plane(scale=1.0):
    vertices, faces = meshes.grid()
    vertices[:, 2] = 0.3 * vertices[:, 0] - 0.7 * vertices[:, 1] + 2
    return Surface(scale * vertices, faces)


@pytest.mark.parametrize("scale", [1e-9, 1.0, 1e9])
@pytest.mark.parametrize("scheme", SCHEMES)
def test_a_plane_stays_exactly_a_plane(scheme, scale):
    fine = subdivide(tilted_plane(scale), 0.3 * scale, scheme)
    x, y, z = fine.vertices.T / scale
    np.testing.assert_allclose(z, 0.3 * x - 0.7 * y + 2, atol=1e-13)
    assert mean_edge(fine) <= 0.3 * scale


@pytest.mark.parametrize("scheme", SCHEMES)
def test_each_step_makes_four_triangles_of_one_and_keeps_disk_and_direction(scheme):
    coarse = Surface(*meshes.grid())
    fine = refine(coarse, scheme)
    assert len(fine.faces) == 4 * len(coarse.faces)
    assert len(fine.vertices) == len(coarse.vertices) + len(edges(coarse.faces))
    np.testing.assert_array_equal(check(fine.vertices, fine.faces).faces, fine.faces)
    parent = np.repeat(frames(coarse)[2], 4, axis=0)
    assert (np.sum(parent * frames(fine)[2], axis=1) > 0).all()
    (before,), (after,) = boundary_loops(coarse.faces), boundary_loops(fine.faces)
    assert len(after) == 2 * len(before)
    np.testing.assert_array_equal(after[::2], before)  # old vertices alternate with new ones


def test_midpoint_keeps_the_facets():
    coarse = Surface(*meshes.grid())
    fine = refine(coarse, "midpoint")
    np.testing.assert_allclose(face_areas(fine), np.repeat(face_areas(coarse) / 4, 4), rtol=1e-12)
    np.testing.assert_allclose(frames(fine)[2], np.repeat(frames(coarse)[2], 4, axis=0), atol=1e-12)
    assert mean_edge(fine) == pytest.approx(mean_edge(coarse) / 2, rel=0.1)


def test_loop_smooths_an_inner_vertex_as_published():
    """Valence 6: a vertex keeps 5/8; a new vertex takes 3/8, 3/8, 1/8, 1/8 (Loop, 1987)."""
    angle = np.arange(6) * np.pi / 3
    ring = np.column_stack([np.cos(angle), np.sin(angle), np.zeros(6)])
    spike = Surface(np.vstack([[0, 0, 1.0], ring]), [(0, 1 + i, 1 + (i + 1) % 6) for i in range(6)])
    z = refine(spike, "loop").vertices[:, 2]
    assert z[0] == pytest.approx(5 / 8)
    np.testing.assert_allclose(z[7:13], 3 / 8)  # the spokes, which sort before the rim
    np.testing.assert_allclose(z[13:], 0, atol=1e-15)
    three = Surface(spike.vertices[[0, 1, 3, 5]], [(0, 1, 2), (0, 2, 3), (0, 3, 1)])
    assert refine(three, "loop").vertices[0, 2] == pytest.approx(7 / 16)


def test_loop_boundary_is_the_cubic_spline_of_the_boundary_alone():
    """The boundary after a step depends on the boundary only, also where an inner edge joins two rim vertices."""
    vertices, faces = meshes.grid(4, 1)  # every inner edge joins two vertices of the rim
    fine = refine(Surface(vertices, faces), "loop")
    (rim,) = boundary_loops(faces)
    (after,) = boundary_loops(fine.faces)
    old = vertices[rim]
    ahead, behind = np.roll(old, -1, axis=0), np.roll(old, 1, axis=0)
    np.testing.assert_allclose(fine.vertices[after[::2]], (behind + 6 * old + ahead) / 8, atol=1e-14)
    np.testing.assert_allclose(fine.vertices[after[1::2]], (old + ahead) / 2, atol=1e-14)


def test_loop_weights_are_averages():
    vertices, faces = meshes.grid()
    weights = SCHEMES["loop"](faces, len(vertices))
    np.testing.assert_allclose(weights.sum(axis=1), 1, rtol=1e-14)
    assert weights.min() >= 0


def test_loop_converges_to_a_smooth_surface():
    """Normals of neighbouring triangles close at first order; midpoint leaves the folds as they are."""

    def fold(surface):
        a, b = np.moveaxis(_pairs(surface.faces), 1, 0)
        normal = frames(surface)[2]
        return np.arccos(np.clip(np.sum(normal[a] * normal[b], axis=1), -1, 1)).max()

    coarse = Surface(*meshes.grid())
    steps = [coarse := refine(coarse, "loop") for _ in range(4)]
    folds = [fold(s) for s in steps]
    assert 1.6 < folds[2] / folds[3] < 2.4
    faceted = Surface(*meshes.grid())
    assert fold(refine(faceted, "midpoint")) == pytest.approx(fold(faceted), rel=1e-9)


def _pairs(faces):
    key = np.sort(half_edges(faces), axis=1)
    order = np.lexsort(key.T)
    same = (key[order][1:] == key[order][:-1]).all(axis=1)
    return np.column_stack([order[:-1][same], order[1:][same]]) % len(faces)


def test_a_mesh_that_is_fine_enough_is_returned_as_it_is():
    surface = tilted_plane()
    assert subdivide(surface, mean_edge(surface), "loop") is surface


@pytest.mark.parametrize("edge", [0.0, -1.0, np.nan, 1e-6])
def test_an_impossible_edge_is_refused(edge):
    with pytest.raises(InputError, match=f"within {MOST_FACES} triangles; ask for a larger edge"):
        subdivide(tilted_plane(), edge, "loop")


def test_an_unknown_scheme_is_refused():
    with pytest.raises(InputError, match="'butterfly' is unknown; choose one of loop, midpoint"):
        subdivide(tilted_plane(), 0.1, "butterfly")


def test_frames_are_orthonormal_right_handed_and_in_the_plane():
    surface = dome(0.1)
    axes = np.stack(frames(surface), axis=1)
    np.testing.assert_allclose(axes @ axes.transpose(0, 2, 1), np.broadcast_to(np.eye(3), axes.shape), atol=1e-14)
    np.testing.assert_allclose(np.linalg.det(axes), 1, atol=1e-13)
    a, b, c = np.moveaxis(surface.vertices[surface.faces], 1, 0)
    flat = np.einsum("fij,fj->fi", axes, c - a)
    np.testing.assert_allclose(flat[:, 2], 0, atol=1e-15)
    np.testing.assert_allclose(np.linalg.norm(b - a, axis=1) * flat[:, 1] / 2, face_areas(surface), rtol=1e-12)


def test_areas_and_normals_converge_to_the_sphere():
    """Area of a spherical cap: 2 pi R h. Vertex normals are radial."""
    radius = 0.5 / np.sin(np.radians(50))
    exact = 2 * np.pi * radius**2 * (1 - np.cos(np.radians(50)))
    area_error, normal_error = [], []
    for edge in (0.1, 0.05):
        surface = dome(edge)
        area_error.append(abs(face_areas(surface).sum() / exact - 1))
        outwards = (surface.vertices + radius * np.array([0, 0, np.cos(np.radians(50))])) / radius
        (rim,) = boundary_loops(surface.faces)
        inner = np.setdiff1d(np.arange(len(outwards)), rim)
        off = np.linalg.norm(vertex_normals(surface) - outwards, axis=1)
        normal_error.append(np.sqrt(np.mean(off[inner] ** 2)))
    assert area_error[0] < 0.01
    assert 3 < area_error[0] / area_error[1] < 5
    assert normal_error[0] < 0.02
    assert normal_error[0] / normal_error[1] > 1.7
