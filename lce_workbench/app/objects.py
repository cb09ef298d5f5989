"""The objects of the parametric document: parameters, design, parts of the cell, channel windows.

Proxies hold no state: what an object knows is in its properties, so a document opens, shows its shapes and keeps its
values in a FreeCAD without this workbench.
"""

from __future__ import annotations

import importlib
import json
import tomllib
from dataclasses import asdict, fields, replace
from functools import lru_cache
from pathlib import Path
from typing import Any

import FreeCAD

from lce_solver.errors import InputError
from lce_solver.types import Design
from lce_workbench.app.properties import declare, read
from lce_workbench.core import jobfile
from lce_workbench.core.job import Job
from lce_workbench.outputs import read_design

SCHEMA = 1
"""Version of the properties; raise it when `setup` has to convert older documents."""

HIDDEN = 2
READ_ONLY = 1
"""FreeCAD's editor modes."""


class Proxy:
    """Behaviour of an object; its data are the object's properties."""

    VIEW = "lce_workbench.gui.views:View"
    """View provider, ``module:class``. By name, because this module has to load without a GUI."""

    def __init__(self, obj: Any) -> None:
        obj.Proxy = self
        self.setup(obj)

    def setup(self, obj: Any) -> None:
        """Add the properties that are missing; runs on creation and each time the document is opened."""
        add(obj, "App::PropertyInteger", "SchemaVersion", "Version of these properties", SCHEMA, mode=HIDDEN)

    def onDocumentRestored(self, obj: Any) -> None:  # noqa: N802 - FreeCAD's name
        """Bring an older document up to date; give it a view if it was saved without a window."""
        self.setup(obj)
        if FreeCAD.GuiUp and not getattr(obj.ViewObject.Proxy, "OURS", False):
            module, _, name = self.VIEW.partition(":")
            getattr(importlib.import_module(module), name)(obj.ViewObject)

    def dumps(self) -> None:
        """Nothing to save (FreeCAD 0.21 and later)."""

    def loads(self, state: None) -> None:
        """Nothing to restore (FreeCAD 0.21 and later)."""

    __getstate__ = dumps  # FreeCAD 0.20
    __setstate__ = loads


def add(obj: Any, kind: str, name: str, doc: str, value: Any = None, *, mode: int = 0) -> None:
    """Add a property unless it is there."""
    if name not in obj.PropertiesList:
        obj.addProperty(kind, name, "Cell", doc)
        if value is not None:
            setattr(obj, name, value)
    obj.setEditorMode(name, mode)


class Parameters(Proxy):
    """One section of the job; the property `Section` names it."""

    def setup(self, obj: Any) -> None:
        super().setup(obj)
        add(obj, "App::PropertyString", "Section", "Section of the job file", mode=HIDDEN)
        if obj.Section:
            declare(obj, SECTIONS[obj.Section], obj.Section.capitalize())

    def execute(self, obj: Any) -> None:
        """Check the values.

        Raises
        ------
        InputError
            A value is out of its limits.
        """
        section = replace(Job(), **{obj.Section: read(obj, SECTIONS[obj.Section])})
        jobfile.from_table(tomllib.loads(jobfile.dump(section)))


SECTIONS: dict[str, type] = {f.name: type(getattr(Job(), f.name)) for f in fields(Job)}
"""Name of a section of the job -> its class."""
