"""The objects of the parametric document: parameters, design, bodies of the cell.

Proxies hold no state: what an object knows is in its properties, so a document opens, shows its shapes and keeps its
values in a FreeCAD without this workbench. An impossible value raises in `execute`; FreeCAD marks the object invalid
with that sentence and leaves everything that depends on it as it was. What takes long is never computed there: a
result whose parameters changed says that it is stale, see `lce_workbench.app.results`.
"""

from __future__ import annotations

import importlib
import tomllib
from collections.abc import Iterable
from dataclasses import fields, replace
from pathlib import Path
from typing import Any

import FreeCAD

from lce_solver.errors import InputError, LceError
from lce_workbench.app import cells, migrations
from lce_workbench.app.geometry import assembled
from lce_workbench.app.properties import declare, properties, read
from lce_workbench.core import jobfile
from lce_workbench.core.cell import Cell, Prism
from lce_workbench.core.job import Job

SCHEMA = len(migrations.STEPS) + 1
"""Version of the properties."""

SECTIONS: dict[str, type] = {f.name: type(getattr(Job(), f.name)) for f in fields(Job)}
"""Name of a section of the job -> its class."""

LABELS = {"plates": "Plate sizes", "spacer": "Spacer sizes", "prediction": "Heating"}
"""Section -> label of its object, where the section's own name is wanted by something else."""

FILES = {"target": "mesh", "material": "curve"}
"""Section -> the parameter that names a file, which the document keeps a copy of."""

EDITABLE, READ_ONLY, HIDDEN = 0, 1, 2
"""FreeCAD's editor modes."""


class Proxy:
    """Behaviour of an object; its data are the object's properties."""

    VIEW = "lce_workbench.gui.views:View"
    """View provider, ``module:class``; by name, because proxies load without a window."""

    def __init__(self, obj: Any) -> None:
        obj.Proxy = self
        self.setup(obj)
        self.show(obj)

    def setup(self, obj: Any) -> None:
        """Add the properties that are missing; runs on creation and each time the document is opened."""
        add(obj, "App::PropertyInteger", "SchemaVersion", "Version of these properties", SCHEMA, mode=HIDDEN)

    def onDocumentRestored(self, obj: Any) -> None:  # noqa: N802 - FreeCAD's name
        """Bring an older document up to date; give it a view if it was saved without a window."""
        migrations.migrate(obj)
        self.setup(obj)
        self.show(obj)

    def show(self, obj: Any) -> None:
        """Give the object its view when there is a window; one that was saved with the object stays."""
        module, _, name = self.VIEW.partition(":")
        if FreeCAD.GuiUp and type(obj.ViewObject.Proxy).__name__ != name:
            getattr(importlib.import_module(module), name)(obj.ViewObject)

    def execute(self, obj: Any) -> None:
        """What FreeCAD calls: it prints every frame of a fault, and a user's mistake is one sentence."""
        try:
            self.compute(obj)
        except LceError as fault:
            raise fault.with_traceback(None) from None

    def compute(self, obj: Any) -> None:
        """Bring the object up to date.

        Raises
        ------
        LceError
            It cannot be, with the values as they are.
        """
        raise NotImplementedError

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
    """One section of the job; the target's can take its mesh from another object of the document."""

    VIEW = "lce_workbench.gui.views:ParametersView"

    def __init__(self, obj: Any, section: str) -> None:
        add(obj, "App::PropertyString", "Section", "Section of the job file", section, mode=HIDDEN)
        super().__init__(obj)
        obj.Label = LABELS.get(section, section.capitalize())

    def setup(self, obj: Any) -> None:
        super().setup(obj)
        declare(obj, SECTIONS[obj.Section], obj.Section.capitalize())
        if obj.Section in FILES:
            add(obj, "App::PropertyFileIncluded", "File", "The file, kept inside this document", mode=READ_ONLY)
        if obj.Section == "target":
            add(obj, "App::PropertyLinkSubGlobal", "Source", "A mesh of this document, or a face of a part, as target")
            add(obj, "App::PropertyLinkListGlobal", "Sizes", "Sheet and domains, which size a face's mesh", mode=HIDDEN)

    def onChanged(self, obj: Any, name: str) -> None:  # noqa: N802 - FreeCAD's name
        """Let an optional value be edited only while its tick says that it counts."""
        if "Restore" in obj.State:
            return
        for prop in properties(SECTIONS[obj.Section]):
            if prop.given == name and prop.name in obj.PropertiesList:
                obj.setEditorMode(prop.name, EDITABLE if getattr(obj, name) else READ_ONLY)

    def compute(self, obj: Any) -> None:
        """Check the values; take the mesh from the source.

        Raises
        ------
        InputError
            A value is out of its limits, or the source is no surface.
        """
        jobfile.from_table(tomllib.loads(jobfile.dump(job_of([obj]))))
        if obj.Section == "target" and obj.Source:
            from lce_workbench.app.sources import take

            take(obj)


def job_of(parameters: Iterable[Any]) -> Job:
    """The job that parameter objects hold; sections without an object have their defaults."""
    return replace(Job(), **{obj.Section: read(obj, SECTIONS[obj.Section]) for obj in parameters})


class Body(Proxy):
    """A part of the cell, or the channels of the chosen domains: the prisms of one name or group."""

    VIEW = "lce_workbench.gui.views:BodyView"

    def __init__(self, obj: Any, prisms: str) -> None:
        add(obj, "App::PropertyString", "Prisms", "Name of this part or group in the cell", prisms, mode=HIDDEN)
        super().__init__(obj)

    def setup(self, obj: Any) -> None:
        super().setup(obj)
        add(obj, "App::PropertyLinkGlobal", "Design", "The design that it is made for")
        add(obj, "App::PropertyLinkListGlobal", "Parameters", "The parameters that shape it")
        add(obj, "App::PropertyVolume", "Volume", "Volume as built", mode=READ_ONLY)
        add(obj, "App::PropertyColor", "Colour", "Colour at first sight", mode=HIDDEN)
        add(obj, "App::PropertyPercent", "Transparency", "Transparency at first sight", mode=HIDDEN)

    def compute(self, obj: Any) -> None:
        """Build the shape.

        Raises
        ------
        InputError
            The parameters do not go together; the sentence names the one to change.
        """
        import Part

        from lce_workbench.cad.part import same, solid

        prisms = prisms_of(obj)
        obj.Volume = sum(prism.volume for prism in prisms)  # each solid is checked against its prism's
        if not prisms:  # an option of the workshop was switched off
            obj.Shape = Part.Shape()
            return
        stacks = [prisms] if prisms[0].name == obj.Prisms else [[prism] for prism in prisms]  # a part; channels
        shapes = [solid(stack) for stack in stacks]
        if not same(obj.Shape, shapes):
            obj.Shape = shapes[0] if len(shapes) == 1 else Part.makeCompound(shapes)
        obj.Colour = prisms[0].colour
        obj.Transparency = _transparency(prisms[0])


SHAPED_BY = {
    "sheet": ("sheet",),
    "spacer_left": ("sheet", "plates", "marks", "spacer"),
    "spacer_right": ("sheet", "plates", "marks", "spacer"),
    "glue_left": ("sheet", "plates", "marks", "spacer"),
    "glue_right": ("sheet", "plates", "marks", "spacer"),
    "channels_bottom": ("sheet", "channels", "output"),
    "channels_top": ("sheet", "channels", "output"),
}
"""Name or group of prisms -> the sections that shape them; the plates are shaped by `CELL_SECTIONS`."""

CELL_SECTIONS = ("sheet", "channels", "plates", "marks", "spacer", "output")
"""What shapes the cell around a design."""


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
    """The prisms that a body consists of.

    Raises
    ------
    InputError
        The design was deleted, or the parameters do not go together.
    """
    if obj.Design is None:
        msg = f"{obj.Label} has lost its design; undo its deletion, or start a new cell"
        raise InputError(msg)
    cell = prisms_around(cells.cell_of(obj))
    return [prism for prism in (*cell.parts, *cell.channels) if obj.Prisms in {prism.name, prism.group}]


def prisms_around(cell: Any) -> Cell:
    """The prisms of a cell with a design; one look at all sections, so that all bodies share it.

    Raises
    ------
    InputError
        The parameters do not go together.
    """
    design, job = cells.design_of(cell), job_of(cells.sections(cell).values())
    return assembled(Path(design.File), job, cells.made_for(design))


def __getattr__(name: str) -> Any:
    """Where documents of schema 1 look for a class that moved."""
    if name == "DesignData":
        from lce_workbench.app.results import DesignData

        return DesignData
    raise AttributeError(name)
