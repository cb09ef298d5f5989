"""The figure of the domains: where they lie and which way their directors point. Knows no FreeCAD."""

from __future__ import annotations

import numpy as np

from lce_solver.types import Floats
from lce_workbench.app.cell_views import Subject
from lce_workbench.app.figures import Dim, Figure, Label, Stroke, extremes, point, scale_for
from lce_workbench.core.domains import Domains

MAP_ROOM = (230.0, 205.0)
"""Of the domain map on paper [mm]."""

NUMBERED = 12.0
"""Domains bear their numbers where their edges are so long on paper [mm]; else there are directors and a grid."""


def domain_map(subject: Subject) -> Figure:
    """Every domain in the colour of its director: few with their numbers, many with the director and a grid."""
    domains, sheet = subject.domains, subject.domains.outline
    west, east, south, north = (point(edge[0]) for edge in extremes(sheet))
    strokes = [
        Stroke(ring, "hair", fill=direction_colour(float(angle)), layer="DOMAINS")
        for k, angle in enumerate(domains.theta)
        for ring in [domains.ring(k)]
    ]
    if numbered(subject):
        inside, names = (
            [],
            [Label(str(k), point(at), (0.0, -1.0), size=2.8) for k, at in enumerate(_middles(domains))],
        )
    else:
        inside, names = _grid(subject)
        inside += _directors(domains)
    return Figure(
        "domain_map",
        "SHEET SEEN FROM ABOVE",
        (),
        (Dim("sheet_width", west, east, "x", 10), Dim("sheet_height", south, north, "y", -12)),
        (*strokes, *inside, *(Stroke(ring, "thin", layer="SHEET") for ring in subject.rims)),
        tuple(names),
        lines=tuple(extremes(sheet)),
    )


def numbered(subject: Subject) -> bool:
    """Whether there is room for numbers in the domains."""
    edge = float(np.sqrt(np.abs(subject.domains.area).mean() * 4 / np.sqrt(3)))
    return edge * scale_for(subject.frame.sheet.size, MAP_ROOM) >= NUMBERED


COLOUR_STEP = 5
"""Directions nearer than this share a colour [degrees]: few colours make few paths."""


def direction_colour(angle: float) -> str:
    """SVG colour of a line direction [rad]: a pale colour circle of period pi."""
    import colorsys

    step = round(np.degrees(angle) / COLOUR_STEP) * COLOUR_STEP / 180
    red, green, blue = colorsys.hls_to_rgb(step % 1.0, 0.82, 0.75)
    return f"#{round(255 * red):02x}{round(255 * green):02x}{round(255 * blue):02x}"


def _directors(domains: Domains) -> list[Stroke]:
    """A line along each director, within its domain."""
    half = (
        0.35 * np.sqrt(np.abs(domains.area))[:, None] * np.column_stack([np.cos(domains.theta), np.sin(domains.theta)])
    )
    ends = np.stack([domains.centroid - half, domains.centroid + half], axis=1)
    return [Stroke(line, "thin", closed=False, layer="DIRECTORS") for line in ends]


def _middles(domains: Domains) -> Floats:
    """(n, 2) where there is most room in each domain: of a triangle the middle of its inscribed circle [mm]."""
    if domains.polygons.shape[1] > 3:
        return domains.centroid
    corners = domains.corners
    opposite = np.linalg.norm(np.roll(corners, -1, axis=1) - np.roll(corners, 1, axis=1), axis=2)
    return np.asarray((corners * opposite[..., None]).sum(axis=1) / opposite.sum(axis=1)[:, None])


def _grid(subject: Subject) -> tuple[list[Stroke], list[Label]]:
    """Lines at round coordinates, with their values [mm] at the lower and right side."""
    sheet = subject.frame.sheet
    step = next(step for step in (0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0) if max(sheet.size) / step <= 12)
    xs = np.arange(np.ceil(sheet.x0 / step), np.floor(sheet.x1 / step) + 1) * step
    ys = np.arange(np.ceil(sheet.y0 / step), np.floor(sheet.y1 / step) + 1) * step
    lines = [[(x, sheet.y0), (x, sheet.y1)] for x in xs] + [[(sheet.x0, y), (sheet.x1, y)] for y in ys]
    below = [Label(f"{x + 0.0:g}", (float(x), sheet.y0), (0.0, -5.5)) for x in xs]
    right = [Label(f"{y + 0.0:g}", (sheet.x1, float(y)), (3.0, -1.2), "start") for y in ys]
    return [Stroke(np.array(line), "grid", closed=False, layer="GRID") for line in lines], below + right
