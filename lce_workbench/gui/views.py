"""View providers of the document's objects."""

from __future__ import annotations

from typing import Any

from lce_workbench import ROOT
from lce_workbench.app import cells
from lce_workbench.app.objects import is_fine
from lce_workbench.app.results import STALE

ICONS = ROOT / "resources" / "icons"


class View:
    """The view of an object. It holds no state; FreeCAD saves what the user changes about the looks."""

    def __init__(self, vobj: Any) -> None:
        """Show an object that has no looks yet: a new one, or one from a file that was saved without a window."""
        vobj.Proxy = self
        vobj.Visibility = True
        for container in vobj.Object.InListRecursive:
            if "Group" in container.PropertiesList:
                container.ViewObject.Visibility = True

    def attach(self, vobj: Any) -> None:
        """FreeCAD calls this when the view comes to life: from now on the view knows its object."""
        self.object = vobj.Object

    def setEdit(self, vobj: Any, mode: int = 0) -> bool | None:  # noqa: N802  FreeCAD's name
        """Double click: the panel of the object, where it has one."""
        from lce_workbench.gui.edit import edit

        return edit(vobj.Object) if mode == 0 else None

    def doubleClicked(self, vobj: Any) -> bool:  # noqa: N802  FreeCAD's name
        """Edit as other workbenches do."""
        return bool(self.setEdit(vobj))

    def dumps(self) -> None:
        """Nothing to save (FreeCAD 0.21 and later)."""

    def loads(self, state: None) -> None:
        """Nothing to restore (FreeCAD 0.21 and later)."""

    __getstate__ = dumps  # FreeCAD 0.20
    __setstate__ = loads


class BodyView(View):
    """A part of the cell, in its colour."""

    def __init__(self, vobj: Any) -> None:
        super().__init__(vobj)
        self.fresh = not vobj.Object.Transparency
        _colour(vobj)

    fresh = False
    """Whether the body is new: its colour is not known before it is computed, and later it is the user's."""

    def getIcon(self) -> str:  # noqa: N802  FreeCAD's name
        """The tree's icon."""
        channels = self.object.Prisms.startswith("channels")
        return str(ICONS / ("channels.svg" if channels else "body.svg"))

    def updateData(self, obj: Any, name: str) -> None:  # noqa: N802  FreeCAD's name
        """Take the colour once it is known; the transparency is set last."""
        if name == "Transparency" and self.fresh:
            self.fresh = False
            _colour(obj.ViewObject)


class ParametersView(View):
    """A section of the parameters."""

    def isShow(self) -> bool:  # noqa: N802  FreeCAD's name
        """There is nothing to hide: the tree would write the label in grey."""
        return True

    def getIcon(self) -> str:  # noqa: N802  FreeCAD's name
        """The tree's icon."""
        return str(ICONS / ("target.svg" if self.object.Section == "target" else "parameters.svg"))

    def claimChildren(self) -> list[Any]:  # noqa: N802  FreeCAD's name
        """The target stands above the mesh or part it is taken from."""
        source = getattr(self.object, "Source", None)
        return [source[0]] if source else []


class ResultView(View):
    """A result: what it is made from stands below it, and its icon tells when it is stale."""

    def isShow(self) -> bool:  # noqa: N802  FreeCAD's name
        """There is nothing to hide: the tree would write the label in grey."""
        return True

    def getIcon(self) -> str:  # noqa: N802  FreeCAD's name
        """The tree's icon."""
        name = PICTURES[cells.kind_of(self.object)]
        stale = self.object.Status.startswith(STALE)
        return str(ICONS / f"{name}{'-stale' * stale}.svg")

    def updateData(self, obj: Any, name: str) -> None:  # noqa: N802  FreeCAD's name
        """Change the icon with the status."""
        if name == "Status":
            obj.ViewObject.signalChangeIcon()

    def claimChildren(self) -> list[Any]:  # noqa: N802  FreeCAD's name
        """The sections that only this result is made from."""
        own = CHILDREN[cells.kind_of(self.object)]
        return [section for section in self.object.Parameters if section.Section in own]


PICTURES = {"DesignData": "design", "PredictionData": "predict", "MaskData": "mask", "ReviewData": "review"}
"""Class of a result -> its icon."""

CHILDREN = {
    "DesignData": ("target", "material", "sheet", "domains", "solver"),
    "PredictionData": ("prediction",),
    "MaskData": ("channels", "marks", "output"),
    "ReviewData": (),
}
"""Class of a result -> the sections that stand below it in the tree."""


def _colour(vobj: Any) -> None:
    obj = vobj.Object
    vobj.ShapeColor, vobj.Transparency = obj.Colour, obj.Transparency
    if "ShapeAppearance" in vobj.PropertiesList:
        # FreeCAD 1.0 makes every body shine: what faces the eye is white.
        material = vobj.ShapeAppearance[0]
        material.SpecularColor = (0.0, 0.0, 0.0)
        vobj.ShapeAppearance = (material,)
    vobj.DisplayMode = "Shaded" if is_fine(obj.Shape) else "Flat Lines"
