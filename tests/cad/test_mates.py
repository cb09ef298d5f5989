"""The cell, put together by cadquery from named faces and marks, is the cell of the prisms."""

from dataclasses import replace

import numpy as np
import pytest
from cad.cad_sample import WORKSHOP, gauged

from lce_workbench.cad import mates
from lce_workbench.cad.mates import mated

PARTS = {None: 11, WORKSHOP: 12}


@pytest.mark.parametrize("plates", PARTS, ids=["plain", "workshop"])
def test_mated_parts_lie_where_the_prisms_are(plates):
    cell, _, frame, job = gauged(plates)
    assert len({part.name for part in cell.parts}) == PARTS[plates]
    assert mated(cell, frame, job)[0] < 1e-9  # mm


def changed(cell, name, **how):
    """The cell with one part made otherwise."""
    return replace(cell, parts=tuple(replace(p, **how) if p.name == name else p for p in cell.parts))


def test_a_part_that_lies_elsewhere_than_its_mates_put_it_is_seen():
    """Ten nanometres, along each axis; and a thicker strip lifts the plate that lies on it."""
    cell, _, frame, job = gauged()
    part = {p.name: p for p in cell.parts}
    strip, film = part["spacer_right"], part["sheet"]
    for name, how in {
        "spacer_right": {"outline": strip.outline + np.array([1e-5, 0.0])},
        "sheet": {"z0": film.z0 + 1e-5, "z1": film.z1 + 1e-5},
    }.items():
        off, where = mated(changed(cell, name, **how), frame, job)
        assert where == name
        assert off == pytest.approx(1e-5, rel=1e-3)
    thick = changed(changed(cell, "spacer_left", z1=strip.z1 + 1e-5), "spacer_right", z1=strip.z1 + 1e-5)
    off, where = mated(thick, frame, job)
    assert where == "top_plate"
    assert off == pytest.approx(1e-5, rel=1e-3)


WRONG = {
    "a ruler read 1 um short": ("glue_left?left", "PointInPlane", 1e-3, 1e-3),
    "a film upside down": ("sheet?below", "Axis", -180.0, 0.1),
    "a mark left out": ("top_plate/top_land?gauge_2", "PointOnLine", None, 1.0),
    "a jig on nothing": ("alignment_frame?below", "PointInPlane", None, 1.0),
}
"""What goes wrong: datum, kind, change of the mate's value (none: the mate is missing), least distance [mm]."""


@pytest.mark.parametrize(("datum", "kind", "change", "least"), WRONG.values(), ids=WRONG)
def test_a_wrong_mate_is_seen(monkeypatch, datum, kind, change, least):
    cell, _, frame, job = gauged(WORKSHOP)
    right = mates.mates

    def wrong(*how):
        for mate in right(*how):
            if (mate[0], mate[2:3]) != (datum, (kind,)):
                yield mate
            elif change is not None:
                yield (*mate[:3], mate[3] + change)

    assert datum in {mate[0] for mate in right(frame, job)}
    monkeypatch.setattr(mates, "mates", wrong)
    off, where = mated(cell, frame, job)
    assert where == datum.split("?")[0].split("/")[0]
    assert off > 0.999 * least
