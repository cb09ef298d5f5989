"""Finding one's way in a document: cells, their sections and their results."""

from __future__ import annotations

import hashlib
import tomllib
from dataclasses import fields
from functools import lru_cache
from pathlib import Path
from typing import Any

from lce_solver.errors import InputError
from lce_workbench.app.revival import is_lost, revive
from lce_workbench.core import jobfile
from lce_workbench.core.job import Job


def cells(doc: Any) -> list[Any]:
    """The cells of a document: what holds a design."""
    found = (design.getParentGeoFeatureGroup() for design in _alive(doc).Objects if kind_of(design) == "DesignData")
    return [cell for cell in found if cell is not None]  # a design may have been copied or moved out of its cell


def _alive(doc: Any) -> Any:
    """The document, whose objects have their proxies again if another FreeCAD took them."""
    if any(map(is_lost, doc.Objects)):
        revive(doc)
    return doc


def kind_of(obj: Any) -> str:
    """Class of an object's proxy; "" for what is not ours."""
    return type(getattr(obj, "Proxy", None)).__name__


def cell_of(obj: Any) -> Any:
    """The cell that an object belongs to.

    Raises
    ------
    InputError
        It belongs to none.
    """
    found = [cell for cell in cells(obj.Document) if obj in (cell, *cell.OutListRecursive)]
    if not found:
        msg = f"{obj.Label} belongs to no cell; make one with New cell, or choose another object"
        raise InputError(msg)
    return found[0]


def the_cell(doc: Any, chosen: Any = ()) -> Any:
    """The cell of what is ``chosen``, or the document's only one.

    Raises
    ------
    InputError
        There is none, or there are several and not one of them is chosen.
    """
    found = cells(doc) if doc else []
    found = [cell for cell in found if any(obj in (cell, *cell.OutListRecursive) for obj in chosen)] or found
    if len(found) != 1:
        several = "choose one of the cells in the tree, and only one"
        msg = several if found else "there is no cell in this document; start with New cell"
        raise InputError(msg)
    return found[0]


def result(cell: Any, kind: str) -> Any:
    """The cell's object whose proxy is of class ``kind``, or `None`."""
    _alive(cell.Document)
    return next((obj for obj in cell.Group if kind_of(obj) == kind), None)


def design_of(cell: Any) -> Any:
    """The cell's design object.

    Raises
    ------
    InputError
        It was deleted.
    """
    found = result(cell, "DesignData")
    if found is None:
        msg = f"{cell.Label} has lost its design; undo its deletion, or start a new cell"
        raise InputError(msg)
    return found


def sections(cell: Any) -> dict[str, Any]:
    """Section of the job -> its object, in the job's order.

    Raises
    ------
    InputError
        One was deleted: its defaults would silently take its place.
    """
    _alive(cell.Document)
    found = {obj.Section: obj for obj in cell.OutListRecursive if kind_of(obj) == "Parameters"}
    lost = ", ".join(f.name for f in fields(Job) if f.name not in found)
    if lost:
        msg = f"{cell.Label} has lost its parameters of {lost}; undo their deletion, or start a new cell"
        raise InputError(msg)
    return {f.name: found[f.name] for f in fields(Job)}


def made_for(design: Any) -> Job:
    """The job that a design was solved for."""
    return _parsed(design.Job)


@lru_cache(maxsize=8)
def _parsed(toml: str) -> Job:
    return jobfile.from_table(tomllib.loads(toml))


def digest(path: str) -> str:
    """SHA-256 of a file that an object keeps; "" when it keeps none."""
    if not path or not Path(path).is_file():
        return ""
    return _digest(path, Path(path).stat().st_mtime_ns)


@lru_cache(maxsize=32)
def _digest(path: str, changed: int) -> str:  # noqa: ARG001 - a changed file has another one
    with Path(path).open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()
