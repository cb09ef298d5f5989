"""The panel of an object that is double-clicked."""

from __future__ import annotations

from dataclasses import fields
from typing import Any

import FreeCADGui

from lce_workbench.app import cells
from lce_workbench.app.objects import LABELS, SECTIONS
from lce_workbench.core import jobfile
from lce_workbench.gui import findings
from lce_workbench.gui.commands import show
from lce_workbench.gui.steps import STEPS, Step

STEP_OF = {"DesignData": "Design", "PredictionData": "Predict", "MaskData": "Mask", "ReviewData": "Review"}
"""Class of an object -> the step that makes it."""


def edit(obj: Any) -> bool | None:
    """Open the panel; `None` where FreeCAD's own editing is as good."""
    if FreeCADGui.Control.activeDialog():
        return False
    if cells.kind_of(obj) == "ReviewData" and obj.Records:
        findings.show(cells.cell_of(obj))
        return False  # nothing stays in edit mode
    step = _step(obj)
    if step is None:
        return None
    show(step, obj.Document, cells.cell_of(obj))
    return True


def _step(obj: Any) -> Step | None:
    kind = cells.kind_of(obj)
    if kind == "Parameters":
        return section_step(obj.Section)
    wanted = STEP_OF.get(kind) or ("ChannelWindow" if obj.Prisms.startswith("channels") else "Plates")
    return next(step for step in STEPS if step.name == wanted)


def section_step(section: str) -> Step:
    """A step that only changes one section."""
    title = LABELS.get(section, section.capitalize())
    names = tuple(f"{section}.{jobfile.toml_name(f)}" for f in fields(SECTIONS[section]))
    return Step(f"Edit{section.capitalize()}", "", title, "", "parameters", title, common=names)
