"""One job through the whole pipeline, from the shell and inside FreeCAD."""

import csv
import json
import os
import re
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import meshes
import numpy as np
import pytest
from faults import BAD_JOBS, BAD_MESHES
from scipy.spatial.transform import Rotation
from small import digests

from lce_workbench import ROOT
from lce_workbench.cli import main
from lce_workbench.core.align import PLACES
from lce_workbench.outputs import read_design

JOB = """
[target]
surface = "saddle"
[sheet]
width_mm = 3.0
[domains]
size_um = 300.0
"""

CLUSTERS = sorted(f"mask/cluster_{place.replace(' ', '_')}.png" for place in PLACES)
DRAWN = ("1_assembly", "2_bottom_plate", "3_top_plate", "4_spacer", "5_marks", "6_channels", "7_domains")
DRAWINGS = sorted(
    ["drawings/drawings.pdf", *(f"drawings/{name}.{end}" for name in DRAWN for end in ("dxf", "pdf", "svg"))]
)
CONTRACT = [
    "cad/bottom_plate.3mf", "cad/bottom_plate.step", "cad/bottom_plate.stl", "cad/cell.FCStd", "cad/cell.glb",
    "cad/cell.step", "cad/channels_bottom.step", "cad/channels_top.step", "cad/combs_bottom.step", "cad/combs_top.step",
    "cad/domains.step", "cad/outlines.dxf", "cad/outlines.svg", "cad/sheet.step", "cad/sheet_actuated.stl",
    "cad/spacer.step",
    "cad/top_plate.3mf", "cad/top_plate.step", "cad/top_plate.stl", "design.npz", "domains.csv", *DRAWINGS, "job.toml",
    "manifest.json", "mask/border.png", "mask/bottom.dxf", "mask/bottom.gds", "mask/bottom.oas", *CLUSTERS,
    "mask/domain.png", "mask/job_sheet.txt", "mask/overlay.png", "mask/overview.png", "mask/readings.csv",
    "mask/top.dxf", "mask/top.gds", "mask/top.oas", "prediction.json", "prediction.npz",
    "report.html", "report.json", "report.pdf",
]  # fmt: skip


@pytest.fixture(scope="module")
def job(tmp_path_factory):
    path = tmp_path_factory.mktemp("a job") / "saddle job.toml"
    path.write_text(JOB)
    return path


@pytest.fixture(scope="module")
def built(job):
    assert main(["build", str(job), "--quiet"]) == 0
    return job.parent / "out" / "saddle job"


def files(folder):
    return digests(folder, besides=["manifest.json"])


def rows(folder):
    with (folder / "domains.csv").open() as file:
        return list(csv.DictReader(file))


def test_a_build_writes_the_files_of_the_contract_and_nothing_else(built):
    assert sorted(p.relative_to(built).as_posix() for p in built.rglob("*") if p.is_file()) == CONTRACT
    assert [p.name for p in built.parent.iterdir()] == [built.name]


def test_the_manifest_tells_the_truth(built):
    manifest = json.loads((built / "manifest.json").read_text())
    assert {f["path"]: f["sha256"] for f in manifest["files"]} == files(built)
    assert manifest["exit_code"] == 0
    assert manifest["stages"] == ["design", "predict", "mask", "cad", "drawings", "review"]
    assert any(f["check"] == "material_estimate" for f in manifest["findings"])


def test_the_same_job_gives_the_same_bytes_in_freecad_and_in_the_shell(built, job, tmp_path):
    batch = ROOT / "lce_workbench" / "batch.py"
    done = subprocess.run(
        ["freecadcmd", str(batch), "--", "build", str(job), "--out", str(tmp_path / "in freecad")],
        capture_output=True, text=True, check=False, env={**os.environ, "LC_ALL": "C.UTF-8"}, cwd=tmp_path,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    assert files(tmp_path / "in freecad") == files(built)


def test_the_stages_alone_equal_the_build(built, job, tmp_path):
    out = tmp_path / "staged"
    assert main(["design", str(job), "--quiet", "--out", str(out)]) == 0
    assert sorted(p.name for p in out.iterdir()) == ["design.npz", "domains.csv", "job.toml", "manifest.json"]
    for stage in ("predict", "mask", "cad", "drawings", "review"):
        assert main([stage, str(out), "--quiet"]) == 0
    assert files(out) == files(built)


def test_the_resolved_job_builds_again(built, tmp_path):
    assert main(["design", str(built / "job.toml"), "--quiet", "--out", str(tmp_path / "again")]) == 0
    assert (tmp_path / "again" / "design.npz").read_bytes() == (built / "design.npz").read_bytes()


def test_the_table_is_the_design_in_degrees(built):
    plan, table = read_design(built / "design.npz"), rows(built)
    column = {key: np.array([float(row[key]) for row in table]) for key in table[0]}

    def apart(a, b):
        return np.abs((a - b + 90) % 180 - 90).max()

    theta, dtheta = np.degrees(plan.theta), np.degrees(plan.dtheta)
    assert apart(column["theta_deg"], theta) < 1e-5
    assert np.abs(column["dtheta_deg"] - dtheta).max() < 1e-5
    assert apart(column["theta_top_deg"], theta + dtheta / 2) < 1e-5
    assert apart(column["theta_bottom_deg"], theta - dtheta / 2) < 1e-5
    assert apart(column["written_bottom_deg"], theta - dtheta / 2) < 1e-5
    assert apart(column["written_top_deg"], 180 - (theta + dtheta / 2)) < 1e-5
    angles = [key for key in column if key.endswith("_deg") and key != "dtheta_deg"]
    assert all(((column[key] >= 0) & (column[key] < 180)).all() for key in angles)
    assert np.ptp(plan.uv, axis=0).max() == pytest.approx(3.0, abs=1e-12)


def test_npz_loads_without_pickle_and_has_the_contract_names(built):
    with np.load(built / "design.npz", allow_pickle=False) as data:
        names = {"vertices", "faces", "uv", "theta", "dtheta", "stretch", "lambda_", "nu", "thickness"}
        assert names <= set(data.files)
        assert float(data["thickness"]) == pytest.approx(0.1)


def test_the_prediction_is_the_distance_between_its_shape_and_the_target(built):
    plan, record = read_design(built / "design.npz"), json.loads((built / "prediction.json").read_text())
    found = np.load(built / "prediction.npz")["vertices"]
    area = np.linalg.norm(np.cross(*np.diff(plan.surface.vertices[plan.surface.faces], axis=1).swapaxes(0, 1)), axis=1)
    weight = np.bincount(plan.surface.faces.ravel(), np.repeat(area, 3))
    turned, _ = Rotation.align_vectors(*(x - weight @ x / weight.sum() for x in (plan.surface.vertices, found)), weight)
    p, q = (x - weight @ x / weight.sum() for x in (found, plan.surface.vertices))
    rms = np.sqrt(weight @ ((turned.apply(p) - q) ** 2).sum(axis=1) / weight.sum())
    assert record["rms_pct"] == pytest.approx(100 * rms / np.linalg.norm(np.ptp(q, axis=0)), rel=1e-6)
    assert record["mirrored"] is False
    assert {"max_pct", "energy_ratio", "residual_strain_rms"} <= set(record)


def said(capsys, *argv):
    """Run a command that fails; return its exit code and the one sentence."""
    code = main(["--quiet", *(str(word) for word in argv)])
    lines = capsys.readouterr().err.strip().splitlines()
    assert len(lines) == 1, lines
    return code, lines[0]


def test_faults_of_the_user_end_with_2_and_one_sentence(capsys, tmp_path, job):
    def fails(*argv):
        code, sentence = said(capsys, *argv)
        assert code == 2
        return sentence

    assert "does not exist" in fails("build", tmp_path / "none.toml")
    assert "did you mean" in fails("build", job, "--set", "sheet.widht_mm=3")
    assert "must be a number" in fails("build", job, "--set", "sheet.width_mm=wide")
    assert "no director" in fails("build", job, "--set", "material.lambda=1", "material.nu=0.5")
    assert "unknown; shipped are" in fails("build", job, "--set", "target.surface=dune")
    assert "format 'tiff' is unknown" in fails("build", job, '--set=output.masks=["tiff"]')
    assert "too small" in fails("build", job, "--set", "plates.width_mm=2")
    assert "domains, more than" in fails("build", job, "--set", "sheet.width_mm=190", "domains.size_um=200")
    assert "not an output folder" in fails("mask", tmp_path)
    assert "invalid choice" in fails("fold", job)
    assert "required" in fails("build")
    (tmp_path / "lost.toml").write_text('[target]\nmesh = "lost.stl"\n')
    assert "lost.stl" in fails("build", tmp_path / "lost.toml")
    assert sorted(p.name for p in tmp_path.iterdir()) == ["lost.toml"]


@pytest.mark.parametrize("case", BAD_JOBS)
def test_a_bad_job_ends_with_2_and_its_sentence(capsys, tmp_path, case):
    text, words = BAD_JOBS[case]
    (tmp_path / "bad.toml").write_text(text)
    code, sentence = said(capsys, "build", tmp_path / "bad.toml")
    assert code == 2
    assert words.removeprefix("job.toml: ") in sentence
    assert [p.name for p in tmp_path.iterdir()] == ["bad.toml"]


@pytest.mark.parametrize("case", BAD_MESHES)
def test_a_bad_mesh_ends_with_2_and_its_sentence(capsys, tmp_path, case):
    make, element, remedy = BAD_MESHES[case]
    meshes.write_obj(tmp_path / "bad.obj", *make())
    (tmp_path / "bad.toml").write_text('[target]\nmesh = "bad.obj"\n')
    code, sentence = said(capsys, "build", tmp_path / "bad.toml")
    assert code == 2
    assert re.search(element, sentence), sentence
    assert remedy in sentence
    assert sorted(p.name for p in tmp_path.iterdir()) == ["bad.obj", "bad.toml"]


def test_an_unwritable_output_ends_with_4(capsys, tmp_path, job):
    (tmp_path / "file").write_text("")
    code, sentence = said(capsys, "build", job, "--out", tmp_path / "file" / "out")
    assert code == 4
    assert "cannot be written" in sentence


@pytest.mark.parametrize("delay", [0.3, 0.6, 1.2])
def test_ctrl_c_while_the_libraries_load_is_told_too(job, tmp_path, delay):
    run = subprocess.Popen(
        [sys.executable, "-m", "lce_workbench", "build", str(job), "--out", str(tmp_path / "out")],
        stderr=subprocess.PIPE, text=True, env={**os.environ, "PYTHONPATH": ":".join(sys.path)},
    )  # fmt: skip
    time.sleep(delay)
    run.send_signal(signal.SIGINT)
    _, err = run.communicate(timeout=60)
    assert run.returncode == 130
    assert err.strip().splitlines()[-1] == "lce: interrupted; nothing was changed"
    assert list(tmp_path.iterdir()) == []


def test_a_damaged_design_is_refused(capsys, built, tmp_path):
    for size in (0, 2000):
        copy = tmp_path / f"copy {size}"
        shutil.copytree(built, copy)
        with (copy / "design.npz").open("r+b") as file:
            file.truncate(size)
        code, sentence = said(capsys, "mask", copy)
        assert code == 2
        assert "design.npz is missing or not what manifest.json says" in sentence


def test_a_missing_freecad_is_told_before_the_work_begins(capsys, tmp_path, job, monkeypatch):
    monkeypatch.setenv("PATH", str(tmp_path))
    code, sentence = said(capsys, "build", job, "--out", tmp_path / "out")
    assert code == 4
    assert "freecadcmd is missing" in sentence
    assert "output.freecad=false" in sentence
    assert list(tmp_path.iterdir()) == []


def test_a_solver_that_is_stopped_early_says_so_and_ends_with_3(tmp_path, job):
    out = tmp_path / "early"
    assert main(["design", str(job), "--quiet", "--out", str(out), "--set", "solver.max_iterations=2"]) == 3
    manifest = json.loads((out / "manifest.json").read_text())
    assert manifest["exit_code"] == 3
    assert any(f["check"] == "solver" and f["severity"] == "error" for f in manifest["findings"])


def test_an_interrupted_build_leaves_nothing(job, tmp_path):
    run = subprocess.Popen(
        [sys.executable, "-m", "lce_workbench", "build", str(job), "--json", "--out", str(tmp_path / "out"),
         "--set", "domains.size_um=100"],
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env={**os.environ, "PYTHONPATH": ":".join(sys.path)},
    )  # fmt: skip
    while '"flatten"' not in run.stdout.readline():
        time.sleep(0.01)
    run.send_signal(signal.SIGINT)
    _, err = run.communicate(timeout=60)
    assert run.returncode == 130
    assert err.strip().splitlines()[-1] == "lce: interrupted; nothing was changed"
    assert list(tmp_path.iterdir()) == []


def test_progress_as_json_lines(capsys, job, tmp_path):
    assert main(["design", str(job), "--json", "--out", str(tmp_path / "out")]) == 0
    lines = [json.loads(line) for line in capsys.readouterr().out.splitlines()]
    assert all(0 <= line["fraction"] <= 1 for line in lines[:-1])
    assert lines[-1]["exit_code"] == 0
    assert lines[-1]["out"].endswith("out")


def test_a_new_job_is_commented_and_builds(tmp_path, capsys):
    import trimesh

    trimesh.Trimesh(*grid()).export(tmp_path / "hill.stl")
    assert main(["new", str(tmp_path / "hill.stl")]) == 0
    text = (tmp_path / "hill.toml").read_text()
    assert "# film thickness = spacer thickness" in text
    assert main(["design", str(tmp_path / "hill.toml"), "--quiet", "--set", "sheet.width_mm=4"]) == 0
    assert main(["new", str(tmp_path / "hill.stl")]) == 2
    assert (tmp_path / "hill.toml").read_text() == text


def grid(n=9):
    """A shallow hill over a square."""
    x, y = (axis.ravel() for axis in np.meshgrid(*[np.linspace(-1, 1, n)] * 2, indexing="ij"))
    cell = (np.arange(n - 1)[:, None] * n + np.arange(n - 1)).ravel()
    faces = np.concatenate([cell[:, None] + [0, n, n + 1], cell[:, None] + [0, n + 1, 1]])
    return np.column_stack([x, y, 0.3 * np.exp(-(x**2) - y**2)]), faces


def test_help_and_version_end_with_0(capsys):
    for flag in ("--help", "--version"):
        with pytest.raises(SystemExit) as end:
            main([flag])
        assert end.value.code == 0
    assert "build" in capsys.readouterr().out


def test_a_defect_of_ours_is_one_sentence_too(capsys, monkeypatch, job):
    """The last net: whatever is raised, the user sees one sentence and no traceback."""

    def broken(*_args, **_more):
        raise ZeroDivisionError

    monkeypatch.setattr("lce_workbench.pipeline.build", broken)
    code, sentence = said(capsys, "build", job)
    assert code == 4
    assert "internal fault (ZeroDivisionError" in sentence
    assert Path(job).exists()


def test_another_film_takes_the_metric_and_solves_the_twist_alone(job, built, tmp_path, capsys):
    """What is written is what solving all anew gives, for any parameter that only the twist depends on."""
    for change in ("sheet.gap_um=150", "sheet.twist_limit_deg=0.4", "sheet.edge_overdrive=true"):
        fresh, taken = tmp_path / "fresh", tmp_path / "taken"
        for out, how in ((fresh, ()), (taken, ("--metric", str(built)))):
            main(["design", str(job), "--quiet", "--out", str(out), *how, "--set", change])
        assert files(taken) == files(fresh)
        found, expected = (json.loads((out / "manifest.json").read_text())["findings"] for out in (taken, fresh))
        assert found == expected
        assert files(taken)["domains.csv"] != files(built)["domains.csv"]
    capsys.readouterr()
    assert main(["design", str(job), "--out", str(taken), "--metric", str(built), "--set", "sheet.width_mm=3.1"]) == 2
    assert "sheet.width_mm is 3.1, but" in capsys.readouterr().err
