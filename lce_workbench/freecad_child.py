"""FreeCAD in a process of its own, which writes the document and the drawings."""

from __future__ import annotations

import os
import shutil
import subprocess
import tempfile
from pathlib import Path

from lce_solver.errors import EnvironmentFault, LceError
from lce_workbench import ROOT


def run_freecad(command: str, folder: Path, made: Path) -> None:
    """Run one of our commands inside FreeCAD, in a process of its own, which must make the file ``made``.

    Raises
    ------
    LceError
        FreeCAD is missing, or the command failed; its own sentence and exit code are passed on.
    """
    call = [freecad(), str(ROOT / "lce_workbench" / "batch.py"), "--", command, str(folder)]
    with tempfile.TemporaryDirectory() as home:  # where no other addon is found
        place = {"LC_ALL": "C.UTF-8", "FREECAD_USER_HOME": home, "QT_HASH_SEED": "0", "PYTHONHASHSEED": "0"}
        try:
            done = subprocess.run(
                call, capture_output=True, text=True, check=False, env={**os.environ, **place}, timeout=PATIENCE
            )
        except subprocess.TimeoutExpired as late:
            msg = f"FreeCAD did not write {made.name} within {PATIENCE:g} s; end other programs and try again"
            raise EnvironmentFault(msg) from late
    if done.returncode or not made.is_file():
        said = done.stderr.strip().splitlines() or [f"no message, exit code {done.returncode}"]
        own = [line for line in said if line.startswith("lce: ")]
        fault = LceError(f"FreeCAD could not write {made.name}: {(own or said)[-1].removeprefix('lce: ')}")
        fault.exit_code = max(done.returncode, 0) or EnvironmentFault.exit_code  # a signal, as Qt's abort, is below 0
        raise fault


PATIENCE = 900.0
"""So long FreeCAD may work on one file [s]."""


def freecad() -> str:
    """FreeCAD's program without a window.

    Raises
    ------
    EnvironmentFault
        It is not installed.
    """
    program = shutil.which("freecadcmd") or shutil.which("FreeCADCmd")
    if program is None:
        msg = (
            "freecadcmd is missing, so cad/cell.FCStd and drawings/ cannot be written; install FreeCAD or set "
            "output.freecad=false output.drawings=false"
        )
        raise EnvironmentFault(msg)
    return program
