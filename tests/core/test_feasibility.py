"""The survey of stretches and temperatures on targets whose answer is known."""

import json
from dataclasses import replace

import numpy as np
import pytest
from meshes import write_ply
from targets import cap

from lce_solver.errors import InputError
from lce_workbench import cli
from lce_workbench.core import feasibility
from lce_workbench.core.feasibility import survey
from lce_workbench.core.job import Job, MaterialSpec, Target


def write(path, surface):
    write_ply(path, surface.vertices, surface.faces)


def job(name, **material):
    return replace(Job(), target=Target(mesh=name), material=MaterialSpec(**material))


def test_a_steep_cap_needs_a_strong_stretch(tmp_path):
    """Half angle 75 degrees: no smooth director above lambda = (1 - (5/6)^2)^(1/3) = 0.673."""
    write(tmp_path / "cap.ply", cap(75, edge=0.15))
    found = survey(job("cap.ply", lambda_=0.6, nu=0.5), tmp_path)
    lambdas, ratio, rms = (
        np.array([f(row) for row in found.rows])
        for f in (lambda r: r.material.lambda_, lambda r: r.length_ratio, lambda r: r.start.rms)
    )
    assert (np.diff(ratio) > 0).all()
    assert np.interp(1.0, ratio, lambdas) == pytest.approx((1 - (75 / 90) ** 2) ** (1 / 3), rel=0.15)
    assert rms[lambdas == 0.9] > 3 * rms[lambdas == 0.4]
    assert found.best.material.lambda_ < 0.7
    assert 1.6 < found.factor < 2.6  # below the bound the error is the mesh's


def test_a_curve_is_read_at_each_temperature_and_where_it_does_nothing_left_out(tmp_path):
    write(tmp_path / "cap.ply", cap(40, edge=0.15))
    (tmp_path / "curve.csv").write_text(
        "T_C,lambda_parallel,lambda_perpendicular\n20,1,1\n100,0.9,1.054\n180,0.6,1.29\n"
    )
    found = survey(job("cap.ply", curve="curve.csv", temperature_C=180.0), tmp_path)
    assert [row.temperature for row in found.rows] == [100.0, 180.0]
    assert found.rows[1].material.lambda_ == 0.6
    assert found.best.temperature == 180.0


def test_the_command_says_it_as_a_table_and_as_json(tmp_path, capsys, monkeypatch):
    monkeypatch.setattr(feasibility, "LAMBDAS", (0.5, 0.7))
    write(tmp_path / "cap.ply", cap(40, edge=0.2))
    (tmp_path / "job.toml").write_text('[target]\nmesh = "cap.ply"\n')
    assert cli.main(["feasibility", str(tmp_path / "job.toml"), "--json"]) == 0
    *progress, told = map(json.loads, capsys.readouterr().out.splitlines())
    assert progress[-1]["fraction"] == 1
    assert len(told["rows"]) == 3
    assert cli.main(["feasibility", str(tmp_path / "job.toml"), "--quiet"]) == 0
    text = capsys.readouterr().out
    best = min(told["rows"], key=lambda row: row["rms"])
    assert f"lambda = {best['lambda']:.3f} comes closest" in text
    assert text.count("valid") == 3


def test_a_missing_target_is_one_sentence(tmp_path):
    with pytest.raises(InputError, match="nowhere"):
        survey(job("nowhere.ply", lambda_=0.6, nu=0.5), tmp_path)
