"""Pictures of the masks as the microscope will show them, seen from above: overview, zooms, both plates overlaid."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
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

BORDER = 0.02
"""Side of the picture of a border between domains [mm]."""


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
    views = {
        "domain.png": (Rect(x0, y0, x1, y1), (0.0, 0.0)),
        "border.png": (_around((corner[0] + corner[1]) / 2, BORDER), (0.0, 0.0)),
        "overlay.png": (_around(frame.marks[0], MARK_BOX), mismatch),
    } | {
        f"cluster {place}.png".replace(" ", "_"): (_around(at, MARK_BOX), (0.0, 0.0))
        for place, at in zip(PLACES, frame.marks, strict=True)
    }
    seen = {name: {plate: list[Floats]() for plate in masks} for name in views}
    for plate, mask in masks.items():
        for polygons in _polygons(mask):  # one pass for all pictures: a large plate is never in memory
            low, high = polygons.min(axis=1), polygons.max(axis=1)
            for name, (view, _) in views.items():
                inside = np.all((high >= [view.x0, view.y0]) & (low <= [view.x1, view.y1]), axis=1)
                seen[name][plate].extend(polygons[inside])
    for name, (view, shift) in views.items():
        shifts = {"bottom": (0.0, 0.0), "top": shift}
        _save(_zoom(view, {p: np.array(q).reshape(-1, 4, 2) + shifts[p] for p, q in seen[name].items()}), folder / name)


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

    figure, axes = _figure(frame.plate)
    coloured = PolyCollection(domains.corners, array=np.degrees(domains.theta), cmap="hsv", clim=(0, 180), lw=0)
    axes.add_collection(coloured)
    figure.colorbar(coloured, ax=axes, label="director [degrees]", shrink=0.7)
    for ring, look in (
        (frame.plate.ring, {"fill": False}),
        (frame.fill.ring, {"fill": False, "ls": ":"}),
        *((strip.ring, {"color": "0.8"}) for strip in frame.strips),
        *((_around(at, MARK_BOX).ring, {"color": "0.3"}) for at in frame.marks),
        *((band.ring, {"fill": False, "ls": "--", "ec": "0.6"}) for band in frame.bands),
    ):
        axes.add_patch(Polygon(ring, **look))
    axes.set(xlabel="x [mm]", ylabel="y [mm]")
    return figure


def _zoom(view: Rect, polygons: Mapping[Plate, Floats]) -> Figure:
    """Both plates' channels or marks in ``view``, in um from its middle."""
    from matplotlib.collections import PolyCollection

    middle = np.array([view.x0 + view.x1, view.y0 + view.y1]) / 2
    figure, axes = _figure(Rect(*((view.ring[[0, 2]] - middle) / UM).ravel()))
    for plate, shapes in polygons.items():
        axes.add_collection(PolyCollection((shapes - middle) / UM, color=COLOURS[plate], alpha=0.5, lw=0, label=plate))
    axes.set(xlabel="x [um]", ylabel="y [um]")
    figure.legend(loc="outside upper center", ncols=2)
    return figure


def _figure(view: Rect) -> tuple[Figure, Any]:
    from matplotlib.figure import Figure

    figure = Figure(figsize=(9, 9 * min(max(view.size[1] / view.size[0], 0.4), 1.5)), layout="constrained")
    axes = figure.add_subplot(aspect="equal", xlim=(view.x0, view.x1), ylim=(view.y0, view.y1))
    return figure, axes


def _save(figure: Figure, path: Path) -> None:
    """Without a date or version, so that the bytes depend on the picture alone."""
    figure.savefig(path, dpi=240, metadata={"Software": None})
