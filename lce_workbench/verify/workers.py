"""Readers in processes of their own: both processors work, and a damaged file can kill a reader but not the caller."""

from __future__ import annotations

import sys
from collections.abc import Callable, Mapping
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from multiprocessing import get_context
from typing import Any

from lce_workbench.verify.finding import Unreadable

Task = tuple[Callable[..., Any], tuple[Any, ...]]

WORKERS = 2


def run(tasks: Mapping[str, Task], told: Callable[[str], None]) -> dict[str, Any]:
    """What each task returned or raised; after a death those that had not ended run again, each alone."""
    if "FreeCAD" in sys.modules:  # whose program is no Python that could start another
        return {name: _alone(name, task, told) for name, task in tasks.items()}
    found = _together(tasks, WORKERS, told)
    for name, result in found.items():
        if isinstance(result, BrokenProcessPool):
            found[name] = _together({name: tasks[name]}, 1, told)[name]
    return found


def value(result: Any) -> Any:
    """What a task returned, or raise what it raised."""
    if isinstance(result, BrokenProcessPool):
        msg = "cannot be read (its reader died); write it again"
        raise Unreadable(msg)
    if isinstance(result, Exception):
        raise result
    return result


def _together(tasks: Mapping[str, Task], workers: int, told: Callable[[str], None]) -> dict[str, Any]:
    found: dict[str, Any] = {}
    with ProcessPoolExecutor(workers, mp_context=get_context("spawn")) as pool:
        futures = {name: pool.submit(function, *given) for name, (function, given) in tasks.items()}
        for name, future in futures.items():
            told(name)
            found[name] = future.exception() or future.result()
    return found


def _alone(name: str, task: Task, told: Callable[[str], None]) -> Any:
    told(name)
    try:
        return task[0](*task[1])
    except Exception as fault:
        return fault
