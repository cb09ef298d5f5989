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
