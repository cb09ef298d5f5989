"""What stands on the sheets of the drawings, for jobs of every size: no FreeCAD."""

from itertools import combinations

import numpy as np
import pytest
import sheets as designs

from lce_workbench.app.figures import TEXT, WIDE
from lce_workbench.app.sheets import sheets, subject_of, title_block
from lce_workbench.app.symbols import PAPER
from lce_workbench.core import jobfile
from lce_workbench.core.frame import MARK_BOX
from lce_workbench.outputs import write_design

JOBS = {
    "defaults": (),
    "fine channels": ("channels.width_um=0.8", "channels.spacing_um=1.2", "channels.depth_um=0.123"),
    "narrow lands": ("channels.width_um=5", "channels.spacing_um=0.8", "channels.depth_um=3"),
    "coarse": ("channels.width_um=50", "channels.spacing_um=12.345", "marks.tolerance_um=33.3", "sheet.gap_um=1200"),
    "wide glass": ("plates.carrier=75x25", "plates.glass_mm=0.17", "plates.epoxy_um=5", "sheet.gap_um=12.5"),
    "tall glass": ("plates.carrier=25x75", "sheet.gap_um=150", "spacer.strip_mm=2"),
    "large": ("plates.width_mm=120.25", "plates.height_mm=133.333", "plates.frame_mm=4"),
}


@pytest.fixture(scope="module")
def path(tmp_path_factory):
    path = tmp_path_factory.mktemp("sheets") / "design.npz"
    write_design(designs.design(width=4.0, height=4.4), path)
    return path


def drawn(path, *values):
    job = jobfile.parse('[target]\nsurface = "saddle"\n[sheet]\nwidth_mm = 4.4', settings=values)
    return {sheet.name[2:]: sheet for sheet in sheets(path, job)}, subject_of(path, job)


def text_box(view, dim):
    """Lower left and upper right corner of a dimension's text on paper, above or left of its line [mm]."""
    half = np.array([WIDE * len(dim.text), TEXT]) / 2
    middle = np.array(view.at) + view.text_at(dim) + (0, TEXT / 2)
    if dim.axis == "y":
        half, middle = half[::-1], np.array(view.at) + view.text_at(dim) - (TEXT / 2, 0)
    return middle - half, middle + half


@pytest.mark.parametrize("values", JOBS.values(), ids=JOBS.keys())
def test_no_two_dimensions_are_written_over_each_other_or_off_the_sheet(path, values):
    for sheet in drawn(path, *values)[0].values():
        boxes = {(view.figure.name, dim.name): text_box(view, dim) for view in sheet.views for dim in view.figure.dims}
        for (one, (a, b)), (other, (c, d)) in combinations(boxes.items(), 2):
            assert np.any((b <= c + 0.1) | (d <= a + 0.1)), (sheet.name, one, other)
        for name, (low, high) in boxes.items():
            assert np.all(low > (20, 37)), (sheet.name, name)  # right of the margin, above the title block
            assert np.all(high < np.array(PAPER[sheet.paper]) - 10), (sheet.name, name)


def test_names_of_the_marks_stand_between_their_boxes(path):
    found, subject = drawn(path, *JOBS["wide glass"], "marks.clearance_mm=1.8")
    plan = found["assembly"].views[0]
    names = {label.text: label for label in plan.figure.labels if label.text.startswith("M")}
    boxes = plan.paper(subject.frame.marks)[:, 1] + plan.scale * np.array([[-MARK_BOX / 2], [MARK_BOX / 2]])
    for text in ("M3", "M4", "M6", "M8"):
        label = names[text]
        low = plan.paper(np.array([label.at]))[0, 1] + label.shift[1]
        inside = (boxes[0] < low + 0.7 * label.size) & (low < boxes[1])
        assert not inside.any(), text


def test_an_alignment_frame_is_in_the_parts_list(path):
    rows = {row[2].split(",")[0]: row for row in drawn(path, *JOBS["large"])[0]["assembly"].table}
    assert rows["Glue bead"][0] == "7"
    assert rows["Alignment frame"][0] == "8"
    assert rows["Alignment frame"][4] == "opening 120.35 x 133.433, wall 4"
    without = drawn(path, *JOBS["large"], "spacer.bead_mm=0")[0]["assembly"].table
    assert [row[0] for row in without if row[2].startswith("Alignment")] == ["7"]
    assert not any(row[2].startswith("Alignment") for row in drawn(path)[0]["assembly"].table)


@pytest.mark.parametrize(("casts", "odd"), [(2, False), (3, True), (0, False), (1, True)])
def test_notes_on_the_masks_follow_the_number_of_casts(path, casts, odd):
    found = drawn(path, f"plates.replications={casts}")[0]
    bottom, top = (" ".join(found[f"{plate}_plate"].notes) for plate in ("bottom", "top"))
    assert ("do not mirror them again" in top) != odd
    for notes in (bottom, top):
        assert (f"Odd number of casts, {casts}: mirror BOTH mask files" in notes) == odd


def test_test_fields_that_are_left_out_are_not_drawn(path):
    for fields, there in ((["depth"], True), ([], False)):
        sheet = drawn(path, f"marks.fields={fields}")[0]["bottom_plate"]
        assert any(stroke.layer == "FIELDS" for stroke in sheet.views[0].figure.strokes) == there
        assert ("test fields" in " ".join(sheet.notes)) == there


def test_a_long_name_stays_in_its_box(path):
    found, subject = drawn(path, "output.author=Dipl.-Ing. Jörg Müller-Lüdenscheidt, Institut", "output.date=22. 11.")
    block = title_block(found["assembly"], subject)
    assert block["author"] == "Dipl.-Ing. Jörg Müller-L..."
    assert block["date"] == "22. 11."


def test_no_grid_line_is_at_minus_nought(tmp_path):
    write_design(designs.design(columns=40, rows=60, width=0.9, height=30.0), tmp_path / "design.npz")
    job = jobfile.parse('[target]\nsurface = "saddle"\n[sheet]\nwidth_mm = 30')
    figure = sheets(tmp_path / "design.npz", job)[-1].views[0].figure
    assert "0" in (texts := [label.text for label in figure.labels])
    assert "-0" not in texts
