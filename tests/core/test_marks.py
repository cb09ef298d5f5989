from itertools import product

import klayout.db as kdb
import numpy as np
import pytest

from lce_workbench.core.frame import MARK_BOX, arrange
from lce_workbench.core.job import Job, Marks
from lce_workbench.core.marks import MARKS, box, cross, ell, marks, mirrored, moved, text, turned, vernier, windows

UM = 1e-3
SPEC = Marks()
FRAME = arrange(np.array([[-5.0, -4.0], [5.0, 4.0]]), Job())


def region(*shapes):
    """The rectangles as an integer region [nm]."""
    found = kdb.Region()
    for rectangle in np.concatenate(shapes):
        found.insert(kdb.Polygon([kdb.Point(*map(round, p / 1e-6)) for p in rectangle]))
    return found


def drawn(element, plate, spec=SPEC):
    draw = getattr(element, plate)
    return moved(draw(spec), *element.at) if draw else box(0, 0, 0, 0)[:0]


@pytest.mark.parametrize("tolerance", [2.0, 10.0, 100.0])
@pytest.mark.parametrize("name", MARKS)
def test_every_element_lies_in_its_box(name, tolerance):
    for plate in ("bottom", "top"):
        reach = np.abs(drawn(MARKS[name], plate, Marks(tolerance_um=tolerance))).max(initial=0)
        assert reach <= MARK_BOX / 2


@pytest.mark.parametrize("tolerance", [2.0, 10.0, 100.0])
def test_elements_of_both_plates_are_apart(tolerance):
    spec = Marks(tolerance_um=tolerance)
    parts = [drawn(element, plate, spec) for element, plate in product(MARKS.values(), ("bottom", "top"))]
    parts = [region(part) for part in parts if len(part)]
    together = kdb.Region()
    for part in parts:
        assert (part.sized(1000) & together).is_empty()
        together += part
    assert sum(p.area() for p in parts) == together.merged().area()


@pytest.mark.parametrize("plate", ["bottom", "top"])
def test_outlines_are_simple(plate):
    """Rectangles may abut, but no two touch in a point only and no group has a hole, so recesses are simple."""
    shapes = region(*marks(FRAME, plate, SPEC).values())
    assert shapes.area() == shapes.merged().area()  # disjoint
    coherent = shapes.dup()
    coherent.min_coherence = True
    assert coherent.merged().count() == shapes.merged().count()
    assert shapes.merged().holes().is_empty()
    assert all(p.num_points() == 4 and p.is_box() and p.area() > 0 for p in shapes.each())


@pytest.mark.parametrize("tolerance", [3.0, 10.0, 40.0])
def test_the_gauge_shows_the_tolerance(tolerance):
    spec = Marks(tolerance_um=tolerance)
    for shift in ((1, 0), (0, 1), (-1, 0), (0, -1)):
        reach = [moved(cross(spec), *(np.array(shift) * s)) for s in (tolerance - 0.002, tolerance + 0.002)]
        overlap = [(region(r) & region(windows(spec))).is_empty() for r in reach]
        assert overlap == [True, False]


@pytest.mark.parametrize("shift", range(-10, 11))
@pytest.mark.parametrize("turn", [False, True])
def test_the_vernier_reads_the_shift_of_the_top_plate(shift, turn):
    name, axis = ("vernier_y", 1) if turn else ("vernier_x", 0)
    centre = {p: drawn(MARKS[name], p).mean(axis=1)[:, axis] - MARKS[name].at[axis] * UM for p in ("bottom", "top")}
    meet = np.abs(centre["top"] + shift * UM - centre["bottom"]) < 1e-9
    assert (np.flatnonzero(meet) - 10).tolist() == [-shift]


def test_vernier_bars_are_longer_at_every_fifth():
    size = np.ptp(vernier(20, 1), axis=1)
    assert np.allclose(size[:, 0], 8 * UM)
    assert np.allclose(np.flatnonzero(size[:, 1] > 0.08), [0, 5, 10, 15, 20])


def test_the_ell_tells_a_mirrored_plate():
    def normal(shape):
        low = shape.min(axis=(0, 1))
        return region(shape - low)

    shape = ell(100, 20)
    reflected = mirrored(shape)
    for _ in range(4):
        reflected = turned(reflected)
        assert not (normal(shape) ^ normal(reflected)).is_empty()


def test_one_corner_is_unlike_the_others():
    for plate in ("bottom", "top"):
        found = marks(FRAME, plate, SPEC)["MARKS"]
        near = np.linalg.norm(found.mean(axis=1)[:, None] - FRAME.marks, axis=2).argmin(axis=1)
        counts = np.bincount(near)
        assert counts[0] == counts[1] + 1
        assert counts[1] == counts[2] == counts[3]


def test_labels_read_from_above_and_on_the_loose_plate():
    def seen(plate, label, at_pixel):
        found = marks(FRAME, plate, SPEC)["LABELS"]
        letters = moved(label, *at_pixel) + FRAME.marks[1]
        return (region(letters) - region(found)).is_empty()

    assert seen("bottom", text("BOTTOM"), MARKS["bottom"].at)
    assert seen("top", text("TOP"), MARKS["top, closed cell"].at)
    # the loose plate is turned over to look at its patterned face, x -> -x: then this one reads
    assert seen("top", mirrored(text("TOP")), MARKS["top, loose plate"].at)


def test_a_letter_is_what_its_dots_say():
    shape = region(text("T"))
    assert shape.area() == (5 + 6) * 14000**2
    assert shape.count() == 2
    assert (shape & region(box(-1, -49, 1, 49))).area() == 2000 * 98000
