"""Folders of other kinds: domains that are no triangles, cuts, workshop options, every level of detail."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest
import trimesh
from tampering import errors, grouped, redraw, replaced

from lce_workbench import pipeline
from lce_workbench.cad.step import write_cad
from lce_workbench.core import jobfile
from lce_workbench.core.cell import select
from lce_workbench.core.channels import ChannelField
from lce_workbench.core.closed import closed
from lce_workbench.core.domains import PLATES
from lce_workbench.divided import read_domains
from lce_workbench.outputs import read_design
from lce_workbench.verify import cells, masks, papers, verify
from lce_workbench.verify.reference import read

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


def drawn(folder, more, output=""):
    """A folder with masks and CAD files, the latter without our own checks of them, which take longest."""
    out = folder / "out"
    pipeline.build(jobfile.parse(JOB.format(more=more, output=output)), folder, out, ["design", "mask"])
    job, path = jobfile.load(out / "job.toml"), out / "design.npz"
    domains = read_domains(path)
    cell = closed(read_design(path), domains, job)
    solids = {plate: list(ChannelField(domains, plate, job.channels)) for plate in PLATES}
    if job.output.step == "chosen":
        solids = {plate: [select(part, cell.chosen) for part in parts] for plate, parts in solids.items()}
    (out / "cad").mkdir()
    write_cad(cell, solids, job, out / "cad", lambda *_: None)
    return out


def held(out):
    """What the masks hold, and the table's counts."""
    reference, columns = read(out), papers.table(out / "domains.csv")
    counts = {plate: columns[f"channels_{plate}"] for plate in PLATES}
    return {plate: masks.check(out, plate, reference, counts[plate])[1] for plate in PLATES}, counts


def test_workshop_options(tmp_path):
    """A job that says something else of every option: its parts are found, and only they."""
    out = drawn(tmp_path, dome() + WORKSHOP)
    facts, counts = held(out)
    got = {name: cells.read(out, name) for name in cells.readable(out, read(out))}

    def wrong(*changes):
        text = (out / "job.toml").read_text()
        for former, other in changes:
            replaced(out / "job.toml", former, other)
        found = grouped(cells.check(out, got, read(out), facts, counts)[0])
        (out / "job.toml").write_text(text)
        return {check: {f.where.rpartition(", ")[2] for f in told} for check, told in found.items()}

    assert wrong() == {}
    glasses, beads = {"top_glass", "bottom_glass"}, {"glue_left", "glue_right"}
    found = wrong(("release_deg = 10.0", "release_deg = 11.0"))
    assert found["verify_volume"] == {"top_epoxy", "bottom_epoxy"}
    assert found["verify_extent"] == {"top_land", "bottom_land"}
    assert beads == wrong(("bead_mm = 1.0", "bead_mm = 1.1"))["verify_volume"]
    found = wrong(("frame_clearance_um = 50.0", "frame_clearance_um = 60.0"))
    assert found == {"verify_extent": {"alignment_frame"}, "verify_volume": {"alignment_frame"}}
    assert wrong(("engraving_um = 120.0", "engraving_um = 130.0")) == {"verify_levels": glasses}
    assert wrong(("chamfer_mm = 0.2", "chamfer_mm = 0.21"))["verify_levels"] == glasses
    found = wrong(("engraving_um = 120.0", "engraving_um = 0.0"))
    assert found == {"verify_levels": glasses, "verify_volume": glasses}
    plain = [replace(part, volume=part.volume + 1) if "glass" in part.name else part for part in got["cad/cell.step"]]
    got["cad/cell.step"] = plain  # as if nothing were engraved
    assert glasses <= wrong()["verify_parts"]
    got["cad/top_plate.step"] = [part for part in plain if part.name.startswith("top")]
    assert "top_glass" in wrong()["verify_engraving"]


@pytest.mark.parametrize("way", ["mapped", "assembly"])
def test_all_channels_as_solids_of_which_one_is_dropped(tmp_path, way):
    out = drawn(tmp_path, dome(), f'step = "all"\nstep_instances = "{way}"')
    facts, counts = held(out)
    name, context = "cad/channels_top.step", cells.Context("top", read(out), facts["top"], counts["top"])
    assert grouped(cells.channel_solids(out, name, None, context)) == {}
    statement = {"mapped": "MAPPED_ITEM", "assembly": "NEXT_ASSEMBLY_USAGE_OCCURRENCE"}[way]
    lines = (out / name).read_text().splitlines(keepends=True)
    gone = [line for line in lines if f"={statement}(" in line][-1]
    text = "".join(line for line in lines if line != gone)
    (out / name).write_text(re.sub(rf",{gone.partition('=')[0]}(?=[,)])", "", text, count=1))
    (finding,) = grouped(cells.channel_solids(out, name, None, context))["verify_channel_solids"]
    assert finding.value == 1
    domain = re.search(r"domain_0007[^']*", text)[0]
    (out / name).write_text(text.replace(domain, "domain_9999"))
    found = grouped(cells.channel_solids(out, name, None, context))["verify_parts"]
    assert "domain_9999" in found[0].message
    assert "first: 7" in found[1].message
