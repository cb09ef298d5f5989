"""View providers of the document's objects."""

from __future__ import annotations

from typing import Any

from lce_workbench.app.objects import is_fine


class View:
    """The view of an object. It holds no state; FreeCAD saves what the user changes about the looks."""

    def __init__(self, vobj: Any) -> None:
        """Show an object that has no looks yet: a new one, or one from a file that was saved without a window."""
        vobj.Proxy = self
        vobj.Visibility = True
        obj = vobj.Object
        if "Colour" in obj.PropertiesList:
            vobj.ShapeColor, vobj.Transparency = obj.Colour, obj.Transparency
            vobj.DisplayMode = "Shaded" if is_fine(obj.Shape) else "Flat Lines"
        for container in obj.InListRecursive:
            if "Group" in container.PropertiesList:
                container.ViewObject.Visibility = True

    def attach(self, vobj: Any) -> None:
        """FreeCAD calls this when the view comes to life."""

    def dumps(self) -> None:
        """Nothing to save (FreeCAD 0.21 and later)."""

    def loads(self, state: None) -> None:
        """Nothing to restore (FreeCAD 0.21 and later)."""

    __getstate__ = dumps  # FreeCAD 0.20
    __setstate__ = loads
