"""Runs functions of a file of this folder inside FreeCAD, in a process of its own, with results in a JSON file."""

import json
import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

HERE = Path(__file__).parent
ROOT = HERE.parent.parent

CALL = """
import json, sys, traceback
sys.path.insert(0, {here!r})
try:
    import {module}
    result = {{"value": {module}.{function}(**json.loads({arguments!r}))}}
except BaseException:
    result = {{"fault": traceback.format_exc()}}
with open({answer!r}, "w", encoding="utf-8") as file:
    json.dump(result, file)
"""

MACRO = """
import sys
from PySide import QtCore
def work():
{call}
    sys.exit(0)
QtCore.QTimer.singleShot(500, work)
"""


class InFreeCAD:
    """Calls functions inside FreeCAD; what they return comes back through JSON."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.said = ""
        """What the last process printed."""

    def console(self, function: Callable[..., Any], **arguments: Any) -> Any:
        """Call ``function`` in `freecadcmd`."""
        return self._answer(["freecadcmd", "-c", self._call(function, arguments)])

    def window(self, function: Callable[..., Any], *, workbench: bool = True, **arguments: Any) -> Any:
        """Call ``function`` in FreeCAD with its window, on a display of its own."""
        call = self._call(function, arguments).replace("\n", "\n    ")
        macro = self.folder / "call.FCMacro"
        macro.write_text(MACRO.format(call=call), encoding="utf-8")
        display = ["xvfb-run", "-a", "-s", "-screen 0 1400x900x24"]
        return self._answer([*display, "freecad", str(macro)], workbench=workbench)

    def _call(self, function: Callable[..., Any], arguments: dict[str, Any]) -> str:
        module = Path(sys.modules[function.__module__].__file__ or "").stem
        return CALL.format(
            here=str(HERE),
            module=module,
            function=function.__name__,
            arguments=json.dumps(arguments, default=str),
            answer=str(self.folder / "answer.json"),
        )

    def _answer(self, command: list[str], *, workbench: bool = True) -> Any:
        answer = self.folder / "answer.json"
        answer.unlink(missing_ok=True)
        env = {**os.environ, "LC_ALL": "C.UTF-8", "QTWEBENGINE_DISABLE_SANDBOX": "1"}
        env |= {"FREECAD_USER_HOME": str(self.folder), "PYTHONPATH": str(ROOT) if workbench else ""}
        done = subprocess.run(command, env=env, capture_output=True, text=True, timeout=120, check=False)
        self.said = done.stdout + done.stderr
        assert answer.exists(), f"FreeCAD gave no answer, exit code {done.returncode}:\n{self.said}"
        result = json.loads(answer.read_text(encoding="utf-8"))
        assert "fault" not in result, result["fault"]
        return result["value"]


@pytest.fixture
def freecad(tmp_path: Path) -> InFreeCAD:
    """FreeCAD with a home of its own."""
    return InFreeCAD(tmp_path)
