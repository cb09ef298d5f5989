"""What the user told the workbench: preferences, and the values of last time."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import FreeCAD

GROUP = "User parameter:BaseApp/Preferences/Mod/LceMold"


def group() -> Any:
    """FreeCAD's parameters of this workbench."""
    return FreeCAD.ParamGet(GROUP)


def author() -> str:
    """Who stands in the title blocks of new cells."""
    return str(group().GetString("Author", ""))


def most_solids() -> int:
    """How many channels may be shown as solids."""
    return int(group().GetInt("MostSolids", 5000))


def remember(step: str, settings: dict[str, Any], folder: str) -> None:
    """Keep the values of a panel for the next time, unless the user does not want it."""
    if group().GetBool("RememberLast", True):
        group().SetString(f"Last{step}", json.dumps(settings))
        if folder:
            group().SetString("LastFolder", folder)


def last(step: str) -> dict[str, Any]:
    """The values of last time; {} when there are none, or the user does not want them."""
    if not group().GetBool("RememberLast", True):
        return {}
    try:
        found = json.loads(group().GetString(f"Last{step}", "{}"))
    except ValueError:
        return {}
    return {name: tuple(value) if isinstance(value, list) else value for name, value in found.items()}


def folder(doc: Any) -> str:
    """Where files go: the preferred folder, the last one, the document's, or the home."""
    chosen = group().GetString("OutputFolder", "") or group().GetString("LastFolder", "")
    return chosen or (str(Path(doc.FileName).parent) if doc.FileName else str(Path.home() / "LCE"))
