"""The 3D view: every picture, its legend and its lines, picking, the table, the cell apart and cut open."""

from dataclasses import replace

import numpy as np
import pytest
import sheets
import view_steps as steps
from freecad_call import FreeCAD
from processes import display

from lce_solver.types import Surface
from lce_workbench.core import jobfile
from lce_workbench.core.channels import hatch
from lce_workbench.core.domains import PLATES, partition
from lce_workbench.outputs import write_design

JOB = """
[target]
surface = "saddle"
[sheet]
width_mm = 2.2
gap_um = 100.0
[channels]
width_um = 4.0
spacing_um = 6.0
"""

FLAT = sheets.design()
X, Y = FLAT.uv.T
DESIGN = replace(FLAT, surface=Surface(np.column_stack([X, Y, 0.15 * X**2 - 0.1 * Y**2]), FLAT.surface.faces))


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return made(tmp_path_factory.mktemp("view"), DESIGN)


def made(folder, design):
    (folder / "job.toml").write_text(JOB)
    write_design(design, folder / "design.npz")
    hot = design.surface.vertices + [0, 0, 1.0] * (0.02 * design.uv[:, :1] ** 2)
    np.savez(folder / "prediction.npz", vertices=hot, frames=hot[None])
    return folder


@pytest.fixture(scope="module")
def seen(folder, tmp_path_factory):
    freecad = FreeCAD(tmp_path_factory.mktemp("home"))
    with display() as screen:
        found = freecad.window(screen, steps.looks, folder=str(folder))
    assert "Traceback" not in freecad.said
    return found


@pytest.mark.parametrize("name", steps.PICTURES)
def test_the_legend_on_the_screen_has_the_colours_of_the_ends_of_the_data(seen, name):
    low, high, unit = seen["pictures"][name]["scale"]
    most = np.degrees(np.abs(DESIGN.dtheta).max())
    expected = {"directors": (-most, most, "°"), "deviation": (0, pytest.approx(high), "µm")}
    assert (low, high, unit) == expected.get(name, (0, 180, "°"))
    assert max(seen["pictures"][name]["bar"]) < 25


def test_the_deviation_is_in_micrometres(seen):
    height = 20 * DESIGN.uv[:, 0] ** 2
    assert 0.3 * np.ptp(height) < seen["pictures"]["deviation"]["scale"][1] < np.ptp(height)


@pytest.mark.parametrize("plate", PLATES)
def test_as_many_lines_are_drawn_as_there_are_channels(seen, plate):
    domains = partition(DESIGN)
    channels = hatch(domains, plate, jobfile.parse(JOB, "job").channels)
    assert seen["pictures"][f"channels_{plate}"]["lines"] == len(channels) + 3 * len(domains)
    assert seen["pictures"][f"channels_{plate}"]["count"] == len(channels)


def test_each_triangle_has_its_director_on_the_sheet_and_on_the_target(seen):
    rim = 2 * (6 + 8)
    assert seen["pictures"]["directors"]["lines"] == 2 * (len(DESIGN.theta) + rim)


@pytest.mark.parametrize("name", steps.PICTURES)
def test_the_domain_at_a_pixel_is_the_one_that_is_seen_there(seen, name):
    pairs = seen["pictures"][name]["picked"]
    assert len(pairs) >= 5
    for domain, found in pairs:
        assert domain == found


@pytest.mark.parametrize("name", steps.PICTURES)
def test_pictures_put_the_solids_aside_and_the_cell_comes_back_as_it_was(seen, name):
    assert not any(seen["pictures"][name]["aside"])
    assert seen["back"] == 0


def test_the_cell_is_taken_apart_and_put_together_without_a_placement(seen):
    closed, apart, placements, again = seen["exploded"]
    assert again == pytest.approx(closed)
    assert np.abs(placements).max() == 0
    moves = {name: apart[name] - closed[name] for name in closed}
    assert moves["bottom_glass"] < moves["spacer_left"] < moves["sheet"] == 0 < moves["top_glass"]
    assert moves["channels_top"] == moves["top_land"]
    assert moves["top_glass"] == pytest.approx(-moves["bottom_land"])


def test_the_section_hides_half_and_shows_what_is_cut(seen):
    (whole, half, again), colours = seen["section"]
    assert again == pytest.approx(whole)
    assert half == pytest.approx(whole / 2, rel=0.03)
    for colour in ((204, 56, 77), (237, 201, 107), (168, 214, 230)):  # film, epoxy, glass
        assert any(np.abs(np.subtract(colour, found)).max() <= 2 for found in colours)


def test_the_table_has_a_row_for_each_domain_and_sorts_them(seen):
    rows, domains, visible = seen["table"]["rows"]
    assert rows == domains == len(DESIGN.theta)
    assert visible
    assert seen["table"]["heads"][:6] == ["Domain", "x [mm]", "y [mm]", "Area [mm²]", "θ [°]", "Δθ [°]"]
    first, largest = seen["table"]["first"]
    assert first == largest


def test_a_selected_row_is_marked_in_the_view_which_goes_there(seen):
    marked, chosen = seen["table"]["row to view"]
    assert marked == [chosen] == seen["table"]["kept"]
    away, size = seen["table"]["focus"]
    assert away < size
    before, after = seen["table"]["marked"]
    assert before == 0
    assert after > 30


def test_clicks_in_the_view_select_rows_while_the_table_is_open(seen):
    assert seen["table"]["click 20 "] == [[20], [20]]
    assert seen["table"]["click 37 ctrl"] == [[20, 37], [20, 37]]
    assert seen["table"]["click 20 ctrl"] == [[37], [37]]
    assert seen["table"]["table closed"] == [37]


def test_nothing_of_it_is_in_the_document_or_its_file(seen):
    assert seen["document"] == []
    assert seen["file"]


def test_selected_domains_become_solids_in_one_undo_step(seen):
    steps_, domains, solids, undone = seen["solids"]
    channels = hatch(partition(DESIGN), "top", jobfile.parse(JOB, "job").channels)
    assert steps_ == ["Channel window"]
    assert domains == [7, 9]
    assert solids == channels.counts[[7, 9]].sum()
    assert undone == []


def test_picked_domains_stand_in_the_panel_of_the_channel_window(seen):
    assert seen["panel"] == ["5, 6", True]


def test_a_picture_follows_the_parameters(seen):
    former, now, expected = seen["follows"]
    assert now == expected != former


def test_another_view_takes_over_when_the_first_is_closed(seen):
    assert seen["reopened"] == [True, True, [3], True]


def test_every_command_shows_its_line(seen):
    said = seen["console"].replace("\n", "")
    for line in (
        "scene.show(App.getDocument('View').getObject('Cell'), 'deviation')",
        "scene.explode(App.getDocument('View').getObject('Cell'), True)",
        "scene.section(App.getDocument('View').getObject('Cell'), None)",
        "table.open_table(App.getDocument('View').getObject('Cell'))",
    ):
        assert line in said
    assert seen["closed"] == [0, 0]
