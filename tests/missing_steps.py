"""What the tests of an incomplete installation do inside FreeCAD."""


def message(call):
    """The sentence of the fault that a call refuses."""
    from lce_solver.errors import LceError

    try:
        call()
    except LceError as fault:
        return [type(fault).__name__, str(fault)]
    return []


def nothing():
    """Start and end."""


def bare(document, folder, packages):
    """Everything that can be done without our packages; and the sentences for the rest."""
    import importlib.util

    import FreeCAD

    import lce_workbench
    from lce_workbench.app import session

    found = {"root": str(lce_workbench.ROOT), "there": [p for p in packages if importlib.util.find_spec(p)]}
    doc = FreeCAD.openDocument(document)
    cell = doc.Cell
    volume = doc.BottomLand.Shape.Volume
    session.set_parameters(cell, {"channels.depth_um": 1.2})
    found["depth"] = doc.BottomLand.Shape.Volume / volume
    session.inspect(cell)
    found["errors"] = doc.Review.Errors
    session.channel_window(cell, (4, 5))
    found["channels"] = len(doc.ChannelsTop.Shape.Solids)
    found["mass"] = doc.BillOfMaterials.total_mass.getValueAs("g").Value
    session.set_parameters(cell, {"sheet.gap_um": 150.0})
    found["gap"] = doc.Design.getStatusString()
    session.set_parameters(cell, {"sheet.gap_um": 100.0})
    found["back"] = [o.Name for o in doc.Objects if not o.isValid()]
    found["mask"] = message(lambda: session.mask(cell, folder))
    other = session.new_cell(FreeCAD.newDocument("Other"), {"target.surface": "dome"})
    found["design"] = message(lambda: session.design(other))
    return found


def drawn(document, folder):
    """The drawings without the packages that write their files."""
    import FreeCAD

    import lce_workbench  # noqa: F401
    from lce_workbench.app import session
    from lce_workbench.app.drawings import hidden_window

    hidden_window()
    doc = FreeCAD.openDocument(document)
    found = {"dxf": message(lambda: session.drawings(doc.Cell, folder))}
    found["pages"] = len(doc.findObjects("TechDraw::DrawPage"))
    return found


def solved():
    """Design where the solver lacks a package."""
    import FreeCAD

    import lce_workbench  # noqa: F401
    from lce_workbench.app import session

    cell = session.new_cell(FreeCAD.newDocument("Other"), {"target.surface": "dome"})
    return message(lambda: session.design(cell))


def window(folder):
    """The window of a user without our packages, whose home cannot be written."""
    import os

    import FreeCAD
    import gui_hands

    gui_hands.activate()
    found = {"commands": len(gui_hands.described()), "home": os.access(FreeCAD.getUserAppDataDir(), os.W_OK)}
    gui_hands.run("ExampleDome")
    doc = FreeCAD.ActiveDocument
    former = gui_hands.state(doc)
    gui_hands.run("Design")
    found["design"] = [gui_hands.press("Ok"), gui_hands.is_open(), gui_hands.widget("reason").text()]
    gui_hands.press("Cancel")
    found["changed"] = gui_hands.differences(former, gui_hands.state(doc))
    gui_hands.run("Inspect")
    found["refused"] = FreeCAD.ActiveDocument.Review.Status
    doc.saveAs(f"{folder}/saved.FCStd")
    return found
