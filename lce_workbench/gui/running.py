"""Work in a child process, watched by Qt's event loop: the window stays free, and the work can be stopped."""

from __future__ import annotations

import shutil
from collections.abc import Callable

from lce_solver.errors import LceError
from lce_solver.types import Progress
from lce_workbench.app import child
from lce_workbench.gui.qt import QtCore, number

PATIENCE_MS = 500
"""How long a stopped child may take to end in order, before it is killed."""


class Running(QtCore.QObject):
    """One work on its way through its commands."""

    def __init__(self, work: child.Work, progress: Progress, ended: Callable[[str], None]) -> None:
        """Start; ``ended`` gets a reason, or "" when the work is done."""
        super().__init__()
        self.work, self.progress, self.ended = work, progress, ended
        self.left = list(work.commands)
        self.stopped = False
        self.said = b""
        self.process = QtCore.QProcess(self)
        self.process.setWorkingDirectory(work.scratch.name)
        self.process.setProcessEnvironment(_environment())
        self.process.readyReadStandardOutput.connect(self.hear)
        self.process.finished.connect(self.next)
        self.start()

    def start(self) -> None:
        """Start the next command."""
        program, *words = child.words(self.left.pop(0))
        self.process.start(program, words)
        self.process.closeWriteChannel()

    def hear(self) -> None:
        """Pass progress on."""
        self.said += bytes(self.process.readAllStandardOutput())
        *lines, self.said = self.said.split(b"\n")
        for line in lines[-1:]:  # what was overtaken is not shown
            child.told(line.decode(errors="replace"), self.progress)

    def next(self, code: int, _: object = None) -> None:
        """A command ended: start the next one, or tell that all is done."""
        crashed = number(self.process.exitStatus()) != 0
        said = bytes(self.process.readAllStandardError()).decode(errors="replace")
        if self.stopped:
            self.clear()
            self.ended("stopped; nothing was changed")
            return
        try:
            child.require(self.work, -1 if crashed else code, said)
        except LceError as fault:
            self.ended(str(fault))
            return
        if self.left:
            self.start()
        else:
            child.FINISHED[self.work.key] = self.work
            self.ended("")

    def stop(self) -> None:
        """End the work; it leaves nothing half-written."""
        self.stopped = True
        self.process.terminate()
        QtCore.QTimer.singleShot(PATIENCE_MS, self.kill)

    def kill(self) -> None:
        """End a child that does not listen."""
        if number(self.process.state()):
            self.process.kill()

    def clear(self) -> None:
        """Remove what a killed child was writing."""
        for partial in self.work.out.parent.glob(f".{self.work.out.name}.*.partial"):
            shutil.rmtree(partial, ignore_errors=True)


def _environment() -> QtCore.QProcessEnvironment:
    found = QtCore.QProcessEnvironment()
    for name, value in child.environment().items():
        found.insert(name, value)
    return found
