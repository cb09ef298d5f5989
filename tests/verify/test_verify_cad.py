"""CAD files that were tampered with."""

from __future__ import annotations

import json
import re

import numpy as np
import pytest
from tampering import errors, grouped, replaced

from lce_workbench.verify import cells, goals, verify
from lce_workbench.verify.reference import read
from lce_workbench.verify.solids import parts

Z = r"(CARTESIAN_POINT\('[^']*',\([^,()]*,[^,()]*,)"
"""A point in a STEP file up to its height."""


def test_an_untouched_folder_is_well_in_every_format(copy):
    found = verify(copy)
    assert grouped(found) == {}
    names = {finding.where.split(",")[0] for finding in found}
    assert {f"mask/{p}.{e}" for p in ("top", "bottom") for e in ("gds", "oas", "dxf", "r12.dxf", "cif")} <= names
    assert {
        "cad/cell.step",
        "cad/channels_top.step",
        "cad/combs_bottom.step",
        "cad/spacer.step",
        "cad/sheet.step",
    } <= names


def test_tampered_solids(solid):
    """Each file in its own way: all of it is found in one pass."""
    cad = solid / "cad"
    replaced(cad / "spacer.step", Z + r"0\.05\)", r"\g<1>0.07)")  # a spacer of 120 um
    replaced(cad / "top_plate.step", "'top_epoxy'", "'top_glue'")  # renamed
    replaced(cad / "channels_bottom.step", r"-0\.0506\)", "-0.0505)")  # not as deep: moved by 0.1 um
    (cad / "combs_top.step").write_bytes((cad / "combs_top.step").read_bytes()[:20000])  # cut short
    _drop_solids(cad / "channels_top.step", 3)
    (cad / "combs_bottom.step").unlink()
    found = errors(solid)
    assert {f.where for f in found["verify_spacer"]} == {
        "cad/spacer.step, spacer_left",
        "cad/spacer.step, spacer_right",
    }
    assert found["verify_spacer"][0].value == pytest.approx(20000)
    assert "top_glue" in next(f for f in found["verify_parts"] if f.where == "cad/top_plate.step").message
    assert found["verify_depth"][0].where.startswith("cad/channels_bottom.step, domain")
    assert found["verify_depth"][0].value == pytest.approx(100)
    dropped = [f for f in found["verify_channel_solids"] if f.where.startswith("cad/channels_top.step")]
    assert [f.value for f in dropped] == [3.0] * len(dropped)
    assert any(f.where.startswith("cad/channels_top.step") for f in found["verify_volume"])
    assert {"cad/combs_top.step", "cad/combs_bottom.step"} <= {f.where for f in found["verify_step"]}


def _drop_solids(path, count):
    """Take mapped items, not the shortest ones at the end, out of the representation that lists them."""
    text = path.read_text()
    items = re.findall(r"#(\d+)=MAPPED_ITEM", text)[30:][:count]
    for item in items:
        text = re.sub(rf",#{item}(?=[,)])", "", text, count=1)
        text = re.sub(rf"(?m)^#{item}=MAPPED_ITEM.*\n", "", text)
    path.write_text(text)


def test_a_gap_of_120_um_and_a_depth_of_half_a_um(built):
    """The closed cell against a job that says otherwise, and lands that are not as deep as the job wants them."""
    reference = read(built)
    held = {name: cells.read(built, name) for name in ("cad/cell.step",)}
    wanted = goals.wanted(reference, {})
    (gap,) = [f for f in _cell(held, wanted) if f.check == "verify_gap"]
    assert gap.severity.value == "info"
    for section, key, check in (
        ("sheet", "gap_um = 100.0", "verify_gap"),
        ("channels", "depth_um = 0.6", "verify_height"),
    ):
        text = (built / "job.toml").read_text()
        assert f"[{section}]" in text
        other = built.parent / f"other_{section}"
        other.mkdir()
        name, _, value = key.partition(" = ")
        changed = {"100.0": "120.0", "0.6": "0.5"}[value]
        (other / "job.toml").write_text(text.replace(key, f"{name} = {changed}"))
        (other / "design.npz").write_bytes((built / "design.npz").read_bytes())
        wrong = [f for f in _cell(held, goals.wanted(read(other), {})) if f.severity.value == "error"]
        assert check in {f.check for f in wrong}


def _cell(held, wanted):
    return list(cells._parts_of(held["cad/cell.step"], "cad/cell.step", (), wanted, {}))


def test_random_bytes_in_every_file(copy):
    noise = np.random.default_rng(1).bytes(2_000_000)
    kept = {"manifest.json", "design.npz", "job.toml"}
    for path in (p for p in copy.rglob("*") if p.is_file() and p.name not in kept):
        path.write_bytes(noise)
    found = errors(copy)
    told = " ".join(finding.message for group in found.values() for finding in group)
    for name in json.loads((copy / "manifest.json").read_text())["files"]:
        if name["path"].startswith(("mask/top", "mask/bottom", "domains", "prediction.json")) or "step" in name["path"]:
            assert name["path"] in told
    assert "Traceback" not in told


def test_a_reader_of_nothing(tmp_path):
    (tmp_path / "a.step").write_text("")
    with pytest.raises(Exception, match="finds no part"):
        parts(tmp_path / "a.step")
