"""Sessions in FreeCAD's window from a mesh to the end: for the tests, and for the documentation's pictures."""

import numpy as np
from gui_hands import activate, is_open, picture, press, pump, run, until, widget, write


def shown(mesh, pictures):
    """A session for the documentation: a picture of each step."""
    import tempfile

    import FreeCAD
    import FreeCADGui
    import Mesh

    window = FreeCADGui.getMainWindow()
    window.showMaximized()
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
            if name != "Design":
                picture(pictures, f"{number}_{name}")
            press("Ok")
            if name == "Design":
                until(lambda: "energy" in widget("stage").text())
                picture(pictures, f"{number}_{name}_running")
            until(lambda: not is_open())
            FreeCADGui.Selection.clearSelection()
            if name == "Plates":
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


def whole(mesh, folder, settings, pictures=""):
    """From a mesh to all files, as a user takes the steps; ``settings``: step -> what is written into its panel."""
    import time

    import FreeCAD
    import FreeCADGui
    import Mesh

    FreeCADGui.getMainWindow().setGeometry(0, 0, 1400, 900)
    activate()
    doc, seconds, free = FreeCAD.newDocument("Whole"), {}, {}
    Mesh.insert(mesh, doc.Name)
    FreeCADGui.Selection.addSelection(doc.Objects[0])
    for number, (name, fill) in enumerate(
        {
            "NewCell": {},
            "Design": {},
            "Predict": {},
            "Plates": {},
            "Mask": {"folder": folder},
            "Drawings": None,
            "Inspect": None,
            "Export": {"folder": folder},
            "Review": {"folder": folder},
        }.items(),
        start=1,
    ):
        began = time.monotonic()
        run(name)
        if fill is not None:
            for field, text in (fill | settings.get(name, {})).items():
                write(field, text)
            assert press("Ok"), widget("reason").text()
            free[name] = [round(gap, 3) for gap in until(lambda: not is_open(), 3000)]
        seconds[name] = round(time.monotonic() - began, 1)
        FreeCADGui.Selection.clearSelection()
        picture(pictures, f"{number}_{name}")
    rows = widget("lce_findings").widget().topLevelItemCount()
    statuses = {o.Label: o.Status for o in doc.Objects if "MadeFor" in o.PropertiesList}
    figures = [doc.Design.Domains, doc.Mask.ChannelsBottom, doc.Prediction.Verdict, doc.Prediction.Rms]
    found = {"statuses": statuses, "folder": doc.Review.Folder, "rows": rows, "errors": doc.Review.Errors}
    return found | {"seconds": seconds, "free": free, "figures": figures}


def viewed(folder, pictures):
    """A picture of each state of the view, for the documentation; ``folder`` is an output folder."""
    import FreeCAD
    import FreeCADGui
    from view_steps import PICTURES, opened

    from lce_workbench.gui.qt import QtCore, QtWidgets

    look = FreeCAD.ParamGet("User parameter:BaseApp/Preferences/View")
    look.SetBool("Gradient", False)
    look.SetBool("Simple", True)
    look.SetUnsigned("BackgroundColor", 0xE3E8EEFF)
    window = FreeCADGui.getMainWindow()
    window.showMaximized()
    activate()
    cell = opened(folder)
    from lce_workbench.gui import scene

    for dock in window.findChildren(QtWidgets.QDockWidget):
        if dock.objectName() in {"Report view", "Python console"}:
            dock.hide()
    expand(window)
    view = scene.of(cell).view
    view.viewIsometric()
    view.fitAll()
    for number, name in enumerate(list(PICTURES.values())[:-1], start=1):  # both plates look alike
        run(name)
        picture(pictures, f"view_{number}_{name[4:]}")
    run("ShowCell")
    run("Explode")
    picture(pictures, "view_6_exploded")
    run("Explode")
    run("Section")
    picture(pictures, "view_7_section")
    run("Section")
    run("ShowDirectors")
    run("Domains")
    dock = window.findChild(QtWidgets.QDockWidget, "lce_domains")
    window.resizeDocks([dock], [420], QtCore.Qt.Horizontal)
    pump(0.3)
    middle = scene.of(cell).shown().domains.centroid - [1.0, 2.0]
    near = np.argsort(np.linalg.norm(middle, axis=1))[:4]
    scene.mark(cell, near.tolist(), go=True)
    picture(pictures, "view_8_table")
    dock.button.click()
    for obj in cell.OutListRecursive:
        if hasattr(obj, "Prisms") and not obj.Prisms.startswith("channels_"):
            obj.ViewObject.Visibility = False
    view.viewTop()
    view.fitAll()
    picture(pictures, "view_9_solids")
