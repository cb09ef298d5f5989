"""Readers in processes of their own: both processors work, and a damaged file can kill a reader but not the caller."""

from __future__ import annotations

import os
import signal
import sys
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import dataclass
from multiprocessing import Pipe, get_context
from multiprocessing.connection import Connection, wait
from multiprocessing.process import BaseProcess
from typing import Any, NoReturn

from lce_workbench.verify.finding import Unreadable

Task = tuple[Callable[..., Any], tuple[Any, ...]]

WORKERS = 2

GRACE = 0.4
"""So long a reader may take to end what it started itself, before it is killed [s]."""


class Died(Exception):
    """The process of a task ended without an answer."""


@dataclass(frozen=True, eq=False)
class Worker:
    """A process that does one task after the other."""

    process: BaseProcess
    pipe: Connection
    """Tasks go in, what they returned or raised comes out."""


def run(tasks: Mapping[str, Task], told: Callable[[str], None]) -> dict[str, Any]:
    """What each task returned or raised; `Died` of one that killed its process. An interruption kills them all."""
    if "FreeCAD" in sys.modules:  # whose program is no Python that could start another
        return {name: _alone(task, name, told) for name, task in tasks.items()}
    idle = [_begun() for _ in range(min(WORKERS, len(tasks)))]
    busy: dict[Connection, tuple[str, Worker]] = {}
    found: dict[str, Any] = {}
    left = list(tasks)[::-1]
    try:
        while left or busy:
            while left and idle:
                worker, name = idle.pop(), left.pop()
                busy[worker.pipe] = name, worker
                told(name)
                with suppress(OSError):  # of a dead worker: its answer says so
                    worker.pipe.send(tasks[name])
            for pipe in wait(list(busy)):
                name, worker = busy.pop(pipe)  # type: ignore[index]
                found[name] = _answer(worker)
                idle.append(_begun() if isinstance(found[name], Died) else worker)
    finally:
        _end([*idle, *(worker for _, worker in busy.values())])
    return found


def value(result: Any) -> Any:
    """What a task returned, or raise what it raised."""
    if isinstance(result, Died):
        msg = "cannot be read (its reader died); write it again"
        raise Unreadable(msg)
    if isinstance(result, Exception):
        raise result
    return result


def _begun() -> Worker:
    ours, theirs = Pipe()
    process = get_context("spawn").Process(target=_serve, args=(theirs,), daemon=True)
    process.start()
    theirs.close()  # so that the end of the process ends what we read
    return Worker(process, ours)


def _answer(worker: Worker) -> Any:
    try:
        return worker.pipe.recv()
    except (EOFError, OSError):
        return Died()


def _serve(pipe: Connection) -> None:
    """In the worker, which leads a group of its own: a terminal's Ctrl-C is the caller's, who ends the whole group."""
    os.setpgrp()
    signal.signal(signal.SIGTERM, _quit)
    with suppress(EOFError):
        while True:
            pipe.send(_alone(pipe.recv()))


def _quit(*_: object) -> NoReturn:
    raise SystemExit


def _end(workers: list[Worker]) -> None:
    """Ask, then kill: a library that reads a file hears nothing before it has read it."""
    for worker in workers:
        worker.process.terminate()
    for worker in workers:
        worker.process.join(GRACE)
        with suppress(ProcessLookupError, PermissionError):  # nobody is left of it
            os.killpg(worker.process.pid, signal.SIGKILL)
        worker.process.kill()  # which may not lead its group yet
        worker.process.join()
        worker.pipe.close()


def _alone(task: Task, name: str = "", told: Callable[[str], None] = lambda _: None) -> Any:
    told(name)
    try:
        return task[0](*task[1])
    except Exception as fault:
        return fault
