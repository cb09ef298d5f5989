"""Doing things by Python lines, so that the console shows them and a macro records them."""

from __future__ import annotations

import FreeCADGui


def say(line: str) -> None:
    """Run a line that calls `session`, as if the user had written it."""
    FreeCADGui.doCommand("from lce_workbench.app import session")
    FreeCADGui.doCommand(line)
