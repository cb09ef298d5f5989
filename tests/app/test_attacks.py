"""What careless users do: deleting, renaming, copying, closing, two documents at once."""

import attack_steps as steps
import pytest
from freecad_call import FreeCAD
from processes import ROOT, display


@pytest.fixture
def freecad(tmp_path):
    return FreeCAD(tmp_path / "home")


def test_deleted_objects_are_missed_in_one_sentence_and_come_back(freecad):
    found = freecad.console(steps.deleted, root=ROOT)  # FreeCAD itself prints what a recompute raises
    for said in found["SheetParameters"]:
        assert "has lost its parameters of sheet; undo their deletion" in said[0]
    assert found["BottomLand"][0] == []
    assert "not all of their parts; run Plates and Spacer first" in found["BottomLand"][1][0]
    assert "has lost its design; undo its deletion" in found["Design"][1][0]
    assert found["again"] == [True, [], 0]


def test_copies_and_other_documents_do_not_know_of_each_other(freecad, tmp_path):
    found = freecad.console(steps.copied, root=ROOT, folder=tmp_path)
    assert "Traceback" not in freecad.said
    assert len(found["parts"]) == len(set(found["parts"])) == 5
    assert found["depths"] == pytest.approx([0.6e-3, 1.4e-3, 2.0e-3])
    assert found["invalid"] == []
    assert len(set(found["bills"])) == len(found["bills"])


def test_broken_meshes_are_told_in_one_sentence_and_change_nothing(freecad, tmp_path):
    found = freecad.console(steps.broken, folder=tmp_path)
    assert "Traceback" not in freecad.said
    for name, (said, changed) in found.items():
        assert said, name
        assert said[1].count("\n") == 0
        assert len(said[1]) > 20
        assert "Error" not in said[1]
        assert changed == [], name


def test_objects_without_a_cell_are_told_and_stop_nothing(freecad):
    found = freecad.console(steps.strays, root=ROOT)  # FreeCAD itself prints what a recompute raises
    for name in ("Design", "BottomLand", "SheetParameters", "Mask"):
        assert "there is no cell in this document; start with New cell" in found[name][0]
    assert found["SheetParameters out"] == [True, []]  # it is still found, by what uses it
    assert not found["Design out"][0]
    assert "has lost its design" in found["Design out"][1][0]
    assert found["in"] == [[], []]


def test_a_moved_file_takes_everything_along(freecad, tmp_path):
    status, invalid, depth = freecad.console(steps.moved, root=ROOT, folder=tmp_path)
    assert "Traceback" not in freecad.said
    assert status.startswith("current")
    assert invalid == []
    assert depth == pytest.approx(0.8e-3)


def test_a_cell_undone_while_its_panel_works_takes_the_panel_along(freecad, tmp_path):
    with display() as screen:
        found = freecad.window(screen, steps.undone, folder=tmp_path)
    assert "Traceback" not in freecad.said
    assert found["left"] == []
    assert found["saved"] == ["not computed", False, f"{tmp_path}/saved.FCStd"]


def test_a_document_closed_while_its_panel_works_takes_the_panel_along(freecad):
    with display() as screen:
        found = freecad.window(screen, steps.closed, root=ROOT)
    assert "Traceback" not in freecad.said
    assert not found["others"]  # one panel at a time
    assert found["next"] == [True, True, False]
    assert found["active"]
