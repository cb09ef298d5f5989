"""Sheets with holes, from the domains to the film in the cell."""

from dataclasses import replace

import gdstk
import numpy as np
import pytest
from sheets import design

from lce_solver.topology import boundary_loops
from lce_solver.types import Surface
from lce_workbench.core.domains import partition, signed_area
from lce_workbench.core.job import Job
from lce_workbench.core.partition import divide
from lce_workbench.core.tessellation import TESSELLATIONS
from lce_workbench.divided import arrays, read_domains
from lce_workbench.outputs import write_design


def holed():
    """A sheet of five by five squares without its middle one."""
    whole = design(5, 5, width=2.0, height=2.0)
    keep = np.abs(whole.uv[whole.surface.faces].mean(axis=1)).max(axis=1) > 0.2
    surface = Surface(whole.surface.vertices, whole.surface.faces[keep])
    return replace(
        whole, surface=surface, theta=whole.theta[keep], dtheta=whole.dtheta[keep], stretch=whole.stretch[keep]
    )


def test_the_hole_is_a_rim_of_its_own_that_runs_the_other_way():
    domains = partition(holed())
    assert len(boundary_loops(domains.polygons)) == 2
    (hole,) = domains.holes
    outside, inside = (float(signed_area(ring[None])[0]) for ring in (domains.outline, hole))
    assert outside == pytest.approx(4.0, rel=1e-12)
    assert inside == pytest.approx(-0.16, rel=0.1)  # its corners are scattered
    assert domains.area.sum() == pytest.approx(outside + inside, rel=1e-12)


@pytest.mark.parametrize("kind", TESSELLATIONS)
def test_cells_leave_the_hole_free_and_cover_the_rest(kind, tmp_path):
    job, plan = Job(), holed()
    domains, found = divide(plan, replace(job, domains=replace(job.domains, kind=kind, size_um=150.0)))
    (hole,) = domains.holes
    left = 4.0 + float(signed_area(hole[None])[0])
    assert 0.985 * left < domains.area.sum() <= left * (1 + 1e-12)
    covers = next(one for one in found if one.check == "domain_cover")
    assert covers.value == pytest.approx(1 - domains.area.sum() / left, abs=1e-9)
    rings = [gdstk.Polygon(domains.vertices[row[row >= 0]]) for row in domains.polygons]
    assert sum(p.area() for p in gdstk.boolean(rings, gdstk.Polygon(hole), "and", precision=1e-9)) < 1e-6
    write_design(plan, tmp_path / "design.npz", arrays(domains))
    back = read_domains(tmp_path / "design.npz")
    np.testing.assert_array_equal(back.polygons, domains.polygons)
    np.testing.assert_array_equal(back.holes[0], hole)
