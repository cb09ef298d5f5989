"""Studies from the command line, in this process and on workers of which one is killed."""

import csv
import json
import os
import signal

import pytest
import small
from distributed import Client, LocalCluster
from small import digests

from lce_workbench.cli import main
from lce_workbench.core.job import PredictionSpec
from lce_workbench.core.perturb import STUDIES
from lce_workbench.divided import read_domains
from lce_workbench.outputs import read_design
from lce_workbench.studies import computed


@pytest.fixture(scope="module")
def designed(tmp_path_factory):
    settings = ['output.masks=["gds"]', "output.pictures=false"]
    return small.designed(tmp_path_factory.mktemp("studies"), steps=2, settings=settings)


def test_a_study_adds_its_files_and_later_stages_keep_them(designed, capsys):
    assert main(["study", "twist", str(designed), "--samples", "12"]) == 0
    told = capsys.readouterr().err
    assert "12 samples of" in told.splitlines()[0]
    assert "s of one processor" in told.splitlines()[0]
    assert "2 of 2 at 1, 0" in told
    files = {f"studies/twist.{kind}" for kind in ("csv", "json", "png")}
    manifest = json.loads((designed / "manifest.json").read_text())
    assert files <= {entry["path"] for entry in manifest["files"]}
    assert [record["stage"] for record in manifest["findings"]].count("study twist") == 1
    before = {name: digests(designed)[name] for name in files}
    assert main(["study", "twist", str(designed), "--samples", "12", "--quiet"]) == 0
    assert main(["mask", str(designed), "--quiet"]) == 0
    assert {name: digests(designed)[name] for name in files} == before
    manifest = json.loads((designed / "manifest.json").read_text())
    assert [record["stage"] for record in manifest["findings"]].count("study twist") == 1


def test_the_review_tells_the_studies_of_its_folder(designed):
    assert main(["study", "twist", str(designed), "--samples", "6", "--quiet"]) == 0
    assert main(["review", str(designed), "--quiet"]) in {0, 1}
    text = (designed / "report.json").read_text()
    assert (
        "Study twist, twist [of the design's], edge overdriven (0, 1): the simulated sheet reaches the target" in text
    )
    assert "No study of tolerances" not in text


def test_the_table_counts_what_the_samples_say(designed):
    assert main(["study", "twist", str(designed), "--samples", "12", "--quiet"]) == 0
    with (designed / "studies" / "twist.csv").open() as file:
        rows = list(csv.DictReader(file))
    table = json.loads((designed / "studies" / "twist.json").read_text())["table"]
    assert [{key: row[key] for key in ("gain", "overdrive")} for row in table] == list(STUDIES["twist"].values)
    for entry in table:
        own = [row for row in rows if all(float(row[key]) == entry[key] for key in ("gain", "overdrive"))]
        assert {row["seed"] for row in own} == {"1", "2"}
        assert entry["reached"] == sum(row["reached"] == "True" for row in own) / len(own)
        assert entry["rms_pct_max"] == max(float(row["rms_pct"]) for row in own)
    right, wrong = (next(row for row in table if row["gain"] == gain) for gain in (1.0, -1.0))
    assert (right["reached"], right["mirrored"]) == (1, 0)
    assert (wrong["reached"], wrong["mirrored"]) == (0, 1)  # the wrong sign gives the mirror image


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["study", "twists", "."], "'twists' is unknown; known are robustness"),
        (["study", "twist", "DIR", "--samples", "3"], "--samples 3 is fewer than the 6 values of the study twist"),
        (["study", "twist", "DIR", "--samples", "1000001"], "--samples 1000001 is too many; give at most 1000000"),
        (["study", "twist", "/nowhere"], "is not a readable design"),
    ],
)
def test_mistakes_are_told_and_change_nothing(designed, words, said, capsys):
    before = digests(designed)
    assert main([str(designed) if word == "DIR" else word for word in words]) == 2
    assert said in capsys.readouterr().err
    assert digests(designed) == before


def test_an_interrupted_study_leaves_the_folder_as_it_was(designed, monkeypatch):
    def stop(*_):
        raise KeyboardInterrupt

    before = digests(designed)
    monkeypatch.setattr("lce_workbench.studies.summary", stop)
    assert main(["study", "rounding", str(designed), "--samples", "7", "--quiet"]) == 130
    assert digests(designed) == before
    assert [p.name for p in designed.parent.iterdir()] == [designed.name]


def test_a_killed_worker_loses_nothing(designed):
    """200 samples on two workers, one killed in the middle: every number as without workers, to the last bit."""
    plan, domains = read_design(designed / "design.npz"), read_domains(designed / "design.npz")
    common = plan, domains, PredictionSpec(steps=1)
    alone = list(computed(common, "misalignment", 200))
    rows, victims = [], []
    with (
        LocalCluster(n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None) as cluster,
        Client(cluster, set_as_default=False) as watcher,
    ):
        for row in computed(common, "misalignment", 200, cluster.scheduler_address):
            rows.append(row)
            if len(rows) == 60:
                victims = [min(watcher.run(os.getpid).values())]
                os.kill(victims[0], signal.SIGKILL)
        left = list(watcher.run(os.getpid).values())
    assert len(victims) == 1
    assert victims[0] not in left
    assert rows == alone
    assert len({row["rms_pct"] for row in rows}) > 100
