from dataclasses import replace
from itertools import product

import klayout.db as kdb
import numpy as np
import pytest
from sheets import design

from lce_solver.errors import InputError
from lce_workbench.core.domains import partition
from lce_workbench.core.frame import MARK_BOX, arrange
from lce_workbench.core.job import Job, Marks
from lce_workbench.core.marks import (
    ANGLE,
    LABEL_INSET,
    LONGEST,
    MARKS,
    PIXEL,
    RINGS,
    SCALE_MM,
    Wanted,
    cross,
    exposed,
    fingerprint,
    marks,
    scale_bars,
    vernier,
    windows,
)
from lce_workbench.core.shapes import PLAIN, STENCIL, box, ell, grating, mirrored, moved, rings, text, turned

UM = 1e-3
SPEC = Marks()
CODE = "0123ABCD"
FRAME = arrange(np.array([[-5.0, -4.0], [5.0, 4.0]]), Job())


def region(*shapes):
    """The rectangles as an integer region [nm]."""
    found = kdb.Region()
    for rectangle in np.concatenate(shapes):
        found.insert(kdb.Polygon([kdb.Point(*map(round, p / 1e-6)) for p in rectangle]))
    return found


def drawn(element, plate, spec=SPEC):
    draw = getattr(element, plate)
    return moved(draw(Wanted(spec, CODE)), *element.at) if draw else box(0, 0, 0, 0)[:0]


@pytest.mark.parametrize("tolerance", [2.0, 10.0, 100.0])
@pytest.mark.parametrize("name", MARKS)
def test_every_element_lies_in_its_box(name, tolerance):
    for plate in ("bottom", "top"):
        reach = np.abs(drawn(MARKS[name], plate, Marks(tolerance_um=tolerance))).max(initial=0)
        assert reach <= MARK_BOX / 2


@pytest.mark.parametrize("tolerance", [2.0, 10.0, 100.0])
def test_elements_of_both_plates_are_apart(tolerance):
    spec = Marks(tolerance_um=tolerance)
    separate = [element for name, element in MARKS.items() if name != "moire"]  # the rings lie on each other
    parts = [drawn(element, plate, spec) for element, plate in product(separate, ("bottom", "top"))]
    parts = [region(part) for part in parts if len(part)]
    together = kdb.Region()
    for part in parts:
        assert (part.sized(1000) & together).is_empty()
        together += part
    assert sum(p.area() for p in parts) == together.merged().area()


@pytest.mark.parametrize("plate", ["bottom", "top"])
def test_elements_of_one_plate_are_apart(plate):
    parts = [region(drawn(element, plate)) for element in MARKS.values()]
    together = kdb.Region()
    for part in parts:
        assert (part.sized(5000) & together).is_empty()
        together += part


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
        reach = [moved(cross(Wanted(spec)), *(np.array(shift) * s)) for s in (tolerance - 0.002, tolerance + 0.002)]
        overlap = [(region(r) & region(windows(Wanted(spec)))).is_empty() for r in reach]
        assert overlap == [True, False]


@pytest.mark.parametrize("shift", range(-10, 11))
@pytest.mark.parametrize("turn", [False, True])
def test_the_vernier_reads_the_shift_of_the_top_plate(shift, turn):
    name, axis = ("vernier_y", 1) if turn else ("vernier_x", 0)
    centre = {p: drawn(MARKS[name], p).mean(axis=1)[:, axis] - MARKS[name].at[axis] * UM for p in ("bottom", "top")}
    meet = np.abs(centre["top"] + shift * UM - centre["bottom"]) < 1e-9
    assert (np.flatnonzero(meet) - 10).tolist() == [-shift]


def test_vernier_bars_are_longer_at_every_fifth():
    size = np.ptp(vernier("top"), axis=1)
    assert np.allclose(size[:, 0], 9 * UM)
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
        assert len(set(counts[1:])) == 1


def test_labels_read_from_above_and_on_the_loose_plate():
    def seen(plate, label, at_pixel):
        found = marks(FRAME, plate, SPEC)["LABELS"]
        letters = moved(label, *at_pixel) + FRAME.marks[1]
        return (region(letters) - region(found)).is_empty()

    assert seen("bottom", text("BOTTOM", PIXEL, STENCIL), MARKS["bottom"].at)
    assert seen("top", text("TOP", PIXEL, STENCIL), MARKS["top, closed cell"].at)
    # the loose plate is turned over to look at its patterned face, x -> -x: then this one reads
    assert seen("top", mirrored(text("TOP", PIXEL, STENCIL)), MARKS["top, loose plate"].at)


def test_a_letter_is_what_its_dots_say():
    shape = region(text("T", PIXEL, STENCIL))
    assert shape.area() == (5 + 6) * 14000**2
    assert shape.count() == 2
    assert (shape & region(box(-1, -49, 1, 49))).area() == 2000 * 98000


def test_plain_letters_look_like_themselves():
    assert PLAIN["T"] == ("#####", "..#..", "..#..", "..#..", "..#..", "..#..", "..#..")
    assert PLAIN["L"] == ("#....",) * 6 + ("#####",)
    assert len({dots for letter, dots in PLAIN.items()}) == len(PLAIN)


def test_a_label_that_cannot_be_drawn_is_refused():
    for label in ("MÜLLER", "small"):
        with pytest.raises(InputError, match=r"^marks.label .* cannot be drawn; use capitals"):
            text(label, PIXEL)
    with pytest.raises(InputError, match=r"'\\xdc'"):
        exposed(FRAME, "top", Job(marks=Marks(label="\xdc")), CODE)


def test_a_label_that_could_not_be_read_is_refused():
    """The grating needs two lines at least to fill the dots of the longest that is drawn."""
    longest = Job(marks=Marks(label="A" * LONGEST))
    printed = exposed(FRAME, "top", longest, CODE)["LABELS"]
    assert np.ptp(printed[..., 0], axis=1).min() > 4 * UM
    with pytest.raises(InputError, match=r"^marks\.label has 21 characters, too many to be read; give 20 at most"):
        exposed(FRAME, "top", Job(marks=Marks(label="A" * (LONGEST + 1))), CODE)


@pytest.mark.parametrize("shift", [0, 3, -7])
def test_the_digits_name_the_shift(shift):
    """The number under the bars that meet is the top plate's shift, left of the middle if positive."""
    bars = {p: vernier(p).mean(axis=1)[:, 0] for p in ("bottom", "top")}
    (k,) = np.flatnonzero(np.abs(bars["top"] + shift * UM - bars["bottom"]) < 1e-9)
    assert (k - 10) * 20 == -20 * shift
    digits = drawn(MARKS["digits_x"], "bottom") - np.array(MARKS["digits_x"].at) * UM
    for word, number in (("10", 10), ("+5", 5), ("0", 0), ("-5", -5), ("10", -10)):
        printed = moved(text(word, 6.0), -20 * number, -126.5)
        around = moved(box(-40, -30, 40, 30), -20 * number, -126.5)
        assert ((region(digits) & region(around)) ^ region(printed)).is_empty()


def test_rings_of_both_plates_beat():
    """Ring k of the top plate lies k um outside the bottom's; they meet again after 20 and 21 rings."""
    for pitch in (20.0, 21.0):
        shape = region(rings(pitch, RINGS, 9.0))
        assert shape.area() == shape.merged().area()
        assert shape.count() == sum(8 + 4 * k for k in range(1, RINGS + 1))
        along = np.sort(np.array([p.bbox().center().x for p in shape.each() if p.bbox().center().y == 0]))
        assert np.abs(along[along > 0] / 1000 - pitch * np.arange(1, RINGS + 1)).max() < 0.01


@pytest.mark.parametrize("plate", ["bottom", "top"])
def test_gratings_fill_their_marks_to_both_outlines(plate):
    job = Job()
    for draw in (windows, cross, lambda _: vernier(plate)):
        outline = draw(Wanted(SPEC))
        lines = grating(outline, ANGLE[plate], job.channels)
        assert (region(lines) - region(outline)).is_empty()
        assert region(lines).merged().area() == region(lines).area()
        assert np.abs(lines.min(axis=(0, 1)) - outline.min(axis=(0, 1))).max() < 1e-6
        assert np.abs(lines.max(axis=(0, 1)) - outline.max(axis=(0, 1))).max() < 1e-6
        assert 0.5 < region(lines).area() / region(outline).area() < 0.56
        size = np.ptp(lines, axis=1)
        assert np.allclose(size[:, 1 if plate == "top" else 0], 1 * UM)


def test_gratings_of_letters_keep_their_lands():
    lines = region(grating(text("BOTTOM8", 14.0), 0.0, Job().channels, LABEL_INSET))
    assert lines.space_check(999).count() == 0
    assert lines.width_check(999).count() == 0


@pytest.mark.parametrize("plate", ["bottom", "top"])
def test_scale_bars_measure_ten_millimetres_along_both_axes(plate):
    frame = arrange(np.array([[-10.0, -10.0], [10.0, 10.0]]), Job())
    bars, numbers = scale_bars(frame, plate)
    middle = bars.mean(axis=1)
    assert np.allclose(middle[:4, 0] - middle[0, 0], SCALE_MM)
    assert np.allclose(middle[4:, 1] - middle[4, 1], SCALE_MM)
    assert len(bars) == 8
    assert (len(numbers) > 0) == (plate == "bottom")


def test_a_small_sheet_has_the_ticks_that_fit():
    frame = arrange(np.array([[-1.0, -1.0], [1.0, 1.0]]), Job())
    bars, _ = scale_bars(frame, "top")
    x, y = bars.mean(axis=1)[:2, 0], bars.mean(axis=1)[2:, 1]  # 0 and 1 mm along both
    assert x.min() > frame.sheet.x0
    assert x.max() < frame.sheet.x1
    assert y.min() > frame.marks[0][1] + MARK_BOX / 2
    assert y.max() < frame.marks[7][1] - MARK_BOX / 2


def test_the_code_names_the_design():
    domains = partition(design(2, 2, width=0.2, height=0.2))
    spec = Job().channels
    code = fingerprint(domains, spec)
    assert len(code) == 8
    assert set(code) <= set("0123456789ABCDEF")
    assert code == fingerprint(partition(design(2, 2, width=0.2, height=0.2)), spec)
    assert code != fingerprint(replace(domains, dtheta=domains.dtheta + 1e-5), spec)
    assert code != fingerprint(domains, replace(spec, width_um=1.1))


def test_marks_at_the_sides_lie_behind_the_strips():
    for x in FRAME.marks[[0, 3, 7], 0]:
        assert x + MARK_BOX / 2 < FRAME.strips[0].x0
    for x in FRAME.marks[[1, 2, 5], 0]:
        assert x - MARK_BOX / 2 > FRAME.strips[1].x1
    assert (np.abs(FRAME.marks[[4, 6], 1]) - MARK_BOX / 2 > FRAME.fill.y1).all()
