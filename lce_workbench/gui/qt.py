"""Qt as this FreeCAD brings it: PySide2 (0.20, 1.0) or PySide6 (1.1), behind FreeCAD's name `PySide`."""

from __future__ import annotations

from typing import Any

from PySide import QtCore, QtGui

try:
    from PySide import QtWidgets
except ImportError:  # 0.20: QtGui holds the widgets
    QtWidgets = QtGui

__all__ = ["QtCore", "QtGui", "QtWidgets", "number", "on_change", "tr"]

CONTEXT = "LceMold"
"""Under which translations stand."""


def tr(text: str) -> str:
    """The text in the user's language."""
    return str(QtCore.QCoreApplication.translate(CONTEXT, text))


def number(flag: Any) -> int:
    """A button or flag as a number: PySide2 gives one, PySide6 an enumeration."""
    return int(getattr(flag, "value", flag))


def on_change(widget: Any, signal: str, slot: Any) -> None:
    """Connect a signal of one of FreeCAD's own widgets, which Python knows only by name."""
    QtCore.QObject.connect(widget, QtCore.SIGNAL(signal), slot)
