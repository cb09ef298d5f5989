"""Coarse scans: the surface between their vertices, and when their facets are left alone."""

import meshes
import numpy as np
import pytest
from targets import cap

from lce_solver.facets import rounded
from lce_solver.geometry import face_areas, mean_edge
from lce_solver.subdivision import loop_limit, refine
from lce_solver.surfaces import SURFACES
from lce_solver.topology import boundary_loops
from lce_solver.types import Surface


def off_sphere(surface: Surface) -> float:
    """Rms distance from the unit sphere, weighted with the area."""
    middle = surface.vertices[surface.faces].mean(axis=1)
    return float(np.sqrt(np.average((np.linalg.norm(middle, axis=1) - 1) ** 2, weights=face_areas(surface))))


def on_unit_sphere(edge: float) -> Surface:
    coarse = cap(50, edge)
    return Surface(coarse.vertices / np.linalg.norm(coarse.vertices, axis=1)[:, None], coarse.faces)


def test_limit_is_where_subdivision_leads():
    surface = SURFACES["saddle"](0.2)
    fine = surface
    for _ in range(7):
        fine = refine(fine, "loop")
    n = len(surface.vertices)
    np.testing.assert_allclose(loop_limit(surface.faces, n) @ surface.vertices, fine.vertices[:n], atol=2e-4)


@pytest.mark.parametrize("edge", [0.24, 0.12])
def test_a_sphere_comes_out_rounder_than_its_facets_and_than_loop_makes_it(edge):
    coarse = on_unit_sphere(edge)
    found, known = rounded(coarse, edge / 8)
    facets, loop = coarse, coarse
    while mean_edge(loop) > edge / 8:
        facets, loop = refine(facets, "midpoint"), refine(loop, "loop")
    assert off_sphere(found) < 0.25 * min(off_sphere(facets), off_sphere(loop))
    assert known == pytest.approx(off_sphere(facets), rel=0.3)


def test_a_plate_keeps_its_corners_its_sides_and_its_plane():
    points, faces = meshes.grid(6, 5)
    flat = Surface(np.column_stack([points[:, :2], np.zeros(len(points))]), faces)
    found, _ = rounded(flat, mean_edge(flat) / 3)
    assert np.ptp(found.vertices, axis=0) == pytest.approx(np.ptp(flat.vertices, axis=0), rel=1e-12)
    assert face_areas(found).sum() == pytest.approx(face_areas(flat).sum(), rel=1e-12)
    assert len(found.faces) >= 9 * len(faces)


@pytest.mark.parametrize("height", [1.0, 0.2, 0.05])
def test_facets_of_a_roof_are_meant(height):
    points = np.array([(0, 0, 0), (1, 0, 0), (0, 1, 1), (1, 1, 1), (0, 2, 0), (1, 2, 0)], dtype=np.float64)
    roof = Surface(points * (1, 1, height), [(0, 1, 3), (0, 3, 2), (2, 3, 5), (2, 5, 4)])
    assert rounded(roof, 0.05) == (roof, 0.0)


def test_a_fine_mesh_stays():
    fine = on_unit_sphere(0.1)
    assert rounded(fine, 0.11) == (fine, 0.0)


def test_a_mesh_of_slivers_is_not_blown_up():
    """A strip of 20 000 long thin triangles: little area, so few domains, but edges that are far too long."""
    x = np.linspace(0, 1, 10_001)
    points = np.concatenate([np.column_stack([x, np.full_like(x, y), np.sin(3 * x)]) for y in (0.0, 1.0)])
    i = np.arange(10_000)
    strip = Surface(
        points, np.concatenate([np.stack([i, i + 1, i + 10_001], 1), np.stack([i + 1, i + 10_002, i + 10_001], 1)])
    )
    assert rounded(strip, 0.02) == (strip, 0.0)


def test_where_it_lies_does_not_matter():
    coarse = on_unit_sphere(0.2)
    here, _ = rounded(coarse, 0.1)
    there, _ = rounded(Surface(coarse.vertices + 1e3, coarse.faces), 0.1)
    np.testing.assert_allclose(there.vertices - 1e3, here.vertices, atol=1e-11)
    assert [len(loop) for loop in boundary_loops(here.faces)] == [len(loop) for loop in boundary_loops(there.faces)]
