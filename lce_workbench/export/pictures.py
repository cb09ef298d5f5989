"""Pictures of the masks as the microscope will show them, seen from above: overview, zooms, both plates overlaid."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from lce_solver.types import Floats
from lce_workbench.core.align import PLACES
from lce_workbench.core.domains import Domains, Plate
from lce_workbench.core.frame import MARK_BOX, Frame, Rect
from lce_workbench.core.mask import EXPOSED, Mask, flipped
from lce_workbench.core.units import NM, UM

if TYPE_CHECKING:
    from matplotlib.figure import Figure

COLOURS: dict[Plate, str] = {"bottom": "tab:blue", "top": "tab:red"}

MARK_INK = 0.9
"""Opacity of marks: see `View.ink`."""

BORDER = 0.02
"""Side of the picture of a border between domains [mm]."""

LARGEST, LEAST = (8.0, 11.0), 3.0
"""Width and height that a picture's axes may have, and the least of either [inch]."""

MARGIN, BAR = 1.0, 1.4
"""Beside and below the axes, and for a colour bar [inch]."""


@dataclass(frozen=True)
class View:
    """What a picture shows."""

    region: Rect
    title: str
    shift: tuple[float, float] = (0.0, 0.0)
    """How far the top plate is shifted [mm]."""
    ink: float = 0.5
    """Opacity; the marks' gratings are too fine to be resolved, and need more than the channels close by."""


def write_pictures(
    frame: Frame, domains: Domains, masks: Mapping[Plate, Mask], folder: Path, mismatch: tuple[float, float]
) -> None:
    """Write `overview.png`, `border.png`, `domain.png`, a picture of each cluster and `overlay.png`.

    Parameters
    ----------
    mismatch : how far the top plate is shifted in `overlay.png` [mm].

    Raises
    ------
    OSError
        A file cannot be written.
    """
    _save(_overview(frame, domains), folder / "overview.png")
    middle = int(np.argmin(np.linalg.norm(domains.centroid - domains.centroid.mean(axis=0), axis=1)))
    corner = domains.corners[middle]
    (x0, y0), (x1, y1) = corner.min(axis=0), corner.max(axis=0)
    x, y = mismatch
    shifted = f"lower left, top plate shifted by ({x / UM:g}, {y / UM:g}) um"
    views = {
        "domain.png": View(Rect(x0, y0, x1, y1), f"domain {middle}"),
        "border.png": View(_around((corner[0] + corner[1]) / 2, BORDER), f"border of domain {middle}"),
        "overlay.png": View(_around(frame.marks[0], MARK_BOX), shifted, mismatch, MARK_INK),
    } | {
        f"cluster {place}.png".replace(" ", "_"): View(_around(at, MARK_BOX), place, ink=MARK_INK)
        for place, at in zip(PLACES, frame.marks, strict=True)
    }
    seen = {name: {plate: list[Floats]() for plate in masks} for name in views}
    for plate, mask in masks.items():
        for polygons in _polygons(mask):  # one pass for all pictures: a large plate is never in memory
            low, high = polygons.min(axis=1), polygons.max(axis=1)
            for name, view in views.items():
                start, end = view.region.ring[[0, 2]]
                inside = np.all((high >= start) & (low <= end), axis=1)
                seen[name][plate].extend(polygons[inside])
    for name, view in views.items():
        shapes = {plate: np.array(found).reshape(-1, 4, 2) for plate, found in seen[name].items()}
        _save(_zoom(view, shapes, domains), folder / name)


def _polygons(mask: Mask) -> Iterator[Floats]:
    """What is exposed, back in sheet coordinates, in runs (n, 4, 2) [mm]."""
    for polygons in (group for name in EXPOSED for group in mask.layers[name] if len(group)):
        yield (flipped(polygons) if mask.plate == "top" else polygons) * NM


def _around(at: Floats, side: float) -> Rect:
    return Rect(at[0] - side / 2, at[1] - side / 2, at[0] + side / 2, at[1] + side / 2)


def _overview(frame: Frame, domains: Domains) -> Figure:
    """The plate: domains coloured by the director's angle, marks, strips, filled area."""
    from matplotlib.collections import PolyCollection
    from matplotlib.patches import Polygon

    figure, axes = _figure(frame.plate, BAR)
    coloured = PolyCollection(domains.corners, array=np.degrees(domains.theta), cmap="hsv", clim=(0, 180), lw=0)
    axes.add_collection(coloured)
    figure.colorbar(coloured, ax=axes, label="director [degrees]", shrink=0.7, aspect=30)
    for ring, look in (
        (frame.plate.ring, {"fill": False}),
        (frame.fill.ring, {"fill": False, "ls": ":"}),
        *((strip.ring, {"color": "0.8"}) for strip in frame.strips),
        *((_around(at, MARK_BOX).ring, {"color": "0.3"}) for at in frame.marks),
        *((band.ring, {"fill": False, "ls": "--", "ec": "0.6"}) for band in frame.bands),
    ):
        axes.add_patch(Polygon(ring, **look))
    for place, (x, y) in zip(PLACES, frame.marks, strict=True):
        side, va = (-1, "top") if place.startswith("lower") else (1, "bottom")
        at = (x, y + side * MARK_BOX / 2)
        axes.annotate(place, at, (0, 2 * side), textcoords="offset points", ha="center", va=va, size=6)
    axes.set(xlabel="x [mm]", ylabel="y [mm]")
    return figure


def _zoom(view: View, polygons: Mapping[Plate, Floats], domains: Domains) -> Figure:
    """Both plates' channels or marks and the domains' borders in ``view``, in um from its middle."""
    from matplotlib.collections import PolyCollection

    (x0, y0), (x1, y1) = view.region.ring[[0, 2]]
    middle = np.array([x0 + x1, y0 + y1]) / 2
    figure, axes = _figure(Rect(*((view.region.ring[[0, 2]] - middle) / UM).ravel()))
    shifts = {"bottom": (0.0, 0.0), "top": view.shift}
    for plate, shapes in polygons.items():
        corners, colour = (shapes + shifts[plate] - middle) / UM, COLOURS[plate]
        drawn = PolyCollection(corners, color=colour, alpha=view.ink, lw=0, label=plate, snap=False)  # lines keep width
        axes.add_collection(drawn)
    axes.add_collection(PolyCollection((domains.corners - middle) / UM, fc="none", ec="0.3", lw=0.5))
    axes.set(xlabel="x [um]", ylabel="y [um]")
    figure.legend(loc="outside upper center", ncols=2, title=view.title)
    return figure


def _figure(view: Rect, beside: float = 0.0) -> tuple[Figure, Any]:
    """A figure that its axes fill, but for ``beside`` [inch] on the right."""
    from matplotlib.figure import Figure

    width, height = np.maximum(np.array(view.size) * min(np.array(LARGEST) / view.size), LEAST) + MARGIN
    figure = Figure(figsize=(width + beside, height), layout="constrained")
    axes = figure.add_subplot(aspect="equal", xlim=(view.x0, view.x1), ylim=(view.y0, view.y1))
    return figure, axes


def _save(figure: Figure, path: Path) -> None:
    """Without a date or version, so that the bytes depend on the picture alone."""
    figure.savefig(path, dpi=160, metadata={"Software": None})
