"""View providers of the document's objects."""

from __future__ import annotations

from typing import Any

ICONS = {
    "Parameters": ":/icons/Std_DlgParameter.svg",
}


class View:
    """Icon of an object. Like the proxies it holds no state."""

    OURS = True

    def __init__(self, vobj: Any) -> None:
        vobj.Proxy = self

    def attach(self, vobj: Any) -> None:
        """FreeCAD calls this when the view comes to life, on creation and on opening."""

    def dumps(self) -> None:
        """Nothing to save (FreeCAD 0.21 and later)."""

    def loads(self, state: None) -> None:
        """Nothing to restore (FreeCAD 0.21 and later)."""

    __getstate__ = dumps  # FreeCAD 0.20
    __setstate__ = loads
