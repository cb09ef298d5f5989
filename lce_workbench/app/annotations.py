"""Dimensions and balloons of TechDraw's views, and where they stand."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import count
from typing import Any

import FreeCAD
import numpy as np

from lce_solver.types import Floats
from lce_workbench.app.figures import TEXT, Figure, Placed, Point

NEAR = 1e-6
"""A vertex of a view is a dimension's point when it is so near, relative to the view's size."""


def annotate(page: Any, view: Any, placed: Placed) -> None:
    """Give a view the dimensions and balloons that it has not got yet, and take away the balloons of what is gone."""
    former = len(view.InList)
    for k, dim in enumerate(placed.figure.dims):
        if _note(view, "Dim", dim.name) is None:
            _dimension(page, view, placed.figure, k)
    wanted = {_note_name(view, "Balloon", balloon.text): balloon for balloon in placed.figure.balloons}
    for obj in view.InList:
        if obj.Name.startswith(_note_name(view, "Balloon", "")) and obj.Name not in wanted:
            page.Document.removeObject(obj.Name)
    for name, balloon in wanted.items():
        if page.Document.getObject(name) is None:
            _balloon(page, view, name, balloon.text)
    hold(view, placed.figure, vertices_of(view))
    if len(view.InList) != former:
        lay(view, placed)


def _note_name(view: Any, kind: str, name: str) -> str:
    return f"{kind}_{view.Name[5:]}_{name}"


def _note(view: Any, kind: str, name: str) -> Any:
    """A view's dimension or balloon, or `None`."""
    return view.Document.getObject(_note_name(view, kind, name))


def _dimension(page: Any, view: Any, figure: Figure, number: int) -> None:
    dim, vertices = figure.dims[number], vertices_of(view)
    shown = page.Document.addObject("TechDraw::DrawViewDimension", _note_name(view, "Dim", dim.name))
    shown.Type = {"x": "DistanceX", "y": "DistanceY"}[dim.axis]
    shown.References2D = [(view, _nearest(vertices, figure, at)) for at in (dim.a, dim.b)]
    if dim.unit == "um":  # TechDraw's own format knows millimetres only
        shown.Arbitrary = True
        shown.setExpression("FormatSpec", f"{view.Source[0].Name}.Texts[{number}]")
    else:
        shown.FormatSpec = "%.4w"
    page.addView(shown)
    _style(shown)


def _balloon(page: Any, view: Any, name: str, text: str) -> None:
    shown = page.Document.addObject("TechDraw::DrawViewBalloon", name)
    assign(shown, SourceView=view, Text=text)
    page.addView(shown)
    assign(shown, EndType="Dot", ShapeScale=1.0)
    _style(shown)


def layout(placed: Placed) -> str:
    """What `lay` depends on, in words that are equal when it is."""
    texts = [placed.text_at(dim).round(3).tolist() for dim in placed.figure.dims]
    balloons = [(balloon.tip, balloon.at) for balloon in placed.figure.balloons]
    return repr((placed.scale, placed.at, texts, np.round(balloons, 6).tolist()))


def hold(view: Any, figure: Figure, vertices: Floats) -> None:
    """Let a view's dimensions hold at its vertices (n, 2)."""
    for dim in figure.dims:
        if shown := _note(view, "Dim", dim.name):
            shown.References2D = [(view, _nearest(vertices, figure, at)) for at in (dim.a, dim.b)]


def lay(view: Any, placed: Placed) -> None:
    """Scale a view, and put its dimensions and balloons where the figure wants them."""
    figure = placed.figure
    set_scale(view, placed)
    for dim in figure.dims:
        if shown := _note(view, "Dim", dim.name):
            shown.X, shown.Y = placed.text_at(dim).tolist()
    for balloon in figure.balloons:
        if shown := _note(view, "Balloon", balloon.text):
            (x, y), at = (balloon.tip - figure.middle).tolist(), balloon.at
            assign(shown, OriginX=x, OriginY=y, X=at[0] / placed.scale, Y=at[1] / placed.scale)


def vertices_of(view: Any) -> Floats:
    """Vertices (n, 2) of a view, in its own plane from its middle."""
    return np.array([(point.x, point.y) for point in _points(view)]).reshape(-1, 2)


def _points(view: Any) -> Iterator[Any]:
    for index in count():
        try:
            yield view.getVertexByIndex(index).Point
        except ValueError:
            return


def _nearest(vertices: Floats, figure: Figure, at: Point) -> str:
    """Name of the view's vertex at a point of the figure."""
    away = np.linalg.norm(vertices - (at - figure.middle), axis=1)
    best = int(away.argmin())
    if away[best] > NEAR * max(figure.size):
        msg = f"the view {figure.name} has no vertex at {at}; report it"
        raise RuntimeError(msg)
    return f"Vertex{best}"


def _style(shown: Any) -> None:
    """Pens and text, whose size is the whole line's in FreeCAD 0.20, and that of its capitals in 1.0."""
    look = shown.ViewObject
    if look is not None:
        look.LineWidth = 0.18
        look.Fontsize = CAPITALS * TEXT if NEW else TEXT


CAPITALS = 0.7
"""Height of osifont's capitals, of its line."""

NEW = int(FreeCAD.Version()[0]) >= 1
"""Whether this is FreeCAD 1."""


def set_scale(view: Any, placed: Placed) -> None:
    """Scale a view and put it in its place."""
    view.Scale = placed.scale
    view.X, view.Y = placed.at  # after the scale: adding and scaling move it


def assign(obj: Any, **values: Any) -> None:
    """Set properties in their order."""
    for name, value in values.items():
        setattr(obj, name, value)
