"""The parametric FreeCAD document of one cell, written without a window."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping, Sequence
from dataclasses import fields
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import FreeCAD

from lce_solver.errors import InputError
from lce_workbench.app import cells
from lce_workbench.app.bill import add_bill
from lce_workbench.app.fcstd import Look, finish, isometric
from lce_workbench.app.objects import CELL_SECTIONS, FILES, SHAPED_BY, Body, Parameters, is_fine, prisms_around
from lce_workbench.app.properties import write
from lce_workbench.app.results import RESULTS, DesignData
from lce_workbench.core import jobfile
from lce_workbench.core.cell import LOOKS
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
        build(doc, design_npz, job, design_npz.parent)
        doc.recompute()
        _refuse_invalid(doc)
        _save(doc, fcstd)
    finally:
        FreeCAD.closeDocument(doc.Name)


def build(doc: Any, design_npz: Path, job: Job, base: Path | None = None) -> Any:
    """Add the whole cell of a solved design to a document; nothing is computed yet. Returns the `App::Part`.

    ``base`` is the folder that the job's file names are relative to; without it the files are not kept in the document.
    """
    cell = new_cell(doc, job, base)
    take_design(cell, design_npz, job)
    add_bodies(cell)
    add_bill(cell)
    add_window(cell)
    return cell


def new_cell(doc: Any, job: Job, base: Path | None = None) -> Any:
    """Add a cell that holds the parameters of a job, and results that are not computed yet."""
    cell = doc.addObject("App::Part", "Cell")
    found = {}
    for section in fields(Job):
        name = section.name
        found[name] = obj = doc.addObject("App::FeaturePython", f"{name.capitalize()}Parameters")
        Parameters(obj, name)
        write(obj, getattr(job, name))
        cell.addObject(obj)
        if base and name in FILES and (kept := getattr(getattr(job, name), FILES[name])) and (base / kept).is_file():
            obj.File = str(base / kept)
    for name in RESULTS:
        add_result(cell, name)
    return cell


def add_result(cell: Any, name: str) -> Any:
    """The cell's result of this name; it is made when the document has none, being older."""
    proxy, label = RESULTS[name]
    obj = cells.result(cell, proxy.__name__)
    if obj is None:
        obj = cell.Document.addObject("App::FeaturePython", name)
        proxy(obj)
        obj.Label = label
        sections = cells.sections(cell)
        obj.Parameters = [sections[section] for section in proxy.SECTIONS]
        cell.addObject(obj)
        if proxy is not DesignData:
            obj.Design = cells.design_of(cell)
    return obj


def take_design(cell: Any, design_npz: Path, job: Job, manifest: str = "") -> None:
    """Put the design that was solved for ``job`` into the cell."""
    design = cells.design_of(cell)
    design.File, design.Job, design.Manifest = str(design_npz), jobfile.dump(job), manifest
    design.Proxy.remember(design)


def take_findings(cell: Any, records: Sequence[Mapping[str, Any]]) -> None:
    """Put what was found, as the manifest records it, into the cell's review."""
    obj = add_result(cell, "Review")
    obj.Errors, obj.Warnings = (sum(r["severity"] == level for r in records) for level in ("error", "warning"))
    obj.Findings = [f"{r['severity']}: {r['message']}" for r in records]
    obj.Records = [json.dumps(r) for r in records]


def add_bodies(cell: Any) -> None:
    """Add plates, spacer and film that the cell does not have yet, and what an option may bring later."""
    parts = {prism.name: prism.group for prism in prisms_around(cell).parts}
    for name, group in {**parts, **OPTIONAL}.items():
        there = _body_of(cell, name)
        if there is not None and there.Shape.isNull():
            there.touch()  # a damaged file has lost its shape
        if there is None:
            body = _body(cell, name)
            if name not in parts:  # what is empty tells no colour
                body.Colour, opacity = LOOKS["glue" if group else "jig"]
                body.Transparency = round(100 * (1 - opacity))
            _assembly(cell, group).addObject(body)


OPTIONAL = {"glue_left": "glue", "glue_right": "glue", "alignment_frame": ""}
"""Parts that a workshop's options bring and take -> their assembly; meanwhile their bodies are empty."""


def add_window(cell: Any) -> None:
    """Add the channels of the chosen domains as solids, one body a plate."""
    for group in dict.fromkeys(prism.group for prism in prisms_around(cell).channels):
        if _body_of(cell, group) is None:
            cell.addObject(_body(cell, group))


def _body_of(cell: Any, prisms: str) -> Any:
    bodies = (obj for obj in cell.OutListRecursive if cells.kind_of(obj) == "Body")
    return next((obj for obj in bodies if obj.Prisms == prisms), None)


def _body(cell: Any, prisms: str) -> Any:
    """One body, named after its prisms: ``bottom_land`` becomes BottomLand, "Bottom land"."""
    body = cell.Document.addObject("Part::FeaturePython", _camel(prisms))
    body.Label = BODY_LABELS.get(prisms, prisms.replace("_", " ").capitalize())
    Body(body, prisms)
    sections = cells.sections(cell)
    body.Design = cells.design_of(cell)
    body.Parameters = [sections[name] for name in SHAPED_BY.get(prisms, CELL_SECTIONS)]
    return body


BODY_LABELS = {
    "sheet": "Film",
    "channels_bottom": "Channel window, bottom",
    "channels_top": "Channel window, top",
}
"""Prisms -> label, where the name of the prisms says too little."""


def _assembly(cell: Any, group: str) -> Any:
    """The `App::Part` of a group inside the cell, or the cell itself."""
    if not group:
        return cell
    label = group.replace("_", " ").capitalize()
    inside = [obj for obj in cell.Group if obj.isDerivedFrom("App::Part")]
    part = next((obj for obj in inside if obj.Label == label or obj.Name == _camel(group)), None)
    if part is None:
        part = cell.Document.addObject("App::Part", _camel(group))
        part.Label = label
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
