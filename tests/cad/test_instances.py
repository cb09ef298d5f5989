"""All channels of a plate in one STEP file, read back by two programs."""

import gzip
import re

import numpy as np
import pytest
from cad.cad_sample import domains, hatched, job
from cad.readers import centroid, valid, volume
from OCP.BRep import BRep_Tool
from OCP.TopAbs import TopAbs_VERTEX
from OCP.TopExp import TopExp_Explorer
from OCP.TopLoc import TopLoc_Location
from OCP.TopoDS import TopoDS

from lce_workbench.cad.instances import WAYS, write_channels
from lce_workbench.cad.part21 import part21
from lce_workbench.cad.reread import channels_in, solids_in, tally
from lce_workbench.core.cell import domain_name
from lce_workbench.core.channels import corners
from lce_workbench.core.domains import PLATES
from lce_workbench.verify.solids import counted

GAP = job().sheet.thickness
CASES = [(way, plate) for way in WAYS for plate in PLATES]


@pytest.fixture(scope="module")
def channels():
    return hatched(domains(), job())


def box(part):
    """Volume of each channel of a plate [mm3]."""
    return part.length * part.width * part.depth


@pytest.mark.parametrize(("way", "plate"), CASES)
def test_opencascade_finds_every_channel_where_it_belongs(written, channels, way, plate):
    part = channels[plate]
    found = solids_in(written / way / f"channels_{plate}.step")
    assert len(found) == len(part)
    np.testing.assert_allclose([volume(s) for s in found], box(part), rtol=1e-9)
    z = {"bottom": -1, "top": 1}[plate] * (GAP + part.depth) / 2
    middle = np.column_stack([part.centre, np.full(len(part), z)])
    np.testing.assert_allclose([centroid(s) for s in found], middle, atol=1e-9)
    ours = corners(part)
    for solid, ring in zip(found, ours, strict=True):
        theirs = vertices(solid)
        assert len(theirs) == 8
        far = np.abs(theirs[:, None, :2] - ring[None]).max(axis=2).min(axis=1)
        assert far.max() < 1e-9
        assert sorted({*np.round(np.abs(theirs[:, 2]), 9)}) == [round(GAP / 2, 9), round(GAP / 2 + part.depth, 9)]


@pytest.mark.parametrize(("way", "plate"), CASES)
def test_every_box_is_valid_and_as_many_as_lengths(written, channels, way, plate):
    found = solids_in(written / way / f"channels_{plate}.step")
    boxes = {hash(box): box for box in (shape.Located(TopLoc_Location()) for shape in found)}
    assert len(boxes) == len(np.unique(np.rint(channels[plate].length * 1e4))) < len(found)
    assert all(valid(shape) for shape in boxes.values())


@pytest.mark.parametrize(("way", "plate"), CASES)
def test_freecad_finds_every_channel_where_it_belongs(freecad, channels, way, plate):
    part, found = channels[plate], freecad["files"][f"{way}/channels_{plate}.step"]
    assert len(found) == len(part)
    assert all(s["valid"] for s in found)
    np.testing.assert_allclose([s["volume"] for s in found], box(part), rtol=1e-9)
    np.testing.assert_allclose([s["centroid"][:2] for s in found], part.centre, atol=1e-9)
    ring = corners(part)
    want = np.concatenate([ring.min(axis=1), ring.max(axis=1)], axis=1)
    np.testing.assert_allclose([[*s["box"][:2], *s["box"][3:5]] for s in found], want, atol=1e-6)


@pytest.mark.parametrize(("way", "plate"), CASES)
def test_a_product_per_domain_states_its_volume(written, channels, way, plate):
    part = channels[plate]
    text = (written / way / f"channels_{plate}.step").read_text("ascii")
    names = re.findall(r"=PRODUCT\('(domain_\w+\.\d\d)'", text)
    assert names == [domain_name(part, k) for k in np.flatnonzero(part.counts)]
    stated = [float(v) for v in re.findall(r"VOLUME_MEASURE\(([^)]*)\)", text)]
    np.testing.assert_allclose(stated, part.areas[part.counts > 0] * part.depth, rtol=1e-12)
    assert sum(stated) == pytest.approx(box(part).sum(), rel=1e-12)


@pytest.mark.parametrize(("way", "plate"), CASES)
def test_channels_are_counted_without_a_kernel(written, channels, way, plate):
    path = written / way / f"channels_{plate}.step"
    assert channels_in(path, way) == len(channels[plate])
    assert tally(path)["solids"] == len(np.unique(np.rint(channels[plate].length * 1e4)))


@pytest.mark.parametrize(
    ("way", "statement"),
    [("mapped", r"=MAPPED_ITEM\("), ("assembly", r"=NEXT_ASSEMBLY_USAGE_OCCURRENCE\('#\d+','',")],  # a box has no name
)
def test_a_lost_channel_is_seen(written, channels, tmp_path, monkeypatch, way, statement):
    """By the count of statements, by that of `verify`, which is made anew, and by the kernel."""
    monkeypatch.setattr("lce_workbench.cad.reread.CHUNK", 999)  # statements across the ends of chunks count once
    path = written / way / "channels_top.step"
    assert channels_in(path, way) == len(channels["top"])
    text = path.read_text("ascii")
    at = [hit.start() for hit in re.finditer(statement, text)][-1]
    start, end = text.rindex("\n", 0, at), text.index("\n", at)
    number = text[start + 1 : at]
    (tmp_path / "lost.step").write_text(
        (text[:start] + text[end:]).replace(f",{number})", ")").replace(f",{number},", ",")
    )
    assert channels_in(tmp_path / "lost.step", way) == len(channels["top"]) - 1
    assert [counted(at)[0] for at in (path, tmp_path / "lost.step")] == [len(channels["top"]), len(channels["top"]) - 1]
    if way == "mapped":  # the box of a lost component may stay behind as a solid, so kernels cannot be trusted
        assert len(solids_in(tmp_path / "lost.step")) == len(channels["top"]) - 1


@pytest.mark.parametrize("way", WAYS)
def test_the_parts_in_which_channels_come_leave_no_trace(written, channels, tmp_path, way):
    part = channels["top"]
    from lce_workbench.core.cell import select

    halves = [select(part, range(20)), select(part, range(20, 50))]
    for name in ("channels_top.step", "channels_top.step.gz"):
        with part21(tmp_path / name) as out:
            write_channels(out, halves, GAP, way)
    want = (written / way / "channels_top.step").read_bytes()
    assert (tmp_path / "channels_top.step").read_bytes() == want
    packed = (tmp_path / "channels_top.step.gz").read_bytes()
    assert gzip.decompress(packed) == want
    assert len(packed) < len(want) / 4
    assert channels_in(tmp_path / "channels_top.step.gz", way) == len(part)


def vertices(shape):
    """Distinct vertices (8, 3) [mm]."""
    explorer, found = TopExp_Explorer(shape, TopAbs_VERTEX), set()
    while explorer.More():
        p = BRep_Tool.Pnt_s(TopoDS.Vertex_s(explorer.Current()))
        found.add((round(p.X(), 10), round(p.Y(), 10), round(p.Z(), 10)))
        explorer.Next()
    return np.array(sorted(found))
