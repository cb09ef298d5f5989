"""FreeCAD lists and opens the workbench, alone and beside an addon with packages of the same names."""

from __future__ import annotations

import json
import xml.etree.ElementTree as ET
from pathlib import Path
from typing import Any

import pytest
from processes import ROOT, Ended, environment, start

FACTS = """
import json, os, sys
import FreeCAD

early = "numpy" in sys.modules
import lce_solver, lce_workbench, solver, tests

files = [m.__file__ for m in (lce_solver, lce_workbench, solver, tests)]
facts = {"early_numpy": early, "files": files, "path": list(sys.path)}
"""
WINDOW = """
import FreeCADGui
from PySide import QtCore

def told():
    if FreeCADGui.activeWorkbench().name() != "LceWorkbench":
        FreeCADGui.activateWorkbench("LceWorkbench")
    bench = FreeCADGui.listWorkbenches()["LceWorkbench"]
    path = list(sys.path)
    import ezdxf, numpy  # after the path is told: some packages append to it
    facts.update(name=FreeCADGui.activeWorkbench().name(), menu=bench.MenuText, tip=bench.ToolTip, icon=bench.Icon,
                 last=path[-1], numpy=numpy.__file__)
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


def addons(tmp: Path, front: str) -> tuple[Path, list[str | Path]]:
    """Ours, and an addon that has packages `solver` and `tests`; the one named comes first on FreeCAD's sys.path.

    What stands in the user's Mod folder is loaded in an order of the file system's; what `-M` names is loaded after
    it, and so comes before it on the path.
    """
    for name in ("solver", "tests"):
        write(tmp / "other" / name / "__init__.py", "theirs = True\n")
    places = {"ours": ROOT, "theirs": tmp / "other"}
    first = places.pop(front)
    (behind,) = places.values()
    home = tmp / "user home"
    (home / "Mod").mkdir(parents=True)
    (home / "Mod" / "Addon").symlink_to(behind)
    return home, ["-M", first]


def facts(ended: Ended, path: Path) -> dict[str, Any]:
    assert "Traceback" not in ended.out + ended.err
    assert "During initialization" not in ended.out + ended.err
    assert ended.code == 7, ended.err
    found: dict[str, Any] = json.loads(path.read_text())
    return found


def assert_whose(found: dict[str, Any], tmp: Path, front: str) -> None:
    solver, workbench, *theirs = (Path(file).resolve() for file in found["files"])
    assert solver == ROOT / "solver" / "lce_solver" / "__init__.py"
    assert workbench == ROOT / "lce_workbench" / "__init__.py"
    assert theirs == [tmp / "other" / name / "__init__.py" for name in ("solver", "tests")]
    path = [Path(entry).resolve() for entry in found["path"]]
    assert (path.index(ROOT) < path.index(tmp / "other")) == (front == "ours")


@pytest.mark.parametrize("front", ["ours", "theirs"])
def test_loads_without_a_window(tmp_path: Path, front: str) -> None:
    home, option = addons(tmp_path, front)
    script = write(tmp_path / "facts.FCMacro", FACTS + END + "end()\n")
    env = environment(home, FACTS=str(tmp_path / "facts"))
    found = facts(start("freecadcmd", script, *option, env=env, cwd=tmp_path), tmp_path / "facts")
    assert_whose(found, tmp_path, front)
    # Whose numpy is loaded stays the choice of who needs one (with a window, FreeCAD 1.0 itself does).
    assert not found["early_numpy"]


@pytest.mark.parametrize("front", ["ours", "theirs"])
def test_opens_in_the_window(tmp_path: Path, screen: str, front: str) -> None:
    home, option = addons(tmp_path, front)
    script = write(tmp_path / "facts.FCMacro", FACTS + END + WINDOW)
    env = environment(home, FACTS=str(tmp_path / "facts"), DISPLAY=screen)
    found = facts(start("freecad", script, *option, env=env, cwd=tmp_path), tmp_path / "facts")
    assert_whose(found, tmp_path, front)
    assert found["name"] == "LceWorkbench"
    assert found["menu"] == "LCE Mold"
    assert "molds" in found["tip"]
    assert ET.parse(found["icon"]).getroot().tag == "{http://www.w3.org/2000/svg}svg"
    # Ours come last: FreeCAD's own numpy stays everybody's.
    assert Path(found["last"]).is_relative_to(ROOT / ".venv")
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
