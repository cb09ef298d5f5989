"""The workbench in the window: every command, undo, cancel, stop, wrong values, and the files of `./lce build`."""

import importlib.util
import os

import gui_steps as steps
import pytest
import trimesh
from freecad_call import FreeCAD
from processes import ROOT

from lce_solver.surfaces import SURFACES
from lce_workbench.cli import main

STEPS = ["NewCell", "Design", "Predict", "Plates", "ChannelWindow", "Mask"]


@pytest.fixture(scope="module")
def out(tmp_path_factory):
    return tmp_path_factory.mktemp("window out")


@pytest.fixture(scope="module")
def walked(screen, out, tmp_path_factory):
    folder = tmp_path_factory.mktemp("a mesh")
    surface = SURFACES["saddle"](0.12)
    trimesh.Trimesh(surface.vertices, surface.faces, process=False).export(folder / "bump.stl")
    freecad = FreeCAD(tmp_path_factory.mktemp("walk home"))
    found = freecad.window(screen, steps.walk, mesh=str(folder / "bump.stl"), folder=str(out))
    assert "Traceback" not in freecad.said
    return found


def test_every_command_has_words_a_tip_and_a_picture(walked):
    for name, (text, tip, picture) in walked["commands"].items():
        assert text, name
        assert tip, name
        assert picture or name == "LCE_Examples", name
    for name in [*STEPS, "Drawings", "Review", "Export", "ExampleFace"]:
        assert f"LCE_{name}" in walked["commands"]


@pytest.mark.parametrize("name", STEPS)
def test_cancel_leaves_no_trace(walked, name):
    assert walked["cancel"][name] == [False, []]


@pytest.mark.parametrize("name", [*STEPS, "Inspect", "Drawings"])
def test_undo_brings_back_the_former_state_and_redo_the_later_one(walked, name):
    assert walked["undo"][name] == []
    assert walked["undo"][f"{name} again"] == []


def test_each_step_is_one_undo_step_and_one_python_line(walked):
    assert walked["names"] == [
        "New cell", "Design", "Predict", "Plates and spacer", "Channel window", "Mask", "Design review", "Drawings",
    ]  # fmt: skip
    calls = (
        "new_cell",
        "design",
        "predict",
        "plates",
        "channel_window",
        "mask",
        "inspect",
        "drawings",
    )
    for call in calls:
        assert f"session.{call}(App.getDocument('Walk')" in walked["console"].replace("\n", "")


def test_findings_are_listed_with_limits_and_lead_to_their_places(walked):
    rows = {row[1]: row for row in walked["findings"]["rows"]}
    assert {"stretch_rms", "twist_limit", "interference", "marks_seen", "body_gap"} <= rows.keys()
    assert rows["body_gap"][2:5] == ["0 nm", "1 nm", "top_land and bottom_land"]
    assert all(row[0] in {"error", "warning", "info"} and row[5] for row in rows.values())
    (selected, *_), (_, marked, height), nowhere = (
        walked["findings"][check] for check in ("body_volume", "stretch_max", "interference")
    )
    assert len(selected) == 1
    assert marked == 1
    assert 0.3 < height < 3  # a domain of 0.3 mm
    assert nowhere == [[], 0, height]


def test_the_window_stays_free_while_the_solver_works(walked):
    by_the_wall, by_the_processor = (max(times) for times in zip(*walked["free"], strict=True))
    assert by_the_processor < 0.1
    assert by_the_wall < 0.1 * max(1.0, os.getloadavg()[0])


def test_results_are_current_and_bodies_are_seen_in_their_colours(walked):
    assert {k: v for k, v in walked["statuses"].items() if k != "Review"} == {
        "Design": "current", "Prediction": "current", "Mask": "current",
    }  # fmt: skip
    assert {"BottomLand", "TopGlass", "SpacerLeft", "Sheet", "ChannelsTop"} <= set(walked["visible"])
    assert walked["colour"] == [0.87, 0.6, 0.22]
    assert walked["transparency"] == 95


def test_table_and_masks_are_those_of_the_command_line(walked, out, tmp_path):
    toml = out / "cell.toml"
    main(["design", str(toml), "--out", str(tmp_path / "other"), "--quiet"])
    main(["mask", str(tmp_path / "other"), "--quiet"])
    names = [
        "domains.csv",
        "design.npz",
        *(f"mask/{p}.{kind}" for p in ("bottom", "top") for kind in ("gds", "oas", "dxf")),
    ]
    for name in names:
        assert (out / "out" / "cell" / name).read_bytes() == (tmp_path / "other" / name).read_bytes(), name


@pytest.fixture(scope="module")
def mistaken(screen, tmp_path_factory):
    freecad = FreeCAD(tmp_path_factory.mktemp("mistakes home"))
    found = freecad.window(screen, steps.mistakes, folder=str(tmp_path_factory.mktemp("mistakes out")))
    assert "Traceback" not in freecad.said
    return found


def test_commands_that_need_a_cell_wait_for_one(mistaken):
    assert mistaken["inactive"] == [False, False, False]


def test_a_wrong_value_is_told_and_never_closes_a_panel(mistaken):
    assert len(mistaken["wrong"]) == 6
    for case, (enabled, still_open, reason) in mistaken["wrong"].items():
        assert not enabled, case
        assert still_open, case
        assert reason.startswith(("sheet.", "domains.", "solver.", "cell: domains.")), case


def test_stop_ends_the_work_within_a_second_and_leaves_the_document_as_it_was(mistaken):
    seconds, still_open, changed = mistaken["stop"]
    assert seconds < 1.0 + 0.5 * os.getloadavg()[0]
    assert still_open
    assert changed == []
    assert mistaken["stage"].startswith("flatten, energy ")
    assert float(mistaken["stage"].split()[-1]) > 0
    assert mistaken["busy"] == [False, True]
    for case in ("after", "cancelled", "left"):
        assert mistaken[case] == [False, []]


def test_steps_out_of_order_say_what_to_do_first(mistaken):
    assert mistaken["too early"] == [True, "Cell is not designed yet; run Design first"]
    assert mistaken["no design"] == [True, "Cell is not designed yet; run Design first", []]


def test_objects_are_edited_by_double_click_and_examples_open(screen, tmp_path):
    freecad = FreeCAD(tmp_path / "home")
    found = freecad.window(screen, steps.edited)
    assert "Traceback" not in freecad.said
    assert found["edit"] == [True, False, pytest.approx(0.12), ["Sheet"]]
    assert found["undone"] == pytest.approx(0.1)
    assert found["expression"] == [pytest.approx(0.13), [["Gap", "ChannelsParameters.Width * 130"]]]
    for name in ("Face", "Dome", "Saddle", "Leaf"):
        assert found[name] == [name, [name]]


def test_german_is_complete_and_used(screen, tmp_path):
    """All words of the window; parameters may be newer than their translation, but hardly any."""
    source = importlib.util.spec_from_file_location("update", ROOT / "resources" / "translations" / "update.py")
    update = importlib.util.module_from_spec(source)
    source.loader.exec_module(update)
    known = {text for _, text in update.known("de")}
    assert [text for text in update.window_texts() if text not in known] == []
    assert [text for texts in update.form_texts().values() for text in texts if text not in known] == []
    parameters = update.parameter_texts()
    assert sum(text in known for text in parameters) >= 0.8 * len(parameters)
    freecad = FreeCAD(tmp_path / "home")
    found = freecad.window(screen, steps.german)
    assert found["tip"] == "Filmdicke = Dicke des Abstandshalters"
    assert found["stop"] == "Anhalten"
    assert found["gap"]["0,15 mm"] == found["gap"]["150 µm"] == ""
    assert "decimal mark of your language is ','" in found["gap"]["0.15 mm"]  # FreeCAD alone reads 15 mm
    assert found["commands"]["LCE_ExampleFace"][0] == "Gesicht"
    assert found["commands"]["LCE_Mask"][:2] == [
        "Maske …", "Schreibt die Masken beider Platten für den Laserschreiber",
    ]  # fmt: skip
