"""The commands of the menu and the toolbar."""

from __future__ import annotations

import gc
from typing import Any

import FreeCAD
import FreeCADGui

from lce_solver.errors import LceError
from lce_workbench import ROOT
from lce_workbench.app import cells
from lce_workbench.app.session import EXAMPLES
from lce_workbench.gui.qt import QtWidgets, tr
from lce_workbench.gui.record import say
from lce_workbench.gui.steps import STEPS, Step

PREFIX = "LCE_"
ICONS = ROOT / "resources" / "icons"


class StepCommand:
    """One step of the work: its panel, or the step itself."""

    def __init__(self, step: Step) -> None:
        self.step = step

    def GetResources(self) -> dict[str, str]:  # noqa: N802
        """Words and picture."""
        icon = str(ICONS / f"{self.step.icon}.svg")
        return {"Pixmap": icon, "MenuText": tr(self.step.menu), "ToolTip": tr(self.step.tip)}

    def IsActive(self) -> bool:  # noqa: N802
        """A cell can always be started; the other steps need one. Only one panel is open at a time."""
        if FreeCADGui.Control.activeDialog():
            return False
        return self.step.new or bool(FreeCAD.ActiveDocument and cells.cells(FreeCAD.ActiveDocument))

    def Activated(self, _: int = 0) -> None:  # noqa: N802
        """Open the panel, or do it."""
        try:
            self.begin()
        except LceError as fault:
            refuse(str(fault))

    def begin(self) -> None:
        """What the command does; a mistake of the user raises.

        Raises
        ------
        LceError
            What is missing.
        """
        if self.step.new:
            doc = FreeCAD.ActiveDocument or FreeCAD.newDocument()
            return show(self.step, doc, None, chosen_source())
        cell = cells.the_cell(FreeCAD.ActiveDocument, FreeCADGui.Selection.getSelection())
        if self.step.panel:
            return show(self.step, cell.Document, cell)
        if once(cell.Document, self.step.title, f"session.{self.step.call}({path(cell)})"):
            tell(self.step, cell)
            self.step.after(cell)
        return None


class ExampleCommand:
    """The examples, as a group of commands with pictures."""

    def GetResources(self) -> dict[str, str]:  # noqa: N802
        """Words and picture."""
        tip = tr("Opens a new document with one of the shipped examples, ready to be designed")
        return {"Pixmap": str(ICONS / "example.svg"), "MenuText": tr("Examples"), "ToolTip": tip}

    def GetCommands(self) -> tuple[str, ...]:  # noqa: N802
        """One for each example."""
        return tuple(f"{PREFIX}Example{name}" for name in EXAMPLES)

    def IsActive(self) -> bool:  # noqa: N802
        """Not while a panel is open."""
        return not FreeCADGui.Control.activeDialog()


class OneExample:
    """One example."""

    def __init__(self, name: str) -> None:
        self.name = name

    def GetResources(self) -> dict[str, str]:  # noqa: N802
        """Words and picture."""
        picture = ROOT / "resources" / "pictures" / "examples" / f"{self.name.lower()}.png"
        return {"Pixmap": str(picture), "MenuText": tr(self.name), "ToolTip": tr("Opens this example")}

    def IsActive(self) -> bool:  # noqa: N802
        """Not while a panel is open."""
        return not FreeCADGui.Control.activeDialog()

    def Activated(self, _: int = 0) -> None:  # noqa: N802
        """Make the document."""
        doc = FreeCAD.newDocument(self.name)
        once(doc, self.name, f"session.example(App.getDocument({doc.Name!r}), {self.name!r})")


def path(obj: Any) -> str:
    """An object as Python."""
    return f"App.getDocument({obj.Document.Name!r}).getObject({obj.Name!r})"


def once(doc: Any, title: str, line: str) -> bool:
    """Run a line as one undo step; returns whether it went well."""
    doc.openTransaction(title)
    try:
        say(line)
    except Exception as fault:  # FreeCAD hands on what the line raised as an exception of its own
        doc.abortTransaction()
        refuse(str(fault))
        return False
    doc.commitTransaction()
    return True


def show(step: Step, doc: Any, cell: Any, source: Any = None) -> None:
    """Open the panel of a step."""
    from lce_workbench.gui.panels import Panel

    # A former panel may still hold widgets that Qt has deleted: PySide2 would take new ones at their address for them.
    gc.collect()
    FreeCADGui.Control.showDialog(Panel(step, doc, cell, source))


def chosen_source() -> Any:
    """The selected mesh, or (object, "Face1", ...), or (object,) for a shell, or `None`."""
    for chosen in FreeCADGui.Selection.getSelectionEx():
        faces = [name for name in chosen.SubElementNames if name.startswith("Face")]
        if hasattr(chosen.Object, "Mesh"):
            return chosen.Object
        shape = getattr(chosen.Object, "Shape", None)
        if faces or (shape is not None and shape.Faces and not shape.Solids):
            return chosen.Object, *faces
    return None


def name_of(source: Any) -> str:
    """What the panel calls a source."""
    return ".".join([str(source[0].Label), *source[1:]]) if isinstance(source, tuple) else str(source.Label)


def path_of(source: Any) -> str:
    """A source as Python."""
    if isinstance(source, tuple):
        return f"({path(source[0])}, {', '.join(map(repr, source[1:]))})"
    return path(source)


def refuse(sentence: str) -> None:
    """Tell the user why nothing happened."""
    FreeCAD.Console.PrintWarning(f"LCE Mold: {sentence}\n")
    window = FreeCADGui.getMainWindow()
    window.statusBar().showMessage(sentence, 10000)
    box = QtWidgets.QMessageBox(QtWidgets.QMessageBox.Information, "LCE Mold", sentence, parent=window)
    box.setObjectName("lce_refusal")
    box.open()  # not exec: the window stays alive


def tell(step: Step, cell: Any) -> None:
    """Tell what came out of a step: the tree shows it only to those who know where to look."""
    made = cells.result(cell, step.makes) if step.makes else None
    if made is not None:
        sentence = f"{tr(step.title)}: {made.Proxy.summary(made)}"
        FreeCAD.Console.PrintMessage(f"LCE Mold: {sentence}\n")
        FreeCADGui.getMainWindow().statusBar().showMessage(sentence, 30000)


def register() -> list[str]:
    """Add all commands to FreeCAD; returns their names in the order of the work."""
    names = [f"{PREFIX}{step.name}" for step in STEPS]
    for name, step in zip(names, STEPS, strict=True):
        FreeCADGui.addCommand(name, StepCommand(step))
    for name in EXAMPLES:
        FreeCADGui.addCommand(f"{PREFIX}Example{name}", OneExample(name))
    FreeCADGui.addCommand(f"{PREFIX}Examples", ExampleCommand())
    return names
