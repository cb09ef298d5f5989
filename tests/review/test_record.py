"""report.json, and how the stage treats its folder."""

import csv
import json
import re
import shutil

import jsonschema
import numpy as np
import pytest
from pypdf import PdfReader

from lce_workbench import ROOT
from lce_workbench.cli import main
from lce_workbench.core.perturb import STUDIES
from lce_workbench.outputs import read_manifest
from lce_workbench.review.data import assemble

SCHEMA = json.loads((ROOT / "resources" / "report.schema.json").read_text(encoding="utf-8"))


def report(folder):
    return json.loads((folder / "report.json").read_text(encoding="utf-8"))


def test_report_json_follows_its_schema(built):
    jsonschema.Draft202012Validator.check_schema(SCHEMA)
    jsonschema.validate(report(built), SCHEMA)


@pytest.mark.parametrize("spoil", [
    lambda r: r.pop("verdict"),
    lambda r: r.update(version=2),
    lambda r: r["domains"]["theta_deg"].__setitem__(0, 180.0),
    lambda r: r["findings"][0].update(severity="fatal"),
    lambda r: r["provenance"]["files"][0].update(sha256="00"),
])  # fmt: skip
def test_the_schema_refuses_what_is_not_a_report(built, spoil):
    record = report(built)
    spoil(record)
    with pytest.raises(jsonschema.ValidationError):
        jsonschema.validate(record, SCHEMA)


def test_its_domains_are_those_of_the_table(built):
    with (built / "domains.csv").open() as file:
        rows = list(csv.DictReader(file))
    columns = report(built)["domains"]
    assert list(columns) == list(rows[0])
    assert all([float(row[name]) for row in rows] == columns[name] for name in columns)


def test_its_findings_are_those_of_the_manifest_and_its_files_are_digested(built):
    record, manifest = report(built), read_manifest(built)
    assert sorted(map(str, record["findings"])) == sorted(map(str, manifest["findings"]))
    assert any(f["stage"] == "review" and f["check"].startswith("verify_") for f in record["findings"])
    ours = {f["path"]: f["sha256"] for f in manifest["files"]}
    told = {f["path"]: f["sha256"] for f in record["provenance"]["files"]}
    assert told.items() <= ours.items()
    assert ours.keys() - told.keys() == {"report.html", "report.json", "report.pdf"}


@pytest.fixture
def plain(built, tmp_path):
    """A folder of the design stage alone, so that a review of it is quick."""
    out = tmp_path / "plain"
    assert main(["design", str(built / "job.toml"), "--quiet", "--out", str(out)]) == 0
    return out


def test_a_review_of_the_same_folder_is_the_same_to_the_byte(plain):
    reports = []
    for _ in range(2):
        assert main(["review", str(plain), "--quiet"]) == 0
        reports.append([(plain / name).read_bytes() for name in ("report.html", "report.pdf", "report.json")])
    assert reports[0] == reports[1]


def test_what_the_folder_lacks_is_left_out_and_told_and_the_jobs_numbers_are_in_the_process(folder):
    out = folder.parent / "plain"
    settings = ["sheet.gap_um=150", "channels.depth_um=0.8"]
    assert main(["design", str(folder / "job.toml"), "--quiet", "--out", str(out), "--set", *settings]) == 0
    assert main(["review", str(out), "--quiet"]) == 0
    record, page = report(out), (out / "report.html").read_text(encoding="utf-8")
    jsonschema.validate(record, SCHEMA)
    assert record["prediction"] is None
    told = " ".join(record["left_out"])
    assert "lce predict" in told
    assert "lce cad" in told
    assert 'id="shape-heat"' not in page
    assert 'id="cell"' not in page
    text = json.dumps(record["process"], ensure_ascii=False)
    assert "150 µm" in text
    assert "0.8 µm deep" in text
    assert not re.search(r"\{[a-z]+_", text)
    assert all(step["source"] for step in record["process"])


def test_the_studies_of_the_folder_are_figures_on_page_and_paper(plain):
    assert main(["review", str(plain), "--quiet"]) == 0
    assert any("lce study NAME" in line and "misalignment" in line for line in report(plain)["left_out"])
    assert 'id="fig-study-twist"' not in (plain / "report.html").read_text(encoding="utf-8")
    assert main(["study", "twist", str(plain), "--samples", "6", "--quiet"]) == 0
    assert main(["review", str(plain), "--quiet"]) == 0
    record = report(plain)
    jsonschema.validate(record, SCHEMA)
    assert record["studies"] == [json.loads((plain / "studies" / "twist.json").read_text(encoding="utf-8"))]
    assert not any("study" in line for line in record["left_out"])
    page = (plain / "report.html").read_text(encoding="utf-8")
    figure = page[page.index('id="fig-study-twist"') :]
    assert STUDIES["twist"].question in figure.split("</figcaption>")[0]
    drawn = figure[figure.index("<svg") : figure.index("</svg>")]
    assert all(f">{row['reached']:.0%}<" in drawn for row in record["studies"][0]["table"])
    text = "".join(leaf.extract_text() for leaf in PdfReader(plain / "report.pdf").pages)
    assert "Study: twist" in text


def test_another_stage_makes_the_former_review_go(folder):
    assert main(["predict", str(folder), "--quiet"]) == 0
    assert not list(folder.glob("report.*"))
    assert all(f["stage"] != "review" for f in read_manifest(folder)["findings"])


def test_an_error_of_the_files_is_in_the_verdict(plain):
    table = (plain / "domains.csv").read_text()
    first = table.splitlines()[1]
    angle = first.split(",")[4]
    wrong = first.replace(f",{angle},", f",{float(angle) + 0.5:.6f},", 1)
    (plain / "domains.csv").write_text(table.replace(first, wrong))
    assert main(["review", str(plain), "--quiet"]) == 1
    record = report(plain)
    assert record["verdict"]["severity"] == "error"
    assert record["questions"][3]["severity"] == "error"
    assert record["findings"][0]["severity"] == "error"


def test_the_winner_is_the_start_with_the_sheet_that_was_made(built):
    record = report(built)
    (winner,) = (start for start in record["starts"] if start["winner"])
    (miss,) = (n["value"] for n in record["numbers"] if n["name"].startswith("Stretches miss"))
    assert winner["rms"] * 100 == pytest.approx(miss, rel=1e-4)


def test_the_heating_begins_flat_and_ends_on_the_target(built):
    review = assemble(built)
    found, target = review.prediction, review.design.surface.vertices
    assert found.lambdas[0] == 1
    assert found.lambdas[-1] == found.record["heating"][-1]["lambda_"] == review.design.material.lambda_
    centred = found.frames[0] - found.frames[0].mean(axis=0)
    assert np.linalg.svd(centred, compute_uv=False)[2] < 1e-9
    assert np.abs(np.linalg.norm(found.frames[-1] - target, axis=1) - found.deviation).max() < 1e-12
    diagonal = np.linalg.norm(np.ptp(target, axis=0))
    assert 100 * found.deviation.max() / diagonal == pytest.approx(found.record["max_pct"], rel=1e-6)


def test_the_cell_is_as_high_as_gap_epoxy_and_glass_and_lies_flat(built):
    review = assemble(built)
    high = np.max([part.vertices.max(axis=0) for part in review.cell], axis=0)
    low = np.min([part.vertices.min(axis=0) for part in review.cell], axis=0)
    job = review.job
    plate = job.channels.depth + job.plates.epoxy_um / 1000 + job.plates.glass_mm
    thick = job.sheet.thickness + 2 * plate
    assert high[2] - low[2] == pytest.approx(thick, rel=1e-6)
    assert (high - low)[:2] == pytest.approx(review.frame.plate.size, rel=1e-6)


def test_a_folder_of_somebody_else_is_refused(tmp_path, capsys):
    shutil.copy(ROOT / "README.md", tmp_path)
    assert main(["review", str(tmp_path), "--quiet"]) == 2
    assert "not an output folder" in capsys.readouterr().err
