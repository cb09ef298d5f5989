"""Older documents: each step turns an object of one schema version into the next. Steps may find their work done."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

from lce_workbench.core import jobfile


def migrate(obj: Any) -> None:
    """Bring a restored object up to the present schema."""
    kind = type(obj.Proxy).__name__
    for version in range(getattr(obj, "SchemaVersion", 1), len(STEPS) + 1):
        STEPS[version - 1].get(kind, _nothing)(obj)
        obj.SchemaVersion = version + 1


def _nothing(_: Any) -> None:
    """What a step does to most objects."""


def _parameters_2(obj: Any) -> None:
    """Labels name the thing itself: "Sheet parameters" became "Sheet"."""
    from lce_workbench.app.objects import LABELS

    former = obj.Section.capitalize()
    if former == "Marks":  # whose printed label was the object's own
        obj.addProperty("App::PropertyString", "PrintedLabel", former, "")
        obj.PrintedLabel = obj.Label.removesuffix("Marks parameters")
        obj.Label = former
    elif obj.Label == f"{former} parameters":
        obj.Label = LABELS.get(obj.Section, former)


def _design_2(obj: Any) -> None:
    """The whole job was noted as a nested table without the gap; now it is a job file."""
    import numpy as np

    if not obj.MadeFor or "target" not in json.loads(obj.MadeFor):
        return
    table = json.loads(obj.MadeFor)
    with np.load(str(Path(obj.File)), allow_pickle=False) as data:
        table["sheet"]["gap_um"] = round(float(data["thickness"]) * 1e3, 9)
    given = {
        section: {name.rstrip("_"): value for name, value in values.items() if value is not None}
        for section, values in table.items()
    }
    job = jobfile.from_table(given)
    obj.addProperty("App::PropertyString", "Job", "Cell", "The job that it was solved for")
    obj.setEditorMode("Job", 2)
    obj.Job = jobfile.dump(job)
    obj.MadeFor = json.dumps(jobfile.metric_values(job))


def _body_2(obj: Any) -> None:
    """Only what shapes a body makes it recompute."""
    from lce_workbench.app.objects import CELL_SECTIONS, SHAPED_BY

    wanted = SHAPED_BY.get(obj.Prisms, CELL_SECTIONS)
    obj.Parameters = [section for section in obj.Parameters if section.Section in wanted]


def _body_3(obj: Any) -> None:
    """The volume became a property, which the bill of materials reads."""
    obj.addProperty("App::PropertyVolume", "Volume", "Cell", "Volume as built")
    obj.setEditorMode("Volume", 1)
    obj.Volume = obj.Shape.Volume


def _result_4(obj: Any) -> None:
    """The twist depends on how it is corrected; and what a result is not made from does not make it stale."""
    from lce_workbench.app import cells

    linked = [section.Section for section in obj.Parameters]
    if "prediction" not in linked:
        obj.Parameters = [*obj.Parameters, cells.sections(cells.cell_of(obj))["prediction"]]
    if hasattr(obj.Proxy, "USES") and obj.MadeFor:
        kept = obj.Proxy.values(obj).keys()
        obj.MadeFor = json.dumps({name: value for name, value in json.loads(obj.MadeFor).items() if name in kept})


STEPS: tuple[dict[str, Callable[[Any], None]], ...] = (
    {"Parameters": _parameters_2, "DesignData": _design_2, "Body": _body_2},
    {"Body": _body_3},
    {"DesignData": _result_4, "PredictionData": _result_4, "MaskData": _result_4},
)
"""From schema 1 to 2, and so on: class of a proxy -> what is done."""
