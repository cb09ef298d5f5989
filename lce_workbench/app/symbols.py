"""What stands on a sheet beside views and dimensions, as SVG in paper millimetres: fills, thin lines, words, tables."""

from __future__ import annotations

from collections.abc import Iterator
from xml.sax.saxutils import escape

import numpy as np

from lce_solver.types import Floats
from lce_workbench.app.figures import TEXT, Label, Placed, Point, Sheet, hatching
from lce_workbench.app.map_views import direction_colour
from lce_workbench.app.sheets import caption

PAPER = {"A4": (297.0, 210.0), "A3": (420.0, 297.0)}
"""Width and height, landscape [mm]."""

PIXELS = 96 / 25.4
"""Of TechDraw's pages, per mm."""

PENS = {
    "thin": 'stroke-width="0.18"',
    "hair": 'stroke-width="0.05" stroke-opacity="0.5"',
    "grid": 'stroke-width="0.13" stroke-opacity="0.6"',
    "dashed": 'stroke-width="0.18" stroke-dasharray="2 1"',
    "centre": 'stroke-width="0.13" stroke-dasharray="6 1 1 1"',
    "phantom": 'stroke-width="0.18" stroke-dasharray="6 1 1 1 1 1"',
    "section": 'stroke-width="0.25" stroke-dasharray="8 1.5 1.5 1.5"',
    "none": 'stroke="none"',
}
"""Style -> pen."""

HATCHES = {"glass": (3.0, 30.0), "epoxy": (1.8, 45.0), "mylar": (1.2, 135.0)}
"""Material -> distance of the lines on paper [mm], their direction [degrees]."""

ROW = 6.5
"""Height of a row of a table on paper [mm]."""

LINE = 5.2
"""From line to line of the notes on paper [mm]."""


def symbol(sheet: Sheet) -> str:
    """The SVG document of a whole sheet, upper left corner at the sheet's."""
    width, height = PAPER[sheet.paper]
    body = "".join(_parts(sheet, height))
    # In pixels: Qt makes 90 of them from an inch, and TechDraw an inch from 96.
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{width * PIXELS:.3f}" height="{height * PIXELS:.3f}" '
        f'viewBox="0 0 {width:g} {height:g}">'
        f'<g fill="none" stroke="#000000" font-family="osifont">{body}</g></svg>'
    )


def _parts(sheet: Sheet, height: float) -> Iterator[str]:
    for view in sheet.views:
        yield from _strokes(view, height)
        for label in view.figure.labels:
            yield _label(view, label, height)
        yield from _arrows(view, height)
        yield _caption(view, height)
    yield from _notes(sheet, height)
    yield from _table(sheet, height)
    yield from _legend(sheet, height)


def _strokes(view: Placed, height: float) -> Iterator[str]:
    """One path for all strokes of a look: TechDraw's time grows with the square of the number of paths."""
    looks: dict[str, list[str]] = {}
    for stroke in view.figure.strokes:
        points = view.paper(stroke.points)
        look = PENS[stroke.style] + (f' fill="{stroke.fill}"' if stroke.fill else "")
        if look != PENS["none"]:
            looks.setdefault(look, []).append(_path(points, height, closed=stroke.closed))
        if stroke.hatch:
            step, angle = HATCHES[stroke.hatch]
            lines = [_path(line, height, closed=False) for line in hatching(points, step, np.radians(angle))]
            looks.setdefault('stroke-width="0.1"', []).extend(lines)
    for look, paths in looks.items():
        yield f'<path d="{" ".join(paths)}" {look}/>'


def _path(points: Floats, height: float, *, closed: bool) -> str:
    pairs = [f"{x:.3f},{height - y:.3f}" for x, y in points]
    return "M" + "L".join(pairs) + ("Z" if closed else "")


def _label(view: Placed, label: Label, height: float) -> str:
    (x, y), (dx, dy) = view.paper(np.array([label.at]))[0], label.shift
    return _text(label.text, (x + dx, y + dy), height, label.size, label.anchor)


def _text(text: str, at: Point, height: float, size: float = TEXT, anchor: str = "start") -> str:
    return (
        f'<text x="{at[0]:.3f}" y="{height - at[1]:.3f}" font-size="{size:g}" text-anchor="{anchor}" '
        f'fill="#000000" stroke="none">{escape(text)}</text>'
    )


def _caption(view: Placed, height: float) -> str:
    """Above the topmost dimension of the view."""
    figure = view.figure
    top = view.at[1] + figure.size[1] * view.scale / 2
    lift = max([dim.at for dim in figure.dims if dim.axis == "x"] + [2.0])
    lift = max([lift] + [b.at[1] + 5 - figure.size[1] * view.scale / 2 for b in figure.balloons])
    return _text(caption(view), (view.at[0], top + lift + 6.0), height, TEXT, "middle")


def _arrows(view: Placed, height: float) -> Iterator[str]:
    """The arrows at both ends of a section line: which way one looks (towards +y)."""
    for stroke in (stroke for stroke in view.figure.strokes if stroke.style == "section"):
        (x0, y), (x1, _) = view.paper(stroke.points)
        for x in (x0 - 4.0, x1 + 4.0):
            yield f'<path d="M{x:.3f},{height - y:.3f} v-6" stroke-width="0.35"/>'
            yield f'<path d="M{x:.3f},{height - y - 8:.3f} l-1.2,3.2 h2.4 Z" fill="#000000" stroke="none"/>'
        for a, b in ((x0 - 7.0, x0), (x1, x1 + 7.0)):
            yield f'<path d="M{a:.3f},{height - y:.3f} L{b:.3f},{height - y:.3f}" stroke-width="0.5"/>'


def _notes(sheet: Sheet, height: float) -> Iterator[str]:
    """In the lower left corner on A3, above the right end of the title block on A4."""
    x, width = (24.0, 64) if sheet.paper == "A3" else (176.0, 52)
    lines = [line for note in sheet.notes for line in _wrapped(note, width)]
    y = 13.0 + LINE * len(lines) if sheet.paper == "A3" else 42.0 + LINE * len(lines)
    for k, line in enumerate(["NOTES", *lines]):
        yield _text(line, (x, y - LINE * k), height)


def _wrapped(note: str, width: int) -> list[str]:
    import textwrap

    return [line.replace("\xa0", " ") for line in textwrap.wrap(note, width)]


def _table(sheet: Sheet, height: float) -> Iterator[str]:
    if not sheet.table:
        return
    x0, y0 = sheet.table_at
    edges = x0 + np.cumsum([0.0, *sheet.columns])
    last = y0 - ROW * len(sheet.table)
    for x in edges:
        yield f'<path d="M{x:.3f},{height - y0:.3f} V{height - last:.3f}" stroke-width="0.25"/>'
    for k in range(len(sheet.table) + 1):
        pen = 0.5 if k in {0, 1, len(sheet.table)} else 0.18
        yield f'<path d="M{edges[0]:.3f},{height - y0 + ROW * k:.3f} H{edges[-1]:.3f}" stroke-width="{pen}"/>'
    for k, row in enumerate(sheet.table):
        for x, cell in zip(edges, row, strict=False):
            yield _text(cell, (float(x) + 1.5, y0 - ROW * (k + 1) + 2.0), height)


def _legend(sheet: Sheet, height: float) -> Iterator[str]:
    if sheet.legend is None:
        return
    x, y = sheet.legend
    yield _text("DIRECTOR", (x, y), height)
    for k in range(12):
        angle, low = np.pi * k / 12, y - 9.0 - 8.0 * k
        box = np.array([(x, low), (x + 10, low), (x + 10, low + 6), (x, low + 6)])
        line = np.array([(x + 5, low + 3)]) + np.outer([-2.6, 2.6], [np.cos(angle), np.sin(angle)])
        yield f'<path d="{_path(box, height, closed=True)}" {PENS["thin"]} fill="{direction_colour(angle)}"/>'
        yield f'<path d="{_path(line, height, closed=False)}" stroke-width="0.35"/>'
        yield _text(f"{15 * k}°", (x + 13, low + 1.5), height)
