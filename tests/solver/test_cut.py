"""Cuts make sheets of surfaces that are closed, have handles or are too curved."""

import meshes
import numpy as np
import pytest
from targets import cap

from lce_solver import judge
from lce_solver.cut import _judged, _narrowest, handles, opened, proposed, seams, straightened
from lce_solver.design import design
from lce_solver.geometry import face_areas, mean_edge
from lce_solver.metric import Stop, flatten, lay_flat
from lce_solver.mirror import even_mesh
from lce_solver.surface import check
from lce_solver.topology import boundary_loops, edges
from lce_solver.types import Material, Status, Surface

MATTER = Material(0.6, 0.5, "test")


def grid(embed, n, m, around=(False, False)):
    """Triangles of an (n, m) grid of points ``embed(i / n, j / m)``, closed ``around`` either way."""
    i, j = (k.ravel() for k in np.meshgrid(np.arange(n), np.arange(m), indexing="ij"))
    rows, columns = n - (not around[0]), m - (not around[1])
    a, b = (k.ravel() for k in np.meshgrid(np.arange(rows), np.arange(columns), indexing="ij"))
    p, q, r, s = (((a + u) % n) * m + (b + v) % m for u, v in ((0, 0), (1, 0), (1, 1), (0, 1)))
    return Surface(embed(i / n, j / m), np.vstack([np.column_stack([p, q, r]), np.column_stack([p, r, s])]))


def tube(n=40, m=16, length=2.0):
    turn = 2 * np.pi
    return grid(lambda i, j: np.column_stack([np.cos(turn * i), np.sin(turn * i), length * j]), n, m, (True, False))


def ring(n=48, m=12, inner=0.4):
    def embed(i, j):
        radius, angle = inner + (1 - inner) * j * m / (m - 1), -2 * np.pi * i
        return np.column_stack([radius * np.cos(angle), radius * np.sin(angle), 0 * i])

    return grid(embed, n, m, (True, False))


def ball(n=6):
    """A sphere: an octahedron, divided and blown up."""
    vertices, faces = meshes.octahedron()
    for _ in range(3):
        corner = vertices[faces]
        middle = [(corner[:, k] + corner[:, k - 1]) / 2 for k in (1, 2, 0)]
        points = np.vstack([corner[:, 0], corner[:, 1], corner[:, 2], *middle])
        a, b, c, d, e, f = np.arange(6 * len(faces)).reshape(6, -1)
        triangles = np.vstack([np.column_stack(t) for t in ((a, d, f), (d, b, e), (f, e, c), (d, e, f))])
        vertices, where = np.unique(np.round(points, 9), axis=0, return_inverse=True)
        faces = where.reshape(-1)[triangles]
        vertices = vertices / np.linalg.norm(vertices, axis=1, keepdims=True)
    return Surface(vertices, faces)


def donut(n=36, m=18):
    def embed(i, j):
        a, b = 2 * np.pi * i, 2 * np.pi * j
        radius = 1 + 0.4 * np.cos(b)
        return np.column_stack([radius * np.cos(a), radius * np.sin(a), 0.4 * np.sin(b)])

    return grid(embed, n, m, (True, True))


def best_rms(surface):
    return _judged(surface, MATTER)[1]


@pytest.mark.parametrize(
    ("shape", "wanted"), [(ball, 0.06), (donut, 0.05), (tube, 1e-3)], ids=["ball", "donut", "tube"]
)
def test_cuts_lay_flat_what_no_sheet_can_be(shape, wanted):
    surface = shape()
    cuts = proposed(surface, MATTER)
    sheet = opened(surface, cuts)
    check(sheet.vertices, sheet.faces)
    assert (len(boundary_loops(sheet.faces)), handles(sheet)) == (1, 0)
    assert best_rms(sheet) < wanted
    np.testing.assert_allclose(face_areas(sheet), face_areas(surface), rtol=0, atol=0)


def test_a_cap_is_cut_only_when_it_is_too_steep():
    assert proposed(cap(50, edge=0.12), MATTER) == ()
    steep = cap(130, edge=0.14)
    sheet = opened(steep, proposed(steep, MATTER))
    assert best_rms(sheet) < 0.25 * best_rms(steep)


def test_a_seam_is_found_and_its_sides_lie_on_each_other():
    surface = tube()
    sheet = opened(surface, proposed(surface, MATTER))
    pairs = seams(sheet)
    np.testing.assert_array_equal(sheet.vertices[pairs[:, 0, 0]], sheet.vertices[pairs[:, 1, 1]])
    np.testing.assert_array_equal(sheet.vertices[pairs[:, 0, 1]], sheet.vertices[pairs[:, 1, 0]])
    length = np.linalg.norm(np.diff(sheet.vertices[pairs[:, 0]], axis=1), axis=2).sum()
    assert length == pytest.approx(2.0 * 15 / 16, rel=0.02)  # straight along the tube
    assert len(seams(cap(50, edge=0.2))) == 0


def turns(sheet):
    """(k,) angles between successive edges of the seam, where it does not end [deg]."""
    rim = dict(seams(sheet)[:, 0].tolist())
    chain = [(a, b, rim[b]) for a, b in rim.items() if b in rim]
    p, q, r = sheet.vertices[np.array(chain).T]
    first, second = ((v / np.linalg.norm(v, axis=1, keepdims=True)) for v in (q - p, r - q))
    return np.degrees(np.arccos(np.clip(np.einsum("ki,ki->k", first, second), -1, 1)))


def test_a_straight_seam_turns_little_and_the_triangles_stay_good():
    surface = even_mesh(cap(130, edge=0.05), 0.09)
    top, rim = surface.vertices[:, 2].argmax(), surface.vertices[:, 0].argmax()
    cut = (surface.vertices[[top, rim]],)
    zigzag, straight = (opened(surface, cut, straight=how) for how in (False, True))
    assert np.percentile(turns(zigzag), 90) > 25
    assert np.percentile(turns(straight), 90) < 8
    np.testing.assert_allclose(np.linalg.norm(straight.vertices, axis=1), 1, atol=3e-3)
    np.testing.assert_array_equal(straight.faces, zigzag.faces)
    assert _narrowest(straight.vertices, straight.faces) > np.radians(15)
    bad = straightened(surface, edges(surface.faces)[:0])
    np.testing.assert_array_equal(bad, surface.vertices)


def test_a_cut_planned_on_a_coarse_mesh_is_made_in_a_fine_one():
    coarse, fine = ball(), tube(80, 32)
    assert handles(opened(fine, proposed(tube(), MATTER))) == 0
    assert len(boundary_loops(opened(fine, proposed(tube(), MATTER)).faces)) == 1
    assert len(boundary_loops(opened(coarse, (coarse.vertices[[0, 9]],)).faces)) == 1


def test_a_flat_ring_stays_a_ring_and_is_an_affine_image():
    flat = lay_flat(ring())
    found = flatten(flat, (0.6, 0.6**-0.5), 0.0, Stop(1e-14))
    assert found.status is Status.CONVERGED
    errors = judge.stretch_errors(judge.stretches(ring(), found.uv, MATTER), MATTER)
    assert np.abs(errors).max() < 1e-6


def test_a_cone_without_tip_is_reached_ever_better_and_stays_an_annulus():
    """Director circles around the hole: the exact solution, so the error falls with the edge."""

    def cone(n, m):
        def embed(i, j):
            slant, angle = 0.4 + 0.6 * j * m / (m - 1), -2 * np.pi * i
            rho = slant * 0.6**1.5
            return np.column_stack([rho * np.cos(angle), rho * np.sin(angle), -slant * np.sqrt(1 - 0.6**3)])

        return grid(embed, n, m, (True, False))

    coarse, fine = (design(cone(*size), MATTER, 20.0, 0.1, starts=3) for size in ((32, 10), (64, 20)))
    assert coarse.flattening.status is fine.flattening.status is Status.CONVERGED
    assert len(boundary_loops(fine.surface.faces)) == 2
    rms = [judge.rms(judge.stretch_errors(plan.stretch, MATTER), face_areas(plan.surface)) for plan in (coarse, fine)]
    assert rms[1] < 0.65 * rms[0]
    assert mean_edge(fine.surface) == pytest.approx(mean_edge(coarse.surface) / 2, rel=0.1)
