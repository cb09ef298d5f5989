"""The files of drawings: SVG as FreeCAD wrote it, finished; PDF from the SVG; DXF at true scale. Knows no FreeCAD."""

from __future__ import annotations

import re
import xml.etree.ElementTree as ET
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from lce_solver.types import Floats
from lce_workbench.app.figures import TEXT, Dim, Placed, Sheet
from lce_workbench.app.sheets import caption
from lce_workbench.app.symbols import PAPER


def write_svg(path: Path, beside: str) -> None:
    """Finish a page that FreeCAD exported: with what stands beside the views, and pens that keep their width."""
    text = path.read_text(encoding="utf-8")
    text = re.sub(r' vector-effect="[a-z-]*"', "", text)  # pens of so many pixels at any zoom
    inner = beside[beside.index("<g ") : beside.rindex("</svg>")]
    mark = re.search(r'\s*<g [^>]*id="DrawingContent"', text)
    assert mark is not None
    text = f'{text[: mark.start()]}\n  <g id="Beside" transform="scale(10)">{inner}</g>{text[mark.start() :]}'
    path.write_text(ET.canonicalize(text), encoding="utf-8")  # Qt writes attributes in an order of chance


def write_pdf(pages: Sequence[tuple[Path, str]], fonts: Path, path: Path) -> None:
    """Write SVG pages of some paper sizes as one PDF, words as words; ``fonts`` is the folder of TechDraw's.

    Raises
    ------
    OSError
        The file cannot be written.
    """
    import typst

    folder = pages[0][0].parent
    body = "".join(
        '#page(width: {}mm, height: {}mm, margin: 0mm, image("{}", width: 100%))\n'.format(*PAPER[paper], page.name)
        for page, paper in pages
    )
    look = {"font_paths": [str(fonts)], "ignore_system_fonts": True, "timestamp": 0, "pdf_tags": False}
    path.write_bytes(typst.compile(body.encode(), root=str(folder), **look))


LAYERS: dict[str, tuple[int, str]] = {
    "OUTLINE": (7, "CONTINUOUS"),
    "DIMENSIONS": (3, "CONTINUOUS"),
    "TEXT": (2, "CONTINUOUS"),
    "CENTRE": (1, "CENTER"),
}
"""Layers that every file has: colour and line type; what is beside the outlines brings its own."""

DASHES = {"dashed": "DASHED", "centre": "CENTER", "section": "CENTER", "phantom": "PHANTOM"}


def write_dxf(sheet: Sheet, code: str, path: Path) -> None:
    """Write a sheet's figures at true scale in mm: the first where it lies on the plate, the others to its right.

    Raises
    ------
    OSError
        The file cannot be written.
    """
    import ezdxf
    from ezdxf import options

    former, options.write_fixed_meta_data_for_testing = options.write_fixed_meta_data_for_testing, True
    try:
        document: Any = ezdxf.new("R2010", setup=True, units=4)
        for name, (colour, line) in LAYERS.items():
            document.layers.add(name, color=colour, linetype=line)
        space, right = document.modelspace(), None
        for view in sheet.views:
            low, high = view.figure.box
            shift = np.zeros(2) if right is None else np.array([right - low[0], 0.0])
            _draw(document, space, view, shift)
            right = high[0] + shift[0] + 60.0 / view.scale + 0.2 * (high[0] - low[0])
        low, high = sheet.views[0].figure.box
        height = TEXT / sheet.views[0].scale
        words = f"{sheet.title}, {sheet.subtitle}; design {code}; mm, 1:1"
        space.add_text(words, height=height, dxfattribs={"layer": "TEXT"}).set_placement((low[0], low[1] - 20 * height))
        document.saveas(path)
    finally:
        options.write_fixed_meta_data_for_testing = former


def _draw(document: Any, space: Any, view: Placed, shift: Floats) -> None:
    for edges, closed in ((view.figure.outlines, True), (view.figure.lines, False)):
        for edge in edges:
            space.add_lwpolyline((edge + shift).tolist(), close=closed, dxfattribs={"layer": "OUTLINE"})
    for stroke in view.figure.strokes:
        if stroke.layer not in document.layers:
            document.layers.add(stroke.layer)
        if stroke.style != "none" or stroke.layer.startswith(("MARKS", "LABELS")):
            points = (np.asarray(stroke.points) + shift).tolist()
            line = {"linetype": DASHES[stroke.style]} if stroke.style in DASHES else {}
            space.add_lwpolyline(points, close=stroke.closed, dxfattribs={"layer": stroke.layer, **line})
    for dim in view.figure.dims:
        _dimension(space, view, dim, shift)
    for label in view.figure.labels:
        at = np.array(label.at) + shift + np.array(label.shift) / view.scale
        text = space.add_text(label.text, height=label.size / view.scale, dxfattribs={"layer": "TEXT"})
        text.set_placement(at.tolist())
    low, high = view.figure.box
    size = TEXT / view.scale
    words = space.add_text(caption(view), height=size, dxfattribs={"layer": "TEXT"})
    words.set_placement((low[0] + shift[0], high[1] + shift[1] + 30.0 / view.scale))


def _dimension(space: Any, view: Placed, dim: Dim, shift: Floats) -> None:
    """A dimension that measures the same two points, as tall as on paper."""
    low, high = (corner + shift for corner in view.figure.box)
    a, b = (np.array(at) + shift for at in (dim.a, dim.b))
    lift = dim.at / view.scale
    side = 1 if dim.axis == "x" else 0
    base = np.array(a)
    base[side] = (high if lift > 0 else low)[side] + lift
    size = TEXT / view.scale
    micro = dim.unit == "um"
    look = {
        "dimtxt": size, "dimasz": 0.7 * size, "dimexe": 0.4 * size, "dimexo": 0.2 * size, "dimgap": 0.3 * size,
        "dimdec": 3 if micro else 4, "dimlfac": 1000.0 if micro else 1.0, "dimpost": "<> µm" if micro else "<>",
        "dimzin": 8, "dimtad": 1,
    }  # fmt: skip
    shown = space.add_linear_dim(
        base.tolist(), a.tolist(), b.tolist(), angle=0 if dim.axis == "x" else 90, override=look,
        dxfattribs={"layer": "DIMENSIONS"},
    )  # fmt: skip
    shown.render()
