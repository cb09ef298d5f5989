"""One editor for each parameter, made from its declaration."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Sequence
from dataclasses import Field
from typing import Any

import FreeCAD
import FreeCADGui

from lce_solver.errors import InputError
from lce_workbench.app.properties import Property
from lce_workbench.gui.qt import QtCore, QtGui, QtWidgets, on_change, tr

Changed = Callable[..., None]


class Editor:
    """A widget that holds the value of one parameter."""

    def __init__(self, name: str, prop: Property, field: Field[Any], obj: Any) -> None:
        """Make the widget for ``section.key``; ``obj`` has the property, or is `None` before there is a cell."""
        self.name, self.prop, self.obj = name, prop, obj
        self.unit = field.metadata["unit"]
        self.widget = self.make()
        self.widget.setObjectName(name)
        self.widget.setToolTip(tr(field.metadata["doc"]))

    def make(self) -> Any:
        """The widget."""
        raise NotImplementedError

    def set(self, value: Any) -> None:
        """Show a value."""
        raise NotImplementedError

    def get(self) -> Any:
        """The value as the job has it.

        Raises
        ------
        InputError
            What is written is not of the kind.
        """
        raise NotImplementedError

    def watch(self, changed: Changed) -> None:
        """Call ``changed`` when the user changes the value."""
        raise NotImplementedError

    def drop(self) -> None:
        """Let go of the widget before Qt deletes it: PySide2 would take a new one at its address for it."""
        self.widget = None


class Text(Editor):
    """A line of text."""

    def make(self) -> Any:
        return QtWidgets.QLineEdit()

    def set(self, value: Any) -> None:
        self.widget.setText(value or "")

    def get(self) -> Any:
        return self.widget.text().strip()

    def watch(self, changed: Changed) -> None:
        self.widget.textChanged.connect(changed)


class FileName(Text):
    """A file that can be looked for; the line edit is inside a row with a button."""

    def make(self) -> Any:
        row = QtWidgets.QWidget()
        layout = QtWidgets.QHBoxLayout(row)
        layout.setContentsMargins(0, 0, 0, 0)
        self.line, button = QtWidgets.QLineEdit(), QtWidgets.QToolButton()
        button.setText("…")
        button.clicked.connect(self.browse)
        layout.addWidget(self.line)
        layout.addWidget(button)
        return row

    def browse(self, *_: Any) -> None:
        """Let the user look for a file."""
        kinds = tr("Meshes") + " (*.stl *.obj *.ply *.off)" if self.name == "target.mesh" else "CSV (*.csv)"
        found = QtWidgets.QFileDialog.getOpenFileName(self.widget, tr("Choose a file"), self.line.text(), kinds)[0]
        if found:
            self.line.setText(found)

    def set(self, value: Any) -> None:
        self.line.setText(value or "")

    def get(self) -> Any:
        return self.line.text().strip()

    def watch(self, changed: Changed) -> None:
        self.line.textChanged.connect(changed)


class List(Text):
    """Words or whole numbers, separated by commas."""

    def set(self, value: Any) -> None:
        self.widget.setText(", ".join(str(item) for item in value))

    def get(self) -> Any:
        words = [word.strip() for word in self.widget.text().split(",") if word.strip()]
        if self.prop.type == "App::PropertyStringList":
            return tuple(words)
        try:
            return tuple(int(word) for word in words)
        except ValueError:
            msg = f"{self.name} is {self.widget.text()!r}; give whole numbers with commas between them"
            raise InputError(msg) from None


class Number(Text):
    """A number without a unit, written as the user likes: 0.5, 1e-8."""

    def set(self, value: Any) -> None:
        self.widget.setText("" if value is None else repr(value))

    def get(self) -> Any:
        text = self.widget.text().strip().replace(",", ".")
        if not text and self.prop.given:
            return None
        try:
            return self.prop.kind(text)
        except ValueError:
            kind = "a whole number" if self.prop.kind is int else "a number"
            msg = f"{self.name} is {text!r}; give {kind}"
            raise InputError(msg) from None


class Tick(Editor):
    """Yes or no."""

    def make(self) -> Any:
        return QtWidgets.QCheckBox()

    def set(self, value: Any) -> None:
        self.widget.setChecked(bool(value))

    def get(self) -> Any:
        return self.widget.isChecked()

    def watch(self, changed: Changed) -> None:
        self.widget.toggled.connect(changed)


class Choice(Editor):
    """One of several words."""

    def __init__(self, *how: Any, choices: Sequence[str]) -> None:
        self.choices = choices
        super().__init__(*how)

    def make(self) -> Any:
        box = QtWidgets.QComboBox()
        box.addItems([choice or tr("(none)") for choice in self.choices])
        return box

    def set(self, value: Any) -> None:
        if value not in self.choices:
            self.choices = (*self.choices, value)
            self.widget.addItem(value)
        self.widget.setCurrentIndex(self.choices.index(value))

    def get(self) -> Any:
        return self.choices[self.widget.currentIndex()]

    def watch(self, changed: Changed) -> None:
        self.widget.currentIndexChanged.connect(changed)


class Quantity(Editor):
    """A length or angle with its unit, and with f(x) where there is an object to bind the expression to."""

    def make(self) -> Any:
        self.loader = FreeCADGui.UiLoader()  # kept: the widget goes with it
        self.box = _created(self.loader, "Gui::QuantitySpinBox")
        self.box.setProperty("unit", KINDS_OF_UNIT[self.unit][0])
        if self.obj is not None:
            FreeCADGui.ExpressionBinding(self.box).bind(self.obj, self.prop.name)
        self.shown, self.value = 0.0, None
        return self.box

    def set(self, value: Any) -> None:
        self.value = value
        if value is not None:
            size = FreeCAD.Units.Quantity(self.prop.shifted(value, self.prop.places), KINDS_OF_UNIT[self.unit][1])
            size.Format = {"NumberFormat": "g", "Precision": DIGITS, "Denominator": 8}  # two decimals hide, and round
            self.box.setProperty("value", size)
        self.shown = self.box.property("rawValue")

    def get(self) -> Any:
        text = self.box.findChild(QtWidgets.QLineEdit).text()
        mark, groups = QtCore.QLocale().decimalPoint(), QtCore.QLocale().groupSeparator()
        if re.search(rf"\d{re.escape(groups)}\d", text):
            # FreeCAD passes over it: where thousands are grouped by points, 1.3 mm would be 13 mm.
            msg = f"{self.name} is {text!r}; the decimal mark of your language is {mark!r}, so leave out {groups!r}"
            raise InputError(msg)
        now = self.box.property("rawValue")
        # The box passes over what it cannot read, and keeps its former value.
        written = _size(text, KINDS_OF_UNIT[self.unit][1])
        if not math.isfinite(written) or not (self.bound() or math.isclose(written, now, rel_tol=SHOWN, abs_tol=SHOWN)):
            msg = f"{self.name} is {text!r}; give a number with a unit, for example {KINDS_OF_UNIT[self.unit][2]}"
            raise InputError(msg)
        return self.value if now == self.shown else self.prop.shifted(float(f"{now:.12g}"), -self.prop.places)

    def bound(self) -> bool:
        """Whether an expression gives the value; the box shows two decimals of it."""
        return self.obj is not None and any(path == self.prop.name for path, _ in self.obj.ExpressionEngine)

    def watch(self, changed: Changed) -> None:
        self.box.findChild(QtWidgets.QLineEdit).textChanged.connect(changed)
        on_change(self.box, "valueChanged(double)", changed)

    def drop(self) -> None:
        self.widget = self.box = self.loader = None


def _size(text: str, unit: Any) -> float:
    """A quantity of this kind of unit, or a plain number, as FreeCAD reads it [mm, degrees]; nan for all else."""
    try:
        written = FreeCAD.Units.Quantity(text)
    except (ValueError, ArithmeticError, OSError):
        return math.nan
    return written.Value if text.strip() and written.Unit in (unit, PLAIN) else math.nan


def _created(loader: Any, kind: str) -> Any:
    """One of FreeCAD's own widgets.

    PySide2 takes a new widget for a deleted one of which Python still knows something when it lies at its address; then
    another one is made while the first keeps the address.
    """
    dead = []
    while True:
        widget = loader.createWidget(kind)
        try:
            widget.objectName()
        except RuntimeError:
            dead.append(widget)
        else:
            return widget


DIGITS = 9
"""Of a quantity, as shown."""

SHOWN = 1e-8
"""So far a text may be from its value [1, mm, degrees]."""

KINDS_OF_UNIT = {
    "um": ("mm", FreeCAD.Units.Length, "150 um"),
    "mm": ("mm", FreeCAD.Units.Length, "20 mm"),
    "deg": ("deg", FreeCAD.Units.Angle, "5 deg"),
}
"""Unit of a parameter -> unit of the box, FreeCAD's kind of unit, an example."""


PLAIN = FreeCAD.Units.Unit()
"""No unit."""


class OptionalQuantity(Quantity):
    """A quantity that counts only while its tick is set."""

    def make(self) -> Any:
        row = QtWidgets.QWidget()
        layout = QtWidgets.QHBoxLayout(row)
        layout.setContentsMargins(0, 0, 0, 0)
        self.tick, box = QtWidgets.QCheckBox(), super().make()
        self.tick.toggled.connect(self.enable)
        layout.addWidget(self.tick)
        layout.addWidget(box, 1)
        return row

    def enable(self, on: bool) -> None:
        """Let the value be edited while it counts."""
        self.box.setEnabled(on)

    def set(self, value: Any) -> None:
        self.tick.setChecked(value is not None)
        self.box.setEnabled(value is not None)
        super().set(value)

    def get(self) -> Any:
        return super().get() if self.tick.isChecked() else None

    def watch(self, changed: Changed) -> None:
        self.tick.toggled.connect(changed)
        super().watch(changed)


class KeepOpen(QtCore.QObject):
    """Enter, which fields hand on to their form, goes to the next field; FreeCAD would close the panel."""

    def eventFilter(self, form: Any, event: Any) -> bool:  # noqa: N802  Qt's name
        """Take Enter away from what is around the form."""
        # PySide2 may hand over something else while a panel is being deleted.
        pressed = isinstance(event, QtGui.QKeyEvent) and event.type() == QtCore.QEvent.KeyPress
        if not pressed or event.key() not in (QtCore.Qt.Key_Return, QtCore.Qt.Key_Enter):
            return False
        form.focusNextChild()
        return True
