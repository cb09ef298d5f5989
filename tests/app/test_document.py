"""The FreeCAD document of the cell: written without a window, opened with one, with and without our addon."""

import hashlib
import zipfile
from dataclasses import fields

import document_steps as steps
import numpy as np
import pytest
import sheets
from freecad_call import FreeCAD
from PIL import Image

from lce_solver.bounded import retwisted
from lce_solver.twist import second_form
from lce_workbench.core import jobfile
from lce_workbench.core.closed import closed
from lce_workbench.core.domains import partition
from lce_workbench.core.job import Job
from lce_workbench.outputs import write_design

JOB = """
[target]
surface = "saddle"
[sheet]
width_mm = 2.2
gap_um = 100.0
[channels]
width_um = 2.0
spacing_um = 3.0
"""

JOBS = {
    "defaults": '[target]\nsurface = "face"',
    "everything else": """
[target]
mesh = "faces/μ ü.stl"
subdivision = "midpoint"
flip = true
[material]
lambda = 0.615
nu = 0.47
[sheet]
width_mm = 19.7
gap_um = 150
twist_gain = -2.5
edge_overdrive = true
[domains]
size_um = 333.3
[channels]
width_um = 0.7
spacing_um = 1.1
depth_um = 0.123456789
guard_um = 0.3
[plates]
width_mm = 75.0
glass_mm = 1.1
epoxy_um = 12.0
[marks]
clearance_mm = 2.9
tolerance_um = 5.7
[spacer]
strip_mm = 3.3
clearance_mm = 0.0
glue_mm = 2.1
[solver]
starts = 7
tolerance = 3e-9
max_iterations = 77
[output]
masks = ["dxf"]
freecad = false
step_domains = [0, 17, 4]
""",
    "a curve": '[target]\nsurface = "dome"\n[material]\ncurve = "strain.csv"\ntemperature_C = 0.0',
}


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """An output folder with the document of a small cell."""
    out = tmp_path_factory.mktemp("an output")
    (out / "job.toml").write_text(JOB)
    write_design(sheets.design(), out / "design.npz")
    freecad = FreeCAD(tmp_path_factory.mktemp("writer"))
    assert freecad.console(steps.run, folder=out) == ["", 0]
    return out


@pytest.fixture(scope="module")
def fcstd(folder):
    return folder / "cad" / "cell.FCStd"


@pytest.fixture
def freecad(tmp_path):
    return FreeCAD(tmp_path / "home")


def prisms(design, job):
    """Name of a body -> its prisms, by the way the pipeline goes."""
    cell = closed(design, partition(design), job)
    found = {}
    for name, prism in [(p.name, p) for p in cell.parts] + [(p.group, p) for p in cell.channels]:
        found.setdefault(name, []).append(prism)
    return {"".join(word.capitalize() for word in name.split("_")): parts for name, parts in found.items()}


def assert_is_cell(bodies, design, job):
    """The bodies are the prisms: as many solids, their volume and their place."""
    expected = prisms(design, job)
    assert bodies.keys() == expected.keys()
    for name, parts in expected.items():
        body, points = bodies[name], np.concatenate([part.outline for part in parts])
        assert body["valid"]
        assert body["solids"] == (len(parts) if name.startswith("Channels") else 1)
        assert body["volume"] == pytest.approx(sum(part.volume for part in parts), rel=1e-9)
        assert body["low"] == pytest.approx([*points.min(axis=0), min(part.z0 for part in parts)], abs=1e-6)
        assert body["high"] == pytest.approx([*points.max(axis=0), max(part.z1 for part in parts)], abs=1e-6)


@pytest.mark.parametrize("toml", JOBS.values(), ids=JOBS.keys())
def test_every_section_survives_properties_and_file_exactly(freecad, tmp_path, toml):
    before, after = freecad.console(steps.round_trip, toml=toml, path=tmp_path / "job.FCStd")
    assert after == before


@pytest.fixture(scope="module")
def opened(fcstd, tmp_path_factory):
    return FreeCAD(tmp_path_factory.mktemp("reader")).console(steps.read_only, path=fcstd)


def test_the_document_is_a_tree_of_named_parts(opened):
    tree = opened["tree"]
    assert tree["Cell"] == []
    for inside in (
        "Design",
        "Prediction",
        "Mask",
        "Review",
        "BottomPlate",
        "TopPlate",
        "Spacer",
        "Sheet",
        "ChannelsTop",
    ):
        assert tree[inside] == ["Cell"]
    assert tree["BottomLand"] == ["BottomPlate"]
    assert tree["SpacerLeft"] == ["Spacer"]
    assert sum(name.endswith("Parameters") for name in tree) == len(fields(Job))


def test_bodies_are_the_prisms_of_the_cell(opened):
    assert_is_cell(opened["bodies"], sheets.design(), jobfile.parse(JOB))


@pytest.fixture(scope="module")
def edited(fcstd, tmp_path_factory):
    """What happened to a document that was edited and saved without a window, and its file."""
    path = tmp_path_factory.mktemp("edited") / "edited.FCStd"
    changes = [("ChannelsParameters", "Depth", "1.5 um"), ("SheetParameters", "Gap", "150 um")]
    freecad = FreeCAD(tmp_path_factory.mktemp("editor"))
    return freecad.console(steps.edit, path=fcstd, changes=changes, save_as=path), path


def test_an_edit_of_depth_and_gap_moves_plates_spacer_film_and_channels(edited):
    design = sheets.design()
    thicker = retwisted(design, second_form(design.surface, design.uv), 0.15)
    job = jobfile.parse(JOB, settings=["channels.depth_um=1.5", "sheet.gap_um=150"])
    for state in ("edited", "reopened", "recomputed"):
        assert edited[0][state]["invalid"] == {}
        assert_is_cell(edited[0][state]["bodies"], thicker, job)


def test_options_of_the_workshop_come_and_go(freecad, fcstd, tmp_path):
    """Chamfered glass is one solid; the alignment frame appears, the glue beads go."""
    plates = [("PlatesParameters", "Chamfer", "0.2 mm"), ("PlatesParameters", "Frame", "4 mm")]
    changes = [*plates, ("SpacerParameters", "Bead", "0 mm")]
    found = freecad.console(steps.edit, path=fcstd, changes=changes, save_as=tmp_path / "options.FCStd")
    job = jobfile.parse(JOB, settings=["plates.chamfer_mm=0.2", "plates.frame_mm=4", "spacer.bead_mm=0"])
    for state in ("edited", "reopened", "recomputed"):
        assert found[state]["invalid"] == {}
        assert_is_cell(found[state]["bodies"], sheets.design(), job)
        assert found[state]["bodies"]["BottomGlass"]["solids"] == 1


def test_a_parameter_that_a_file_lacks_gets_its_default(edited):
    assert edited[0]["guard"] == 0.0005


def test_an_optional_value_can_be_edited_once_it_counts(opened):
    assert opened["modes"] == [["ReadOnly"], []]


def test_volumes_follow_the_depth_where_only_numpy_is_installed(freecad, fcstd, opened):
    found = freecad.console(steps.edit_without_scipy, path=fcstd, changes=[("ChannelsParameters", "Depth", "1.8 um")])
    assert found["invalid"] == {}
    for name, body in found["bodies"].items():
        ratio = 3.0 if name.startswith("Channels") or name.endswith("Land") else 1.0
        assert body["volume"] == pytest.approx(ratio * opened["bodies"][name]["volume"], rel=1e-9)


IMPOSSIBLE = {
    "no depth": ("ChannelsParameters", "Depth", 0.0, "ChannelsParameters", "channels.depth_um is 0 um; it must be"),
    "depth below 0": (
        "ChannelsParameters",
        "Depth",
        "-1 um",
        "ChannelsParameters",
        "channels.depth_um is -1 um; it must",
    ),
    "gap of 6 mm": ("SheetParameters", "Gap", "6 mm", "SheetParameters", "sheet.gap_um is 6000 um; it must be at most"),
    "glass of 3 mm": ("PlatesParameters", "Width", "3 mm", "BottomGlass", "the plate of 3 x"),
    "domain 999": ("OutputParameters", "StepDomains", [999], "ChannelsTop", "domain 999 does not exist"),
}

OUTDATED = {
    "another sheet": ("SheetParameters", "Width", "3 mm", "sheet.width_mm is now 3.0, this was made for 2.2"),
    "another target": ("TargetParameters", "Flip", True, "target.flip is now True, this was made for False"),
}


def test_an_impossible_value_marks_an_object_with_one_sentence(freecad, fcstd):
    cases = {case: [change[:3]] for case, change in IMPOSSIBLE.items()}
    cases["glass of 3 mm"].append(("PlatesParameters", "WidthGiven", True))
    cases |= {case: [change[:3]] for case, change in OUTDATED.items()}
    found = freecad.console(steps.attempt, path=fcstd, cases=cases)
    for case, (*_, marked, sentence) in IMPOSSIBLE.items():
        assert sentence in found["said"][case]["invalid"][marked]
        assert found["said"][case]["moved"] == []  # what cannot be computed stays as it was
    for case, (*_, sentence) in OUTDATED.items():
        assert found["said"][case]["invalid"] == {}
        assert found["said"][case]["design"] == ["Design (stale)", f"stale: {sentence}"]
    assert found["end"]["invalid"] == {}
    assert_is_cell(found["end"]["bodies"], sheets.design(), jobfile.parse(JOB))


def test_two_runs_write_the_same_bytes(freecad, folder, fcstd, tmp_path):
    digest = hashlib.sha256(fcstd.read_bytes()).digest()
    other = tmp_path / "another place"
    other.mkdir()
    for name in ("job.toml", "design.npz"):
        (other / name).write_bytes((folder / name).read_bytes())
    assert freecad.console(steps.run, folder=other) == ["", 0]
    assert hashlib.sha256((other / "cad" / "cell.FCStd").read_bytes()).digest() == digest


def test_another_job_is_another_document_with_another_identity(freecad, folder, fcstd, tmp_path):
    (tmp_path / "job.toml").write_text(JOB.replace("100.0", "150.0"))
    (tmp_path / "design.npz").write_bytes((folder / "design.npz").read_bytes())
    assert freecad.console(steps.run, folder=tmp_path) == ["", 0]
    assert identity(tmp_path / "cad" / "cell.FCStd") != identity(fcstd)


def identity(fcstd):
    with zipfile.ZipFile(fcstd) as archive:
        text = archive.read("Document.xml").decode()
    return [part.split('"')[0] for part in text.split('<Uuid value="')[1:]]


def test_a_fault_is_one_sentence_and_leaves_no_file(freecad, folder, tmp_path):
    (tmp_path / "design.npz").write_bytes((folder / "design.npz").read_bytes())
    (tmp_path / "job.toml").write_text(JOB + "[plates]\nwidth_mm = 3.0\n")
    sentence, code = freecad.console(steps.run, folder=tmp_path)
    assert sentence.startswith("the plate of 3 x")
    assert code == 2
    assert list((tmp_path / "cad").iterdir()) == []


def assert_looks(shown, picture):
    """Every body is visible in its colour, and so is the picture."""
    for name, (first, *_) in prisms(sheets.design(), jobfile.parse(JOB)).items():
        opacity = first.opacity * (0.2 if first.group == "top_plate" else 1.0)
        assert shown[name]["colour"][:3] == pytest.approx(first.colour, abs=1 / 255)
        assert shown[name]["transparency"] == round(100 * (1 - opacity))
        assert shown[name]["shine"] == [0, 0, 0]
    hidden = {name for name, view in shown.items() if not view["visible"]}
    assert all(name.startswith(AIDS) for name in hidden)
    pixels = np.asarray(Image.open(picture).convert("RGB")).astype(int)
    assert np.mean(np.ptp(pixels, axis=2) > 40) > 0.1  # epoxy and film: neither grey nor the white behind them


AIDS = ("Origin", "X_Axis", "Y_Axis", "Z_Axis", "XY_Plane", "XZ_Plane", "YZ_Plane", "BillOfMaterials")
"""What has nothing to show in the 3D view, or hides it."""


def test_it_opens_visible_and_coloured_and_can_be_edited_in_the_window(freecad, screen, fcstd, edited, tmp_path):
    saved, picture, other = tmp_path / "saved.FCStd", tmp_path / "view.png", tmp_path / "other.png"
    changes = [("ChannelsParameters", "Depth", "0.9 um")]
    arguments = {"path": fcstd, "picture": picture, "changes": changes, "save_as": saved}
    found = freecad.window(screen, steps.looks_and_edit, **arguments, other=edited[1], other_picture=other)
    assert "Traceback" not in freecad.said
    assert found["invalid"] == {}
    assert_looks(found["first"], picture)
    assert found["first"]["TopLand"]["proxy"] == "BodyView"
    assert_looks(found["other"], other)
    again = freecad.console(steps.read_only, path=saved)
    assert_is_cell(again["bodies"], sheets.design(), jobfile.parse(JOB, settings=["channels.depth_um=0.9"]))


def test_it_opens_visible_and_coloured_without_our_addon(screen, fcstd, tmp_path):
    freecad = FreeCAD(tmp_path / "home", addon=None)
    shown = freecad.window(screen, steps.looks, path=fcstd, picture=tmp_path / "view.png")
    assert_looks(shown, tmp_path / "view.png")
    assert shown["TopLand"]["proxy"] != "BodyView"
