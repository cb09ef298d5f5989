"""What the tests of the window do inside FreeCAD."""

import time

from gui_hands import (
    activate,
    console,
    described,
    differences,
    fingerprint,
    is_open,
    picture,
    press,
    pump,
    run,
    state,
    until,
    widget,
    write,
)


def walk(mesh, folder, pictures=""):
    """All steps in the window, as a user takes them; returns what was seen."""
    import FreeCAD
    import FreeCADGui
    import Mesh

    activate()
    found = {"commands": described(), "undo": {}, "cancel": {}, "names": []}
    doc = FreeCAD.newDocument("Walk")
    Mesh.insert(mesh, doc.Name)
    FreeCADGui.Selection.addSelection(doc.Objects[0])
    for name, fill, slow in (
        ("NewCell", {"sheet.width_mm": "3 mm", "domains.size_um": "300 um"}, False),
        ("Design", {"sheet.gap_um": "0.15 mm"}, True),
        ("Predict", {}, True),
        ("Plates", {"channels.depth_um": "0.7 um"}, False),
        ("ChannelWindow", {"output.step_domains": "3, 5"}, False),
        ("Mask", {"folder": folder}, True),
    ):
        step(found, doc, name, fill, slow=slow, pictures=pictures)
        FreeCADGui.Selection.clearSelection()
        if name == "Plates":
            FreeCADGui.activeDocument().activeView().viewIsometric()
            FreeCADGui.SendMsgToActiveView("ViewFit")
    found["statuses"] = {o.Label: o.Status for o in doc.Objects if "MadeFor" in o.PropertiesList}
    found["job"] = doc.Mask.Folder
    found["visible"] = [
        o.Name for o in doc.Objects if o.isDerivedFrom("Part::FeaturePython") and o.ViewObject.Visibility
    ]
    found["colour"] = [round(c, 2) for c in doc.BottomLand.ViewObject.ShapeColor[:3]]
    found["transparency"] = doc.TopGlass.ViewObject.Transparency
    picture(pictures, "tree")
    direct(found, doc, "Inspect", pictures)
    found["findings"] = findings(doc)
    picture(pictures, "jump")
    direct(found, doc, "Drawings", pictures)
    found["console"] = console()
    return found


def direct(found, doc, name, pictures):
    """A step without a panel: done, undone, done again."""
    former = state(doc)
    run(name)
    pump(1)
    picture(pictures, name)
    found["names"].append(doc.UndoNames[0])
    done = fingerprint(doc)
    doc.undo()
    pump(0.5)
    found["undo"][name] = differences(former, state(doc))
    doc.redo()
    pump(0.5)
    found["undo"][f"{name} again"] = differences((done, []), (fingerprint(doc), []))


def findings(doc):
    """The list of findings, and what a double click on those with a place does."""
    import FreeCADGui
    import pivy.coin  # noqa: F401  FreeCAD 1.0 hands nodes to Python only when it is loaded

    table = widget("lce_findings").widget()
    items = [table.topLevelItem(row) for row in range(table.topLevelItemCount())]
    found = {"rows": [[item.text(column) for column in range(6)] for item in items]}
    view = FreeCADGui.getDocument(doc.Name).activeView()
    for check in ("body_volume", "stretch_max", "interference"):
        item = next(item for item in items if item.text(1) == check)
        table.itemDoubleClicked.emit(item, 0)
        pump(0.3)
        marked = sum(child.getName().getString() == "lce_findings" for child in view.getSceneGraph().getChildren())
        names = [obj.Name for obj in FreeCADGui.Selection.getSelection()]
        found[check] = [names, marked, view.getCameraNode().height.getValue()]
    return found


def step(found, doc, name, fill, *, slow, pictures):
    """One step: cancelled, done, undone, done again."""
    former = state(doc)
    run(name)
    for field, text in fill.items():
        write(field, text)
    picture(pictures, name)
    press("Cancel")
    found["cancel"][name] = [is_open(), differences(former, state(doc))]
    run(name)
    for field, text in fill.items():
        write(field, text)
    assert press("Ok"), widget("reason").text()
    if slow:
        if pictures:
            pump(3)
            picture(pictures, f"{name}_running")
        found.setdefault("free", []).append(until(lambda: not is_open()))
    found["names"].append(doc.UndoNames[0])
    done = fingerprint(doc)
    doc.undo()
    found["undo"][name] = differences(former, state(doc))
    doc.redo()
    found["undo"][f"{name} again"] = differences((done, []), (fingerprint(doc), []))
    pump(0.2)


def mistakes(folder):
    """Wrong values, stops and missing cells."""
    import FreeCAD
    import FreeCADGui

    from lce_workbench.app import session

    activate()
    found = {"inactive": [FreeCADGui.isCommandActive(f"LCE_{name}") for name in ("Design", "Mask", "Export")]}
    doc = FreeCAD.newDocument("Mistakes")
    doc.UndoMode = 1
    session.new_cell(doc, {"target.surface": "face", "sheet.width_mm": 20.0})
    doc.clearUndos()
    former = state(doc)
    found["wrong"] = {}
    for field, text in (
        ("sheet.width_mm", "-3 mm"),
        ("sheet.gap_um", "6 foo"),
        ("sheet.gap_um", "150"),
        ("domains.size_um", "20 mm"),
        ("solver.starts", "many"),
        ("solver.starts", "0"),
    ):
        run("Design")
        write(field, text)
        found["wrong"][f"{field} {text}"] = [press("Ok"), is_open(), widget("reason").text()]
        press("Cancel")
    run("Design")
    press("Ok")
    until(lambda: "energy" in widget("stage").text())
    found["stage"] = widget("stage").text()
    found["busy"] = [press("Ok"), is_open()]
    began = time.monotonic()
    widget("stop").click()
    until(lambda: "stopped" in widget("reason").text())
    found["stop"] = [time.monotonic() - began, is_open(), differences(former, state(doc))]
    press("Cancel")
    found["after"] = [is_open(), differences(former, state(doc))]
    run("Design")
    press("Ok")
    pump(1.0)
    press("Cancel")
    pump(1.0)
    found["cancelled"] = [is_open(), differences(former, state(doc))]
    run("Mask")
    write("folder", str(folder))
    press("Ok")
    found["too early"] = [is_open(), widget("reason").text()]
    press("Cancel")
    run("Plates")
    press("Ok")
    found["no design"] = [is_open(), widget("reason").text(), differences(former, state(doc))]
    press("Cancel")
    found["left"] = [is_open(), differences(former, state(doc))]
    return found


def edited(_=""):
    """Double click on an object of the tree, an expression in a panel, an example."""
    import FreeCAD
    import FreeCADGui

    from lce_workbench.app import session

    activate()
    found = {}
    doc = FreeCAD.newDocument("Edited")
    doc.UndoMode = 1
    session.new_cell(doc, {"target.surface": "dome"})
    doc.clearUndos()
    FreeCADGui.getDocument(doc.Name).setEdit("SheetParameters")
    pump(0.3)
    write("sheet.gap_um", "120 um")
    found["edit"] = [press("Ok"), is_open(), doc.SheetParameters.Gap.Value, doc.UndoNames]
    doc.undo()
    found["undone"] = doc.SheetParameters.Gap.Value
    doc.SheetParameters.setExpression("Gap", "ChannelsParameters.Width * 130")
    doc.recompute()
    run("Design")
    write("domains.size_um", "400 um")
    press("Cancel")
    found["expression"] = [doc.SheetParameters.Gap.Value, doc.SheetParameters.ExpressionEngine]
    for name in ("Face", "Dome", "Saddle", "Leaf"):
        FreeCADGui.runCommand(f"LCE_Example{name}", 0)
        pump(0.2)
        found[name] = [FreeCAD.ActiveDocument.Cell.Label, FreeCAD.ActiveDocument.UndoNames]
    return found


def german(_=""):
    """Words of the window in German."""
    import FreeCAD
    import FreeCADGui

    from lce_workbench.gui.qt import QtCore

    QtCore.QLocale.setDefault(QtCore.QLocale("de_DE"))  # the comma too
    FreeCADGui.setLocale("German")
    pump(0.2)
    activate()
    from lce_workbench.app import session

    doc = FreeCAD.newDocument("Deutsch")
    session.new_cell(doc, {"target.surface": "dome"})
    run("Design")
    found = {"tip": widget("sheet.gap_um").toolTip(), "stop": widget("stop").text()}
    found["gap"] = {}
    for text in ("0,15 mm", "0.15 mm", "150 µm"):
        write("sheet.gap_um", text)
        found["gap"][text] = widget("reason").text()
    write("sheet.gap_um", "0,15 mm")
    press("Cancel")
    return {**found, "commands": described()}
