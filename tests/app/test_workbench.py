"""FreeCAD lists and opens the workbench, alone and beside an addon with packages of the same names."""

from __future__ import annotations

import json
import xml.etree.ElementTree as ET
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from processes import ROOT, Ended, display, environment, start

FACTS = """
import json, os, sys
import FreeCAD

early = "numpy" in sys.modules
import lce_solver, lce_workbench, solver, tests

facts = {"early_numpy": early, "files": [m.__file__ for m in (lce_solver, lce_workbench, solver, tests)]}
"""
WINDOW = """
import FreeCADGui
from PySide import QtCore

def told():
    if FreeCADGui.activeWorkbench().name() != "LceWorkbench":
        FreeCADGui.activateWorkbench("LceWorkbench")
    bench = FreeCADGui.listWorkbenches()["LceWorkbench"]
    path = list(sys.path)
    import ezdxf, numpy
    facts.update(name=FreeCADGui.activeWorkbench().name(), menu=bench.MenuText, tip=bench.ToolTip, icon=bench.Icon,
                 path=path, numpy=numpy.__file__)
    end()

QtCore.QTimer.singleShot(500, told)
"""
END = """
def end():
    with open(os.environ["FACTS"], "w") as file:
        json.dump(facts, file)
    sys.exit(7)
"""


def write(path: Path, text: str = "") -> Path:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text)
    return path


def home_with_addons(home: Path, ours: str, other: str) -> Path:
    """A user's FreeCAD folder with this checkout and with an addon that has packages `solver` and `tests`."""
    for name in ("solver", "tests"):
        write(home / "Mod" / other / name / "__init__.py", "theirs = True\n")
    # It imports them early, as addons do; whose it gets must not depend on us.
    write(home / "Mod" / other / "Init.py", "import solver, tests\nassert solver.theirs and tests.theirs\n")
    (home / "Mod" / ours).symlink_to(ROOT)
    return home


def facts(ended: Ended, path: Path) -> dict[str, Any]:
    assert "Traceback" not in ended.out + ended.err
    assert "During initialization" not in ended.out + ended.err
    assert ended.code == 7, ended.err
    found: dict[str, Any] = json.loads(path.read_text())
    return found


def assert_whose(found: dict[str, Any], home: Path, other: str) -> None:
    solver, workbench, *theirs = (Path(file) for file in found["files"])
    assert solver.resolve() == ROOT / "solver" / "lce_solver" / "__init__.py"
    assert workbench.resolve() == ROOT / "lce_workbench" / "__init__.py"
    assert theirs == [home / "Mod" / other / name / "__init__.py" for name in ("solver", "tests")]
    assert not found["early_numpy"]  # whose numpy is loaded stays the choice of who needs one


@pytest.fixture(scope="module")
def screen() -> Iterator[str]:
    with display() as name:
        yield name


ORDERS = [("LCEMold", "AnAddon"), ("LCEMold", "ZAddon")]


@pytest.mark.parametrize(("ours", "other"), ORDERS)
def test_loads_without_a_window(tmp_path: Path, ours: str, other: str) -> None:
    home = home_with_addons(tmp_path / "user home", ours, other)
    script = write(tmp_path / "facts.FCMacro", FACTS + END + "end()\n")
    ended = start("freecadcmd", script, env=environment(home, FACTS=str(tmp_path / "facts")), cwd=tmp_path)
    assert_whose(facts(ended, tmp_path / "facts"), home, other)


@pytest.mark.parametrize(("ours", "other"), ORDERS)
def test_opens_in_the_window(tmp_path: Path, screen: str, ours: str, other: str) -> None:
    home = home_with_addons(tmp_path / "user home", ours, other)
    script = write(tmp_path / "facts.FCMacro", FACTS + END + WINDOW)
    env = environment(home, FACTS=str(tmp_path / "facts"), DISPLAY=screen)
    found = facts(start("freecad", script, env=env, cwd=tmp_path), tmp_path / "facts")
    assert_whose(found, home, other)
    assert found["name"] == "LceWorkbench"
    assert found["menu"] == "LCE Mold"
    assert "molds" in found["tip"]
    assert ET.parse(found["icon"]).getroot().tag == "{http://www.w3.org/2000/svg}svg"
    # Ours come last: FreeCAD's own numpy stays everybody's.
    assert Path(found["path"][-1]).parts[-5:-2] == (ROOT.name, ".venv", "lib")
    assert ".venv" not in found["numpy"]


def test_metadata_is_what_freecad_reads(tmp_path: Path) -> None:
    script = write(
        tmp_path / "meta.FCMacro",
        "import FreeCAD, json, os, sys\n"
        f"meta = FreeCAD.Metadata({str(ROOT / 'package.xml')!r})\n"
        "bench = meta.Content['workbench'][0]\n"
        "facts = {'name': meta.Name, 'version': meta.Version, 'min': meta.FreeCADMin, 'class': bench.Classname,\n"
        "         'folder': bench.Subdirectory, 'icon': meta.Icon, 'licence': meta.License[0]}\n" + END + "end()\n",
    )
    ended = start("freecadcmd", script, env=environment(tmp_path / "home", FACTS=str(tmp_path / "facts")), cwd=tmp_path)
    found = facts(ended, tmp_path / "facts")
    assert found["class"] == "LceWorkbench"
    assert found["folder"] == "./"
    assert (ROOT / found["icon"]).is_file()
    assert (ROOT / found["licence"]["file"]).is_file()
    assert found["licence"]["name"] == "LGPL-2.1-or-later"
    assert found["min"].startswith("0.20")
