"""The closed cell hatches a few domains, and is what all channels of the sheet would give."""

from dataclasses import replace

import numpy as np
import pytest
from cad.cad_sample import hatched
from sheets import design

from lce_solver.errors import InputError
from lce_workbench.core.cell import assemble
from lce_workbench.core.closed import closed
from lce_workbench.core.domains import PLATES, partition
from lce_workbench.core.frame import arrange
from lce_workbench.core.job import Job, Output
from lce_workbench.core.marks import marks


@pytest.mark.parametrize("chosen", [(), (7,), (31, 3, 90)])
def test_it_is_the_cell_of_the_whole_sheet(chosen):
    plan, job = design(), replace(Job(), output=Output(step_domains=chosen))
    domains, frame = partition(plan), arrange(plan.uv, job)
    drawn = {plate: np.concatenate([*marks(frame, plate, job.marks).values()]) for plate in PLATES}
    want, found = assemble(frame, job, domains, drawn, hatched(domains, job)), closed(plan, domains, job)
    assert found.chosen == want.chosen
    for name in ("parts", "channels", "combs"):
        for one, other in zip(getattr(found, name), getattr(want, name), strict=True):
            assert (one.name, one.z0, one.z1, one.group) == (other.name, other.z0, other.z1, other.group)
            assert len(one.rings) == len(other.rings)
            assert all(np.array_equal(a, b) for a, b in zip(one.rings, other.rings, strict=True))


@pytest.mark.parametrize("number", [96, -1, 10**30])
def test_a_domain_that_does_not_exist_is_refused(number):
    with pytest.raises(InputError, match=rf"domain {number} does not exist; the sheet has 0 to 95"):
        closed(design(), partition(design()), replace(Job(), output=Output(step_domains=(3, number))))
