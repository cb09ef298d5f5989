"""The work on a cell by the functions that scripts and the window call, in FreeCAD without a window."""

import csv
import io

import numpy as np
import pytest
import session_steps as steps
import trimesh
from freecad_call import FreeCAD
from processes import ROOT

from lce_solver.surfaces import SURFACES
from lce_workbench.cli import main

MESH = "bump.stl"


@pytest.fixture(scope="module")
def mesh(tmp_path_factory):
    """A gently bent surface as a mesh file."""
    path = tmp_path_factory.mktemp("a mesh") / MESH
    surface = SURFACES["saddle"](0.12)
    trimesh.Trimesh(surface.vertices, surface.faces, process=False).export(path)
    return path


@pytest.fixture(scope="module")
def out(tmp_path_factory):
    return tmp_path_factory.mktemp("session out")


@pytest.fixture(scope="module")
def done(mesh, out, tmp_path_factory):
    freecad = FreeCAD(tmp_path_factory.mktemp("session home"))
    found = freecad.console(steps.work, mesh=str(mesh), folder=str(out))
    assert "Traceback" not in freecad.said
    return found


def test_a_new_cell_says_that_nothing_is_computed(done):
    assert set(done["new"]) == {"Design", "Prediction", "Mask", "Review"}
    assert set(done["new"].values()) == {"not computed"}
    assert done["children"][:4] == ["Target", "Material", "Sheet", "Domains"]


def test_a_result_is_current_once_it_is_made(done):
    assert done["designed"]["Design"] == "current"
    assert done["predicted"][0] == "current"
    assert done["predicted"][2] > 0
    assert done["masked"]["Mask"] == "current"
    assert done["window"] > 10
    assert done["cell"] == "Cell"


def test_a_wrong_setting_is_one_sentence_and_changes_nothing(done):
    gap, unknown, deep, missing, label, coarse, unchanged = done["refused"]
    assert "marks.label" in label
    assert "channels.width_um = 1 is finer than output.writer_um = 2 um" in coarse
    assert "sheet.gap_um is -1 um" in gap
    assert "did you mean gap_um?" in unknown
    assert "channels.depth_um = 60 is not smaller than" in deep
    assert missing == "target.mesh: /no/such.stl does not exist; choose a mesh file"
    assert unchanged


def test_other_glass_leaves_the_lands_as_they_are_drawn(done):
    """Their shapes stay the same ones; a shape from elsewhere is replaced."""
    assert done["kept"] == [True, False]
    assert done["restored"]


def test_the_gap_moves_twist_and_masks_but_not_the_metric(done):
    after = done["gap"]
    assert after["statuses"]["Design"].startswith("current, but not corrected for this film yet")
    assert done["said"]
    assert after["statuses"]["Prediction (stale)"] == "stale: sheet.gap_um is now 150.0, this was made for 100.0"
    twist, mask = after["figures"]
    assert mask != done["mask"]
    assert twist >= done["twist"]
    assert "TargetParameters" not in after["recomputed"]


def test_what_is_written_comes_back_corrected_into_the_document(done, out):
    assert done["masked"]["Design"] == done["masked"]["Mask"] == "current"
    twist, (bottom, top, code) = done["drawn"]
    with (out / "out" / "cell" / "domains.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    assert [sum(int(row[f"channels_{plate}"]) for row in rows) for plate in ("bottom", "top")] == [bottom, top]
    assert max(abs(float(row["dtheta_deg"])) for row in rows) == pytest.approx(twist, abs=1e-6)
    assert code in (out / "out" / "cell" / "mask" / "job_sheet.txt").read_text()


def test_results_are_stale_only_when_a_parameter_of_theirs_changed(done):
    assert done["window moved"] == done["masked"]
    statuses, uncorrected = done["off"]
    assert statuses["Design"] == "current"
    assert uncorrected != done["drawn"]
    assert statuses["Mask (stale)"] == "stale: prediction.correct is now 'off', this was made for 'full'"


def test_the_depth_moves_the_plates_alone_and_at_once(done):
    moved = set(done["depth"]["recomputed"])
    assert {"BottomLand", "TopLand", "BottomGlass"} <= moved
    assert not moved & {"Design", "Prediction", "Sheet", "SpacerLeft", "SpacerRight"}
    assert done["depth"]["seconds"] < 1


def test_expressions_and_a_spreadsheet_drive_the_cell(done):
    assert done["expression"] == pytest.approx([0.03, 0.03])


def test_another_width_makes_all_results_stale_and_the_masks_refuse(done):
    told = "stale: sheet.width_mm is now 4.0, this was made for 3.0"
    assert done["stale"]["Design (stale)"] == told
    assert done["stale"]["Mask (stale)"].startswith("stale")
    assert done["designed"]["Review"] == "not computed"
    assert done["too late"].startswith(f"the design of Cell is {told}; run Design again")


def test_masks_and_table_are_those_of_the_command_line(done, out, tmp_path):
    assert main(["design", str(out / "cell.toml"), "--out", str(tmp_path / "other"), "--quiet"]) == 0
    main(["mask", str(tmp_path / "other"), "--quiet"])
    files = [p.relative_to(tmp_path / "other") for p in (tmp_path / "other").rglob("*") if p.is_file()]
    assert len(files) > 10
    for name in files:
        if name.name == "domains.csv" or name.parent.name == "mask":
            assert (out / "out" / "cell" / name).read_bytes() == (tmp_path / "other" / name).read_bytes(), name


def test_a_document_of_schema_1_opens_works_and_is_saved_anew(tmp_path):
    freecad = FreeCAD(tmp_path / "home")
    path = ROOT / "tests" / "documents" / "schema1.FCStd"
    found = freecad.console(steps.old, path=path, save_as=tmp_path / "new.FCStd")
    assert "Traceback" not in freecad.said
    assert found["versions"] == [4]
    assert found["labels"]["SheetParameters"] == "Sheet"
    assert "surface='saddle'" in found["job"]
    assert "width_um=5.0" in found["job"]
    assert "label='A1'" in found["job"]
    assert found["ratio"] == pytest.approx(2, rel=1e-4)  # channels are rounded otherwise than they were then
    assert found["invalid"] == []
    assert found["status"] == "current"
    assert found["stale"] == "stale: sheet.width_mm is now 9.0, this was made for 2.2"
    assert found["again"] == [found["stale"], "A1", "Marks"]


def test_a_document_of_schema_3_takes_the_dependencies_of_today(tmp_path):
    freecad = FreeCAD(tmp_path / "home")
    found = freecad.console(steps.third, path=ROOT / "tests" / "documents" / "schema3.FCStd")
    assert "Traceback" not in freecad.said
    assert found["opened"] == [[4], "current", "current"]
    assert found["gap"][0].startswith("current, but not corrected")
    assert found["uncorrected"][0] == "current"
    assert found["back"] == ["current", "current"]


def test_targets_come_from_meshes_and_faces_of_the_document(mesh, tmp_path):
    freecad = FreeCAD(tmp_path / "home")
    found = freecad.console(steps.sources, mesh_file=str(mesh), folder=str(tmp_path))
    name, text, surface = found["mesh"]
    assert (name, surface) == ("Scan.off", "")
    taken, given = trimesh.load(io.StringIO(text), file_type="off", process=False), trimesh.load(mesh)
    assert len(taken.faces) == len(given.faces)
    assert taken.area == pytest.approx(given.area, rel=1e-6)
    cap, grown = (trimesh.load(io.StringIO(found[key]), file_type="off") for key in ("face", "moved"))
    assert np.linalg.norm(cap.vertices, axis=1) == pytest.approx(10, rel=1e-5)
    assert cap.area == pytest.approx(2 * np.pi * 10**2 * 0.5, rel=0.01)
    assert np.median(cap.edges_unique_length) < 0.6 / 12 * 30
    assert np.linalg.norm(grown.vertices, axis=1) == pytest.approx(20, rel=1e-5)
    assert "has neither a mesh nor a face" in found["wrong"]
