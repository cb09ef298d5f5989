"""Where the 3D view looks."""

from __future__ import annotations

from typing import Any

import FreeCADGui
import numpy as np
from pivy import coin

from lce_solver.errors import InputError
from lce_solver.types import Floats
from lce_workbench.gui.legend import WIDTH

MARGIN = 1.15
"""Height of the view over what a picture needs."""

ABOVE = (0.0, 0.0, 0.0, 1.0)
ASLANT = (0.42, 0.0, 0.0, 0.9075)
FRONT = (0.7071068, 0.0, 0.0, 0.7071068)
"""How the camera is turned: from above, from the front and above, from the front."""


def view_of(doc: Any) -> Any:
    """The 3D view of a document.

    Raises
    ------
    InputError
        It has none.
    """
    views = FreeCADGui.getDocument(doc.Name).mdiViewsOfType("Gui::View3DInventor")
    if not views:
        msg = f"{doc.Label} has no 3D view; open one with Window, New window"
        raise InputError(msg)
    return views[0]


def turn(view: Any, orientation: tuple[float, float, float, float]) -> None:
    """Turn the camera at once: FreeCAD's own commands move it bit by bit, and where it is meanwhile would count."""
    view.getCameraNode().orientation = orientation


def frame(view: Any, points: Floats) -> None:
    """Move the camera, as it is turned, so that it sees all ``points`` (n, 3), and room for the legend beside them."""
    rotation = view.getCameraNode().orientation.getValue()
    right, up = (np.array(rotation.multVec(coin.SbVec3f(*axis)).getValue()) for axis in ((1, 0, 0), (0, 1, 0)))
    wide, tall = view.getSize()
    spans = [np.ptp(points @ axis) for axis in (right, up)]
    seen = [(points @ axis).max() + (points @ axis).min() for axis in (right, up)]
    middle = points.mean(axis=0)
    middle += sum((total / 2 - middle @ axis) * axis for total, axis in zip(seen, (right, up), strict=True))
    free = max(wide - 2 * WIDTH, wide / 2)
    look_at(view, middle, MARGIN * max(spans[1], spans[0] * tall / free))


def look_at(view: Any, middle: Any, height: float) -> None:
    """Move the camera, as it is turned, so that ``middle`` (3,) is in the middle of a view of this ``height`` [mm]."""
    camera = view.getCameraNode()
    if view.getCameraType() == "Orthographic":
        camera.height, distance = height, max(height, camera.focalDistance.getValue())
    else:
        distance = height / 2 / np.tan(camera.heightAngle.getValue() / 2)
    back = camera.orientation.getValue().multVec(coin.SbVec3f(0, 0, 1)).getValue()
    camera.position = [float(at + distance * step) for at, step in zip(middle, back, strict=True)]
    camera.focalDistance = distance
