"""The panels: lengths as users write them, f(x), presets, what is remembered, preferences, folders that are closed."""

import panel_steps as steps
import pytest
from freecad_call import FreeCAD
from processes import ROOT
from readonly import read_only

from lce_workbench.core import material


@pytest.fixture
def freecad(tmp_path):
    return FreeCAD(tmp_path / "home")


def test_lengths_are_read_in_every_unit_and_nonsense_never_closes_a_panel(screen, freecad):
    found = freecad.window(screen, steps.typed)
    assert "Traceback" not in freecad.said
    for text, (reason, still_open, gap) in found["read"].items():
        assert (reason, still_open) == ("", False), text
        assert gap == pytest.approx(steps.WRITTEN[text], rel=1e-12), text
    for text, (enabled, still_open, reason) in found["refused"].items():
        assert not enabled, text
        assert still_open, text
        assert reason.startswith("sheet.gap_um is"), text
    assert found["changed"] == []


def test_an_expression_given_by_f_x_lives_in_the_document_and_cancel_takes_it_back(screen, freecad):
    found = freecad.window(screen, steps.formula)
    assert "Traceback" not in freecad.said
    assert found["Cancel"][2:] == [[], []]
    assert found["Ok"][3] == [["Gap", "ChannelsParameters.Depth * 201.5"]]
    assert found["gap"] == pytest.approx(120.9)
    assert found["follows"] == pytest.approx(141.05)
    assert found["kept"] == [True, [["Gap", "ChannelsParameters.Depth * 201.5"]], 2.0]
    assert found["undone"] == []


def test_presets_fill_the_fields_and_are_all_offered(screen, freecad):
    found = freecad.window(screen, steps.presets)
    assert "Traceback" not in freecad.said
    for name, (_, values) in steps.PRESETS.items():
        undesigned = "Cell is not designed yet; run Design first" if name == "ChannelWindow" else ""
        assert found["shown"][name] == [values, undesigned]
        assert found["offered"][name] in found["tables"].values()
    assert found["coarse"][:2] == [False, True]
    assert "is finer than output.writer_um = 2 um" in found["coarse"][2]
    assert set(material.presets()) <= set(found["materials"])
    assert found["job"][-1] == "rm82-pdt-1to1-max"


def test_a_new_cell_starts_with_the_values_of_last_time_unless_that_is_switched_off(screen, freecad, tmp_path):
    first = freecad.window(screen, steps.remembered, folder=str(tmp_path), first=True)
    again = freecad.window(screen, steps.remembered, folder=str(tmp_path), first=False)
    assert "Traceback" not in freecad.said
    assert first["start"] == first["unwanted"] == again["unwanted"] == [20, 100, "face"]
    assert first["next"] == again["start"] == [7, 120, "leaf"]
    assert first["no folder"].endswith("LCE")
    assert first["beside"] == str(tmp_path)
    assert first["chosen"] == f"{tmp_path}/chosen"


def test_the_author_and_the_budget_of_the_preferences_are_used(screen, freecad):
    found = freecad.window(screen, steps.budgets, root=str(ROOT))
    assert "Traceback" not in freecad.said
    assert found["author"] == "A. Maker"
    assert found["3"] == [True, False, ""]
    for domains, words in {
        "3, 4, 5, 6, 7, 8": "the preferences allow 50 of them; choose fewer domains",
        "999": "domain 999 does not exist",
        "3, x": "give whole numbers with commas between them",
    }.items():
        enabled, still_open, reason = found[domains]
        assert [enabled, still_open] == [False, True], domains
        assert words in reason
    assert found["changed"] == []


def test_a_folder_that_cannot_be_written_is_told_and_nothing_is_lost(screen, freecad, tmp_path):
    closed = tmp_path / "closed"
    closed.mkdir()
    freecad.before, freecad.place = read_only(closed), tmp_path
    found = freecad.window(screen, steps.unwritable, root=str(ROOT), folder=str(closed), outside=str(tmp_path))
    assert "Traceback" not in freecad.said
    for place in (str(closed), f"{closed}/below/it", "/proc/none", f"{ROOT}/README.md"):
        still_open, reason, changed = found[place]
        assert still_open, place
        assert reason.count("\n") == 0
        assert place.split("/")[-1] in reason
        assert changed == []
    assert found["saved"]
    assert found["kept"]
