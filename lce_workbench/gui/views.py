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
            _make_matte(vobj)
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


def _make_matte(vobj: Any) -> None:
    """Take away the shine that FreeCAD 1.0 gives to every body: in it, what faces the eye is white."""
    if "ShapeAppearance" in vobj.PropertiesList:
        material = vobj.ShapeAppearance[0]
        material.SpecularColor = (0.0, 0.0, 0.0)
        vobj.ShapeAppearance = (material,)
