"""What the tests of the window do inside FreeCAD."""

import hashlib
import re
import time
from itertools import pairwise
from pathlib import Path


def pump(seconds):
    """Let the window live for a while."""
    import FreeCADGui

    end = time.monotonic() + seconds
    while time.monotonic() < end:
        FreeCADGui.updateGui()
        time.sleep(0.01)


def until(done, seconds=240):
    """Let the window live until something is so.

    Returns the longest times between ticks of a clock in the window while the panel works: 99 of 100 by the clock on
    the wall, all by the processor, where other processes do not count.
    """
    from lce_workbench.gui.qt import QtCore

    loop, timer, end, ticks = QtCore.QEventLoop(), QtCore.QTimer(), time.monotonic() + seconds, []

    def tick():
        stop = widget("stop")
        if stop is not None and alive([stop]):
            ticks.append((time.monotonic(), time.thread_time()))
        if done() or time.monotonic() > end:
            loop.quit()

    timer.timeout.connect(tick)
    timer.start(10)
    loop.exec_()
    timer.stop()
    assert time.monotonic() <= end, "it did not happen in time"
    gaps = sorted(b[0] - a[0] for a, b in pairwise(ticks))
    spent = [b[1] - a[1] for a, b in pairwise(ticks)]
    return [gaps[int(0.99 * len(gaps))] if gaps else 0.0, max(spent, default=0.0)]


def activate():
    import FreeCADGui

    FreeCADGui.activateWorkbench("LceWorkbench")
    pump(0.2)


def alive(found):
    """The first visible widget; PySide2 may still know deleted ones."""
    for one in found:
        try:
            if one.isVisible():
                return one
        except RuntimeError:
            continue
    return None


def widget(name):
    """A widget of the open panel."""
    import FreeCADGui

    from lce_workbench.gui.qt import QtWidgets

    return FreeCADGui.getMainWindow().findChild(QtWidgets.QWidget, name)


def write(name, text):
    """Write into the field of a parameter as the user does."""
    from lce_workbench.gui.qt import QtWidgets

    field = widget(name)
    line = field if isinstance(field, QtWidgets.QLineEdit) else field.findChild(QtWidgets.QLineEdit)
    line.setText(text)


def choose(name, text):
    """Choose from a list."""
    box = widget(name)
    box.setCurrentIndex([box.itemText(k) for k in range(box.count())].index(text))


def press(name):
    """Press OK or Cancel of the open panel; returns whether that can be done."""
    import FreeCADGui

    from lce_workbench.gui.qt import QtWidgets

    window = FreeCADGui.getMainWindow()
    wanted = {"Ok": ("OK",), "Cancel": ("Cancel", "Abbrechen")}[name]
    buttons = window.findChildren(QtWidgets.QPushButton)
    button = alive(b for b in buttons if b.text().replace("&", "") in wanted)
    enabled = button.isEnabled()
    button.click()
    pump(0.1)
    return enabled


def is_open():
    import FreeCADGui

    return bool(FreeCADGui.Control.activeDialog())


def run(command):
    """Run a command of the menu."""
    import FreeCADGui

    FreeCADGui.runCommand(f"LCE_{command}", 0)
    pump(0.2)


def fingerprint(doc):
    """Every property of every object, as text."""
    found = {}
    for obj in doc.Objects:
        for name in obj.PropertiesList:
            value = getattr(obj, name)
            if hasattr(value, "Faces") and not value.isNull():
                value = [value.Volume, value.BoundBox.XMin, value.BoundBox.ZMax, len(value.Faces)]
            elif name == "File":
                value = value and hashlib.sha256(Path(value).read_bytes()).hexdigest()
            found[f"{obj.Name}.{name}"] = re.sub(r" at 0x[0-9a-f]+", "", str(value))
    return found


def state(doc):
    """What an undo has to bring back: all properties, and the steps that can be undone."""
    return fingerprint(doc), list(doc.UndoNames)


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


def differences(one, other):
    """Names of the properties that differ; and the undo steps, when they do."""
    (first, steps), (second, later) = one, other
    names = [name for name in {**first, **second} if first.get(name) != second.get(name)]
    return sorted(names) + ([f"{steps} is now {later}"] if steps != later else [])


def described():
    """Command -> text, tooltip, whether its picture is there, whether it needs a cell."""
    import FreeCADGui

    found = {}
    for name in FreeCADGui.listCommands():
        if name.startswith("LCE_"):
            info = FreeCADGui.Command.get(name).getInfo()
            found[name] = [info["menuText"], info["toolTip"], Path(info["pixmap"]).is_file()]
    return found


def console():
    """What the Python console shows."""
    import FreeCADGui

    from lce_workbench.gui.qt import QtWidgets

    window = FreeCADGui.getMainWindow()
    return "\n".join(w.toPlainText() for w in window.findChildren(QtWidgets.QPlainTextEdit))


def picture(folder, name):
    """A picture of the screen."""
    import subprocess

    if folder:
        pump(0.8)
        subprocess.run(["import", "-window", "root", f"{folder}/{name.lower()}.png"], check=True)


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


def shown(mesh, pictures):
    """A session for the documentation: a picture of each step."""
    import tempfile

    import FreeCAD
    import FreeCADGui
    import Mesh

    window = FreeCADGui.getMainWindow()
    window.setGeometry(0, 0, 1400, 900)
    activate()
    from lce_workbench.gui.qt import QtWidgets

    for dock in window.findChildren(QtWidgets.QDockWidget):
        if dock.objectName() in {"Report view", "Python console"}:
            dock.hide()
    with tempfile.TemporaryDirectory() as folder:
        doc = FreeCAD.newDocument("Cell")
        Mesh.insert(mesh, doc.Name)
        source = doc.Objects[0]
        view = FreeCADGui.activeDocument().activeView()
        view.viewIsometric()
        FreeCADGui.SendMsgToActiveView("ViewFit")
        FreeCADGui.Selection.addSelection(source)
        for number, (name, fill) in enumerate(
            {
                "NewCell": {"sheet.width_mm": "6 mm"},
                "Design": {},
                "Predict": {},
                "Plates": {},
                "ChannelWindow": {"output.step_domains": "20, 21, 22, 23"},
                "Mask": {"folder": folder},
            }.items(),
            start=1,
        ):
            run(name)
            for field, text in fill.items():
                write(field, text)
            picture(pictures, f"{number}_{name}")
            press("Ok")
            if name == "Design":
                pump(4)
                picture(pictures, f"{number}_{name}_running")
            until(lambda: not is_open())
            FreeCADGui.Selection.clearSelection()
            if name == "Plates":
                source.ViewObject.Visibility = False
                view.viewIsometric()
                FreeCADGui.SendMsgToActiveView("ViewFit")
        run("Inspect")
        table = widget("lce_findings").widget()
        items = [table.topLevelItem(row) for row in range(table.topLevelItemCount())]
        table.itemDoubleClicked.emit(next(item for item in items if item.text(1) == "stretch_max"), 0)
        picture(pictures, "9_inspect")
        widget("lce_findings").hide()
        view.viewIsometric()
        FreeCADGui.SendMsgToActiveView("ViewFit")
        doc.SheetParameters.Gap = "150 um"
        doc.recompute()
        expand(window)
        picture(pictures, "7_stale")
        run("Drawings")
        pump(3)
        FreeCADGui.runCommand("Std_ViewFitAll", 0)
        picture(pictures, "8_drawings")


def expand(window):
    """Unfold what the cell is made from, but for its axes."""
    from lce_workbench.gui.qt import QtWidgets

    for tree in window.findChildren(QtWidgets.QTreeWidget):
        if tree.isVisible():
            tree.expandAll()
            for item in tree.findItems("Origin", anywhere()):
                item.setExpanded(False)


def anywhere():
    """How a name is looked for in the tree."""
    from lce_workbench.gui.qt import QtCore

    return QtCore.Qt.MatchExactly | QtCore.Qt.MatchRecursive


def whole(mesh, folder, pictures=""):
    """From a mesh to all files, as a user takes the steps."""
    import FreeCAD
    import FreeCADGui
    import Mesh

    activate()
    doc = FreeCAD.newDocument("Whole")
    Mesh.insert(mesh, doc.Name)
    FreeCADGui.Selection.addSelection(doc.Objects[0])
    for number, (name, fill) in enumerate(
        {
            "NewCell": {"sheet.width_mm": "2 mm", "domains.size_um": "400 um"},
            "Design": {},
            "Predict": {},
            "Plates": {},
            "Mask": {"folder": folder, "output.masks": "gds"},
            "Drawings": None,
            "Inspect": None,
            "Export": {"folder": folder},
            "Review": {"folder": folder},
        }.items(),
        start=1,
    ):
        run(name)
        if fill is not None:
            for field, text in fill.items():
                write(field, text)
            assert press("Ok"), widget("reason").text()
            until(lambda: not is_open(), 600)
        FreeCADGui.Selection.clearSelection()
        picture(pictures, f"{number}_{name}")
    rows = widget("lce_findings").widget().topLevelItemCount()
    statuses = {o.Label: o.Status for o in doc.Objects if "MadeFor" in o.PropertiesList}
    return {"statuses": statuses, "folder": doc.Review.Folder, "rows": rows, "errors": doc.Review.Errors}
