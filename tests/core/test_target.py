"""Targets at the resolution of the domains: scans that are coarser than they."""

from dataclasses import replace

import numpy as np
import pytest
from meshes import write_obj
from targets import LCE

from lce_solver.mirror import twins
from lce_solver.surfaces import CAP, SURFACES
from lce_workbench.core import target
from lce_workbench.core.job import DomainSpec, Job, Target

RADIUS = 0.5 / np.sin(CAP)
CENTRE = (0, 0, -RADIUS * np.cos(CAP))


@pytest.fixture(scope="module")
def scan(tmp_path_factory):
    """A folder with a dome of few triangles."""
    folder = tmp_path_factory.mktemp("scan")
    coarse = SURFACES["dome"](0.09)
    write_obj(folder / "dome.obj", coarse.vertices, coarse.faces)
    return folder


def resolved(folder, **spec):
    job = replace(Job(), target=Target(mesh="dome.obj", **spec), domains=DomainSpec(size_um=700.0))
    return target.resolve(job, LCE, folder)


def off_sphere(points):
    return np.sqrt(np.mean((np.linalg.norm(points - CENTRE, axis=1) - RADIUS) ** 2))


def test_a_coarse_scan_is_taken_for_a_smooth_surface_and_said_so(scan):
    smooth, (*_, told) = resolved(scan)
    facets, found = resolved(scan, subdivision="midpoint")
    assert "smoothed" not in {one.check for one in found}
    assert told.check == "smoothed"
    assert told.value > told.limit == 700
    assert 'target.subdivision = "midpoint"' in told.message
    assert off_sphere(smooth.vertices) < 0.4 * off_sphere(facets.vertices)
    assert twins(smooth) is not None


def test_a_kept_mesh_is_subdivided_and_said_so(scan):
    kept, (*_, told) = resolved(scan, remesh=False)
    assert told.check == "subdivided"
    assert len(kept.faces) % 4 == 0
    assert f"to {len(kept.faces)} triangles" in told.message
