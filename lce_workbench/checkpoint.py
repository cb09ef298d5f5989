"""What is done of a heating, kept beside the output folder until its run ends: the next run goes on from there."""

from __future__ import annotations

import hashlib
import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np

from lce_solver.shell import Film, Heated
from lce_solver.types import HeatingStep, Status
from lce_workbench import __version__
from lce_workbench.core.job import PredictionSpec
from lce_workbench.outputs import UNREADABLE, told


def place(out: Path) -> Path:
    """The file beside the output folder ``out``."""
    full = Path(os.path.realpath(out))
    return full.parent / f".{full.name}.heating.npz"


def key(film: Film, spec: PredictionSpec) -> str:
    """What has to be the same for a heating to be gone on with."""
    digest = hashlib.sha256(repr((__version__, np.__version__, spec, film.material, film.thickness)).encode())
    for array in (film.sheet.uv, film.sheet.faces, film.theta, film.dtheta):
        digest.update(np.ascontiguousarray(array).tobytes())
    return digest.hexdigest()


@contextmanager
def resumed(path: Path, name: str) -> Iterator[tuple[Heated | None, Callable[[Heated], None]]]:
    """What ``path`` holds of the heating of this `key`, and how to keep more; at the end the file goes.

    A run that is interrupted or killed leaves the file; a file of another heating is of no use and is replaced.

    Raises
    ------
    EnvironmentFault
        The file cannot be written.
    """

    def keep(done: Heated) -> None:
        part = path.with_suffix(".part")
        steps = [(step.lambda_, step.stretching, step.bending, step.iterations, step.loading) for step in done.history]
        statuses = [step.status.name for step in done.history]
        try:
            with told(path):
                with part.open("wb") as file:
                    np.savez(file, key=name, frames=np.array(done.frames), steps=np.array(steps), statuses=statuses)
                part.replace(path)  # whole or not at all
        finally:
            part.unlink(missing_ok=True)

    yield _read(path, name), keep
    path.unlink(missing_ok=True)


def _read(path: Path, name: str) -> Heated | None:
    try:
        with path.open("rb") as file, np.load(file, allow_pickle=False) as data:
            if str(data["key"]) != name:
                return None
            steps = zip(data["steps"].tolist(), data["statuses"].tolist(), strict=True)
            history = tuple(HeatingStep(*row[:3], int(row[3]), Status[status], row[4]) for row, status in steps)
            return Heated(history, tuple(data["frames"]))
    except UNREADABLE:
        return None
