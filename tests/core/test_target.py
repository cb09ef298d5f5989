"""Targets at the resolution of the domains: scans that are coarser than they."""

from dataclasses import replace

import numpy as np
import pytest
from meshes import write_obj
from targets import LCE

from lce_solver.mirror import twins
from lce_solver.surfaces import CAP, SURFACES
from lce_workbench import stages
from lce_workbench.core import target
from lce_workbench.core.job import DomainSpec, Job, MaterialSpec, Target

RADIUS = 0.5 / np.sin(CAP)
MATTER = MaterialSpec(lambda_=0.6, nu=0.5)
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
    smooth, (*_, told, same) = resolved(scan)
    facets, found = resolved(scan, subdivision="midpoint")
    assert "smoothed" not in {one.check for one in found}
    assert told.check == "smoothed"
    assert told.value > told.limit == 700
    assert 'target.subdivision = "midpoint"' in told.message
    assert off_sphere(smooth.vertices) < 0.4 * off_sphere(facets.vertices)
    assert same.check == "symmetric"
    assert twins(smooth) is not None


def test_where_the_halves_differ_is_told(tmp_path):
    """A wart that is too small to make a symmetric target lopsided."""
    dome = SURFACES["dome"](0.03)
    points = np.array(dome.vertices)
    at = int(np.argmin(np.linalg.norm(points[:, :2] - (0.3, 0.1), axis=1)))
    points[at, 2] += 0.004
    write_obj(tmp_path / "dome.obj", points, dome.faces)
    _, found = resolved(tmp_path)
    told = found[-1]
    assert told.check == "symmetric"
    assert 0.6 < told.value / (0.004 * 15_500) < 1.2  # the dome is 15.5 mm wide, and steep there
    assert f"at ({points[at, 0]:.4g}, {points[at, 1]:.4g}, {points[at, 2]:.4g})" in told.message


def test_domains_have_about_the_size_that_was_asked_for(tmp_path):
    """Three quarters of a tube lie along or across: the trial takes the other way than the design."""
    turn, high = np.meshgrid(np.linspace(0, 1.5 * np.pi, 40), np.linspace(0, 2, 18), indexing="ij")
    points = np.column_stack([np.cos(turn).ravel(), np.sin(turn).ravel(), high.ravel()])
    corner = np.arange(39)[:, None] * 18 + np.arange(17)
    lower = np.stack([corner, corner + 18, corner + 19], axis=-1).reshape(-1, 3)
    upper = np.stack([corner, corner + 19, corner + 1], axis=-1).reshape(-1, 3)
    write_obj(tmp_path / "tube.obj", points, np.concatenate([lower, upper]))
    job = replace(Job(), target=Target(mesh="tube.obj"), domains=DomainSpec(size_um=1500.0), material=MATTER)
    job = replace(job, solver=replace(job.solver, starts=4))
    run = stages.Run(tmp_path, job, tmp_path)
    goal, _ = target.resolve(job, LCE, tmp_path)
    assert not 1 / stages.OFF < target.off_size(next(stages.designed(goal, LCE, run)), job) < stages.OFF
    plans, _ = stages.solved(run)
    assert 1 / stages.OFF < target.off_size(next(plans), job) < stages.OFF


def test_a_kept_mesh_is_subdivided_and_said_so(scan):
    kept, (*_, told) = resolved(scan, remesh=False)
    assert told.check == "subdivided"
    assert len(kept.faces) % 4 == 0
    assert f"to {len(kept.faces)} triangles" in told.message
