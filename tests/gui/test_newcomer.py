"""What somebody meets who has just come: meshes in the way, two cells, wrong values, deleted objects."""

import newcomer_steps as steps
import pytest
import sheets
from freecad_call import SETTINGS, FreeCAD

from lce_workbench.outputs import write_design

JOB = '[target]\nsurface = "saddle"\n[sheet]\nwidth_mm = 2.2\n[channels]\nwidth_um = 4.0\nspacing_um = 6.0\n'


@pytest.fixture
def freecad(tmp_path):
    (tmp_path / "job.toml").write_text(JOB)
    design = sheets.design()
    write_design(design, tmp_path / "design.npz")
    sheets.np.savez(tmp_path / "prediction.npz", vertices=design.surface.vertices)
    return FreeCAD(tmp_path / "home")


def test_the_mesh_of_the_target_is_in_no_picture_and_not_in_the_cell(screen, freecad, tmp_path):
    found = freecad.window(screen, steps.looked, folder=tmp_path)
    assert "Traceback" not in freecad.said
    picture, legend = found["beside the legend"]
    assert picture < legend
    solid, pictured, back = found["seen"]
    assert solid == back >= 0
    assert pictured == -1
    assert [found["beside plates"], found["undone"]] == [False, True]
    assert found["grey"] == {"Sheet": False, "Marks": False, "Origin": True}
    assert found["told"].startswith("Design review: errors: ")
    assert found["predicted"].startswith("the sheet takes the mirror image of the target, 0.82 % of the target's")


def test_the_first_words_are_in_the_users_language(screen, freecad):
    german = SETTINGS.replace("</FCText>", '</FCText><FCText Name="Language">German</FCText>')
    (freecad.home / "user.cfg").write_text(german)
    assert freecad.window(screen, steps.greeted) == ["Neue Zelle", "Neue Zelle", "Neue Zelle …"]
    assert "Traceback" not in freecad.said


def test_one_of_two_cells_is_chosen_and_all_chosen_faces_are_the_target(screen, freecad, tmp_path):
    found = freecad.window(screen, steps.doubled, folder=tmp_path)
    assert "Traceback" not in freecad.said
    assert found["both"] == ["choose one of the cells in the tree, and only one"]
    label, title = found["title"]
    assert title == f"Plates and spacer: {label}"
    assert [title.removesuffix("[*]") for title in found["in front"]] == ["1 Cell assembly", "1 Cell assembly001"]
    faces = [["Box.off", [0, 10, 10]], ["Box.off", [10, 10, 10]], ["Shell.off", [10, 10, 10]]]
    assert found["targets"] == [*faces, "face"]  # a solid is no surface


def test_a_wrong_value_is_one_frame_and_a_sentence_and_the_picture_stays(screen, freecad, tmp_path):
    found = freecad.window(screen, steps.wrong, folder=tmp_path)
    said, kept = found["negative"]
    assert "sheet.gap_um is -1000 um; it must be greater than 0 um" in said
    assert kept
    assert "sheet.gap_um is 1e-05 um; it must be at least 0.01 um" in found["thin"]
    for place in ("masks", "./masks"):
        assert found[place] == f"folder is {place!r}; begin it with / or ~"
    assert [found["~/masks"], found["/masks"]] == ["", ""]
    assert found["names"] == ["grosse-1", "zelle-a-o-2", "stale", "cell"]
    assert found["again"] == []
    assert found["deleted"][0].startswith("Film has lost its design; undo its deletion")
    assert found["deleted"][1] == 0
    assert "slotRecomputedDocument" not in freecad.said
    assert freecad.said.count('  File "') == freecad.said.count("Traceback") > 0
