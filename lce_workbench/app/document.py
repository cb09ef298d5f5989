"""The parametric FreeCAD document of one cell, written without a window."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import fields
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import FreeCAD

from lce_solver.errors import InputError
from lce_workbench.app.fcstd import Look, finish, isometric
from lce_workbench.app.geometry import assembled
from lce_workbench.app.objects import CELL_SECTIONS, DESIGN_SECTIONS, Body, DesignData, Parameters, is_fine, made_for
from lce_workbench.app.properties import write
from lce_workbench.core import jobfile
from lce_workbench.core.job import Job
from lce_workbench.outputs import told


def run_document(folder: Path) -> Path:
    """Write ``cad/cell.FCStd`` of an output folder from its ``job.toml`` and ``design.npz``.

    Raises
    ------
    InputError
        A file is missing or wrong.
    EnvironmentFault
        The file cannot be written.
    """
    fcstd = folder / "cad" / "cell.FCStd"
    with told(fcstd):
        fcstd.parent.mkdir(exist_ok=True)
        write_document(folder / "design.npz", jobfile.load(folder / "job.toml"), fcstd)
    return fcstd


def write_document(design_npz: Path, job: Job, fcstd: Path) -> None:
    """Write the document of the cell around a design; same inputs, same bytes.

    Raises
    ------
    InputError
        The design is not readable, or the job's values do not go together.
    """
    doc = FreeCAD.newDocument(fcstd.stem)
    try:
        build(doc, design_npz, job)
        doc.recompute()
        _refuse_invalid(doc)
        _save(doc, fcstd)
    finally:
        FreeCAD.closeDocument(doc.Name)


def build(doc: Any, design_npz: Path, job: Job) -> Any:
    """Add the cell to a document: parameters, design, bodies; nothing is computed yet. Returns the `App::Part`."""
    cell = doc.addObject("App::Part", "Cell")
    sections = _parameters(doc, cell, job)
    design = doc.addObject("App::FeaturePython", "Design")
    DesignData(design)
    design.File = str(design_npz)
    design.Parameters = [sections[name] for name in DESIGN_SECTIONS]
    design.MadeFor = made_for(job)
    cell.addObject(design)
    shaping = [sections[name] for name in CELL_SECTIONS]
    plan = assembled(design_npz, job)
    for prism in plan.parts:
        body = _body(doc, prism.name, design, shaping)
        _assembly(doc, cell, prism.group).addObject(body)
    for group in dict.fromkeys(prism.group for prism in plan.channels):
        cell.addObject(_body(doc, group, design, shaping))
    return cell


def _parameters(doc: Any, cell: Any, job: Job) -> dict[str, Any]:
    """An object for each section of the job, in a folder of the cell."""
    folder = doc.addObject("App::DocumentObjectGroup", "Parameters")
    cell.addObject(folder)
    found = {}
    for section in fields(Job):
        name = section.name
        found[name] = doc.addObject("App::FeaturePython", f"{name.capitalize()}Parameters")
        found[name].Label = f"{name.capitalize()} parameters"
        Parameters(found[name], name)
        write(found[name], getattr(job, name))
        folder.addObject(found[name])
    return found


def _body(doc: Any, prisms: str, design: Any, parameters: Sequence[Any]) -> Any:
    """One body, named after its prisms: ``bottom_land`` becomes BottomLand, "Bottom land"."""
    body = doc.addObject("Part::FeaturePython", _camel(prisms))
    body.Label = prisms.replace("_", " ").capitalize()
    Body(body, prisms)
    body.Design, body.Parameters = design, list(parameters)
    return body


def _assembly(doc: Any, cell: Any, group: str) -> Any:
    """The `App::Part` of a group inside the cell, or the cell itself."""
    if not group:
        return cell
    part = doc.getObject(_camel(group))
    if part is None:
        part = doc.addObject("App::Part", _camel(group))
        part.Label = group.replace("_", " ").capitalize()
        cell.addObject(part)
    return part


def _camel(name: str) -> str:
    return "".join(word.capitalize() for word in name.split("_"))


def _refuse_invalid(doc: Any) -> None:
    """Turn FreeCAD's marks into the sentence of the first object that could not be computed."""
    for obj in doc.Objects:
        if not obj.isValid():
            raise InputError(obj.getStatusString())


def _save(doc: Any, fcstd: Path) -> None:
    """Save through a folder beside ``fcstd``, so that a half-written file never bears its name."""
    looks = {obj.Name: _look(obj) for obj in doc.Objects if obj.TypeId not in AIDS}
    box = FreeCAD.BoundBox()
    for obj in doc.findObjects("Part::FeaturePython"):
        box.add(obj.Shape.BoundBox)
    with TemporaryDirectory(dir=fcstd.parent, prefix=f".{fcstd.name}.") as folder:
        saved, finished = Path(folder) / fcstd.name, Path(folder) / "finished"
        doc.saveAs(str(saved))
        finish(saved, looks, isometric(tuple(box.Center), box.DiagonalLength), finished)
        os.replace(finished, fcstd)  # noqa: PTH105


AIDS = ("App::Origin", "App::Line", "App::Plane")
"""Axes and planes of an `App::Part`: they stay hidden."""


def _look(obj: Any) -> Look:
    if "Colour" not in obj.PropertiesList:
        return Look(getattr(getattr(obj, "Proxy", None), "VIEW", ""))
    return Look(obj.Proxy.VIEW, obj.Colour[:3], obj.Transparency, edges=not is_fine(obj.Shape))
