"""The command line inside FreeCAD: arguments, exit codes, and whose numpy it computes with."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from processes import BATCH, ROOT, Ended, environment, start


class Batch:
    """The project's batch.py under the real freecadcmd."""

    def __init__(self, project: Path, home: Path) -> None:
        self.project, self.home, self.seen = project, home, home / "seen"
        self.script: str | Path = project / "lce_workbench" / "batch.py"

    def __call__(self, *argv: str, cwd: Path | None = None) -> Ended:
        env = environment(self.home, SEEN=str(self.seen))
        return start("freecadcmd", self.script, "--", *argv, env=env, cwd=cwd or self.home)

    def told(self) -> list[dict[str, object]]:
        return [json.loads(line) for line in self.seen.read_text().splitlines()] if self.seen.exists() else []


@pytest.fixture
def batch(project: Path, tmp_path: Path) -> Batch:
    (project / ".venv").symlink_to(ROOT / ".venv")
    (tmp_path / "home").mkdir()
    return Batch(project, tmp_path / "home")


@pytest.mark.parametrize("code", [0, 3, 130])
def test_exit_code_passes_freecad(batch: Batch, code: int) -> None:
    assert batch("end", str(code)).code == code
    assert len(batch.told()) == 1


def test_defect_ends_with_one_and_runs_once(batch: Batch) -> None:
    ended = batch("raise")
    assert ended.code == 1
    assert "RuntimeError: a defect" in ended.err
    assert len(batch.told()) == 1  # FreeCAD 0.20 runs a script that raises a second time


def test_arguments_arrive_as_they_were_given(batch: Batch, tmp_path: Path) -> None:
    words = ["build", "my job.toml", "--out", "the out", "--set", "sheet.gap_um=100", "--json", "--", "-x"]
    elsewhere = tmp_path / "else where"
    elsewhere.mkdir()
    assert batch(*words, cwd=elsewhere).code == 0
    (told,) = batch.told()
    assert told["argv"] == words
    assert told["cwd"] == str(elsewhere)


def test_relative_script(batch: Batch) -> None:
    batch.script = "lce_workbench/batch.py"
    assert batch("end", "3", cwd=batch.project).code == 3


def test_computes_with_the_packages_of_lce(batch: Batch) -> None:
    for name in ("numpy", "scipy", "OCP"):
        found = batch("import", name).out.split("imported ")[1].strip()
        assert Path(found).is_relative_to(batch.project / ".venv")
    for told in batch.told():
        assert str(batch.project / "lce_workbench") not in told["path"]  # there, `app` and `core` are not packages


def test_missing_packages_are_one_sentence(batch: Batch) -> None:
    (batch.project / ".venv").unlink()
    ended = batch("end", "0")
    assert ended.code == 4
    (sentence,) = ended.err.splitlines()
    assert sentence.startswith("lce: The packages of the workbench are missing")
    assert f"run {batch.project / 'lce'} once" in sentence
    assert not batch.told()


def test_numpy_of_another_addon_is_one_sentence(batch: Batch) -> None:
    other = batch.home / "Mod" / "Other"
    other.mkdir(parents=True)
    (other / "Init.py").write_text("import numpy\n")
    ended = batch("end", "0")
    assert ended.code == 4
    (sentence,) = ended.err.splitlines()
    assert "Another addon has loaded" in sentence
    assert "FREECAD_USER_HOME" in sentence
    assert not batch.told()


def test_fault_of_the_user_through_the_real_command_line(tmp_path: Path) -> None:
    home = tmp_path / "home"
    ended = start("freecadcmd", BATCH, "--", "build", "no such.toml", env=environment(home), cwd=tmp_path)
    assert ended.code == 2
    (sentence,) = ended.err.splitlines()
    assert "no such.toml" in sentence
