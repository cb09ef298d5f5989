"""The solver is usable alone: what it declares is what it needs, its examples run, and nothing else comes in."""

from __future__ import annotations

import ast
import os
import re
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

SOLVER = Path(__file__).parents[2] / "solver"
PYPI_NAMES = {"igl": "libigl"}


def run_alone(folder: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    """Python in an empty folder, with only the solver on the path."""
    environment = {**os.environ, "PYTHONPATH": str(SOLVER)}
    return subprocess.run(
        [sys.executable, "-W", "error", *arguments],
        cwd=folder,
        env=environment,
        capture_output=True,
        text=True,
        check=False,
    )


def imported(source: str) -> set[str]:
    """Top-level packages that a module imports anywhere, lazily too."""
    found = set()
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Import):
            found |= {alias.name.split(".")[0] for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module:
            found.add(node.module.split(".")[0])
    return found


def test_dependencies_are_declared_and_needed():
    project = tomllib.loads((SOLVER / "pyproject.toml").read_text())["project"]
    declared = {re.split(r"[<>=]", name)[0] for name in project["dependencies"]}
    needed = set().union(*(imported(path.read_text()) for path in (SOLVER / "lce_solver").rglob("*.py")))
    needed -= set(sys.stdlib_module_names) | {"lce_solver"}
    assert {PYPI_NAMES.get(name, name) for name in needed} == declared


def test_every_module_is_packaged():
    tool = tomllib.loads((SOLVER / "pyproject.toml").read_text())["tool"]["setuptools"]
    folders = {path.parent.relative_to(SOLVER) for path in (SOLVER / "lce_solver").rglob("*.py")}
    assert {".".join(folder.parts) for folder in folders} == set(tool["packages"])


def test_no_module_brings_in_freecad_or_the_workbench(tmp_path):
    modules = [f"lce_solver.{path.stem}" for path in (SOLVER / "lce_solver").glob("[a-z]*.py")]
    code = f"import sys, {', '.join(modules)}; print(*sys.modules)"
    done = run_alone(tmp_path, "-c", code)
    assert done.returncode == 0, done.stderr
    loaded = {name.split(".")[0] for name in done.stdout.split()}
    assert not loaded & {
        "FreeCAD",
        "Part",
        "lce_workbench",
        "cadquery",
        "build123d",
        "OCP",
        "ezdxf",
        "klayout",
        "matplotlib",
    }


@pytest.mark.parametrize("example", sorted(path.name for path in (SOLVER / "examples").glob("*.py")))
def test_examples_run(tmp_path, example):
    done = run_alone(tmp_path, str(SOLVER / "examples" / example))
    assert done.returncode == 0, done.stderr
    assert "error" not in done.stdout
    assert len(done.stdout.splitlines()) > 4


def test_the_readmes_program_runs(tmp_path):
    (program,) = re.findall(r"```python\n(.*?)```", (SOLVER / "README.md").read_text(), flags=re.DOTALL)
    done = run_alone(tmp_path, "-c", program)
    assert done.returncode == 0, done.stderr
    assert "(" in done.stdout.splitlines()[-1]


def test_the_readme_names_modules_that_exist():
    for line in (SOLVER / "README.md").read_text().splitlines():
        if line.startswith("| `"):
            for name in re.findall(r"`(\w+)`", line.split("|")[1]):
                assert (SOLVER / "lce_solver" / f"{name}.py").is_file(), name
