"""The commands of the 3D view: they change what is seen, never the document."""

from __future__ import annotations

from dataclasses import dataclass

import FreeCAD
import FreeCADGui

from lce_solver.errors import LceError
from lce_workbench.app import cells
from lce_workbench.gui.commands import ICONS, PREFIX, path, refuse
from lce_workbench.gui.qt import tr


@dataclass(frozen=True)
class Look:
    """One command."""

    name: str
    """The command is LCE_<name>."""
    line: str
    """What is done, of `lce_workbench.gui.scene` or `table`; {cell} stands for the cell."""
    menu: str
    tip: str
    icon: str


LOOKS = (
    Look(
        "ShowCell", "scene.show({cell}, '')", "Cell",
        "Shows the cell itself, whole and closed", "view-cell",
    ),
    Look(
        "ShowTarget", "scene.show({cell}, 'target')", "Target and Flat Sheet",
        "Shows the flat sheet and the target beside it, in the colour of the director", "view-target",
    ),
    Look(
        "ShowDirectors", "scene.show({cell}, 'directors')", "Directors",
        "Shows the director of every triangle in the colour of its twist", "view-directors",
    ),
    Look(
        "ShowDeviation", "scene.show({cell}, 'deviation')", "Predicted Shape",
        "Shows the heated sheet in the colour of its distance from the target", "view-deviation",
    ),
    Look(
        "ShowBottomChannels", "scene.show({cell}, 'channels_bottom')", "Channels of the Bottom Plate",
        "Shows all channels of the bottom plate as lines, seen from above", "view-channels-bottom",
    ),
    Look(
        "ShowTopChannels", "scene.show({cell}, 'channels_top')", "Channels of the Top Plate",
        "Shows all channels of the top plate as lines, seen from above", "view-channels-top",
    ),
    Look(
        "Explode", "scene.explode({cell}, {exploded})", "Exploded Cell",
        "Takes the cell apart in the view, or puts it together", "view-explode",
    ),
    Look(
        "Section", "scene.section({cell}, {cut})", "Section through the Gap",
        "Cuts the cell open through the channel window in the view, or closes it", "view-section",
    ),
    Look(
        "Domains", "table.open_table({cell})", "Domain Table",
        "Lists all domains; clicks in the view select their rows, and rows mark them in the view", "domains",
    ),
)  # fmt: skip
"""In the order of the menu."""


class LookCommand:
    """One command of the view."""

    def __init__(self, look: Look) -> None:
        self.look = look

    def GetResources(self) -> dict[str, str]:  # noqa: N802
        """Words and picture."""
        icon = str(ICONS / f"{self.look.icon}.svg")
        words = {"MenuText": tr(self.look.menu), "ToolTip": tr(self.look.tip)}
        return {"Pixmap": icon, "CmdType": "NoTransaction", **words}

    def IsActive(self) -> bool:  # noqa: N802
        """There is a design to look at, whatever else goes on."""
        found = cells.cells(FreeCAD.ActiveDocument) if FreeCAD.ActiveDocument else []
        return any(cells.design_of(cell).File for cell in found)

    def Activated(self, _: int = 0) -> None:  # noqa: N802
        """Do it."""
        from lce_workbench.gui import scene

        try:
            cell = cells.the_cell(FreeCAD.ActiveDocument, FreeCADGui.Selection.getSelection())
            now = scene.of(cell)
            cut = round(scene.window_place(cell)[1], 6) if "{cut}" in self.look.line and now.cut_at is None else None
            line = self.look.line.format(cell=path(cell), exploded=not now.exploded, cut=cut)
        except LceError as fault:
            return refuse(str(fault))
        FreeCADGui.doCommandGui("from lce_workbench.gui import scene, table")
        try:
            FreeCADGui.doCommandGui(line)
        except Exception as fault:  # FreeCAD hands on what the line raised as an exception of its own
            refuse(str(fault))
        return None


def register() -> list[str]:
    """Add the commands to FreeCAD; returns their names in the order of the menu."""
    for look in LOOKS:
        FreeCADGui.addCommand(PREFIX + look.name, LookCommand(look))
    return [PREFIX + look.name for look in LOOKS]
