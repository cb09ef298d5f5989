"""The workbench as FreeCAD lists it."""

from __future__ import annotations

import FreeCADGui

from lce_workbench import ROOT, packages


class LceWorkbench(FreeCADGui.Workbench):
    """The workbench's entry in FreeCAD's list; its menus and toolbars are made when it is first chosen."""

    MenuText = "LCE Mold"
    ToolTip = "Designs the molds that make a flat liquid-crystal-elastomer sheet take a target surface when heated"
    Icon = str(ROOT / "resources" / "icons" / "lce.svg")

    def Initialize(self) -> None:  # noqa: N802  FreeCAD's name
        packages.append()

    def GetClassName(self) -> str:  # noqa: N802  FreeCAD's name
        return "Gui::PythonWorkbench"
