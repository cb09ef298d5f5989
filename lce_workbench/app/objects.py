"""The objects of the parametric document: parameters, design, bodies of the cell.

Proxies hold no state: what an object knows is in its properties, so a document opens, shows its shapes and keeps its
values in a FreeCAD without this workbench. An impossible value raises in `execute`; FreeCAD marks the object invalid
with that sentence and leaves everything that depends on it as it was.
"""

from __future__ import annotations

import importlib
import json
import math
import tomllib
from collections.abc import Iterable
from dataclasses import asdict, fields, replace
from pathlib import Path
from typing import Any

import FreeCAD

from lce_solver.errors import InputError
from lce_solver.types import Design
from lce_workbench.app.geometry import assembled, stored
from lce_workbench.app.properties import declare, properties, read
from lce_workbench.core import jobfile
from lce_workbench.core.cell import Prism
from lce_workbench.core.job import Job

SCHEMA = 1
"""Version of the properties; raise it when `setup` has to convert older documents."""

SECTIONS: dict[str, type] = {f.name: type(getattr(Job(), f.name)) for f in fields(Job)}
"""Name of a section of the job -> its class."""

DESIGN_SECTIONS = ("target", "material", "sheet", "domains", "solver")
"""What a design is made from."""

CELL_SECTIONS = ("sheet", "channels", "plates", "marks", "spacer", "output")
"""What shapes the cell around a design."""

EDITABLE, READ_ONLY, HIDDEN = 0, 1, 2
"""FreeCAD's editor modes."""


class Proxy:
    """Behaviour of an object; its data are the object's properties."""

    VIEW = "lce_workbench.gui.views:View"
    """View provider, ``module:class``; by name, because proxies load without a window."""

    def __init__(self, obj: Any) -> None:
        obj.Proxy = self
        self.setup(obj)

    def setup(self, obj: Any) -> None:
        """Add the properties that are missing; runs on creation and each time the document is opened."""
        add(obj, "App::PropertyInteger", "SchemaVersion", "Version of these properties", SCHEMA, mode=HIDDEN)

    def onDocumentRestored(self, obj: Any) -> None:  # noqa: N802 - FreeCAD's name
        """Bring an older document up to date; give it a view if it was saved without a window."""
        self.setup(obj)
        module, _, name = self.VIEW.partition(":")
        if FreeCAD.GuiUp and type(obj.ViewObject.Proxy).__name__ != name:
            getattr(importlib.import_module(module), name)(obj.ViewObject)

    def dumps(self) -> None:
        """Nothing to save (FreeCAD 0.21 and later)."""

    def loads(self, state: None) -> None:
        """Nothing to restore (FreeCAD 0.21 and later)."""

    __getstate__ = dumps  # FreeCAD 0.20
    __setstate__ = loads


def add(obj: Any, kind: str, name: str, doc: str, value: Any = None, *, mode: int = EDITABLE) -> None:
    """Add a property with its first value, unless it is there."""
    if name in obj.PropertiesList:
        return
    obj.addProperty(kind, name, "Cell", doc)
    obj.setEditorMode(name, mode)
    if value is not None:
        setattr(obj, name, value)


class Parameters(Proxy):
    """One section of the job."""

    def __init__(self, obj: Any, section: str) -> None:
        add(obj, "App::PropertyString", "Section", "Section of the job file", section, mode=HIDDEN)
        super().__init__(obj)

    def setup(self, obj: Any) -> None:
        super().setup(obj)
        declare(obj, SECTIONS[obj.Section], obj.Section.capitalize())

    def onChanged(self, obj: Any, name: str) -> None:  # noqa: N802 - FreeCAD's name
        """Let an optional value be edited only while its tick says that it counts."""
        if "Restore" in obj.State:
            return
        for prop in properties(SECTIONS[obj.Section]):
            if prop.given == name and prop.name in obj.PropertiesList:
                obj.setEditorMode(prop.name, EDITABLE if getattr(obj, name) else READ_ONLY)

    def execute(self, obj: Any) -> None:
        """Check the values.

        Raises
        ------
        InputError
            A value is out of its limits.
        """
        jobfile.from_table(tomllib.loads(jobfile.dump(job_of([obj]))))


def job_of(parameters: Iterable[Any]) -> Job:
    """The job that parameter objects hold; sections without an object have their defaults."""
    return replace(Job(), **{obj.Section: read(obj, SECTIONS[obj.Section]) for obj in parameters})


class DesignData(Proxy):
    """The solved design, stored inside the document, and what it was made for."""

    def setup(self, obj: Any) -> None:
        super().setup(obj)
        add(obj, "App::PropertyFileIncluded", "File", "The design (design.npz), kept inside this document")
        add(obj, "App::PropertyLinkListGlobal", "Parameters", "What the design was made from")
        add(obj, "App::PropertyString", "MadeFor", "Values of these parameters when it was made", mode=HIDDEN)
        add(obj, "App::PropertyInteger", "Domains", "Number of domains", mode=READ_ONLY)
        add(obj, "App::PropertyLength", "Width", "Width of the flat sheet (x)", mode=READ_ONLY)
        add(obj, "App::PropertyLength", "Height", "Height of the flat sheet (y)", mode=READ_ONLY)
        add(obj, "App::PropertyAngle", "LargestTwist", "Largest twist from bottom to top", mode=READ_ONLY)

    def execute(self, obj: Any) -> None:
        """Refuse a stale design; show its figures.

        Raises
        ------
        InputError
            A parameter differs from the one that the design was made for, or the file is not a design.
        """
        _require_current(obj)
        design = design_of(obj)
        obj.Domains = len(design.theta)
        obj.Width, obj.Height = (design.uv.max(axis=0) - design.uv.min(axis=0)).tolist()
        obj.LargestTwist = math.degrees(abs(design.dtheta).max())


def made_for(job: Job) -> str:
    """The parameters that the metric depends on, as text. The gap is not among them: the twist is linear in it."""
    table = {name: asdict(getattr(job, name)) for name in DESIGN_SECTIONS}
    del table["sheet"]["gap_um"]
    return json.dumps(table)


def _require_current(obj: Any) -> None:
    """Refuse parameters that the stored design was not made for."""
    wanted = json.loads(made_for(job_of(obj.Parameters)))
    for section, values in json.loads(obj.MadeFor).items():
        for name, value in values.items():
            now = wanted[section].get(name)
            if not _same(value, now):
                msg = (
                    f"{section}.{name.rstrip('_')} is now {now!r}, but this design was made for {value!r}; "
                    "run `./lce build` with the new value, or set it back"
                )
                raise InputError(msg)


def _same(one: Any, other: Any) -> bool:
    if isinstance(one, float) and isinstance(other, float):
        return math.isclose(one, other, rel_tol=1e-9)  # FreeCAD keeps 16 decimals
    return bool(one == other)


def design_of(obj: Any) -> Design:
    """The stored design at the film thickness that the sheet's parameters give now."""
    return stored(Path(obj.File), job_of(obj.Parameters).sheet.thickness)


class Body(Proxy):
    """A part of the cell, or the channels of the chosen domains: the prisms of one name or group."""

    def __init__(self, obj: Any, prisms: str) -> None:
        add(obj, "App::PropertyString", "Prisms", "Name of this part or group in the cell", prisms, mode=HIDDEN)
        super().__init__(obj)

    def setup(self, obj: Any) -> None:
        super().setup(obj)
        add(obj, "App::PropertyLinkGlobal", "Design", "The design that it is made for")
        add(obj, "App::PropertyLinkListGlobal", "Parameters", "The parameters that shape it")
        add(obj, "App::PropertyColor", "Colour", "Colour at first sight", mode=HIDDEN)
        add(obj, "App::PropertyPercent", "Transparency", "Transparency at first sight", mode=HIDDEN)

    def execute(self, obj: Any) -> None:
        """Build the shape.

        Raises
        ------
        InputError
            The parameters do not go together; the sentence names the one to change.
        """
        import Part

        from lce_workbench.cad.part import solid

        prisms = prisms_of(obj)
        shapes = [solid(prism) for prism in prisms]
        obj.Shape = shapes[0] if len(shapes) == 1 else Part.makeCompound(shapes)
        obj.Colour = prisms[0].colour
        obj.Transparency = _transparency(prisms[0])


def _transparency(prism: Prism) -> int:
    """Per cent; the top plate is fainter, because the document opens seen from above."""
    opacity = prism.opacity * (FAINT if prism.group == "top_plate" else 1.0)
    return round(100 * (1 - opacity))


FAINT = 0.2
"""How much of its opacity the top plate keeps, so that film and channels are seen through it."""


def is_fine(shape: Any) -> bool:
    """Whether the edges of a shape would hide it: a field of channels turns black."""
    return len(shape.Faces) > 100


def prisms_of(obj: Any) -> list[Prism]:
    """The prisms that a body consists of."""
    cell = assembled(Path(obj.Design.File), job_of(obj.Parameters))
    return [prism for prism in (*cell.parts, *cell.channels) if obj.Prisms in {prism.name, prism.group}]
