"""What the tests of the 3D view do inside FreeCAD."""

import time
import zipfile
from pathlib import Path

import numpy as np
from gui_hands import activate, console, fingerprint, pump, run, widget


def opened(folder, *, plates=True):
    """A document with the design and the prediction of a folder; returns the cell."""
    import FreeCAD

    from lce_workbench import packages

    packages.append()
    from lce_workbench.app import document
    from lce_workbench.core import jobfile

    folder = Path(folder)
    doc = FreeCAD.newDocument("View")
    doc.UndoMode = 1
    job = jobfile.load(folder / "job.toml")
    cell = document.new_cell(doc, job)
    document.take_design(cell, folder / "design.npz", job)
    if plates:
        document.add_bodies(cell)
        document.add_window(cell)
    doc.recompute()
    if (folder / "prediction.npz").exists():
        heating = document.add_result(cell, "Prediction")
        heating.File = str(folder / "prediction.npz")
        heating.Proxy.remember(heating)
        doc.recompute()
    doc.clearUndos()
    assert all(obj.isValid() for obj in doc.Objects), [(o.Name, o.getStatusString()) for o in doc.Objects]
    return cell


def looks(folder):
    """Every command of the view; returns what is seen, and what it left in the document."""
    import FreeCAD

    activate()
    cell = opened(folder)
    doc, found = cell.Document, {}
    from lce_workbench.gui import scene, table

    view = scene.of(cell).view
    view.setAnimationEnabled(False)
    view.viewIsometric()
    view.fitAll()
    before, saved = fingerprint(doc), saved_as(doc, folder, "before")
    plain = pixels(view, folder, "plain")
    found["pictures"] = {name: pictured(cell, name, folder) for name in PICTURES}
    run("ShowCell")
    found["back"] = share(pixels(view, folder, "back") != plain)
    found["exploded"] = exploded(cell, folder)
    found["section"] = section(cell, folder)
    found["table"] = tabled(cell, folder)
    run("Explode")
    run("ShowDirectors")
    pump(0.2)
    found["document"] = [n for n, v in fingerprint(doc).items() if before.get(n) != v] + doc.UndoNames
    found["file"] = saved_as(doc, folder, "after") == saved
    found["solids"] = solids(cell)
    found["panel"] = panel(cell)
    found["follows"] = follows(cell)
    found["reopened"] = reopened(cell)
    found["console"] = console()
    FreeCAD.closeDocument(doc.Name)
    pump(0.2)
    found["closed"] = [len(scene.SCENES), table.TABLES[0].model.rowCount()]
    return found


PICTURES = {
    "target": "ShowTarget",
    "directors": "ShowDirectors",
    "deviation": "ShowDeviation",
    "channels_bottom": "ShowBottomChannels",
    "channels_top": "ShowTopChannels",
}


def pictured(cell, name, folder):
    """One picture: its scale, its legend on the screen, its lines, domains picked in it."""
    from lce_workbench.gui import scene

    run(PICTURES[name])
    shown = scene.of(cell)
    seen = pixels(shown.view, folder, name)
    scale = shown.picture.scale
    ends = np.round(255 * scale.colours(np.array([scale.high, scale.low]))).astype(int)
    high, low = bar(seen, shown.legend)
    return {
        "scale": [scale.low, scale.high, scale.unit],
        "bar": [int(np.abs(one - end).max()) for one, end in zip((high, low), ends, strict=True)],
        "lines": lines(shown.back),
        "picked": picked(shown),
        "aside": seen_bodies(cell),
        "count": shown.picture.count,
    }


def pixels(view, folder, name):
    """(h, w, 3) what the 3D view shows."""
    from PIL import Image

    pump(0.2)
    path = Path(folder) / f"{name}.png"
    view.saveImage(str(path), 600, 400, "White")
    return np.asarray(Image.open(path).convert("RGB")).astype(int)


def share(mask):
    """Part of the pixels."""
    return float(mask.reshape(len(mask), -1).any(axis=1).mean() if mask.ndim == 1 else mask.any(axis=-1).mean())


def bar(seen, legend):
    """The colours at the upper and the lower end of the legend's bar, as they are on the screen."""
    from lce_workbench.gui.legend import BAR, EDGE, TALL

    wide = legend.size[0]
    height, width = seen.shape[:2]
    left, below = round(0.98 * width) - wide, round(0.9 * height)
    column = left + EDGE + BAR // 2
    bottom = below - EDGE - 9
    return seen[bottom - TALL + 3, column], seen[bottom - 3, column]


def lines(node):
    """Number of lines that a node draws."""
    from pivy import coin

    action = coin.SoSearchAction()
    action.setType(coin.SoLineSet.getClassTypeId())
    action.setInterest(coin.SoSearchAction.ALL)
    action.apply(node)
    paths = action.getPaths()
    return sum(paths[i].getTail().numVertices.getNum() for i in range(paths.getLength()))


def picked(shown):
    """Domain -> what is picked where its centroid is seen, for some domains that are seen."""
    from FreeCAD import Vector

    found, domains = [], shown.shown().domains
    for skin in shown.skins():
        for domain in range(0, len(domains), 17):
            at = skin.lift(domains.centroid[domain : domain + 1])[0]
            found.append([domain, shown.pick(shown.view.getPointOnScreen(Vector(*at)))])
    return found


def seen_bodies(cell):
    """Whether the solids are drawn."""
    from pivy import coin

    return [obj.ViewObject.SwitchNode.whichChild.getValue() != coin.SO_SWITCH_NONE for obj in cell.Document.RootObjects]


def heights(cell):
    """Body -> heights of its middle where it is drawn [mm]."""
    from pivy import coin

    found = {}
    for body in cell.OutListRecursive:
        if hasattr(body, "Prisms"):
            action = coin.SoGetBoundingBoxAction(coin.SbViewportRegion(600, 400))
            action.apply(body.ViewObject.RootNode)
            found[body.Prisms] = action.getBoundingBox().getCenter().getValue()[2]
    return found


def exploded(cell, folder):
    """Where bodies are closed, apart and closed again; and what placements say meanwhile."""
    from lce_workbench.gui import scene

    found = [heights(cell)]
    run("Explode")
    pixels(scene.of(cell).view, folder, "exploded")
    found += [heights(cell), [list(b.Placement.Base) for b in cell.OutListRecursive if hasattr(b, "Prisms")]]
    run("Explode")
    return [*found, heights(cell)]


def section(cell, folder):
    """How much of the plates is seen from above: whole, cut at y = 0, whole again; and the cut from the front."""
    from lce_workbench.gui import scene

    view, found = scene.of(cell).view, []
    run("Section")
    pixels(view, folder, "section")
    colours = pixels(view, folder, "section").reshape(-1, 3)
    middle = colours.reshape(400, 600, 3)[:, 300]
    run("Section")
    for y in (None, 0.0, None):
        scene.section(cell, y)
        view.viewTop()
        view.fitAll()
        found.append(share((pixels(view, folder, f"section_{y}") != 255).any(axis=2)[..., None]))
    return found, [list(map(int, c)) for c in dict.fromkeys(map(tuple, middle))]


def tabled(cell, folder):
    """The table and the view."""
    from FreeCAD import Vector

    from lce_workbench.gui import scene, table
    from lce_workbench.gui.qt import QtCore

    found = {}
    run("ShowDirectors")
    run("Domains")
    dock, shown = table.TABLES[0], scene.of(cell)
    view, domains = shown.view, shown.shown().domains
    found["rows"] = [dock.model.rowCount(), len(domains), dock.isVisible()]
    found["heads"] = [dock.model.headerData(k, QtCore.Qt.Horizontal) for k in range(dock.model.columnCount())]
    dock.view.sortByColumn(5, QtCore.Qt.DescendingOrder)
    pump(0.1)
    found["first"] = [int(dock.model.order[0]), int(np.argmax(domains.dtheta))]
    unmarked = pixels(view, folder, "unmarked")
    dock.view.selectRow(4)
    pump(0.2)
    chosen = int(dock.model.order[4])
    found["row to view"] = [list(shown.marked), chosen]
    camera = view.getCameraNode()
    at = np.array(camera.position.getValue().getValue())
    ahead = camera.orientation.getValue().multVec(pivy_vector(0, 0, -1)).getValue()
    focus = at + camera.focalDistance.getValue() * np.array(ahead)
    found["focus"] = float(np.linalg.norm(focus[:2] - domains.centroid[chosen])), float(domains.area[chosen] ** 0.5)
    marked = pixels(view, folder, "marked")
    found["marked"] = [magenta(unmarked), magenta(marked)]
    dock.view.sortByColumn(0, QtCore.Qt.AscendingOrder)
    found["kept"] = list(dock.chosen())
    run("ShowTarget")
    for keys, domain in (("", 20), ("ctrl", 37), ("ctrl", 20)):
        place = shown.skins()[0].lift(domains.centroid[domain : domain + 1])[0]
        click(view, view.getPointOnScreen(Vector(*place)), keys)
        found[f"click {domain} {keys}"] = [list(shown.marked), list(dock.chosen())]
    dock.close()
    pump(0.1)
    click(view, view.getPointOnScreen(Vector(*shown.skins()[0].lift(domains.centroid[:1])[0])), "")
    found["table closed"] = list(shown.marked)
    run("Domains")
    run("ShowCell")
    scene.mark(cell, ())
    return found


def pivy_vector(*values):
    from pivy import coin

    return coin.SbVec3f(*values)


def magenta(seen):
    """Pixels in the colour of marked domains."""
    return int((np.abs(seen - [230, 0, 115]).max(axis=2) < 12).sum())


def click(view, place, keys):
    """A click into the 3D view, as the mouse does it; ``place`` is counted from below."""
    from lce_workbench.gui.qt import QtCore, QtGui, QtWidgets

    area = view.graphicsView().viewport()
    scale = view.getSize()[1] / area.height()  # Coin counts the screen's pixels, Qt its own
    at = QtCore.QPointF(place[0] / scale, area.height() - 1 - place[1] / scale)
    held = QtCore.Qt.ControlModifier if keys else QtCore.Qt.NoModifier
    left, none = QtCore.Qt.LeftButton, QtCore.Qt.NoButton
    for kind, button, buttons in (
        (QtCore.QEvent.MouseMove, none, none),
        (QtCore.QEvent.MouseButtonPress, left, left),
        (QtCore.QEvent.MouseButtonRelease, left, none),
    ):
        event = QtGui.QMouseEvent(kind, at, area.mapToGlobal(at.toPoint()), button, buttons, held)
        QtWidgets.QApplication.sendEvent(area, event)
        pump(0.05)


def solids(cell):
    """The selected domains become solids: one undo step."""
    from lce_workbench.gui import scene, table

    doc = cell.Document
    scene.mark(cell, (7, 9))
    table.TABLES[0].button.click()
    pump(0.1)
    found = [doc.UndoNames, list(doc.OutputParameters.StepDomains), len(doc.ChannelsTop.Shape.Solids)]
    doc.undo()
    return [*found, list(doc.OutputParameters.StepDomains)]


def panel(cell):
    """Domains that are picked stand in the open panel of the channel window."""
    import FreeCADGui

    from lce_workbench.gui import scene

    run("ChannelWindow")
    scene.mark(cell, (5, 6))
    found = widget("output.step_domains").text()
    looks_on = FreeCADGui.isCommandActive("LCE_ShowTarget")

    from gui_hands import press

    press("Cancel")
    return found, looks_on


def follows(cell):
    """The picture of the twist follows the gap; a folded panel of the document does not."""
    from lce_workbench.app import session
    from lce_workbench.gui import scene

    run("ShowDirectors")
    former = scene.of(cell).picture.scale.high
    session.set_parameters(cell, {"sheet.gap_um": 150.0})
    return former, scene.of(cell).picture.scale.high, float(np.degrees(abs(scene.of(cell).shown().design.dtheta).max()))


def reopened(cell):
    """The view is closed while the cell is apart, and another one is used."""
    import FreeCADGui

    from lce_workbench.gui import scene, table
    from lce_workbench.gui.qt import QtWidgets

    scene.explode(cell, True)
    apart = heights(cell)["top_glass"]
    area = FreeCADGui.getMainWindow().findChild(QtWidgets.QMdiArea)
    first = area.subWindowList()[0]
    FreeCADGui.runCommand("Std_ViewCreate", 0)
    pump(0.2)
    first.close()
    pump(0.2)
    found = [heights(cell)["top_glass"] == apart]
    scene.explode(cell, True)
    found.append(heights(cell)["top_glass"] == apart)
    scene.mark(cell, (3,))
    return [*found, list(table.TABLES[0].chosen()), scene.of(cell).picking]


def saved_as(doc, folder, name):
    """What a saved document holds, but for the camera."""
    path = Path(folder) / f"{name}.FCStd"
    doc.saveCopy(str(path))
    with zipfile.ZipFile(path) as archive:
        parts = {member: archive.read(member) for member in archive.namelist()}
    parts["GuiDocument.xml"] = parts["GuiDocument.xml"].split(b"<Camera")[0]
    return {k: v for k, v in parts.items() if k != "thumbnails/Thumbnail.png"}


def first_draw(folder, plate="bottom"):
    """Seconds to show all channels of a plate for the first time: of the clock, and of the processor, part by part."""
    activate()
    cell = opened(folder, plates=False)
    from lce_workbench.app.pictures import PICTURES as MADE
    from lce_workbench.gui import nodes, scene

    view = scene.of(cell).view
    data = scene.of(cell).shown()
    found = {}
    for name, part in (
        ("arrays", lambda: found.update(picture=MADE[f"channels_{plate}"](data))),
        ("nodes", lambda: nodes.picture(found["picture"])),
        ("all", lambda: (scene.show(cell, f"channels_{plate}"), drawn(view))),
        ("again", lambda: (view.zoomIn(), drawn(view))),
    ):
        wall, cpu = time.perf_counter(), time.process_time()
        part()
        found[name] = [time.perf_counter() - wall, time.process_time() - cpu]
    del found["picture"]
    return {**found, "lines": lines(scene.of(cell).back)}


def drawn(view):
    """Let the view draw what changed: it does so from a timer of its own."""
    import FreeCADGui

    view.redraw()
    for _ in range(3):
        FreeCADGui.updateGui()
        time.sleep(0.02)
