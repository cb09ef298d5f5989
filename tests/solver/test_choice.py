"""Which finalist is made: the next one is heated only if the better one does not arrive."""

from dataclasses import replace

import numpy as np
import pytest
from targets import LCE

from lce_solver.arrive import arrive
from lce_solver.choice import arriving
from lce_solver.design import design, designs
from lce_solver.surfaces import SURFACES

LIMIT = np.radians(10)


@pytest.fixture(scope="module")
def plan():
    return design(SURFACES["dome"](0.12), LCE, 20.0, 0.1, starts=2, tolerance=1e-6)


def heated(plan):
    return {round(np.degrees(start.angle)): start.heated_pct for start in plan.starts if np.isfinite(start.heated_pct)}


def lost(plan):
    """The same sheet with its director turned: it heats into something else, and changes of the twist cannot help."""
    records = tuple(replace(start, winner=not start.winner) for start in plan.starts)
    return replace(plan, theta=(plan.theta + np.pi / 2) % np.pi, starts=records)


def test_of_a_sheet_that_arrives_the_next_is_not_asked_for(plan):
    def plans():
        yield plan
        pytest.fail("the first one arrives")

    made, told = arriving(plans(), "dtheta", LIMIT)
    alone, said = arrive(plan, "dtheta", LIMIT)
    assert told == said
    np.testing.assert_array_equal(made.dtheta, alone.dtheta)
    assert list(heated(made).values()) == [said.value]


def test_the_next_finalist_takes_the_place_of_one_that_does_not_arrive(plan):
    made, told = arriving([lost(plan), plan], "dtheta", LIMIT)
    np.testing.assert_array_equal(made.theta, plan.theta)
    assert told.value < 1 < max(heated(made).values())
    assert len(heated(made)) == 2
    assert "of 2 finalists it comes nearest" in told.message


def test_each_finalist_is_another_solution_and_names_its_start():
    found = list(designs(SURFACES["leaf"](0.1), LCE, 20.0, 0.1, starts=4, tolerance=1e-6))
    assert len(found) > 1
    winners = [[start.angle for start in plan.starts if start.winner] for plan in found]
    assert all(len(names) == 1 for names in winners)
    assert len({names[0] for names in winners}) == len(found)
    scores = [start.score for plan in found for start in plan.starts if start.winner]
    assert len(np.unique(np.round(scores, 6))) == len(found)
