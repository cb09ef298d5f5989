"""What the 3D view shows besides the document: pictures of the design, marked domains, the cell apart or cut open.

    from lce_workbench.gui import scene
    scene.show(cell, "directors")       # or "target", "deviation", "channels_bottom", "channels_top"; "" for the cell
    scene.mark(cell, (3, 5))            # what the domain table has selected
    scene.explode(cell, True)
    scene.section(cell, 0.0)            # at y = 0 mm; None closes the cell again

Nothing of it is in the document: nothing is saved, nothing becomes stale, and there is nothing to undo.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import FreeCAD
import numpy as np

from lce_solver.errors import InputError, LceError
from lce_workbench.app import cells, works
from lce_workbench.app.objects import prisms_around
from lce_workbench.app.pictures import PICTURES
from lce_workbench.gui.camera import ABOVE, ASLANT, FRONT, frame, look_at, turn, view_of
from lce_workbench.gui.stage import WATCHERS, Scene

GAPS = 25.0
"""Height of the view over the gap when the cell is cut open."""


def show(cell: Any, name: str) -> None:
    """Show a picture of `PICTURES`, or the cell itself for "".

    Raises
    ------
    LceError
        There is no such picture, or it needs what is not computed yet.
    """
    if name and name not in PICTURES:
        msg = f"there is no picture {name!r}; there are {', '.join(PICTURES)}"
        raise InputError(msg)
    scene = of(cell)
    if name and not scene.name:
        scene.camera = scene.view.getCamera()
    scene.name, former = name, scene.name
    scene.draw()
    if name:
        turn(scene.view, ABOVE if name.startswith("channels") else ASLANT)
        fit(scene)
    elif former and scene.camera:
        scene.view.setCamera(scene.camera)


def fit(scene: Scene) -> None:
    """Move the camera, as it is turned, so that it sees the whole picture beside its legend."""
    frame(scene.view, np.concatenate([skin.points for skin in scene.skins()]))


def explode(cell: Any, exploded: bool = True) -> None:
    """Take the cell apart, or put it together; no placement changes.

    Raises
    ------
    LceError
        The cell has no plates yet.
    """
    scene = _with_plates(cell)
    scene.exploded = exploded
    scene.draw()
    scene.view.fitAll()


def section(cell: Any, y: float | None = 0.0) -> None:
    """Cut the cell open at ``y`` [mm] and look into the gap; `None` closes it.

    Raises
    ------
    LceError
        The cell has no plates yet.
    """
    scene = _with_plates(cell)
    scene.cut_at = y
    scene.draw()
    if y is None or scene.exploded:
        scene.view.fitAll()
        return
    turn(scene.view, FRONT)
    look_at(scene.view, (window_place(cell)[0], y, 0.0), GAPS * scene.shown().job.sheet.thickness)


def window_place(cell: Any) -> tuple[float, float]:
    """The middle of the first domain of the channel window, where a section shows channels; else that of the sheet."""
    around = prisms_around(cell)
    if not around.chosen:
        return 0.0, 0.0
    x, y = around.domains.centroid[around.chosen[0]].tolist()
    return x, y


def mark(cell: Any, domains: Iterable[int], *, go: bool = False) -> None:
    """Mark domains in the view, and select them in the table; ``go`` turns the camera to them.

    Raises
    ------
    InputError
        There is no such domain, or no design.
    """
    of(cell).mark(tuple(domains), go=go)


def of(cell: Any) -> Scene:
    """The scene of a cell; it is made when there is none, or when its view was closed."""
    name = cell.Document.Name, cell.Name
    former = SCENES.get(name)
    if former and int(former.graph.this) == int(view_of(cell.Document).getSceneGraph().this):
        return former
    if not FOLLOWING:
        FOLLOWING.append(Follow())
        FreeCAD.addDocumentObserver(FOLLOWING[0])
    SCENES[name] = scene = Scene(cell)
    if former:
        former.leave()
        scene.picking = former.picking
    return scene


def _with_plates(cell: Any) -> Scene:
    """The scene of a cell that shows the cell itself."""
    works.require_design(cell)
    scene = of(cell)
    if not works.bodies(cell):
        msg = f"{cell.Label} has no plates yet; run Plates and Spacer first"
        raise InputError(msg)
    if scene.name:
        show(cell, "")
    return scene


class Follow:
    """Draws scenes anew when their document changes."""

    def slotRecomputedDocument(self, doc: Any) -> None:  # noqa: N802  FreeCAD's name
        """Parameters changed, or something was computed."""
        for name, scene in list(SCENES.items()):
            if name[0] != doc.Name:
                continue
            design = doc.getObject(name[1]) and cells.result(scene.cell, "DesignData")
            if design is None or not design.File:
                _forget(name).close()
                continue
            try:
                if any("Invalid" in obj.State for obj in cells.sections(scene.cell).values()):
                    continue  # the solids stay as they were, too
                if scene.key != scene.made_for():
                    scene.draw()
            except LceError as fault:
                FreeCAD.Console.PrintWarning(f"LCE Mold: {fault}\n")
            for watcher in WATCHERS:
                watcher(scene)

    slotUndoDocument = slotRedoDocument = slotRecomputedDocument

    def slotDeletedDocument(self, doc: Any) -> None:  # noqa: N802  FreeCAD's name
        """Forget the scenes of a document that is closed."""
        for name in [name for name in SCENES if name[0] == doc.Name]:
            _forget(name)


def _forget(name: tuple[str, str]) -> Scene:
    """Take leave of a cell that is gone."""
    scene = SCENES.pop(name)
    scene.gone = True
    for watcher in WATCHERS:
        watcher(scene)
    return scene


FOLLOWING: list[Follow] = []
"""Who follows documents, once there was a scene."""

SCENES: dict[tuple[str, str], Scene] = {}
"""Names of document and cell -> scene."""
