"""What the tests of the window do inside FreeCAD."""

import hashlib
import time
from pathlib import Path


def pump(seconds):
    """Let the window live for a while."""
    import FreeCADGui

    end = time.monotonic() + seconds
    while time.monotonic() < end:
        FreeCADGui.updateGui()
        time.sleep(0.01)


def until(done, seconds=240):
    """Let the window live until something is so; returns the longest time it was not free."""
    import FreeCADGui

    end, worst = time.monotonic() + seconds, 0.0
    while not done():
        assert time.monotonic() < end, "it did not happen in time"
        began = time.monotonic()
        FreeCADGui.updateGui()
        worst = max(worst, time.monotonic() - began)
        time.sleep(0.005)
    return worst


def activate():
    import FreeCADGui

    FreeCADGui.activateWorkbench("LceWorkbench")
    pump(0.2)


def panel():
    """The open panel: its form's widgets by name, and its buttons."""
    import FreeCADGui

    from lce_workbench.gui.qt import QtWidgets

    window = FreeCADGui.getMainWindow()
    box = next(b for b in window.findChildren(QtWidgets.QDialogButtonBox) if b.isVisible())
    return window, box


def widget(name):
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
    """Press OK or Cancel of the open panel."""
    from lce_workbench.gui.qt import QtWidgets

    _, box = panel()
    button = box.button(getattr(QtWidgets.QDialogButtonBox, name))
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
            if hasattr(value, "Volume"):
                value = [value.Volume, value.BoundBox.XMin, value.BoundBox.ZMax, len(value.Faces)]
            elif name == "File":
                value = value and hashlib.sha256(Path(value).read_bytes()).hexdigest()
            found[f"{obj.Name}.{name}"] = str(value)
    return found
