"""The steps of the work as the window offers them: one table for commands, panels, pictures and words."""

from __future__ import annotations

import tomllib
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

from lce_workbench import ROOT
from lce_workbench.app import cells, works
from lce_workbench.app.child import Work
from lce_workbench.core.job import Job

Planned = Callable[[Any, Job, Path], Work]


@dataclass(frozen=True)
class Step:
    """One command."""

    name: str
    """The command is LCE_<name>."""
    call: str
    """Function of `lce_workbench.app.session`."""
    menu: str
    tip: str
    icon: str
    title: str
    """Name of the undo step."""
    common: tuple[str, ...] = ()
    """Parameters that are shown at once."""
    more: tuple[str, ...] = ()
    """Sections whose other parameters are behind "More"."""
    presets: str = ""
    """Table of resources/presets.toml."""
    work: Planned | None = None
    """Long work that is done before anything changes."""
    folder: bool = False
    """Whether files are written to a folder that the user chooses."""
    new: bool = False
    """Whether it makes a cell; the others need one."""
    panel: bool = True
    makes: str = ""
    """Class of the result that tells what came out."""
    after: Callable[[Any], None] = lambda _: None
    """Shows the result of the cell in the window."""


def _first_page(cell: Any) -> None:
    """Open the first drawing."""
    import FreeCADGui

    from lce_workbench.app.drawings import pages_of

    for page in pages_of(cells.design_of(cell))[:1]:
        page.ViewObject.doubleClicked()
        FreeCADGui.updateGui()
        FreeCADGui.SendMsgToActiveView("ViewFit")


def _findings(cell: Any) -> None:
    """Open the list of findings."""
    from lce_workbench.gui.findings import show

    show(cell)


STEPS = (
    Step(
        "NewCell", "new_cell", "New Cell…", "Starts a cell: the surface to make, the material, the size of the sheet",
        "new-cell", "New cell",
        common=("target.mesh", "target.surface", "material.preset", "sheet.width_mm", "sheet.gap_um",
                "domains.size_um"),
        more=("target", "material", "sheet"), presets="spacer", new=True,
    ),
    Step(
        "Design", "design", "Design…", "Solves the flat sheet, its director and its twist for the target",
        "design", "Design",
        common=("sheet.width_mm", "sheet.gap_um", "domains.size_um", "solver.starts"),
        more=("target", "material", "sheet", "domains", "solver"), presets="spacer",
        work=lambda cell, job, _: works.design(cell, job), makes="DesignData",
    ),
    Step(
        "Predict", "predict", "Predict…", "Simulates the heating of the sheet and compares it with the target",
        "predict", "Predict",
        common=("prediction.seed",), more=("prediction",), work=lambda cell, job, _: works.predict(cell, job),
        makes="PredictionData",
    ),
    Step(
        "Plates", "plates", "Plates and Spacer…", "Adds the two plates, the spacer and the film around the sheet",
        "plates", "Plates and spacer",
        common=("channels.depth_um", "plates.glass_mm", "plates.epoxy_um", "spacer.strip_mm"),
        more=("plates", "spacer", "marks", "channels"), presets="plates",
    ),
    Step(
        "ChannelWindow", "channel_window", "Channel Window…", "Shows the channels of the domains you name as solids",
        "channels", "Channel window",
        common=("output.step_domains", "channels.width_um", "channels.spacing_um", "channels.depth_um"),
        more=("channels",), presets="channels",
    ),
    Step(
        "Mask", "mask", "Mask…", "Writes the masks of both plates for the laser writer",
        "mask", "Mask",
        common=("output.masks", "output.writer_um", "marks.label"), more=("marks", "output"), presets="writer",
        work=works.mask, folder=True, makes="MaskData",
    ),
    Step(
        "Drawings", "drawings", "Drawings", "Adds the fabrication drawings of the cell to the document",
        "drawings", "Drawings", panel=False, after=_first_page,
    ),
    Step(
        "Inspect", "inspect", "Design Review", "Checks the cell, lists its parts and masses, and shows what was found",
        "inspect", "Design review", panel=False, makes="ReviewData",
        after=_findings,
    ),
    Step(
        "Review", "review", "Review…", "Writes all files, reads them back and lists what was found",
        "review", "Review", work=works.review, folder=True,
        makes="ReviewData", after=_findings,
    ),
    Step(
        "Export", "export", "Export…", "Writes everything: table, masks, CAD files and report, as ./lce build does",
        "export", "Export",
        common=("output.masks",), more=("output",), work=works.export, folder=True,
        makes="MaskData",
    ),
)  # fmt: skip
"""In the order of the work."""


@cache
def presets() -> dict[str, dict[str, dict[str, Any]]]:
    """Table -> name -> settings."""
    return tomllib.loads((ROOT / "resources" / "presets.toml").read_text(encoding="utf-8"))
