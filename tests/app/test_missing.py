"""The workbench where packages are missing, the home cannot be written, and another addon has packages of our names."""

import os
import shutil
import subprocess
import sys
import sysconfig
from pathlib import Path

import missing_steps as steps
import pytest
import sheets
from freecad_call import FreeCAD
from processes import ROOT, display
from readonly import read_only

from lce_workbench.outputs import write_design, write_manifest
from lce_workbench.pipeline import versions

PACKAGES = ("igl", "cadquery", "OCP", "trimesh", "ezdxf")
DOCUMENT = ROOT / "tests" / "documents" / "schema2.FCStd"


def checkout(folder):
    """A checkout without .venv, in a folder with a blank in its name."""
    root = folder / "a check out"
    for name in ("solver", "resources", "templates", "lce_workbench"):
        shutil.copytree(ROOT / name, root / name, ignore=shutil.ignore_patterns("__pycache__"))
    for name in ("lce", "Init.py", "InitGui.py", "package.xml"):
        shutil.copy(ROOT / name, root / name)
    return root


def environment_without(root, *left_out):
    """Give a checkout the packages that this Python has, but for some."""
    subprocess.run([sys.executable, "-m", "venv", "--without-pip", root / ".venv"], check=True)
    site = next((root / ".venv" / "lib").glob("python*")) / "site-packages"
    for package in Path(sysconfig.get_path("purelib")).iterdir():
        if not package.name.lower().startswith(left_out):
            (site / package.name).symlink_to(package)
    return root / ".venv" / "bin" / "python"


@pytest.fixture
def beside(tmp_path):
    """FreeCAD with a bare checkout, and an addon that has packages `solver` and `tests`."""
    freecad = FreeCAD(tmp_path / "home", addon=checkout(tmp_path))
    for name in ("solver", "tests"):
        package = tmp_path / "home" / "Mod" / "Other" / name
        package.mkdir(parents=True)
        (package / "__init__.py").write_text("theirs = True\n")
    return freecad


def test_without_packages_what_needs_none_works_and_the_rest_says_what_to_do(beside, tmp_path):
    found = beside.console(steps.bare, document=DOCUMENT, folder=tmp_path / "out", packages=[*PACKAGES, "solver"])
    assert "Traceback" not in beside.said
    assert Path(found["root"]).resolve() == tmp_path / "a check out"
    assert found["there"] == ["solver"]  # the other addon's
    assert found["depth"] == pytest.approx(2)
    assert found["errors"] == 0
    assert found["channels"] > 10
    assert found["mass"] > 1
    assert found["back"] == []
    for fault, sentence in (found["mask"], found["design"]):
        assert fault == "EnvironmentFault"
        assert "packages of the workbench are missing" in sentence
        assert f"run {tmp_path / 'a check out' / 'lce'} demo once" in sentence or "lce demo once" in sentence
    if "scipy" in found["gap"]:  # Debian's own may be there
        assert "demo once" in found["gap"]


def test_drawings_without_their_writers_are_pages_and_say_what_is_missing(beside, tmp_path):
    found = beside.console(steps.drawn, document=DOCUMENT, folder=tmp_path)
    assert "Traceback" not in beside.said
    assert found["pages"] == 7
    fault, sentence = found["dxf"]
    assert fault == "EnvironmentFault"
    assert "package typst is missing" in sentence or "package ezdxf is missing" in sentence


def test_the_solver_without_libigl_says_so(tmp_path):
    root = checkout(tmp_path)
    environment_without(root, "igl", "libigl")
    freecad = FreeCAD(tmp_path / "home", addon=root)
    fault, sentence = freecad.console(steps.solved)
    assert fault == "LceError"
    assert "package igl is missing" in sentence
    assert "lce demo once" in sentence


def test_the_cad_stage_without_cadquery_says_so_and_leaves_the_rest(tmp_path):
    root, out = checkout(tmp_path), tmp_path / "out"
    out.mkdir()
    write_design(sheets.design(), out / "design.npz")
    (out / "job.toml").write_text('[target]\nsurface = "saddle"\n[sheet]\nwidth_mm = 2.2\n[output]\nfreecad = false\n')
    write_manifest(out, {"versions": versions(), "stages": ["design"], "inputs": [], "findings": [], "exit_code": 0})
    before = sorted(p.name for p in out.iterdir())
    python = environment_without(root, "cadquery", "ocp")
    env = os.environ | {"PYTHONPATH": f"{root}{os.pathsep}{root / 'solver'}"}
    words = [python, "-P", "-m", "lce_workbench", "cad", out, "--quiet"]
    ended = subprocess.run(words, env=env, capture_output=True, text=True, check=False)
    assert ended.returncode == 4
    assert "package cadquery is missing" in ended.stderr or "package OCP is missing" in ended.stderr
    assert "Traceback" not in ended.stderr
    assert sorted(p.name for p in out.iterdir()) == before


def test_the_window_without_packages_and_with_a_home_that_cannot_be_written(beside, tmp_path, monkeypatch):
    beside.console(steps.nothing)  # FreeCAD needs the folders that it makes in a new home
    beside.before, beside.place = read_only(tmp_path / "home"), tmp_path
    monkeypatch.setenv("HOME", str(tmp_path / "home"))
    monkeypatch.setenv("FREECAD_USER_TEMP", str(tmp_path))  # where FreeCAD 1.0 locks; it ends at once if it cannot
    with display() as screen:
        found = beside.window(screen, steps.window, folder=str(tmp_path))
    assert "Traceback" not in beside.said
    assert not found["home"]
    assert found["commands"] >= 15
    enabled, still_open, sentence = found["design"]
    assert [enabled, still_open] == [True, True]
    assert "packages of the workbench are missing" in sentence
    assert found["changed"] == []
    assert (tmp_path / "saved.FCStd").is_file()
