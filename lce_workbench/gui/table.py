"""The table of the domains beside the 3D view: selected rows are marked in the view, and the other way round."""

from __future__ import annotations

from collections.abc import Iterable
from contextlib import suppress
from typing import Any

import FreeCADGui
import numpy as np

from lce_solver.types import Ints
from lce_workbench.app import works
from lce_workbench.core.domains import PLATES
from lce_workbench.export.table import columns
from lce_workbench.gui import scene, stage
from lce_workbench.gui.commands import once, path, refuse
from lce_workbench.gui.qt import QtCore, QtWidgets, tr

DOCK = "lce_domains"
"""Object name of the dock."""

HEADS: dict[str, str] = {
    "domain": "Domain", "x_mm": "x [mm]", "y_mm": "y [mm]", "area_mm2": "Area [mm²]", "theta_deg": "θ [°]",
    "dtheta_deg": "Δθ [°]", "theta_top_deg": "θ top [°]", "theta_bottom_deg": "θ bottom [°]",
    "stretch_along": "Stretch along", "stretch_across": "Stretch across",
    "channels_top": "Channels top", "channels_bottom": "Channels bottom",
}  # fmt: skip
"""Column of domains.csv -> its head here; the angles as written on the master are left out."""

ROWS_SEEN = 100
"""So many rows tell how wide a column has to be."""

DIGITS = {"dtheta_deg": 3, "area_mm2": 5, "stretch_along": 4, "stretch_across": 4}
"""Decimals; whole numbers have none, the others 2."""


class Rows(QtCore.QAbstractTableModel):
    """Columns of equal length as rows, which can be sorted."""

    def __init__(self) -> None:
        super().__init__()
        self.values: list[Any] = []
        self.names: list[str] = []
        self.order: Ints = np.arange(0)
        """(n_d,) the domain of each row."""

    def take(self, table: dict[str, Any]) -> None:
        """Show other columns."""
        self.beginResetModel()
        self.names = [name for name in HEADS if name in table]
        self.values = [np.asarray(table[name]) for name in self.names]
        self.order = np.arange(len(self.values[0]))
        self.endResetModel()

    def rowCount(self, _: Any = None) -> int:  # noqa: N802  Qt's name
        """Number of domains."""
        return len(self.order)

    def columnCount(self, _: Any = None) -> int:  # noqa: N802  Qt's name
        """Number of columns."""
        return len(self.names)

    def data(self, index: Any, role: int = QtCore.Qt.DisplayRole) -> Any:
        """Text of a field."""
        if role == QtCore.Qt.TextAlignmentRole:
            return int(QtCore.Qt.AlignRight | QtCore.Qt.AlignVCenter)
        if role != QtCore.Qt.DisplayRole:
            return None
        column = self.values[index.column()]
        value = column[self.order[index.row()]]
        whole = column.dtype.kind == "i"
        return str(value) if whole else f"{value:.{DIGITS.get(self.names[index.column()], 2)}f}"

    def headerData(self, section: int, way: Any, role: int = QtCore.Qt.DisplayRole) -> Any:  # noqa: N802  Qt's name
        """Heads of the columns; rows have none."""
        if way == QtCore.Qt.Horizontal and role == QtCore.Qt.DisplayRole:
            return tr(HEADS[self.names[section]])
        return None

    def sort(self, column: int, way: Any = QtCore.Qt.AscendingOrder) -> None:
        """Sort by a column; Qt asks for one before there are any."""
        if not 0 <= column < len(self.values):
            return
        self.layoutAboutToBeChanged.emit()
        former = self.persistentIndexList()
        domains = [int(self.order[index.row()]) for index in former]
        values = self.values[column]
        self.order = np.argsort(values if way == QtCore.Qt.AscendingOrder else -values, kind="stable")
        rows = self.rows(domains)
        moved = [self.index(row, index.column()) for row, index in zip(rows, former, strict=True)]
        self.changePersistentIndexList(former, moved)
        self.layoutChanged.emit()

    def rows(self, domains: Iterable[int]) -> list[int]:
        """Where domains stand."""
        place = np.empty(len(self.order), dtype=int)
        place[self.order] = np.arange(len(self.order))
        return [int(place[domain]) for domain in domains]


class Table(QtWidgets.QDockWidget):
    """The dock."""

    def __init__(self, parent: Any) -> None:
        super().__init__(tr("Domains"), parent)
        self.setObjectName(DOCK)
        self.shown: stage.Scene | None = None
        self.fields: Any = None
        """Channels of both plates."""
        self.following = False
        """Whether the selection follows the view, and not the user."""
        self.model = Rows()
        self.view = QtWidgets.QTableView()
        self.view.setModel(self.model)
        self.view.setSortingEnabled(True)
        self.view.horizontalHeader().setSortIndicator(0, QtCore.Qt.AscendingOrder)
        self.view.horizontalHeader().setResizeContentsPrecision(ROWS_SEEN)
        self.view.setSelectionBehavior(QtWidgets.QAbstractItemView.SelectRows)
        self.view.verticalHeader().hide()
        self.view.verticalHeader().setDefaultSectionSize(22)
        self.view.selectionModel().selectionChanged.connect(self.selected)
        self.button = QtWidgets.QPushButton(tr("Channels of the Selection as Solids"))
        self.button.setObjectName("lce_solids")
        self.button.setToolTip(tr("Shows the real channels of the selected domains in the cell"))
        self.button.clicked.connect(self.solids)
        inside = QtWidgets.QWidget()
        column = QtWidgets.QVBoxLayout(inside)
        column.addWidget(self.view)
        column.addWidget(self.button)
        self.setWidget(inside)
        self.visibilityChanged.connect(self.listen)
        stage.WATCHERS.append(self.follow)

    def take(self, cell: Any) -> None:
        """Show the domains of a cell, and what is marked of them."""
        self.listen(False)
        self.shown, self.fields = scene.of(cell), None
        self.follow(self.shown)
        self.listen(True)

    def listen(self, visible: bool) -> None:
        """Clicks in the view pick domains as long as the table is seen."""
        if self.shown is not None:
            self.shown.picking = visible

    def follow(self, shown: stage.Scene) -> None:
        """Show what the scene has marked, and its domains when they are others."""
        if self.shown is None or shown.id != self.shown.id:
            return
        self.shown = shown
        if shown.gone:
            self.shown = None
            self.model.take({"domain": np.arange(0)})
            return
        fields = shown.fields()
        if fields is not self.fields:
            self.fields = fields
            self.model.take(columns(fields["bottom"].domains, [fields[plate].counts for plate in PLATES]))
            self.view.resizeColumnsToContents()
        self.select(shown.marked)
        self.tell(shown.marked)

    def select(self, domains: tuple[int, ...]) -> None:
        """Select rows, and scroll to the first."""
        if set(domains) == set(self.chosen()):
            return
        last = self.model.columnCount() - 1
        selection = QtCore.QItemSelection()
        for row in self.model.rows(domains):
            selection.select(self.model.index(row, 0), self.model.index(row, last))
        self.following = True
        self.view.selectionModel().select(selection, QtCore.QItemSelectionModel.ClearAndSelect)
        self.following = False
        if domains:
            first = self.model.index(self.model.rows(domains[:1])[0], 0)
            self.view.scrollTo(first, QtWidgets.QAbstractItemView.PositionAtCenter)

    def chosen(self) -> tuple[int, ...]:
        """The domains whose rows are selected."""
        rows = self.view.selectionModel().selectedRows()
        return tuple(sorted(int(self.model.order[index.row()]) for index in rows))

    def selected(self, *_: Any) -> None:
        """The user selected rows: mark them in the view, and go there."""
        if self.shown is not None and not self.following:
            scene.mark(self.shown.cell, self.chosen(), go=True)

    def tell(self, domains: tuple[int, ...]) -> None:
        """Write the marked domains into the panel of the channel window, when it is open."""
        if not domains or not FreeCADGui.Control.activeDialog():
            return
        for field in FreeCADGui.getMainWindow().findChildren(QtWidgets.QLineEdit, "output.step_domains"):
            with suppress(RuntimeError):  # PySide2 may still know those of former panels
                if field.isVisible():
                    field.setText(", ".join(map(str, domains)))

    def solids(self) -> None:
        """Show the channels of the selected domains as solids: one undo step."""
        if self.shown is None or FreeCADGui.Control.activeDialog():
            return refuse(tr("Close the panel first"))
        if self.shown.name:
            scene.show(self.shown.cell, "")
        line = f"session.channel_window({path(self.shown.cell)}, {self.chosen()!r})"
        return once(self.shown.cell.Document, "Channel window", line)


def open_table(cell: Any) -> Table:
    """Show the table of a cell's domains.

    Raises
    ------
    LceError
        The cell has no design.
    """
    works.require_design(cell)
    window = FreeCADGui.getMainWindow()
    if not TABLES:
        TABLES.append(Table(window))
        window.addDockWidget(QtCore.Qt.RightDockWidgetArea, TABLES[0])
    table = TABLES[0]
    table.take(cell)
    narrower, shown = not table.isVisible(), scene.of(cell)
    table.show()
    table.raise_()
    if narrower and shown.picture:
        FreeCADGui.updateGui()
        scene.fit(shown)
    return table


TABLES: list[Table] = []
"""The one table, once it was opened: Qt does not keep what Python does not."""
