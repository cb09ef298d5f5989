"""Digests, table, design, prediction; and folders that are none."""

from __future__ import annotations

import json
import os
import shutil
import sys

import numpy as np
import pytest
from tampering import errors, grouped, refresh, replaced, rewritten

from lce_workbench.cli import main
from lce_workbench.verify import verify


@pytest.fixture
def papers(built, tmp_path):
    """A copy with the stages design and predict alone."""
    left_out = shutil.ignore_patterns("cad", "mask")
    folder = shutil.copytree(built, tmp_path / "papers", ignore=left_out)
    manifest = json.loads((folder / "manifest.json").read_text())
    manifest["stages"] = ["design", "predict"]
    (folder / "manifest.json").write_text(json.dumps(manifest))
    refresh(folder)
    return folder


def test_untouched_papers_are_well(papers):
    assert grouped(verify(papers)) == {}


def test_only_the_digest_tells_of_a_harmless_change(papers):
    replaced(papers / "job.toml", r"\A", "# a remark\n")
    found = grouped(verify(papers))
    assert list(found) == ["verify_digest"]
    assert found["verify_digest"][0].where == "job.toml"


def test_a_twist_of_the_other_sign(papers):
    turn = lambda text: text[1:] if text.startswith("-") else f"-{text}"
    rewritten(papers / "domains.csv", 5, "dtheta_deg", turn)
    (finding,) = errors(papers)["verify_table"]
    assert "domain 5 at" in finding.where
    assert "dtheta_deg" in finding.message


def test_a_master_angle_that_is_not_mirrored(papers):
    rewritten(papers / "domains.csv", 7, "written_top_deg", lambda text: f"{180.0 - float(text):.6f}")
    (finding,) = errors(papers)["verify_table"]
    assert "domain 7 at" in finding.where
    assert "written_top_deg" in finding.message


def test_a_row_that_is_missing(papers):
    lines = (papers / "domains.csv").read_text().splitlines()
    (papers / "domains.csv").write_text("\n".join(lines[:-1]) + "\n")
    assert "number of rows" in errors(papers)["verify_table"][0].message


def test_the_design_of_another_job(papers):
    with np.load(papers / "design.npz") as data:
        arrays = {name: data[name] for name in data.files}
    arrays["theta"] = np.mod(arrays["theta"] + 0.1, np.pi)
    arrays["uv"] = arrays["uv"] * 1.01
    np.savez(papers / "design.npz", **arrays)
    assert set(errors(papers)) == {"verify_design", "verify_stretch", "verify_table"}


def test_a_prediction_of_another_shape(papers):
    with np.load(papers / "prediction.npz") as data:
        arrays = {name: data[name] for name in data.files}
    arrays["vertices"] = arrays["vertices"] * [1, 1, 1.1]
    np.savez(papers / "prediction.npz", **arrays)
    assert {finding.where for finding in errors(papers)["verify_prediction"]} == {"prediction.json", "prediction.npz"}


def test_a_prediction_that_flatters(papers):
    record = json.loads((papers / "prediction.json").read_text())
    (papers / "prediction.json").write_text(json.dumps({**record, "rms_pct": record["rms_pct"] / 2}))
    (finding,) = errors(papers)["verify_prediction"]
    assert "rms_pct" in finding.message


def test_files_that_are_missing_or_strange(papers):
    (papers / "prediction.npz").unlink()
    (papers / "notes.txt").write_text("mine")
    places = {finding.where for finding in grouped(verify(papers))["verify_files"]}
    assert places == {"prediction.npz", "notes.txt"}


@pytest.mark.parametrize("name", ["design.npz", "domains.csv", "job.toml", "prediction.json", "prediction.npz"])
@pytest.mark.parametrize("content", [b"", np.random.default_rng(0).bytes(5_000_000)])
def test_damaged_papers_are_told_in_a_sentence(papers, name, content):
    (papers / name).write_bytes(content)
    found = errors(papers)
    assert any(name in finding.message for told in found.values() for finding in told)
    assert all("Traceback" not in finding.message for told in found.values() for finding in told)


def test_a_folder_of_the_design_stage_alone(papers):
    for name in ("prediction.npz", "prediction.json"):
        (papers / name).unlink()
    manifest = json.loads((papers / "manifest.json").read_text())
    manifest["stages"] = ["design"]
    (papers / "manifest.json").write_text(json.dumps(manifest))
    assert errors(papers) == {}


def test_the_command_line(papers, tmp_path, capsys):
    assert main(["verify", str(papers), "--quiet"]) == 0
    assert capsys.readouterr().out == ""
    (papers / "notes.txt").write_text("mine")
    assert main(["verify", str(papers), "--json"]) == 1
    records = [json.loads(line) for line in capsys.readouterr().out.splitlines()]
    (wrong,) = [r for r in records if r.get("severity") == "error"]
    assert wrong["check"] == "verify_files"
    assert wrong["where"] == "notes.txt"
    (tmp_path / "empty").mkdir()
    for nothing in (tmp_path / "empty", papers / "job.toml", tmp_path / "nowhere"):
        assert main(["verify", str(nothing)]) == 2
        (line,) = capsys.readouterr().err.splitlines()
        assert "is not an output folder" in line


def test_a_manifest_that_makes_no_sense(papers, capsys):
    for text in ("", "{", "[]", '{"versions": {"lce-molds": "1"}, "files": [], "findings": [], "stages": 5}'):
        (papers / "manifest.json").write_text(text)
        assert main(["verify", str(papers), "--quiet"]) in {1, 2}
        assert "internal fault" not in capsys.readouterr().err


def test_a_file_that_may_not_be_read(papers):
    (papers / "design.npz").unlink()
    os.mkfifo(papers / "design.npz")
    assert "verify_design" in grouped(verify(papers))


@pytest.mark.parametrize("reader", ["gdstk", "ezdxf"])
def test_a_reader_that_is_missing_is_no_clean_bill(masked, monkeypatch, capsys, reader):
    monkeypatch.setitem(sys.modules, reader, None)  # Python then knows no such module
    assert main(["verify", str(masked)]) == 4
    assert f"the reader {reader} is missing, so nothing was verified" in capsys.readouterr().err
