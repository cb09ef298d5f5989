"""The workbench as FreeCAD lists it."""

from __future__ import annotations

import FreeCADGui

from lce_workbench import ROOT, packages

FreeCADGui.addLanguagePath(str(ROOT / "resources" / "translations"))
FreeCADGui.addIconPath(str(ROOT / "resources" / "icons"))


class LceWorkbench(FreeCADGui.Workbench):
    """The workbench's entry in FreeCAD's list; its menus and toolbars are made when it is first chosen."""

    MenuText = "LCE Mold"
    ToolTip = "Designs the molds that make a flat liquid-crystal-elastomer sheet take a target surface when heated"
    Icon = str(ROOT / "resources" / "icons" / "lce.svg")

    def Initialize(self) -> None:  # noqa: N802  FreeCAD's name
        FreeCADGui.updateLocale()  # else the first words are English: FreeCAD chose its language before it knew ours
        packages.append()
        from lce_workbench.gui import commands, looks

        names, views = commands.register(), looks.register()
        self.appendToolbar("LCE Mold", [*names, "LCE_Examples"])
        self.appendToolbar("LCE Mold View", views)
        self.appendMenu("&LCE Mold", [*names, "Separator", *views, "Separator", "LCE_Examples"])
        FreeCADGui.addPreferencePage(str(ROOT / "resources" / "preferences.ui"), "LCE Mold")

    def GetClassName(self) -> str:  # noqa: N802  FreeCAD's name
        return "Gui::PythonWorkbench"
