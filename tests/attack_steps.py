"""What the tests of careless users do inside FreeCAD."""

DOCUMENT = "tests/documents/schema2.FCStd"


def opened(root):
    import FreeCAD

    import lce_workbench  # noqa: F401

    return FreeCAD.openDocument(f"{root}/{DOCUMENT}")


def deleted(root):
    """Objects deleted from the tree, and brought back."""
    import FreeCAD
    from missing_steps import message

    from lce_workbench.app import session

    doc, found = opened(root), {}
    cell, doc.UndoMode = doc.Cell, 1
    for name in ("SheetParameters", "BottomLand", "Design"):
        doc.openTransaction("Delete")
        doc.removeObject(name)
        doc.commitTransaction()
        doc.recompute()
        found[name] = [message(lambda: session.set_parameters(cell, {"channels.depth_um": 0.7}))[-1:]]
        found[name] += [message(lambda: session.inspect(cell))[-1:]]
        doc.undo()
        doc.recompute()
    doc.removeObject("BottomLand")
    session.plates(cell)
    found["again"] = [doc.BottomLand.Shape.Volume > 0, message(lambda: session.inspect(cell)), doc.Review.Errors]
    FreeCAD.closeDocument(doc.Name)
    return found


def broken(folder):
    """Meshes that are none, as targets: what is said, and what of the cell has changed."""
    from pathlib import Path

    import FreeCAD
    from gui_hands import differences, state
    from missing_steps import message

    import lce_workbench  # noqa: F401
    from lce_workbench import packages

    packages.append()
    from lce_workbench.app import session

    found = {}
    for name, text in MESHES.items():
        path = Path(folder) / name
        path.write_text(text)
        doc = FreeCAD.newDocument("Broken")
        cell = session.new_cell(doc, {"target.mesh": str(path), "sheet.width_mm": 3.0})
        former = state(doc)
        found[name] = [message(lambda cell=cell: session.design(cell)), differences(former, state(doc))]
    return found


MESHES = {
    "words.stl": "this is not a mesh\n",
    "empty.obj": "",
    "nan.off": "OFF\n4 2 0\n0 0 0\n1 0 0\nnan 1 0\n1 1 0\n3 0 1 2\n3 1 3 2\n",
    "points.off": "OFF\n3 0 0\n0 0 0\n1 0 0\n0 1 0\n",
    "flat.off": "OFF\n3 1 0\n0 0 0\n1 0 0\n2 0 0\n3 0 1 2\n",
    "closed.off": "OFF\n4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 2 0 3\n",
}


def strays(root):
    """Objects copied without their cell, and objects that were dragged out of it."""
    import FreeCAD
    from missing_steps import message

    doc, found = opened(root), {}
    from lce_workbench.app import cells, session

    other = FreeCAD.newDocument("Strays")
    for name in ("Design", "BottomLand", "SheetParameters", "Mask"):
        other.copyObject(doc.getObject(name), False).touch()
        other.recompute()
        found[name] = message(lambda: cells.the_cell(other, other.Objects[-1:]))[-1:]
    for name in ("SheetParameters", "Design"):
        doc.Cell.removeObject(doc.getObject(name))
        doc.recompute()
        found[f"{name} out"] = [cells.cells(doc) == [doc.Cell], message(lambda: session.plates(doc.Cell))[-1:]]
        doc.Cell.addObject(doc.getObject(name))
        doc.recompute()
    found["in"] = [message(lambda: session.plates(doc.Cell)), [o.Name for o in doc.Objects if not o.isValid()]]
    return found


def moved(root, folder):
    """A file that was renamed and moved, opened, changed, saved elsewhere, and changed again."""
    import shutil
    from pathlib import Path

    import FreeCAD

    doc, place = opened(root), Path(folder) / "sub folder ü"
    from lce_workbench.app import session

    place.mkdir()
    doc.saveAs(f"{folder}/a.FCStd")
    FreeCAD.closeDocument(doc.Name)
    shutil.move(f"{folder}/a.FCStd", place / "b.FCStd")
    doc = FreeCAD.openDocument(str(place / "b.FCStd"))
    session.set_parameters(doc.Cell, {"sheet.gap_um": 150.0})
    doc.saveAs(f"{folder}/again.FCStd")
    shutil.rmtree(place)
    session.set_parameters(doc.Cell, {"channels.depth_um": 0.8})
    invalid = [o.Name for o in doc.Objects if not o.isValid()]
    return [doc.Design.Status, invalid, doc.BottomLand.Shape.BoundBox.ZLength]


def copied(root, folder):
    """A renamed cell, its copy, and a second document open at the same time."""
    import shutil

    import FreeCAD

    doc = opened(root)
    from lce_workbench.app import cells, session

    cell = doc.Cell
    cell.Label, doc.SheetParameters.Label, doc.BottomPlate.Label = "Zelle Ä/ö: 1", "mein Blatt", "unten"
    session.plates(cell)
    found = {"parts": [o.Label for o in doc.Objects if o.isDerivedFrom("App::Part")]}
    doc.copyObject(cell, True)
    doc.recompute()
    first, second = cells.cells(doc)
    session.set_parameters(second, {"channels.depth_um": 1.4})
    session.inspect(second)
    shutil.copy(f"{root}/{DOCUMENT}", f"{folder}/other.FCStd")
    other = FreeCAD.openDocument(f"{folder}/other.FCStd")
    session.set_parameters(other.Cell, {"channels.depth_um": 2.0})
    lands = [
        o for c in (first, second, other.Cell) for o in c.OutListRecursive if getattr(o, "Prisms", "") == "top_land"
    ]
    found["depths"] = [land.Shape.BoundBox.ZLength for land in lands]
    found["invalid"] = [o.Name for d in (doc, other) for o in d.Objects if not o.isValid()]
    found["bills"] = [c.Name for c in (first, second) for o in c.Group if o.Name.startswith("BillOf")]
    return found


def undone(folder):
    """A cell is undone while its panel works; then its document is saved while another one does."""
    import FreeCAD
    import gui_hands

    gui_hands.activate()
    doc, found = FreeCAD.newDocument("Undone"), {}
    doc.UndoMode = 1
    for meddle in ("undo", "save"):
        gui_hands.run("NewCell")
        gui_hands.press("Ok")
        gui_hands.run("Design")
        gui_hands.press("Ok")
        gui_hands.until(lambda: "energy" in gui_hands.widget("stage").text())
        if meddle == "undo":
            doc.undo()
            gui_hands.until(lambda: not gui_hands.is_open(), 20)
            found["left"] = [o.Name for o in doc.Objects]
        else:
            doc.saveAs(f"{folder}/saved.FCStd")
            gui_hands.widget("stop").click()
            gui_hands.until(lambda: "stopped" in gui_hands.widget("reason").text())
            gui_hands.press("Cancel")
            found["saved"] = [doc.Design.Status, gui_hands.is_open(), doc.FileName]
    return found


def closed(root):
    """A document is closed while its panel works; another one is open."""
    import FreeCAD
    import FreeCADGui
    import gui_hands

    from lce_workbench.app import session

    gui_hands.activate()
    kept, doc = opened(root), FreeCAD.newDocument("Closed")
    doc.UndoMode = 1
    session.new_cell(doc, {"target.surface": "face"})
    gui_hands.run("Design")
    gui_hands.press("Ok")
    gui_hands.until(lambda: "energy" in gui_hands.widget("stage").text())
    FreeCAD.setActiveDocument(kept.Name)
    found = {"others": FreeCADGui.isCommandActive("LCE_Plates")}
    FreeCAD.closeDocument("Closed")
    gui_hands.until(lambda: not gui_hands.is_open(), 20)
    gui_hands.run("Plates")
    found["next"] = [gui_hands.is_open(), gui_hands.press("Ok"), gui_hands.is_open()]
    found["active"] = FreeCAD.ActiveDocument.Name == kept.Name
    return found
