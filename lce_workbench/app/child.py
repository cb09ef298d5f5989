"""Long work: a process of its own that runs the command line, so that FreeCAD stays free and results are `./lce`'s.

The same work is run to its end by `run` (scripts, `freecadcmd`) or watched by the panels of `lce_workbench.gui`.
"""

from __future__ import annotations

import json
import os
import subprocess
import tempfile
from dataclasses import dataclass
from pathlib import Path

from lce_solver.errors import EnvironmentFault, LceError
from lce_solver.types import Progress, Stage, silent
from lce_workbench import ROOT


@dataclass(frozen=True)
class Work:
    """Commands of the command line, one after the other, and the folder they write."""

    key: str
    """The same for the same work: a result that is there already is taken."""
    commands: tuple[tuple[str, ...], ...]
    out: Path
    """Output folder that the commands write."""
    scratch: tempfile.TemporaryDirectory[str]
    """What only this work needs; it goes with it."""
    accepted: tuple[int, ...] = (0, 1, 3)
    """Exit codes with which the files are written: the findings tell what is wrong."""


FINISHED: dict[str, Work] = {}
"""Work that a panel has run: the Python line that it records takes it from here instead of running it again."""


def words(command: tuple[str, ...]) -> list[str]:
    """Program and arguments of one command.

    Raises
    ------
    EnvironmentFault
        The project's Python is missing.
    """
    python = ROOT / ".venv" / "bin" / "python"
    if not python.exists():
        msg = f"the packages of the workbench are missing ({python}); run {ROOT / 'lce'} demo once, which installs them"
        raise EnvironmentFault(msg)
    return [str(python), "-P", "-m", "lce_workbench", *command, "--json"]


def environment() -> dict[str, str]:
    """As `./lce` sets it: nothing but ours, and one BLAS thread, whose number shows in the last digits."""
    kept = {name: value for name, value in os.environ.items() if not name.startswith(("PYTHON", "QT_", "LD_"))}
    path = os.pathsep.join([str(ROOT), str(ROOT / "solver")])
    threads = os.environ.get("OPENBLAS_NUM_THREADS", "1")
    return kept | {"PYTHONPATH": path, "PYTHONNOUSERSITE": "1", "OPENBLAS_NUM_THREADS": threads, "LC_ALL": "C.UTF-8"}


def done(work: Work) -> Work:
    """The same work when it is done: by a panel that has run it, or now. Its files last as long as it is held."""
    if work.key in FINISHED:
        return FINISHED.pop(work.key)
    run(work)
    return work


def run(work: Work, progress: Progress = silent) -> None:
    """Run the commands to their end.

    Raises
    ------
    LceError
        One failed; its own sentence and exit code are passed on.
    """
    for command in work.commands:
        with subprocess.Popen(
            words(command),
            env=environment(),
            cwd=work.scratch.name,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        ) as child:
            try:
                for line in child.stdout or ():
                    told(line, progress)
            except BaseException:
                child.terminate()
                raise
            said = child.stderr.read() if child.stderr else ""
        require(work, child.returncode, said)


def told(line: str, progress: Progress) -> None:
    """Pass one line of progress on; other lines are none."""
    try:
        record = json.loads(line)
        stage, energy = str(record["stage"]), record.get("energy")
        progress(stage if energy is None else Stage(stage, float(energy)), float(record["fraction"]))
    except (ValueError, KeyError, TypeError):
        return


def require(work: Work, code: int, said: str) -> None:
    """Raise what a command said when it failed."""
    if code in work.accepted:
        return
    lines = said.strip().splitlines() or [f"the work ended with exit code {code} and no message"]
    fault = LceError(lines[-1].removeprefix("lce: "))
    fault.exit_code = code
    raise fault
