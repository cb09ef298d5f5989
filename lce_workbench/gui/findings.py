"""The findings of a review beside the 3D view: values, limits, places; a double click shows the place."""

from __future__ import annotations

import json
from typing import Any

import FreeCAD
import FreeCADGui
import numpy as np

from lce_solver.types import Floats
from lce_workbench.app import cells
from lce_workbench.app.places import place_of
from lce_workbench.gui.qt import QtCore, QtGui, QtWidgets, tr

NAME = "lce_findings"
"""Of the dock."""

SEVERITIES = {"error": "#c62828", "warning": "#b26a00", "info": "#2e7d32"}
"""Severity, the worst first -> colour of its sign; the word stands beside it."""

PLACE, MESSAGE = 4, 5
"""Columns."""

MARKED = (0.85, 0.1, 0.1)
"""Colour of outlines."""

AROUND = 4.0
"""An outline that is jumped to is so many times smaller than the view."""


def show(cell: Any) -> None:
    """Show the findings of a cell's review."""
    review = cells.result(cell, "ReviewData")
    table = _dock().widget()
    table.clear()
    records = [json.loads(text) for text in review.Records]
    for record in sorted(records, key=lambda r: list(SEVERITIES).index(r["severity"])):
        table.addTopLevelItem(_row(record))
    for column in range(MESSAGE):
        table.resizeColumnToContents(column)
    table.setProperty("cell", [cell.Document.Name, cell.Name])


def _dock() -> Any:
    """The dock, made when there is none yet."""
    window = FreeCADGui.getMainWindow()
    dock = window.findChild(QtWidgets.QDockWidget, NAME)
    if dock is None:
        dock = QtWidgets.QDockWidget(tr("Design review"), window)
        dock.setObjectName(NAME)
        dock.setWidget(_table(dock))
        window.addDockWidget(QtCore.Qt.BottomDockWidgetArea, dock)
        others = [other for other in window.findChildren(QtWidgets.QDockWidget) if other.isVisible()]
        below = [other for other in others if window.dockWidgetArea(other) == QtCore.Qt.BottomDockWidgetArea]
        for other in below[:1]:
            window.tabifyDockWidget(other, dock)  # beside them it would be narrow
    dock.show()
    dock.raise_()
    return dock


def _table(dock: Any) -> Any:
    table = QtWidgets.QTreeWidget(dock)
    words = [tr("Finding"), tr("Check"), tr("Value"), tr("Limit"), tr("Place"), tr("What was measured")]
    table.setHeaderLabels(words)
    table.setRootIsDecorated(False)
    table.setUniformRowHeights(True)
    table.setToolTip(tr("Double-click a finding to see its place"))
    table.itemDoubleClicked.connect(lambda item, _: _jump(table, item))
    return table


def _row(record: dict[str, Any]) -> Any:
    """One finding."""
    unit = f" {record['unit']}" if record["unit"] else ""
    figures = ("" if record[key] is None else f"{record[key]:.4g}{unit}" for key in ("value", "limit"))
    words = record["severity"], record["check"], *figures, record["where"], record["message"]
    item = QtWidgets.QTreeWidgetItem(list(words))
    item.setForeground(0, QtGui.QBrush(QtGui.QColor(SEVERITIES[record["severity"]])))
    item.setToolTip(MESSAGE, record["message"])
    return item


def _jump(table: Any, item: Any) -> None:
    """Select and show what a finding is about."""
    document, name = table.property("cell")
    doc = FreeCAD.listDocuments().get(document)
    cell = doc and doc.getObject(name)
    if cell is None:
        return  # closed or deleted since
    place = place_of(cell, item.text(PLACE))
    FreeCADGui.Selection.clearSelection()
    for obj in place.objects:
        FreeCADGui.Selection.addSelection(obj)
    view = FreeCADGui.getDocument(document).activeView()
    if not hasattr(view, "getSceneGraph"):
        return  # a drawing or a table is in front
    _forget(view)
    if place.outlines:
        _outline(view, cell, place.outlines)
    elif place.objects:
        FreeCADGui.SendMsgToActiveView("ViewSelection")


def _outline(view: Any, cell: Any, outlines: tuple[Floats, ...]) -> None:
    """Draw outlines in front of everything, and look at them."""
    from lce_workbench.gui import camera, nodes

    to = cell.getGlobalPlacement()
    closed = [np.array([to.multVec(FreeCAD.Vector(*p)) for p in (*ring, ring[0])]) for ring in outlines]
    node = nodes.polylines(closed, MARKED, 3.0)
    node.setName(NAME)
    view.getSceneGraph().addChild(node)
    points = np.concatenate(closed)
    low, high = points.min(axis=0), points.max(axis=0)
    camera.look_at(view, (low + high) / 2, AROUND * float(np.linalg.norm(high - low)))


def _forget(view: Any) -> None:
    """Take the outlines of the last jump away."""
    scene = view.getSceneGraph()
    for child in list(scene.getChildren() or ()):
        if child.getName().getString() == NAME:
            scene.removeChild(child)
