"""What a user's hands and eyes do in FreeCAD's window."""

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
    """Write into the field of a parameter as the user does; "yes" or "no" where there is a tick."""
    from lce_workbench.gui.qt import QtWidgets

    field = widget(name)
    if isinstance(field, QtWidgets.QCheckBox):
        field.setChecked(text == "yes")
        return
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

    wanted = {"Ok": ("OK",), "Cancel": ("Cancel", "Abbrechen")}[name]

    def shown():
        buttons = FreeCADGui.getMainWindow().findChildren(QtWidgets.QPushButton)
        return alive(b for b in buttons if b.text().replace("&", "") in wanted)

    until(lambda: shown() is not None, 10)
    button = shown()
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
