"""Call functions of a test module inside FreeCAD; arguments and results travel as JSON."""

from __future__ import annotations

import json
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

from processes import ROOT, environment, start

CALL = """
import json, sys, traceback
sys.path.append({tests!r})
def call():
    import {module}
    return {module}.{function}(**json.loads({arguments!r}))
def answer():
    try:
        result = {{"value": call()}}
    except BaseException:
        result = {{"fault": traceback.format_exc()}}
    with open({answer!r}, "w", encoding="utf-8") as file:
        json.dump(result, file)
"""

NOW = "\nanswer()\n"

WITH_WINDOW = """
from PySide import QtCore
def work():
    answer()
    sys.exit(0)
QtCore.QTimer.singleShot(300, work)
"""

SETTINGS = """<?xml version="1.0" encoding="UTF-8"?>
<FCParameters><FCParamGroup Name="Root"><FCParamGroup Name="BaseApp"><FCParamGroup Name="Preferences">
<FCParamGroup Name="General"><FCText Name="AutoloadModule">NoneWorkbench</FCText></FCParamGroup>
</FCParamGroup></FCParamGroup></FCParamGroup></FCParameters>
"""
"""No start page: it brings a web browser."""


class FreeCAD:
    """FreeCAD of a user whose settings lie below ``home``, with a checkout installed as ``addon``."""

    def __init__(self, home: Path, *, addon: Path | None = ROOT) -> None:
        self.home = home
        self.said = ""
        """What the last process printed."""
        self.before: list[str] = []
        """A program that starts FreeCAD, with its words."""
        self.seconds = 900.0
        """It is ended after this time."""
        self.place = home
        """Where scripts and answers are written."""
        (home / "Mod").mkdir(parents=True)
        (home / "user.cfg").write_text(SETTINGS, encoding="utf-8")
        if addon:
            (home / "Mod" / "LceMold").symlink_to(addon)

    def console(self, function: Callable[..., Any], **arguments: Any) -> Any:
        """Return ``function(**arguments)`` from `freecadcmd`."""
        return self._answer("freecadcmd", "-c", self._code(function, arguments) + NOW)

    def window(self, display: str, function: Callable[..., Any], **arguments: Any) -> Any:
        """Return ``function(**arguments)`` from FreeCAD with its window."""
        macro = self.place / "call.FCMacro"
        macro.write_text(self._code(function, arguments) + WITH_WINDOW, encoding="utf-8")
        return self._answer("freecad", macro, DISPLAY=display)

    def _code(self, function: Callable[..., Any], arguments: dict[str, Any]) -> str:
        module = Path(sys.modules[function.__module__].__file__ or "").stem
        return CALL.format(
            tests=str(ROOT / "tests"),
            module=module,
            function=function.__name__,
            arguments=json.dumps(arguments, default=str),
            answer=str(self.place / "answer.json"),
        )

    def _answer(self, *words: str | Path, **more: str) -> Any:
        answer = self.place / "answer.json"
        answer.unlink(missing_ok=True)
        ended = start(*self.before, *words, env=environment(self.home, **more), cwd=self.home, seconds=self.seconds)
        self.said = ended.out + ended.err
        assert answer.exists(), f"no answer from FreeCAD, exit code {ended.code}:\n{self.said}"
        result = json.loads(answer.read_text(encoding="utf-8"))
        assert "fault" not in result, result["fault"]
        return result["value"]
