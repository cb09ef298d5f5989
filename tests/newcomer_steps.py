"""What somebody does who has just met the workbench."""

from gui_hands import activate, press, pump, run, widget, write
from view_steps import opened


def meshed(doc):
    """A mesh of two triangles in the document."""
    import FreeCAD
    import Mesh

    obj = doc.addObject("Mesh::Feature", "Scan")
    corners = [(0, 0, 0), (9, 0, 0), (0, 9, 0), (9, 0, 0), (9, 9, 1), (0, 9, 0)]
    obj.Mesh = Mesh.Mesh([FreeCAD.Vector(*corner) for corner in corners])
    return obj


def _right_end(shown):
    """How far right a picture reaches in its view, and where the legend begins, as shares of the view's width."""
    import FreeCAD

    from lce_workbench.gui.legend import WIDTH

    wide = shown.view.getSize()[0]
    points = [FreeCAD.Vector(*point) for skin in shown.skins() for point in skin.points.tolist()]
    return [max(shown.view.getPointOnScreen(point)[0] for point in points) / wide, 1 - WIDTH / wide]


def greeted():
    """The first words in the window of a user whose FreeCAD is German."""
    import FreeCADGui

    from lce_workbench.gui.qt import tr

    activate()
    run("NewCell")
    bar = FreeCADGui.getMainWindow().menuBar().actions()
    menu = next(action.menu() for action in bar if "LCE" in action.text())
    found = [tr("New cell"), widget("reason").parent().windowTitle(), menu.actions()[0].text()]
    press("Cancel")
    return found


def choose(*objects):
    """Select in the tree, these and nothing else."""
    import FreeCADGui

    FreeCADGui.Selection.clearSelection()
    for obj in objects:
        FreeCADGui.Selection.addSelection(obj)


def refusals():
    """What the window refuses; the boxes are closed."""
    import FreeCADGui

    from lce_workbench.gui.qt import QtWidgets

    boxes = FreeCADGui.getMainWindow().findChildren(QtWidgets.QMessageBox, "lce_refusal")
    said = [box.text() for box in boxes if box.isVisible()]
    for box in boxes:
        box.close()
    pump(0.1)
    return said


def looked(folder):
    """The mesh that a cell is made from, in pictures and beside plates; labels in the tree; what a step tells."""
    import FreeCADGui
    from gui_tour import anywhere

    from lce_workbench.gui.qt import QtCore, QtWidgets

    activate()
    cell = opened(folder)
    doc, found = cell.Document, {}
    from lce_workbench.app import session
    from lce_workbench.gui import scene

    scan = meshed(doc)
    session.cells.sections(cell)["target"].Source = (scan, "")
    doc.recompute()
    switch = scan.ViewObject.SwitchNode.whichChild
    found["seen"] = [switch.getValue()]
    for name in ("directors", ""):
        scene.show(cell, name)
        if name:
            run("Domains")
            found["beside the legend"] = _right_end(scene.of(cell))
        found["seen"].append(switch.getValue())
    run("Plates")
    found["panel"] = widget("reason").window() is not None and press("Ok")
    found["beside plates"] = scan.Visibility
    doc.undo()
    found["undone"] = scan.Visibility
    window = FreeCADGui.getMainWindow()
    run("Inspect")
    found["told"] = window.statusBar().currentMessage()
    pump(0.5)
    items = [
        item
        for tree in window.findChildren(QtWidgets.QTreeWidget)
        for label in ("Sheet", "Marks", "Origin")
        for item in tree.findItems(label, anywhere())
    ]
    found["grey"] = {item.text(0): item.data(0, QtCore.Qt.ForegroundRole) is not None for item in items}
    heating = session.cells.result(cell, "PredictionData")
    heating.Verdict, heating.Rms, heating.Max = "mirror", 0.8247, 2.183
    found["predicted"] = heating.Proxy.summary(heating)
    return found


def doubled(folder):
    """Two cells in a document: both chosen, one chosen; faces and whole parts as targets."""
    import FreeCADGui
    import Part

    activate()
    cell = opened(folder, plates=False)
    doc, found = cell.Document, {"targets": [], "in front": []}
    from lce_workbench.app import cells

    doc.copyObject(cell, True)
    doc.recompute()
    first, second = cells.cells(doc)
    choose(first, second)
    run("Plates")
    found["both"] = refusals()
    choose(second)
    run("Plates")
    found["title"] = [second.Label, widget("reason").parent().windowTitle()]
    press("Cancel")
    for one in (first, second):
        choose(one)
        run("Drawings")
        found["in front"].append(front())
    box, shell = doc.addObject("Part::Box", "Box"), doc.addObject("Part::Feature", "Shell")
    doc.recompute()
    shell.Shape = Part.Shell([box.Shape.Face1, box.Shape.Face3])
    for obj, *faces in [(box, "Face1"), (box, "Face1", "Face3"), (shell, ""), (box, "")]:
        FreeCADGui.Selection.clearSelection()
        for face in faces:
            FreeCADGui.Selection.addSelection(doc.Name, obj.Name, face)
        run("NewCell")
        write("domains.size_um", "2 mm")  # which sizes the mesh of a face
        press("Ok")
        found["targets"].append(_extent(cells.sections(cells.cells(doc)[-1])["target"]))
    return found


def front():
    """Title of what is in front."""
    import FreeCADGui

    return FreeCADGui.getMainWindow().centralWidget().activeSubWindow().windowTitle()


def _extent(target):
    """Name and extent of the mesh that a target keeps, or the name of its surface."""
    from pathlib import Path

    if not target.File:
        return target.Surface
    lines = Path(target.File).read_text().split("\n")[2:]
    points = [list(map(float, line.split())) for line in lines if len(line.split()) == 3]
    return [target.Mesh, [max(axis) - min(axis) for axis in zip(*points, strict=True)]]


def wrong(folder):
    """A negative film, one of atoms, and a deleted design, while the cell is cut open."""
    activate()
    cell = opened(folder)
    doc = cell.Document
    from lce_workbench.app import cells, works
    from lce_workbench.gui import scene

    scene.section(cell, 0.0)
    kept, found = scene.of(cell).key, {}
    sheet, film = cells.sections(cell)["sheet"], next(obj for obj in doc.Objects if obj.Label == "Film")
    sheet.Gap = "-1 mm"
    doc.recompute()
    found["negative"] = [sheet.getStatusString(), scene.of(cell).key == kept]
    sheet.Gap = "1e-8 mm"
    doc.recompute()
    found["thin"] = sheet.getStatusString()
    sheet.Gap = "0.1 mm"
    doc.recompute()
    run("Mask")
    for place in ("masks", "./masks", "~/masks", "/masks"):
        write("folder", place)
        found[place] = widget("reason").text()
    press("Cancel")
    found["names"] = [works.file_name(label) for label in ("Größe / 1", "Zelle Ä/ö: 2", "(stale)", "面")]
    found["again"] = [obj.Name for obj in doc.Objects if not obj.isValid()]
    doc.removeObject(cells.design_of(cell).Name)
    doc.recompute()
    found["deleted"] = [film.getStatusString(), len(scene.SCENES)]
    return found
