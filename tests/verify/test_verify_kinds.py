"""Folders of other kinds: domains that are no triangles, cuts, workshop options, every level of detail."""

from __future__ import annotations

import re

import numpy as np
import pytest
import trimesh
from tampering import errors, grouped, redraw, replaced

from lce_workbench import pipeline
from lce_workbench.core import jobfile
from lce_workbench.verify import verify

JOB = """
{more}
[marks]
grating = false
fields = []
[solver]
starts = 1
[prediction]
correct = "off"
[output]
masks = ["gds"]
pictures = false
freecad = false
drawings = false
{output}
"""


def made(folder, stages, more, output=""):
    """A folder, verified: its findings by check without those that are well."""
    out = folder / "out"
    pipeline.build(jobfile.parse(JOB.format(more=more, output=output)), folder, out, stages)
    assert grouped(verify(out)) == {}
    return out


def dome(size=300):
    return f'[target]\nsurface = "dome"\n[sheet]\nwidth_mm = 1.5\n[domains]\nsize_um = {size}.0\n'


@pytest.mark.parametrize("kind", ["hexagons", "voronoi"])
def test_domains_of_another_kind_whose_channels_meet(tmp_path, kind):
    out = made(tmp_path, ["design", "mask"], f'{dome()}kind = "{kind}"\n[channels]\nalign_phase = true\n')
    with np.load(out / "design.npz") as data:
        arrays = {name: data[name] for name in data.files}
    phase, theta = arrays["domain_phase"].copy(), arrays["domain_theta"].copy()
    phase[3, 1] += 4e-4
    np.savez(out / "design.npz", **{**arrays, "domain_phase": phase})
    found = errors(out)
    assert list(found) == ["verify_phase"]
    assert "top.gds, domain 3 at" in found["verify_phase"][0].where
    assert found["verify_phase"][0].value == pytest.approx(400, abs=2)
    theta[5] += np.radians(0.5)
    np.savez(out / "design.npz", **{**arrays, "domain_theta": theta})
    found = errors(out)
    assert [f.value for f in found["verify_angle"]] == pytest.approx([0.5, 0.5], abs=1e-3)
    assert all("domain 5 at" in f.where for f in (*found["verify_angle"], *found["verify_table"]))


def test_the_lines_on_a_cut(tmp_path):
    trimesh.creation.icosphere(subdivisions=2).export(tmp_path / "ball.stl")
    more = '[target]\nmesh = "ball.stl"\ncuts = true\n[sheet]\nwidth_mm = 3.0\n[domains]\nsize_um = 300.0\n'
    out = made(tmp_path, ["design", "mask"], more)
    path, aside = out / "mask" / "top.gds", np.array([0.0, 0.005])
    redraw(path, lambda shapes: [(layer, points + aside * (layer == 13)) for layer, points in shapes])
    found = errors(out)
    assert found["verify_seams"][0].value == pytest.approx(5, abs=1)
    redraw(path, lambda shapes: [(layer, points) for layer, points in shapes if layer != 13])
    assert "SEAM" in errors(out)["verify_layers"][0].message


WORKSHOP = """[plates]
chamfer_mm = 0.2
release_deg = 10.0
notch_mm = 1.0
frame_mm = 5.0
engraving_um = 120.0
"""


def test_workshop_options(tmp_path, alone):
    """A job that says something else of every option: its part is found, and only it."""
    out = made(tmp_path, ["design", "mask", "cad"], dome() + WORKSHOP, "step_window_um = [-100, -100, 100, 100]")
    for former, other in (
        ("release_deg = 10.0", "release_deg = 11.0"),
        ("bead_mm = 1.0", "bead_mm = 1.1"),
        ("frame_clearance_um = 50.0", "frame_clearance_um = 60.0"),
        ("engraving_um = 120.0", "engraving_um = 130.0"),
        ("-100.0, -100.0, 100.0, 100.0", "-100.0, -100.0, 400.0, 100.0"),
    ):
        replaced(out / "job.toml", former, other)
    found = errors(out)
    wrong = {check: {f.where.rpartition(", ")[2] for f in told} for check, told in found.items()}
    assert wrong.pop("verify_volume") == {"top_epoxy", "bottom_epoxy", "glue_left", "glue_right", "alignment_frame"}
    assert wrong.pop("verify_levels") == {"top_glass", "bottom_glass"}
    assert {"glue_left", "glue_right", "alignment_frame", "top_land"} <= wrong.pop("verify_extent")
    assert all("domains that are missing or too many" in f.message for f in found["verify_parts"])
    replaced(out / "job.toml", "chamfer_mm = 0.2", "chamfer_mm = 0.21")
    text = (out / "job.toml").read_text()
    assert {"top_glass", "bottom_glass"} <= {f.where.rpartition(", ")[2] for f in errors(out)["verify_levels"]}
    (out / "job.toml").write_text(re.sub(r"engraving_um = .*", "engraving_um = 0.0", text))
    found = errors(out)  # letters where none are asked for, and more glass than the chamfer leaves
    assert {"top_glass", "bottom_glass"} <= {f.where.rpartition(", ")[2] for f in found["verify_volume"]}


def test_a_name_that_was_not_engraved(tmp_path, alone):
    out = made(tmp_path, ["design", "mask", "cad"], f"{dome()}[plates]\n")
    replaced(out / "job.toml", "engraving_um = 0.0", "engraving_um = 100.0")
    found = errors(out)
    assert [f.where for f in found["verify_engraving"]] == [
        f"cad/{file}.step, {plate}_glass"
        for file, plate in (("bottom_plate", "bottom"), ("top_plate", "top"), ("cell", "bottom"), ("cell", "top"))
    ]


@pytest.mark.parametrize("way", ["mapped", "assembly"])
def test_all_channels_as_solids_of_which_one_is_dropped(tmp_path, alone, way):
    size = dome(420).replace("1.5", "2.0")
    out = made(tmp_path, ["design", "mask", "cad"], size, f'step = "all"\nstep_instances = "{way}"')
    path = out / "cad" / "channels_top.step"
    statement = {"mapped": "MAPPED_ITEM", "assembly": "NEXT_ASSEMBLY_USAGE_OCCURRENCE"}[way]
    lines = path.read_text().splitlines(keepends=True)
    gone = [line for line in lines if f"={statement}(" in line][-1]
    text = "".join(line for line in lines if line != gone)
    path.write_text(re.sub(rf",{gone.partition('=')[0]}(?=[,)])", "", text, count=1))
    (finding,) = errors(out)["verify_channel_solids"]
    assert finding.where == "cad/channels_top.step"
    assert finding.value == 1
