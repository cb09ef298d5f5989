"""The work on a cell, step by step, as Python functions: what the commands of the window call, and what a script calls.

    from lce_workbench.app import session
    cell = session.new_cell(FreeCAD.newDocument(), {"target.mesh": "/data/face.obj", "sheet.gap_um": 150.0})
    session.design(cell)
    session.predict(cell)
    session.plates(cell)
    session.export(cell, "/data")           # /data/cell.toml and /data/out/cell, as `./lce build` writes them

Settings are named as in the job file. Every function checks its input before it changes anything.
"""

from __future__ import annotations

import json
import tomllib
from collections.abc import Mapping
from dataclasses import fields
from pathlib import Path
from typing import Any

from lce_solver.errors import InputError
from lce_workbench.app import cells, child, document, works
from lce_workbench.app.bill import add_bill
from lce_workbench.app.inspection import inspected
from lce_workbench.app.objects import FILES, SECTIONS, job_of
from lce_workbench.app.properties import properties
from lce_workbench.app.results import CURRENT
from lce_workbench.core import jobfile
from lce_workbench.core.job import Job
from lce_workbench.core.mask import refuse_unwritable
from lce_workbench.outputs import as_record, read_manifest, told

Settings = Mapping[str, Any]
"""``section.key`` -> value; `None` takes an optional value back."""


def new_cell(doc: Any, settings: Settings, source: Any = None) -> Any:
    """Add a cell to a document: its parameters, with the ``settings``. Nothing is solved yet.

    Parameters
    ----------
    source : a mesh of the document, or (object, "Face1", ...), or (object,) for a shell, as target.

    Raises
    ------
    InputError
        A setting is unknown or out of its limits.
    """
    named = {"target.mesh": "source.off"} if source else {}
    job = job_with(Job(), {**settings, **named})
    if not source:
        _require_files(changes(Job(), job))
    cell = document.new_cell(doc, job, Path.cwd())
    if source:
        objects = cells.sections(cell)
        objects["target"].Source = (source[0], list(source[1:])) if isinstance(source, tuple) else (source, "")
        objects["target"].Sizes = [objects["sheet"], objects["domains"]] if isinstance(source, tuple) else []
    cell.Document.recompute()
    return cell


def job_with(job: Job, settings: Settings) -> Job:
    """The job with some values changed, checked as a job file is.

    Raises
    ------
    InputError
        A setting is unknown or out of its limits, the values contradict each other, or no mask can hold them.
    """
    table = tomllib.loads(jobfile.dump(job))
    for name, value in settings.items():
        section, _, key = name.partition(".")
        part = table.setdefault(section, {})
        part[key] = list(value) if isinstance(value, tuple) else value
        if value is None and key in _keys(section):
            del part[key]
    found = jobfile.parse(jobfile.dump(jobfile.from_table(table, "cell")), "cell")
    if any(name.startswith(("channels.", "marks.", "output.")) for name in settings):
        refuse_unwritable(found)
    return found


def _keys(section: str) -> set[str]:
    """Names of a section's parameters in a job file; none where there is no such section."""
    return {jobfile.toml_name(f) for f in fields(SECTIONS[section])} if section in SECTIONS else set()


def job(cell: Any) -> Job:
    """What the cell's parameters say."""
    return job_of(cells.sections(cell).values())


def changes(former: Job, now: Job) -> dict[str, Any]:
    """The settings that lead from one job to another."""
    return {
        f"{section}.{jobfile.toml_name(f)}": getattr(getattr(now, section), f.name)
        for section in SECTIONS
        for f in fields(getattr(now, section))
        if getattr(getattr(now, section), f.name) != getattr(getattr(former, section), f.name)
    }


def set_parameters(cell: Any, settings: Settings) -> None:
    """Change parameters of a cell and recompute what depends on them; long work becomes stale.

    Raises
    ------
    InputError
        A setting is unknown, out of its limits, or driven by an expression; nothing is changed.
    """
    wanted = job_with(job(cell), settings)
    objects, changed = cells.sections(cell), changes(job(cell), wanted)
    _require_files(changed)
    for name, expression in driven(cell).items():
        if name in changed:
            msg = f"{name} is what the expression {expression} says; change what it names, or clear it"
            raise InputError(msg)
    for name in changed:
        section, _, key = name.partition(".")
        part, obj = getattr(wanted, section), objects[section]
        for prop in properties(SECTIONS[section]):
            if prop.field.rstrip("_") == key:
                prop.write(obj, getattr(part, prop.field))
                if FILES.get(section) == key:
                    _keep(obj, getattr(part, prop.field))
    cell.Document.recompute()


def driven(cell: Any) -> dict[str, str]:
    """Setting -> the expression that says its value."""
    found = {}
    for section, obj in cells.sections(cell).items():
        expressions = dict(obj.ExpressionEngine)
        for prop in properties(SECTIONS[section]):
            if prop.name in expressions:
                found[f"{section}.{prop.field.rstrip('_')}"] = expressions[prop.name]
    return found


def _require_files(settings: Settings) -> None:
    """Refuse names of files that are not there."""
    for section, key in FILES.items():
        name = settings.get(f"{section}.{key}")
        if name and not Path(name).is_file():
            msg = f"{section}.{key}: {name} does not exist; choose a {KINDS[section]} file"
            raise InputError(msg)


KINDS = {"target": "mesh", "material": "CSV"}
"""Section -> what its file is."""


def _keep(obj: Any, name: str) -> None:
    """Copy a file that a section names into the document."""
    if obj.Section == "target":
        obj.Source = None
    obj.File = name if name and Path(name).is_file() else ""


def design(cell: Any) -> None:
    """Solve the flat sheet, its director and twist; minutes.

    Raises
    ------
    LceError
        What the solver says.
    """
    work = child.done(works.design(cell, job(cell)))
    _take(cell, work.out)


def _take(cell: Any, out: Path) -> None:
    """Put the design of an output folder into the document, with what was found when it was solved."""
    manifest = read_manifest(out)
    manifest["findings"] = [found for found in manifest["findings"] if found["stage"] == "design"]
    document.take_design(cell, out / "design.npz", job(cell), json.dumps(manifest))
    cell.Document.recompute()


def _take_corrected(cell: Any, out: Path) -> None:
    """Put the design that was corrected for another film on the way to the files of ``out`` into the document."""
    if cells.design_of(cell).Status != CURRENT:
        _take(cell, out)


def predict(cell: Any) -> None:
    """Simulate the heating of the designed sheet; half a minute.

    Raises
    ------
    LceError
        There is no current design, or what the simulation says.
    """
    work = child.done(works.predict(cell, job(cell)))
    _take_corrected(cell, work.out)
    found = json.loads((work.out / "prediction.json").read_text(encoding="utf-8"))
    obj = document.add_result(cell, "Prediction")
    obj.File, obj.Verdict, obj.Mirrored = str(work.out / "prediction.npz"), found["verdict"], found["mirrored"]
    obj.Rms, obj.Max = found["rms_pct"], found["max_pct"]
    obj.Proxy.remember(obj)
    cell.Document.recompute()


def plates(cell: Any) -> None:
    """Add plates, spacer and film around the designed sheet.

    Raises
    ------
    InputError
        There is no design, or the parameters do not go together.
    """
    works.require_design(cell)
    document.add_bodies(cell)
    if source := cells.sections(cell)["target"].Source:
        source[0].Visibility = False  # it stands where the cell is, and may hide it
    cell.Document.recompute()


def channel_window(cell: Any, domains: tuple[int, ...] = ()) -> None:
    """Show the channels of some domains as solids; () shows the most central domain.

    Raises
    ------
    InputError
        There is no design, a domain does not exist, or the solids would be too many.
    """
    settings = {"output.step_domains": tuple(domains)}
    works.solids(cell, job_with(job(cell), settings))  # refuses domains that are not there
    set_parameters(cell, settings)
    document.add_window(cell)
    cell.Document.recompute()


def mask(cell: Any, folder: str) -> None:
    """Write the masks of both plates, below ``folder``.

    Raises
    ------
    LceError
        There is no current design, or what the check of the masks says.
    """
    work = child.done(works.mask(cell, job(cell), Path(folder)))
    _take_corrected(cell, work.out)
    _written(cell, "Mask", work.out)


def export(cell: Any, folder: str) -> None:
    """Write the job file and everything that `./lce build` makes of it, below ``folder``.

    Raises
    ------
    LceError
        There is no current design, or what a stage says.
    """
    work = child.done(works.export(cell, job(cell), Path(folder)))
    _take_corrected(cell, work.out)
    _written(cell, "Mask", work.out)


def inspect(cell: Any) -> None:
    """Check the cell in the document, list its parts with volumes and masses, and keep the findings; seconds.

    Raises
    ------
    InputError
        There is no design, or there are no plates.
    """
    works.require_bodies(cell)
    add_bill(cell)
    cell.Document.recompute()
    solved = json.loads(cells.design_of(cell).Manifest or '{"findings": []}')["findings"]
    document.take_findings(cell, solved + _measured(cell))
    _written(cell, "Review", "")


def _measured(cell: Any) -> list[dict[str, Any]]:
    """What is found in the bodies, if there are any."""
    return [as_record(finding, "cell") for finding in (inspected(cell) if works.bodies(cell) else ())]


def review(cell: Any, folder: str) -> None:
    """Write everything, review it, and list what was found.

    Raises
    ------
    LceError
        There is no current design, or what a stage says.
    """
    work = child.done(works.review(cell, job(cell), Path(folder)))
    _take_corrected(cell, work.out)
    found = json.loads((work.out / "manifest.json").read_text(encoding="utf-8"))["findings"]
    document.take_findings(cell, found + _measured(cell))
    _written(cell, "Review", work.out)


def _written(cell: Any, name: str, out: Path | str) -> None:
    obj = document.add_result(cell, name)
    obj.Folder = str(out)
    obj.Proxy.remember(obj)
    cell.Document.recompute()


def drawings(cell: Any, folder: str = "") -> None:
    """Add the fabrication drawings to the document, or write them as PDF, SVG and DXF to a folder.

    A script calls ``lce_workbench.app.drawings.hidden_window()`` before it makes or opens the document.

    Raises
    ------
    LceError
        There is no current design, TechDraw does not work, or the folder cannot be written.
    """
    from lce_workbench.app import drawings as pages

    works.require_design(cell)
    pages.require_window(cell.Document)
    made = pages.add_pages(cell)
    if folder:
        with told(Path(folder)):
            Path(folder).mkdir(parents=True, exist_ok=True)
            pages.export(made, Path(folder))


EXAMPLES: dict[str, Settings] = {
    "Face": {"target.surface": "face", "sheet.width_mm": 20.0},
    "Dome": {"target.surface": "dome", "sheet.width_mm": 12.0, "domains.size_um": 400.0},
    "Saddle": {"target.surface": "saddle", "sheet.width_mm": 12.0, "sheet.gap_um": 150.0},
    "Leaf": {"target.surface": "leaf", "sheet.width_mm": 15.0, "domains.size_um": 300.0},
}
"""Name -> settings of a cell to start from."""


def example(doc: Any, name: str) -> Any:
    """Add one of the examples to a document, ready to be designed.

    Raises
    ------
    InputError
        There is no such example.
    """
    if name not in EXAMPLES:
        msg = f"example {name!r} is unknown; there are {', '.join(EXAMPLES)}"
        raise InputError(msg)
    cell = new_cell(doc, EXAMPLES[name])
    cell.Label = name
    return cell
