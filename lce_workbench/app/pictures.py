"""What the 3D view shows of a design besides its solids, as arrays: skins, lines and the scale of their colours."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from lce_solver.errors import InputError
from lce_solver.topology import edge_table
from lce_solver.types import Design, Floats, Ints, line_angle
from lce_workbench.app.colours import Scale
from lce_workbench.app.skins import Skin
from lce_workbench.core.channels import ChannelField, Channels, joined
from lce_workbench.core.domains import Domains, Plate, signed_area
from lce_workbench.core.job import Job
from lce_workbench.packages import needed

PALE, INK = (0.93, 0.94, 0.96), (0.20, 0.23, 0.27)
"""Of a sheet without values, and of borders."""

BESIDE = 0.12
"""Room between the flat sheet and the target to its right, over their mean width."""

STICK = 0.95
"""Half a director's line over the distance from its triangle's middle to the nearest side: it stays inside."""

TINT = 0.6
"""How much of its colour the largest twist gives to its triangle: so it is seen from afar, where lines are short."""

TILES = 12
"""Channels are drawn in so many tiles across the sheet, so that those out of sight cost nothing."""


@dataclass(frozen=True, eq=False)
class Shown:
    """What there is to be shown."""

    design: Design
    domains: Domains
    job: Job
    hot: Floats | None = None
    """(n_v, 3) the shape of the heated sheet, where it was simulated [mm]."""
    stale: bool = False
    """Whether it was made for other parameters."""


@dataclass(frozen=True, eq=False)
class Strokes:
    """Lines that are drawn together."""

    ends: NDArray[np.float32]
    """(2 n, 3) both ends of each line, one after the other [mm]."""
    colours: NDArray[np.float32]
    """(n, 3) red, green, blue in [0, 1]; (1, 3) for all."""
    width: float = 1.0
    """[pixels]"""

    def __len__(self) -> int:
        return len(self.ends) // 2


@dataclass(frozen=True, eq=False)
class Picture:
    """One thing to look at."""

    title: str
    skins: tuple[Skin, ...]
    strokes: tuple[Strokes, ...]
    scale: Scale
    stale: bool = False
    count: int = 0
    """Of channels."""


def target(shown: Shown) -> Picture:
    """The flat sheet and beside it the target, each place in the colour of its director."""
    scale = Scale("director θ", "°", 0.0, 180.0, "cyclic")
    colours = scale.colours(np.degrees(line_angle(shown.design.theta)))
    skins = flat_skin(shown.design, colours), target_skin(shown.design, colours)
    return Picture("Target and flat sheet", skins, _rims(skins), scale, shown.stale)


def directors(shown: Shown) -> Picture:
    """The directors on the flat sheet and on the target, in the colour of the twist from the bottom to the top."""
    design = shown.design
    twist = np.degrees(design.dtheta)
    most = float(np.abs(twist).max()) or 1.0
    scale = Scale("twist Δθ", "°", -most, most, "signed")
    colours, faces = scale.colours(twist), np.repeat(np.arange(len(twist)), 2)
    tints = PALE + TINT * (np.abs(twist) / most)[:, None] * (colours - PALE)
    skins = flat_skin(design, tints), target_skin(design, tints)
    ends = sticks(design)
    lines = [Strokes(skin.lift(ends, faces).astype(np.float32), colours, width=2.0) for skin in skins]
    return Picture("Directors", skins, (*lines, *_rims(skins)), scale, shown.stale)


def deviation(shown: Shown) -> Picture:
    """The shape of the heated sheet in the colour of its distance from the target, whose border is drawn with it.

    Raises
    ------
    InputError
        The heating was not simulated yet.
    EnvironmentFault
        SciPy is missing.
    """
    if shown.hot is None:
        msg = "the heating of this design is not simulated yet; run Predict first"
        raise InputError(msg)
    with needed():
        from lce_solver.compare import align, vertex_areas
    design, aim = shown.design, shown.design.surface.vertices
    laid = align(shown.hot, aim, vertex_areas(aim, design.surface.faces))
    away = 1000 * laid.distance
    scale = Scale("distance from the target", "µm", 0.0, float(away.max()), "sequential")
    skin = Skin(laid.moved, design.surface.faces, design.uv, scale.colours(away))
    rim = _lines(aim[rim_of(design.surface.faces)], INK, 2.0)
    return Picture("Predicted shape", (skin,), (rim,), scale, shown.stale)


def channels(shown: Shown, plate: Plate) -> Picture:
    """All channels of a plate, seen from above, in the colour of their direction, and the borders of the domains.

    Raises
    ------
    InputError
        No domain is large enough for a single channel.
    """
    field = ChannelField(shown.domains, plate, shown.job.channels)
    scale = Scale("channel direction", "°", 0.0, 180.0, "cyclic")
    colours = scale.colours(np.degrees(shown.domains.angle(plate)))
    every = joined(list(field))
    tiled = tuple(_tile(every, rows, colours) for rows in tiles(shown.domains, every.domain))
    rings = [_closed(ring) for _, ring in shown.domains.rings()]
    borders = _lines(_raised(np.concatenate([ring.reshape(-1, 2) for ring in rings])), INK, 1.0)
    return Picture(TITLES[plate], (flat_skin(shown.design),), (*tiled, borders), scale, shown.stale, len(every))


TITLES: dict[Plate, str] = {"bottom": "Channels, bottom plate", "top": "Channels, top plate"}

PICTURES: dict[str, Callable[[Shown], Picture]] = {
    "target": target,
    "directors": directors,
    "deviation": deviation,
    "channels_bottom": lambda shown: channels(shown, "bottom"),
    "channels_top": lambda shown: channels(shown, "top"),
}
"""Name -> what makes it."""


def flat_skin(design: Design, colours: Floats | None = None) -> Skin:
    """The flat sheet where it lies in the cell, at z = 0."""
    return _skin(design, _raised(design.uv), colours)


def target_skin(design: Design, colours: Floats | None = None) -> Skin:
    """The target beside the flat sheet, standing on its plane."""
    points, width = design.surface.vertices, float(np.ptp(design.uv[:, 0]))
    low, high = points.min(axis=0), points.max(axis=0)
    shift = design.uv[:, 0].max() + BESIDE * (width + high[0] - low[0]) / 2
    return _skin(design, points - [low[0] - shift, (low[1] + high[1]) / 2, low[2]], colours)


def _skin(design: Design, points: Floats, colours: Floats | None) -> Skin:
    plain = np.array([PALE], dtype=np.float32)
    return Skin(points, design.surface.faces, design.uv, plain if colours is None else colours)


def sticks(design: Design) -> Floats:
    """(2 n_f, 2) both ends of the line that shows each triangle's director on the flat sheet [mm]."""
    corners = design.uv[design.surface.faces]
    longest = np.linalg.norm(np.roll(corners, -1, axis=1) - corners, axis=2).max(axis=1)
    nearest = np.abs(signed_area(corners)) * 2 / 3 / longest
    reach = (STICK * nearest)[:, None] * np.stack([np.cos(design.theta), np.sin(design.theta)], axis=1)
    middle = corners.mean(axis=1)
    return np.stack([middle - reach, middle + reach], axis=1).reshape(-1, 2)


def tiles(domains: Domains, owners: Ints) -> list[Ints]:
    """Rows of channels of ``owners`` (n,) that lie near each other."""
    place = domains.centroid
    low, size = place.min(axis=0), np.maximum(np.ptp(place, axis=0), np.finfo(float).tiny)
    cell = np.minimum((place - low) / size.max() * TILES, TILES - 1).astype(np.int16)
    key = (cell[:, 0] * TILES + cell[:, 1])[owners]
    order = np.argsort(key, kind="stable")
    return np.split(order, np.flatnonzero(np.diff(key[order])) + 1)


def _tile(every: Channels, rows: Ints, colours: Floats) -> Strokes:
    owners = every.domain[rows]
    angle = every.angle[owners]
    reach = every.length[rows][:, None] / 2 * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    ends = np.zeros((len(rows), 2, 3), dtype=np.float32)
    ends[:, 0, :2], ends[:, 1, :2] = every.centre[rows] - reach, every.centre[rows] + reach
    return Strokes(ends.reshape(-1, 3), colours[owners])


def _rims(skins: tuple[Skin, ...]) -> tuple[Strokes, ...]:
    """The borders of skins."""
    return tuple(_lines(skin.points[rim_of(skin.faces)], INK, 2.0) for skin in skins)


def rim_of(faces: Ints) -> Ints:
    """Vertex pairs (2 n,) of the edges on the border."""
    edges, _, count = edge_table(faces)
    return edges[count == 1].ravel()


def _closed(rings: Floats) -> Floats:
    """Ends (n, 2 k, 2) of the sides of rings (n, k, 2)."""
    return np.stack([rings, np.roll(rings, -1, axis=1)], axis=2).reshape(len(rings), -1, 2)


def _raised(points: Floats) -> Floats:
    """Points (n, 2) of the flat sheet in space."""
    return np.column_stack([points, np.zeros(len(points))])


def _lines(ends: Floats, colour: tuple[float, float, float], width: float) -> Strokes:
    return Strokes(ends.astype(np.float32), np.array([colour], dtype=np.float32), width)
