"""The task panel of a step: parameters, checked as one types; long work with progress and stop; one undo step."""

from __future__ import annotations

import os
from contextlib import suppress
from dataclasses import fields, replace
from pathlib import Path
from typing import Any

import FreeCAD
import FreeCADGui

from lce_solver.errors import InputError, LceError
from lce_solver.surfaces import SURFACES
from lce_solver.types import Stage, silent
from lce_workbench.app import session, works
from lce_workbench.app.objects import SECTIONS
from lce_workbench.app.properties import label, properties
from lce_workbench.core import jobfile, material
from lce_workbench.core.cell import SECONDS
from lce_workbench.core.job import Job
from lce_workbench.gui import editors, memory
from lce_workbench.gui.commands import ICONS, name_of, path_of, tell
from lce_workbench.gui.qt import QtCore, QtGui, QtWidgets, tr
from lce_workbench.gui.record import say
from lce_workbench.gui.running import Running
from lce_workbench.gui.steps import Step, presets

OK, CANCEL = QtWidgets.QDialogButtonBox.Ok, QtWidgets.QDialogButtonBox.Cancel


class Panel:
    """What FreeCAD shows as a task. Nothing in the document changes before OK, but for expressions bound by f(x)."""

    def __init__(self, step: Step, doc: Any, cell: Any = None, source: Any = None) -> None:
        self.step, self.doc, self.cell, self.source = step, doc, cell, source
        self.name, self.cell_name = doc.Name, cell.Name if cell else ""
        self.former = session.job(cell) if cell else _first(step, source)
        self.running: Running | None = None
        self.closed = False
        self.buttons: Any = None
        self.editors: dict[str, editors.Editor] = {}
        self.keep = editors.KeepOpen()
        self.form = self.build()
        self.doc.openTransaction(step.title)
        self.check()

    # What is shown

    def build(self) -> Any:
        """The form."""
        form = QtWidgets.QWidget()
        several = f": {self.cell.Label}" if self.cell and len(session.cells.cells(self.doc)) > 1 else ""
        form.setWindowTitle(tr(self.step.title) + several)
        form.setWindowIcon(QtGui.QIcon(str(ICONS / f"{self.step.icon}.svg")))
        form.setMinimumWidth(WIDTH)
        column = QtWidgets.QVBoxLayout(form)
        if self.source is not None:
            column.addWidget(QtWidgets.QLabel(tr("Target") + f": {name_of(self.source)}"))
        common = QtWidgets.QFormLayout()
        column.addLayout(common)
        if self.step.presets:
            common.addRow(tr("Preset"), self.preset_box())
        for name in self.step.common:
            if not (self.source and name in {"target.mesh", "target.surface"}):
                self.add_row(common, name)
        if self.step.folder:
            self.folder = QtWidgets.QLineEdit(memory.folder(self.doc))
            self.folder.setObjectName("folder")
            self.folder.textChanged.connect(self.check)
            common.addRow(tr("Folder"), self.folder)
        self.add_more(column)
        self.reason = QtWidgets.QLabel()
        self.reason.setObjectName("reason")
        self.reason.setWordWrap(True)
        column.addWidget(self.reason)
        self.add_progress(column)
        column.addStretch()
        form.installEventFilter(self.keep)
        return form

    def add_row(self, rows: Any, name: str) -> None:
        """Add the editor of ``section.key``."""
        section, _, key = name.partition(".")
        prop = next(p for p in properties(SECTIONS[section]) if p.field.rstrip("_") == key)
        field = next(f for f in fields(SECTIONS[section]) if f.name == prop.field)
        obj = session.cells.sections(self.cell)[section] if self.cell else None
        editor = _editor(name, prop, field, obj)
        editor.set(getattr(getattr(self.former, section), prop.field))
        editor.watch(self.check)
        rows.addRow(tr(label(section, prop.name)), editor.widget)
        self.editors[name] = editor

    def add_more(self, column: Any) -> None:
        """The rest of the parameters, folded."""
        box = QtWidgets.QGroupBox(tr("More"))
        box.setCheckable(True)
        inside = QtWidgets.QWidget()
        rows = QtWidgets.QFormLayout(inside)
        for section in self.step.more:
            for field in fields(SECTIONS[section]):
                name = f"{section}.{jobfile.toml_name(field)}"
                if name not in self.editors and not (self.source and name in {"target.mesh", "target.surface"}):
                    self.add_row(rows, name)
        if not rows.rowCount():
            return
        layout = QtWidgets.QVBoxLayout(box)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.addWidget(inside)
        box.toggled.connect(inside.setVisible)
        box.setChecked(False)
        inside.setVisible(False)
        column.addWidget(box)

    def add_progress(self, column: Any) -> None:
        """Stage, bar and stop, hidden while nothing runs."""
        self.progress = QtWidgets.QWidget()
        column.addWidget(self.progress)
        layout = QtWidgets.QVBoxLayout(self.progress)
        layout.setContentsMargins(0, 0, 0, 0)
        self.stage, self.bar = QtWidgets.QLabel(), QtWidgets.QProgressBar()
        self.stage.setObjectName("stage")
        self.bar.setRange(0, 1000)
        self.stop_button = QtWidgets.QPushButton(tr("Stop"))
        self.stop_button.setObjectName("stop")
        self.stop_button.clicked.connect(self.stop)
        for widget in (self.stage, self.bar, self.stop_button):
            layout.addWidget(widget)
        self.progress.setVisible(False)

    def preset_box(self) -> Any:
        """Names of presets; choosing one fills the fields."""
        table = presets()[self.step.presets]
        box = QtWidgets.QComboBox()
        box.setObjectName("preset")
        box.addItems([tr("(as below)"), *table])
        box.activated.connect(lambda index: self.take(list(table.values())[index - 1]) if index else None)
        return box

    def take(self, settings: dict[str, Any]) -> None:
        """Fill fields."""
        for name, value in settings.items():
            if name in self.editors:
                self.editors[name].set(value)
        self.check()

    # What the user wants

    def settings(self) -> dict[str, Any]:
        """What differs from the document.

        Raises
        ------
        LceError
            A value is wrong; the sentence says which.
        """
        found = {name: editor.get() for name, editor in self.editors.items()}
        if self.source is None and found.get("target.surface") and found.get("target.mesh") != self.former.target.mesh:
            found["target.surface"] = ""  # a mesh was chosen: it replaces the surface
        wanted = session.job_with(self.former, found)
        return session.changes(self.former, wanted)

    def check(self, *_: Any) -> str:
        """Show why OK cannot be pressed; "" when it can."""
        if self.closed:
            return ""  # Qt tells of fields that it is deleting
        try:
            self.require_budget(self.settings())
            words = self.place()[1]
        except LceError as fault:
            words = str(fault)
        self.tell(words)
        return words

    def place(self) -> tuple[str, str]:
        """The folder for the files, "" for none; and why there cannot be any."""
        text = self.folder.text().strip() if self.step.folder else ""
        folder = os.path.expanduser(text)  # noqa: PTH111  a `Path` drops what is empty
        if self.step.folder and not text:
            return "", tr("choose a folder for the files")
        return folder, f"folder is {text!r}; begin it with / or ~" if text and not Path(folder).is_absolute() else ""

    def require_budget(self, settings: dict[str, Any]) -> None:
        """Refuse a channel window that would be too much for this machine.

        Raises
        ------
        InputError
            It shows more solids than the preferences allow, or what it shows does not exist.
        """
        if self.step.call != "channel_window":
            return
        count, most = works.solids(self.cell, session.job_with(self.former, settings)), memory.most_solids()
        if count > most:
            msg = (
                f"{count} channel solids take about {count * SECONDS:.0f} s, and the preferences allow {most} of them; "
                "choose fewer domains"
            )
            raise InputError(msg)

    def tell(self, words: str) -> None:
        """Show a reason, and let OK be pressed when there is none."""
        self.reason.setText(words)
        if self.buttons is not None:
            self.buttons.button(OK).setEnabled(not words and self.running is None)

    # What FreeCAD calls

    def getStandardButtons(self) -> Any:  # noqa: N802
        """OK and Cancel, not cast: PySide6 has no numbers for them."""
        buttons = OK | CANCEL
        return int(buttons) if FreeCAD.Version()[0] == "0" else buttons

    def modifyStandardButtons(self, box: Any) -> None:  # noqa: N802
        """Keep the buttons, to disable OK."""
        self.buttons = box
        self.check()
        QtCore.QTimer.singleShot(0, lambda: _widen(WIDTH))

    def isAllowedAlterDocument(self) -> bool:  # noqa: N802
        """The document stays as it is while a panel is open."""
        return False

    def accept(self) -> bool:
        """OK: do it, or start the long work; the panel closes when all is done."""
        if self.running is not None or self.check():
            return False
        settings = self.settings()
        if self.step.work is None:
            return self.finish(settings)
        try:
            wanted = session.job_with(self.former, settings)
            work = self.step.work(self.cell, wanted, Path(self.place()[0]))
            self.running = Running(work, self.show, lambda reason: self.ended(reason, settings))
        except LceError as fault:
            self.tell(str(fault))
            return False
        self.show(tr("starting"), 0.0)
        self.progress.setVisible(True)
        self.tell("")
        return False

    def reject(self) -> bool:
        """Cancel: no trace is left."""
        if self.running is not None:
            self.running.ended, self.running.progress = (lambda _: None), silent
            self.running.stop()
        if not self.gone():
            self.doc.abortTransaction()
        self.close()
        return True

    # What happens meanwhile

    def show(self, stage: str, fraction: float) -> None:
        """Show how far the work is; it ends with its document, or with its cell."""
        if self.lost():
            self.reject()
            return
        energy = f", {tr('energy')} {stage.energy:.3e}" if isinstance(stage, Stage) else ""
        self.stage.setText(f"{stage}{energy}")
        self.bar.setValue(round(1000 * min(max(fraction, 0.0), 1.0)))

    def stop(self, *_: Any) -> None:
        """End the work; the panel stays, and the document is as it was."""
        if self.running is not None:
            self.stage.setText(tr("stopping"))
            self.running.stop()

    def ended(self, reason: str, settings: dict[str, Any]) -> None:
        """The work is over: apply it, or say why not."""
        if self.lost():
            self.running = None
            self.reject()
            return
        self.running = None
        self.progress.setVisible(False)
        self.tell("")
        if reason:
            self.reason.setText(reason)
        else:
            self.finish(settings)

    def finish(self, settings: dict[str, Any]) -> bool:
        """Change the document, in the transaction that is open since the panel is."""
        folder, _ = self.place()
        try:
            for line in self.lines(settings, folder):
                say(line)
        except Exception as fault:  # FreeCAD hands on what the line raised as an exception of its own
            self.doc.abortTransaction()
            self.doc.openTransaction(self.step.title)
            self.tell(str(fault))
            return False
        self.doc.commitTransaction()
        if self.step.call in {"plates", "new_cell"}:
            FreeCADGui.SendMsgToActiveView("ViewFit")
        tell(self.step, self.cell)
        memory.remember(self.step.name, {n: e.get() for n, e in self.editors.items()}, folder)
        self.close()
        self.step.after(self.cell)
        return True

    def lines(self, settings: dict[str, Any], folder: str) -> list[str]:
        """The Python lines that do it."""
        doc = f"App.getDocument({self.name!r})"
        if self.step.new:
            settings = session.changes(Job(), session.job_with(self.former, settings))
            source = f", {path_of(self.source)}" if self.source else ""
            if self.source:
                del settings["target.mesh"]
            return [f"session.{self.step.call}({doc}, {settings!r}{source})"]
        cell = f"{doc}.getObject({self.cell.Name!r})"
        free = {name: value for name, value in settings.items() if name not in session.driven(self.cell)}
        change = [f"session.set_parameters({cell}, {free!r})"] if settings else []
        if self.step.call == "channel_window":
            domains = self.editors["output.step_domains"].get()
            return [*change, f"session.channel_window({cell}, {domains!r})"]
        if not self.step.call:
            return change
        return [*change, f"session.{self.step.call}({cell}{f', {folder!r}' if folder else ''})"]

    def close(self) -> None:
        """Close the panel, and let go of what Qt deletes."""
        self.buttons, self.closed = None, True
        for editor in self.editors.values():
            editor.drop()
        self.editors = {}
        FreeCADGui.Control.closeDialog()
        if not self.gone():
            FreeCADGui.getDocument(self.name).resetEdit()

    def gone(self) -> bool:
        """Whether the document was closed meanwhile."""
        return self.name not in FreeCAD.listDocuments()

    def lost(self) -> bool:
        """Whether the document was closed, or the cell deleted or undone."""
        return self.gone() or bool(self.cell_name and self.doc.getObject(self.cell_name) is None)


def _widen(width: int) -> None:
    """Make the dock that shows the panel wide enough."""
    window = FreeCADGui.getMainWindow()
    docks = [dock for dock in window.findChildren(QtWidgets.QDockWidget) if dock.objectName() in DOCKS]
    narrow = [dock for dock in docks if dock.width() < width + MARGIN]
    window.resizeDocks(narrow, [width + MARGIN] * len(narrow), QtCore.Qt.Horizontal)


DOCKS = {"Combo View", "Tasks", "Model"}
"""What FreeCAD shows a task in: 0.20 and 1.0 name it differently."""
WIDTH, MARGIN = 340, 60
"""Of a panel, and of frames and scroll bar around it [pixels]."""


def _first(step: Step, source: Any) -> Job:
    """The job that a new cell's panel starts with: the values of last time."""
    job = jobfile.with_default_material(replace(Job(), target=replace(Job().target, surface="face")))
    with suppress(LceError):  # a former version's values
        job = session.job_with(job, {k: v for k, v in memory.last(step.name).items() if k != "target.mesh"})
    if not job.output.author:
        job = replace(job, output=replace(job.output, author=memory.author()))
    if not source:
        return job if job.target.surface else replace(job, target=replace(job.target, surface="face"))
    return replace(job, target=replace(job.target, surface="", mesh=f"{name_of(source)}.off"))


def _editor(name: str, prop: Any, field: Any, obj: Any) -> editors.Editor:
    """The editor for a parameter."""
    how = (name, prop, field, obj)
    if name in CHOICES:
        return editors.Choice(*how, choices=tuple(CHOICES[name]()))
    if prop.choices:
        return editors.Choice(*how, choices=prop.choices)
    if name in {"target.mesh", "material.curve"}:
        return editors.FileName(*how)
    if prop.type in {"App::PropertyDistance", "App::PropertyAngle"}:
        return (editors.OptionalQuantity if prop.given else editors.Quantity)(*how)
    return KINDS[prop.type](*how)


CHOICES: dict[str, Any] = {
    "target.surface": lambda: ["", *SURFACES],
    "material.preset": lambda: ["", *material.presets()],
}
"""Parameters whose values come from a table."""

KINDS: dict[str, type[editors.Editor]] = {
    "App::PropertyBool": editors.Tick,
    "App::PropertyString": editors.Text,
    "App::PropertyInteger": editors.Number,
    "App::PropertyFloat": editors.Number,
    "App::PropertyStringList": editors.List,
    "App::PropertyIntegerList": editors.List,
}
"""Type of a property -> its editor."""
