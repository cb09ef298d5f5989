"""What the tests of the panels do inside FreeCAD's window: values as users write them, presets, memory, preferences."""

from gui_hands import activate, choose, differences, is_open, press, pump, run, state, until, widget, write

WRITTEN = {
    "150 um": 150.0, "150 µm": 150.0, "0.15 mm": 150.0, "0.015 cm": 150.0, "5 mil": 127.0, "5 thou": 127.0,
    "0.006 in": 152.4, '0.006"': 152.4, "1/4 mm": 250.0, "2*75 um": 150.0, "(0.1 + 0.05) mm": 150.0, "1.5e-1 mm": 150.0,
    "150e3 nm": 150.0, "  150um ": 150.0, "0.00015 m": 150.0,
}  # fmt: skip
"""Text -> film thickness [um]."""

REFUSED = (
    "",
    "150",
    "thick",
    "150 kg",
    "150 um um",
    "150 deg",
    "1/0 mm",
    "nan",
    "0 um",
    "-150 um",
    "1e9 km",
    "0.1,5 mm",
)


def made(name, surface="dome", **settings):
    """A document with a cell, and the cell."""
    import FreeCAD

    from lce_workbench.app import session

    doc = FreeCAD.newDocument(name)
    doc.UndoMode = 1
    cell = session.new_cell(doc, {"target.surface": surface, **settings})
    doc.clearUndos()
    return doc, cell


def typed(_=""):
    """Lengths in many ways, and expressions by f(x)."""
    activate()
    doc, _ = made("Typed")
    found = {"read": {}, "refused": {}}
    for text in WRITTEN:
        edit(doc, "SheetParameters")
        write("sheet.gap_um", text)
        reason = widget("reason").text()
        press("Ok")
        found["read"][text] = [reason, is_open(), doc.SheetParameters.Gap.Value * 1000]
    former = state(doc)
    for text in REFUSED:
        edit(doc, "SheetParameters")
        write("sheet.gap_um", text)
        found["refused"][text] = [press("Ok"), is_open(), widget("reason").text() if is_open() else ""]
        if is_open():
            press("Cancel")
    found["changed"] = differences(former, state(doc))
    return found


def edit(doc, name):
    """Double click on an object."""
    import FreeCADGui

    FreeCADGui.getDocument(doc.Name).setEdit(name)
    pump(0.05)


def formula(_=""):
    """An expression that is given in the dialog of f(x), cancelled, and given again."""
    activate()
    doc, _ = made("Formula")
    former, found = state(doc), {}
    for button in ("Cancel", "Ok"):
        edit(doc, "SheetParameters")
        found[button] = [expressed("sheet.gap_um", "ChannelsParameters.Depth * 201.5"), press(button)]
        found[button] += [differences(former, state(doc)), doc.SheetParameters.ExpressionEngine]
    doc.recompute()
    found["gap"] = doc.SheetParameters.Gap.Value * 1000
    doc.ChannelsParameters.Depth = "0.7 um"
    doc.recompute()
    found["follows"] = doc.SheetParameters.Gap.Value * 1000
    edit(doc, "SheetParameters")
    write("sheet.twist_gain", "2")
    found["kept"] = [press("Ok"), doc.SheetParameters.ExpressionEngine, doc.SheetParameters.TwistGain]
    doc.undo()
    doc.undo()
    found["undone"] = doc.SheetParameters.ExpressionEngine
    return found


def expressed(name, text):
    """Give an expression in the dialog that "=" opens; what it says."""
    from lce_workbench.gui.qt import QtCore, QtGui, QtWidgets

    field = widget(name).findChild(QtWidgets.QLineEdit)
    box = widget(name)
    for kind in (QtCore.QEvent.KeyPress, QtCore.QEvent.KeyRelease):
        event = QtGui.QKeyEvent(kind, QtCore.Qt.Key_Equal, QtCore.Qt.NoModifier, "=")
        QtWidgets.QApplication.sendEvent(box, event)
    pump(0.3)
    dialogs = [w for w in QtWidgets.QApplication.topLevelWidgets() if w.inherits("Gui::Dialog::DlgExpressionInput")]
    line = dialogs[-1].findChild(QtWidgets.QLineEdit, "expression")
    line.setText(text)
    pump(0.3)
    dialogs[-1].accept()
    pump(0.2)
    return field.text()


PRESETS = {
    "Design": ("Mylar 150 um", {"sheet.gap_um": 150.0}),
    "Plates": ("Microscope slide 75 x 25 x 1 mm", {"plates.width_mm": 75.0, "plates.height_mm": 25.0}),
    "ChannelWindow": ("2 um / 2 um / 1.5 um (the paper's former dimensions)", {"channels.depth_um": 1.5}),
    "Mask": ("0.6 um mode", {"output.writer_um": 0.6}),
}
"""Step -> preset and what it sets."""


def presets(_=""):
    """Each kind of presets, and the materials."""
    activate()
    from lce_workbench.app import session
    from lce_workbench.gui.steps import presets as table

    doc, _ = made("Presets")
    found = {"shown": {}, "offered": {}}
    for name, (preset, values) in PRESETS.items():
        run(name)
        box = widget("preset")
        found["offered"][name] = [box.itemText(k) for k in range(box.count())][1:]
        box.setCurrentIndex(box.findText(preset))
        box.activated.emit(box.currentIndex())
        pump(0.1)
        found["shown"][name] = [{key: read(key) for key in values}, widget("reason").text()]
        press("Cancel")
    run("Mask")
    write("output.writer_um", "2 um")
    found["coarse"] = [press("Ok"), is_open(), widget("reason").text()]
    press("Cancel")
    found["tables"] = {name: list(rows) for name, rows in table().items()}
    run("NewCell")
    material = widget("material.preset")
    found["materials"] = [material.itemText(k) for k in range(material.count())]
    choose("material.preset", "rm82-pdt-1to1-max")
    choose("target.surface", "saddle")
    press("Ok")
    found["job"] = [session.job(c).material.preset for c in session.cells.cells(doc)]
    return found


def read(name):
    """The number that a field shows, in the job's unit."""
    import FreeCAD

    from lce_workbench.gui.qt import QtWidgets

    text = widget(name).findChild(QtWidgets.QLineEdit).text()
    length = FreeCAD.Units.Quantity(text).getValueAs("um" if name.endswith("_um") else "mm").Value
    return round(float(length), 6)


def remembered(folder, first):
    """What a new cell's panel starts with; in the first session values are written."""
    import FreeCAD

    activate()
    preferences = FreeCAD.ParamGet("User parameter:BaseApp/Preferences/Mod/LceMold")
    FreeCAD.newDocument("Memory")
    run("NewCell")
    found = {"start": [read("sheet.width_mm"), read("sheet.gap_um"), widget("target.surface").currentText()]}
    if first:
        write("sheet.width_mm", "7 mm")
        write("sheet.gap_um", "0.12 mm")
        choose("target.surface", "leaf")
        press("Ok")
        FreeCAD.newDocument("Next")
        run("NewCell")
        found["next"] = [read("sheet.width_mm"), read("sheet.gap_um"), widget("target.surface").currentText()]
    press("Cancel")
    preferences.SetBool("RememberLast", False)
    FreeCAD.newDocument("Forgetful")
    run("NewCell")
    found["unwanted"] = [read("sheet.width_mm"), read("sheet.gap_um"), widget("target.surface").currentText()]
    press("Cancel")
    preferences.SetBool("RememberLast", True)
    doc, _ = made("Folder")
    run("Mask")
    found["no folder"] = widget("folder").text()
    press("Cancel")
    doc.saveAs(f"{folder}/saved.FCStd")
    run("Mask")
    found["beside"] = widget("folder").text()
    press("Cancel")
    preferences.SetString("OutputFolder", f"{folder}/chosen")
    run("Mask")
    found["chosen"] = widget("folder").text()
    press("Cancel")
    preferences.SetString("OutputFolder", "")
    FreeCAD.saveParameter()
    return found


def budgets(root):
    """The author and the largest channel window, as the preferences have them."""
    import FreeCAD
    from attack_steps import opened

    activate()
    preferences = FreeCAD.ParamGet("User parameter:BaseApp/Preferences/Mod/LceMold")
    preferences.SetString("Author", "A. Maker")
    FreeCAD.newDocument("Authored")
    run("NewCell")
    press("Ok")
    found = {"author": FreeCAD.ActiveDocument.OutputParameters.Author}
    doc = opened(root)
    former = state(doc)
    preferences.SetInt("MostSolids", 50)
    for domains in ("3", "3, 4, 5, 6, 7, 8", "999", "3, x"):
        run("ChannelWindow")
        write("output.step_domains", domains)
        found[domains] = [press("Ok"), is_open(), widget("reason").text() if is_open() else ""]
        if is_open():
            press("Cancel")
    doc.undo()
    found["changed"] = differences(former, state(doc))
    return found


def unwritable(root, folder, outside):
    """Masks into a folder that cannot be written: one sentence, nothing lost, the panel stays and goes on elsewhere."""
    import FreeCAD
    from attack_steps import opened

    activate()
    doc = opened(root)
    doc.UndoMode = 1
    former, found = state(doc), {}
    for place in (folder, f"{folder}/below/it", "/proc/none", f"{root}/README.md"):
        run("Mask")
        write("folder", place)
        press("Ok")
        until(lambda: widget("reason").text() or not is_open(), 60)
        found[place] = [is_open(), widget("reason").text(), differences(former, state(doc))]
        press("Cancel")
    doc.saveAs(f"{outside}/kept.FCStd")
    try:
        doc.saveAs(f"{folder}/lost.FCStd")
        found["saved"] = ""
    except Exception as fault:
        found["saved"] = str(fault)
    found["kept"] = FreeCAD.ActiveDocument.Name == doc.Name
    return found
