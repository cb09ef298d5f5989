"""The fabrication drawings: dimensions are the job's, follow it, and stand in every file; the DXF is exact."""

import re
import xml.etree.ElementTree as ET

import drawing_steps as steps
import ezdxf
import numpy as np
import pypdf
import pytest
import sheets
from freecad_call import FreeCAD

from lce_workbench.app.figures import Dim, Figure, fitting, hatching, spans
from lce_workbench.app.sheets import sheets as scenes
from lce_workbench.cli import main
from lce_workbench.core import jobfile
from lce_workbench.core.frame import arrange
from lce_workbench.core.marks import PITCH
from lce_workbench.outputs import write_design

JOB = """
[target]
surface = "saddle"
[sheet]
width_mm = 4.0
gap_um = 150.0
[channels]
width_um = 1.5
spacing_um = 2.5
depth_um = 0.7
[plates]
glass_mm = 1.1
epoxy_um = 40.0
notch_mm = 1.0
chamfer_mm = 0.2
[spacer]
strip_mm = 2.5
[marks]
tolerance_um = 12.0
[output]
author = "A. Maker"
date = "2026-11-22"
"""
JOB_NOW = jobfile.parse(JOB)
NAMES = ("1_assembly", "2_bottom_plate", "3_top_plate", "4_spacer", "5_marks", "6_channels", "7_domains")


@pytest.fixture(scope="module")
def plan():
    return sheets.design(width=4.0, height=4.4)


@pytest.fixture(scope="module")
def drawn(plan, tmp_path_factory):
    """The folder with the drawings, and what FreeCAD said of them."""
    folder = tmp_path_factory.mktemp("drawn")
    write_design(plan, folder / "design.npz")
    changes = [
        ("SheetParameters", "Gap", "100 um"),
        ("ChannelsParameters", "Depth", "500 nm"),
        ("ChannelsParameters", "Width", "2 um"),
        ("SpacerParameters", "Strip", "3 mm"),
        ("SpacerParameters", "Bead", "0 mm"),
        ("PlatesParameters", "Carrier", "75x25"),
        ("PlatesParameters", "Notch", "0 mm"),
    ]
    freecad = FreeCAD(tmp_path_factory.mktemp("user") / "home")
    return folder, freecad.console(steps.draw, folder=str(folder), job=JOB, changes=changes)


def words(path):
    """All texts of an SVG or a PDF."""
    if path.suffix == ".svg":
        return {
            "".join(node.itertext()).strip() for node in ET.parse(path).getroot().iter() if node.tag.endswith("}text")
        }
    return {line.strip() for page in pypdf.PdfReader(path).pages for line in page.extract_text().splitlines()}


def expected(plan, job):
    """Sheet -> dimension -> length [mm], from the job and the frame alone."""
    frame = arrange(plan.uv, job)
    (width, height), sheet = frame.plate.size, frame.sheet.size
    layer, glass = job.plates.epoxy_um * 1e-3 + job.channels.depth, job.plates.glass_mm
    marks = np.ptp(frame.marks, axis=0)
    return {
        "assembly_plan": {"plate_width": width, "plate_height": height},
        "assembly_section_a": {"cell_thickness": job.sheet.thickness + 2 * (layer + glass), "glass_thickness": glass},
        "assembly_detail_b": {"gap": job.sheet.thickness, "layer_bottom": layer, "layer_top": layer},
        **{
            f"{plate}_plate_{plate}_face": {
                "plate_width": width, "plate_height": height, "marks_x": marks[0], "marks_y": marks[1],
                "sheet_width": sheet[0], "sheet_height": sheet[1],
            }
            for plate in PITCH
        },
        **{f"{plate}_plate_{plate}_side": {"glass": glass, "layer": layer} for plate in PITCH},
        "spacer_strip": {"strip_length": height, "strip_width": job.spacer.strip_mm},
        "spacer_strip_edge": {"strip_thickness": job.sheet.thickness},
        "spacer_strip_place": {
            "strips_apart": frame.strips[1].x0 - frame.strips[0].x1,
            "strip_from_edge": frame.strips[0].x0 - frame.plate.x0,
        },
        "marks_cluster": {"cluster": 1.5},
        "marks_gauge": {
            "square": 0.121, "clearance": 1e-3 * job.marks.tolerance_um,
            "window": 0.021 + 2e-3 * job.marks.tolerance_um,
            "arm": 0.021, "reach": 0.021 + 2e-3 * (job.marks.tolerance_um + 121 + 11),
        },
        "marks_boxes": {"outer_out": 0.401, "outer_in": 0.361, "inner_out": 0.321, "inner_in": 0.281},
        "marks_vernier": {
            "pitch_top": 0.021, "pitch_bottom": 0.020, "bar": 0.009, "tip_gap": 0.015,
            "bar_long": 0.091, "bar_short": 0.061,
        },
        "marks_chirality": {
            "ell_arm": 0.161, "ell_bar": 0.031, "ell_height": 1.5 * 0.161, "ell_thick": 0.031, "small_bar": 0.031,
            "small_arm": 0.101,
        },
        "channels_channel_section": {
            "channel_width": job.channels.width, "channel_spacing": 1e-3 * job.channels.spacing_um,
            "channel_pitch": job.channels.pitch, "channel_depth": job.channels.depth,
        },
        "channels_channel_ends": {
            "guard_both": 2 * job.channels.guard, "channel_width": job.channels.width,
            "channel_pitch": job.channels.pitch,
        },
        "domains_domain_map": {"sheet_width": sheet[0], "sheet_height": sheet[1]},
    }  # fmt: skip


def assert_measured(found, plan, job):
    wanted = {f"Dim_{view}_{name}": x for view, dims in expected(plan, job).items() for name, x in dims.items()}
    assert found.keys() == wanted.keys()
    for name, length in wanted.items():
        assert found[name][0] == pytest.approx(length, rel=1e-9, abs=1e-10), name
        if found[name][1]:
            assert found[name][1] == f"{round(length * 1e3, 3):.9g} µm"


def test_techdraw_measures_what_the_job_says(drawn, plan):
    assert_measured(drawn[1]["first"], plan, JOB_NOW)


def test_fills_and_words_lie_above_the_views_faces(drawn):
    for types in drawn[1]["order"]:
        last = max(k for k, kind in enumerate(types) if kind == "TechDraw::DrawViewPart")
        assert types.index("TechDraw::DrawViewSymbol") > last


NOW = (
    "sheet.gap_um=100", "channels.depth_um=0.5", "channels.width_um=2", "spacer.strip_mm=3", "spacer.bead_mm=0",
    "plates.carrier=75x25", "plates.notch_mm=0",
)  # fmt: skip


def test_dimensions_and_scales_follow_the_parameters(drawn, plan):
    """Although glue and notch, which are gone, had corners that are numbered before those of the dimensions."""
    now = jobfile.parse(JOB, settings=NOW)
    assert_measured(drawn[1]["changed"], plan, now)
    assert drawn[1]["live"] == drawn[1]["changed"] == drawn[1]["again"]
    found = scenes(drawn[0] / "design.npz", now)
    assert drawn[1]["titles"] == [[sheet.title, sheet.subtitle, sheet.material, sheet.scale] for sheet in found]
    placed = {f"View_{sheet.name[2:]}_{view.figure.name}": view for sheet in found for view in sheet.views}
    assert drawn[1]["scales"] == pytest.approx({name: view.scale for name, view in placed.items()})


def test_a_dimension_that_was_moved_by_hand_stays_there(drawn):
    assert drawn[1]["moved"] == 7.0


def test_a_second_call_brings_the_set_up_to_date(drawn):
    assert drawn[1]["objects"] == drawn[1]["objects again"] + 1  # the glue's balloon
    assert "7" not in drawn[1]["balloons"]
    assert drawn[1]["authors"] == 7 * ["B. Other"]


def test_no_view_has_a_face_that_hides_what_stands_beside_it(drawn):
    for name in NAMES:
        for folder in ("drawings", "changed"):
            text = (drawn[0] / folder / f"{name}.svg").read_text()
            assert not re.search('fill="#ffffff"[^>]*stroke="none"', text), (folder, name)


def test_each_cell_of_a_document_has_drawings_of_its_own(drawn, tmp_path):
    freecad = FreeCAD(tmp_path / "home")
    first, second, again, files, (refused,) = freecad.console(
        steps.two_cells, folder=str(drawn[0]), job=JOB, gap="100 um"
    )
    assert (first[0], second[0], again[0]) == pytest.approx((0.15, 0.1, 0.15))
    assert first[1] == second[1] == again[1] == 7
    assert again[2] == second[2] > first[2]
    assert files == 3 * 7 + 1
    assert refused.startswith("/proc/lce cannot be written")


@pytest.mark.parametrize("kind", ["svg", "pdf"])
def test_every_dimension_is_written_on_its_sheet(drawn, plan, kind):
    for view, dims in expected(plan, JOB_NOW).items():
        (name,) = (name for name in NAMES if view.startswith(name[2:]))
        said = words(drawn[0] / "drawings" / f"{name}.{kind}")
        for dim, length in dims.items():
            in_um = drawn[1]["first"][f"Dim_{view}_{dim}"][1]
            wanted = in_um or f"{round(length, 4):.9g}"
            assert any(wanted in line for line in said), (name, dim)


def test_the_title_block_says_whose_it_is_and_the_top_plate_that_it_is_mirrored(drawn):
    for number, name in enumerate(NAMES, 1):
        said = words(drawn[0] / "drawings" / f"{name}.svg")
        assert {"A. Maker", "2026-11-22", f"{number} of 7", "First angle projection"} <= said
    captions = words(drawn[0] / "drawings" / "3_top_plate.svg")
    assert any(text.startswith("VIEW ON THE PATTERNED FACE, MIRRORED") for text in captions)


def test_the_set_is_one_pdf_of_true_paper_sizes(drawn):
    pages = pypdf.PdfReader(drawn[0] / "drawings" / "drawings.pdf").pages
    sizes = [tuple(round(float(x) / 72 * 25.4) for x in (page.mediabox.width, page.mediabox.height)) for page in pages]
    assert sizes == [(297, 210) if name[0] in "46" else (420, 297) for name in NAMES]


def outline(document, layer="OUTLINE"):
    return [
        np.array([p[:2] for p in e.get_points()]) for e in document.modelspace().query(f'LWPOLYLINE[layer=="{layer}"]')
    ]


def test_dxf_is_exact_and_in_millimetres(drawn, plan):
    frame = arrange(plan.uv, JOB_NOW)
    for name in NAMES:
        document = ezdxf.readfile(drawn[0] / "drawings" / f"{name}.dxf")
        assert document.units == ezdxf.units.MM
        assert not document.audit().has_errors
    document = ezdxf.readfile(drawn[0] / "drawings" / "1_assembly.dxf")
    for ring, wanted in zip(outline(document), (frame.plate.ring, *(s.ring for s in frame.strips)), strict=False):
        assert np.array_equal(ring, wanted)  # every bit of it
    document = ezdxf.readfile(drawn[0] / "drawings" / "6_channels.dxf")
    depth = np.ptp(outline(document)[0][:, 1])
    assert depth == pytest.approx(JOB_NOW.channels.depth, rel=1e-12)


def test_dxf_dimensions_measure_the_same(drawn, plan):
    for view, dims in expected(plan, JOB_NOW).items():
        (name,) = (name for name in NAMES if view.startswith(name[2:]))
        document = ezdxf.readfile(drawn[0] / "drawings" / f"{name}.dxf")
        found = [dim.get_measurement() for dim in document.modelspace().query("DIMENSION")]
        for length in dims.values():
            assert any(x == pytest.approx(length, rel=1e-9) for x in found), (view, length)


def test_the_top_plate_is_the_bottom_plate_s_mirror_image(drawn):
    bottom, top = (
        outline(ezdxf.readfile(drawn[0] / "drawings" / f"{name}.dxf"), "SPACER") for name in (NAMES[1], NAMES[2])
    )
    for one, other in zip(bottom, top, strict=True):
        assert np.array_equal(one * [-1, 1], other)
    labels = [
        {e.dxf.text: e.dxf.insert.x for e in ezdxf.readfile(drawn[0] / "drawings" / f"{name}.dxf").query("TEXT")}
        for name in (NAMES[1], NAMES[2])
    ]
    assert labels[0]["M1"] == -labels[1]["M1"] < 0


def test_a_missing_platform_of_qt_is_one_sentence_with_exit_code_4(plan, tmp_path, monkeypatch, capsys):
    (tmp_path / "job.toml").write_text('[target]\nsurface = "saddle"\n[sheet]\nwidth_mm = 2.0\n')
    assert main(["design", str(tmp_path / "job.toml"), "--quiet", "--out", str(tmp_path / "out")]) == 0
    broken = tmp_path / "freecadcmd"  # as Qt ends a program whose platform is not installed
    broken.write_text("#!/bin/sh\necho 'Could not find the Qt platform plugin \"offscreen\"' >&2\nkill -ABRT $$\n")
    broken.chmod(0o755)
    monkeypatch.setenv("PATH", f"{tmp_path}:/usr/bin:/bin")
    capsys.readouterr()
    assert main(["drawings", str(tmp_path / "out"), "--quiet"]) == 4
    (sentence,) = capsys.readouterr().err.splitlines()
    assert sentence.startswith("lce: FreeCAD could not write drawings.pdf: ")
    assert "platform" in sentence
    broken.unlink()
    monkeypatch.setenv("PATH", str(tmp_path))
    assert main(["drawings", str(tmp_path / "out"), "--quiet"]) == 4
    assert "freecadcmd is missing" in capsys.readouterr().err
    assert not (tmp_path / "out" / "drawings").exists()


def test_a_job_may_go_without_drawings(tmp_path):
    (tmp_path / "job.toml").write_text(
        '[target]\nsurface = "saddle"\n[sheet]\nwidth_mm = 2.0\n[output]\ndrawings = false\n'
    )
    assert main(["design", str(tmp_path / "job.toml"), "--quiet", "--out", str(tmp_path / "out")]) == 0
    assert main(["drawings", str(tmp_path / "out"), "--quiet"]) == 0
    assert not (tmp_path / "out" / "drawings").exists()


def test_hatching_covers_a_polygon_and_nothing_else():
    ell = np.array([(0, 0), (3, 0), (3, 1), (1, 1), (1, 2), (0, 2)], dtype=float)
    lines = hatching(ell, 0.01, 0.7)
    assert sum(np.linalg.norm(b - a) for a, b in lines) * 0.01 == pytest.approx(4.0, rel=1e-3)
    assert spans([ell], 1.5) == [(0.0, 1.0)]


def test_scales_are_standard_and_fit():
    figure = Figure("box", "", (np.array([(0, 0), (7.0, 0), (7.0, 3.0), (0, 3.0)]),))
    assert fitting(figure, (100, 100)) == 10
    assert fitting(figure, (100, 14.9)) == 2
    assert fitting(figure, (3.5, 100)) == 0.5


def test_text_without_room_stands_beside_the_arrows():
    wide = Figure("box", "", (np.array([(0, 0), (7.0, 0), (7.0, 3.0), (0, 3.0)]),))
    from lce_workbench.app.figures import Placed

    placed = Placed(wide, 10.0, (0.0, 0.0))
    inside, outside = Dim("a", (0, 3), (7, 3), "x", 10), Dim("b", (7, 0), (7, 0.5), "y", 10)
    assert placed.text_at(inside).tolist() == [0.0, 25.0]
    x, y = placed.text_at(outside)
    assert (x, y > -15 + 5) == (45.0, True)
