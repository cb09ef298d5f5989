"""Scripts that ask for what cannot be, and documents that are damaged: one sentence each, and nothing else changes."""

import pytest
import script_steps as steps
from freecad_call import FreeCAD
from processes import ROOT


@pytest.fixture
def freecad(tmp_path):
    return FreeCAD(tmp_path / "home")


def test_settings_that_cannot_be_taken_are_told_and_change_nothing(freecad):
    found = freecad.console(steps.refused, root=ROOT)
    assert "Traceback" not in freecad.said
    told = {
        "driven": "channels.depth_um is what the expression Values.depth says; change what it names, or clear it",
        "unknown": "unknown key",
        "no section": "unknown key",
        "no domain": "output.step_domains: domain 99999 does not exist",
        "no window": "drawings need FreeCAD's window",
    }
    for case, words in told.items():
        kind, sentence, unchanged, invalid = found[case]
        assert kind == ("EnvironmentFault" if case == "no window" else "InputError")
        assert words in sentence
        assert unchanged
        assert invalid == []
    assert found["depth"] == pytest.approx(0.0012)
    assert found["free"] == pytest.approx([0.002, 150.0])


def test_a_damaged_document_says_what_it_lost_and_is_mended_where_it_can_be(freecad, tmp_path):
    found = freecad.console(steps.damaged, root=ROOT, folder=tmp_path)
    status, plates, inspect, mask = found["lost"]
    assert found["volume"] > 0  # its shapes are still shown
    assert status == "stale: its file is not in this document, which is damaged"
    for sentence in (plates, inspect):
        assert sentence == "the design's file design.npz is not in this document, which is damaged; run Design again"
    assert mask.startswith("the design of Cell is stale: its file is not in this document")
    assert found["short"] == [True, "Cell has no plates, or not all of their parts; run Plates and Spacer first"]
    (sentence,) = found["impossible"]
    assert sentence.startswith("error: Channels: channels.depth_um is -3 um; it must be greater than 0 um")
    assert found["mended"] == ["current", False, 0]


def test_a_document_that_was_saved_without_the_workbench_lives_again(freecad, tmp_path):
    path = tmp_path / "elsewhere.FCStd"
    stranger = FreeCAD(tmp_path / "stranger", addon=None)
    lost, depth = stranger.console(steps.without_addon, path=ROOT / steps.DOCUMENT, save_as=path)
    assert lost > 20
    assert depth == pytest.approx(0.0006)  # nobody computes it there
    found = freecad.console(steps.with_addon_again, path=path)
    assert "Traceback" not in freecad.said
    assert found["cells"] == ["Cell"]
    assert found["lost"] == []
    assert found["labels"] == ["Channels", "Bottom land"]
    assert found["depth"] == pytest.approx(0.0012)
    assert found["gap"][0] == pytest.approx(0.15)
    assert found["gap"][1].startswith("current")
    assert found["review"] == [0, []]
