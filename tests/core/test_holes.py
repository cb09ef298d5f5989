"""Sheets with holes, from the domains to the film in the cell."""

from dataclasses import replace

import numpy as np
import pytest
from sheets import design

from lce_solver.errors import InputError
from lce_solver.topology import boundary_loops
from lce_solver.types import Surface
from lce_workbench.core.domains import partition, signed_area
from lce_workbench.core.job import Job
from lce_workbench.core.partition import divide


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


def test_hexagons_do_not_fill_a_hole_unseen():
    job = Job()
    with pytest.raises(InputError, match="cannot tile a sheet with holes"):
        divide(holed(), replace(job, domains=replace(job.domains, kind="hexagons")))
