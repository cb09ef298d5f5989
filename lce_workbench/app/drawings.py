"""Fabrication drawings as TechDraw pages: added to an open document, exported as SVG, PDF and DXF.

Views show shapes that follow the job's parameters in the document, and dimensions measure the views; so after a change
and a recompute the drawings are those of the changed cell. The window that TechDraw needs may be hidden.
"""

from __future__ import annotations

import os
import time
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import FreeCAD
import numpy as np

from lce_solver.errors import EnvironmentFault, InputError
from lce_workbench import ROOT, packages
from lce_workbench.app import cells
from lce_workbench.app.annotations import NEAR, annotate, assign, hold, lay, layout, set_scale, vertices_of
from lce_workbench.app.cell_views import Subject
from lce_workbench.app.drawing_files import write_dxf, write_pdf, write_svg
from lce_workbench.app.figures import Figure, Placed, Sheet
from lce_workbench.app.objects import HIDDEN, Proxy, add, job_of
from lce_workbench.app.sheets import sheets, subject_of, title_block
from lce_workbench.app.symbols import PAPER, symbol
from lce_workbench.core import jobfile
from lce_workbench.core.job import Job
from lce_workbench.outputs import told

PATIENCE = 120.0
"""TechDraw of FreeCAD 1.0 projects views in threads of its own; so long we wait for them [s]."""


class Drawn(Proxy):
    """Something on a sheet that follows the document's parameters."""

    def setup(self, obj: Any) -> None:
        super().setup(obj)
        add(obj, "App::PropertyString", "Sheet", "Name of the sheet", mode=HIDDEN)
        add(obj, "App::PropertyLinkGlobal", "Design", "The design that is drawn")
        add(obj, "App::PropertyLinkListGlobal", "Parameters", "The parameters that shape it")


class DrawnFigure(Drawn):
    """The edges of one view, in mm, in the plane z = 0."""

    def setup(self, obj: Any) -> None:
        super().setup(obj)
        add(obj, "App::PropertyString", "Figure", "Name of the view", mode=HIDDEN)
        add(obj, "App::PropertyStringList", "Texts", "What the dimensions read, in their order", mode=HIDDEN)
        add(obj, "App::PropertyString", "Layout", "Scale and places of its view and dimensions", mode=HIDDEN)

    def compute(self, obj: Any) -> None:
        """Draw the edges anew; views and dimensions, which are computed after it, get the places that fit them."""
        placed = next(view for view in sheet_of(obj).views if view.figure.name == obj.Figure)
        obj.Shape = _edges(placed.figure)
        obj.Texts = [dim.text for dim in placed.figure.dims]
        former, obj.Layout = obj.Layout, layout(placed)
        for view in obj.InList:
            if view.isDerivedFrom("TechDraw::DrawViewPart"):
                hold(view, placed.figure, placed.figure.vertices(NEAR) - placed.figure.middle)
                if former != obj.Layout:  # else what was moved by hand stays there
                    lay(view, placed)


class DrawnSymbol(Drawn):
    """What stands on a sheet beside its views."""

    def setup(self, obj: Any) -> None:
        super().setup(obj)
        add(obj, "App::PropertyString", "Svg", "Fills, thin lines, words and tables of the sheet", mode=HIDDEN)

    def compute(self, obj: Any) -> None:
        """Draw it anew, and tell it in the title block; what was written there by hand, of which the job says nothing,
        stays.
        """
        sheet = sheet_of(obj)
        obj.Svg = symbol(sheet)
        texts = {key: text for key, text in title_block(sheet, subject_of(*_now(obj.Design))).items() if text}
        for page in (page for view in obj.InList for page in view.InList if hasattr(page, "Template")):
            page.Template.EditableTexts = {**page.Template.EditableTexts, **texts}


def placed_of(view: Any) -> Placed:
    """What a view shows, where and at which scale, for the parameters as they are."""
    source = view.Source[0]
    return next(placed for placed in sheet_of(source).views if placed.figure.name == source.Figure)


def sheet_of(obj: Any) -> Sheet:
    """The sheet that a drawn object stands on, for the parameters as they are."""
    return next(sheet for sheet in sheets(*_now(obj.Design)) if sheet.name == obj.Sheet)


def _now(design: Any) -> tuple[Path, Job, Job]:
    """The design's file, the job that the parameters hold, and the one that the design was solved for."""
    job = job_of(cells.sections(cells.cell_of(design)).values())
    return Path(design.File), job, cells.made_for(design)


def _edges(figure: Figure) -> Any:
    """All outlines as one compound; edges without faces, since there is nothing to hide."""
    import Part

    return Part.makeCompound(
        [Part.makePolygon([FreeCAD.Vector(float(x), float(y), 0.0) for x, y in edge]) for edge in figure.edges]
    )


def run_drawings(folder: Path) -> None:
    """Write ``drawings/`` of an output folder from its ``job.toml`` and ``design.npz``; without a window.

    Raises
    ------
    InputError
        A file is missing or wrong.
    EnvironmentFault
        The files cannot be written, or TechDraw does not work.
    """
    from lce_workbench.app.document import new_cell, take_design

    hidden_window()
    out = folder / "drawings"
    doc = FreeCAD.newDocument("Drawings")
    with told(out):
        out.mkdir(exist_ok=True)
        job = jobfile.load(folder / "job.toml")
        cell = new_cell(doc, job)
        take_design(cell, folder / "design.npz", job)
        export(add_pages(cell), out)


def hidden_window() -> None:
    """Start FreeCAD's window without showing it, for its part of TechDraw."""
    if FreeCAD.GuiUp:
        return
    from PySide import QtGui

    os.environ["QT_QPA_PLATFORM"] = "offscreen"
    # FreeCAD 1.0 waits for itself for ever when what it warns of happens while it shows another warning.
    notes = FreeCAD.ParamGet("User parameter:BaseApp/Preferences/NotificationArea")
    for name in ("NotificationAreaEnabled", "NonIntrusiveNotificationsEnabled"):
        notes.SetBool(name, False)
    # Kept in the module: FreeCAD uses it until the process ends.
    globals()["_application"] = QtGui.QApplication.instance() or QtGui.QApplication(["lce"])
    import FreeCADGui

    FreeCADGui.showMainWindow()
    FreeCADGui.getMainWindow().hide()


def require_window(doc: Any) -> None:
    """Refuse a document that no window knows, hidden or not: TechDraw cannot draw it.

    Raises
    ------
    EnvironmentFault
        There is none, or it was started after the document.
    """
    try:
        import FreeCADGui

        FreeCADGui.getDocument(doc.Name)
    except (ImportError, AttributeError, NameError):
        msg = (
            "drawings need FreeCAD's window, at least a hidden one; call lce_workbench.app.drawings.hidden_window() "
            "before the document is opened, or run `./lce drawings` on an output folder"
        )
        raise EnvironmentFault(msg) from None


def add_pages(cell: Any) -> list[Any]:
    """Add the set of drawings of a cell to its document, one page a sheet, or bring the one that it has up to date.

    Returns the pages, in order.

    Raises
    ------
    InputError
        The cell holds no design.
    EnvironmentFault
        TechDraw does not project the views.
    """
    doc, design, parameters = cell.Document, cells.design_of(cell), list(cells.sections(cell).values())
    if not design.File:
        msg = "the cell has no design to draw; solve it first"
        raise InputError(msg)
    subject = subject_of(*_now(design))
    if former := pages_of(design):
        return _updated(former, subject)
    group = doc.addObject("App::DocumentObjectGroup", GROUP)
    pages = []
    for sheet in sheets(*_now(design)):
        page = _page(group, sheet, subject)
        common = {"Sheet": sheet.name, "Design": design, "Parameters": parameters}
        for view in sheet.views:
            source = _drawn(doc, "Part::FeaturePython", DrawnFigure, f"{sheet.name[2:]}_{view.figure.name}", group)
            assign(source, Figure=view.figure.name, **common)
            _view(doc, page, view, source)
        _symbol(doc, page, sheet, common, group)  # after the views, whose faces would lie on it in the window
        pages.append(page)
    return annotated(pages)


def pages_of(design: Any) -> list[Any]:
    """The pages of the set that shows a design, in order; none when there is no set."""
    sources = sorted((obj for obj in design.InList if cells.kind_of(obj) == "DrawnSymbol"), key=lambda obj: obj.Sheet)
    shown = [view for source in sources for view in source.InList if view.isDerivedFrom("TechDraw::DrawViewSymbol")]
    return [page for view in shown for page in view.InList if page.isDerivedFrom("TechDraw::DrawPage")]


def _updated(pages: list[Any], subject: Subject) -> list[Any]:
    """Pages of a former set, with all that follows the parameters and with the title blocks of today."""
    for page in pages:
        _fill(page.Template, sheet_of(_beside(page)[1]), subject)
    return annotated(pages)


def annotated(pages: list[Any]) -> list[Any]:
    """The pages with the dimensions and balloons of their views."""
    recompute(pages)
    for page in pages:
        for view in _views(page):
            annotate(page, view, placed_of(view))
    recompute(pages)
    return pages


def _views(page: Any) -> list[Any]:
    return [view for view in page.Views if view.isDerivedFrom("TechDraw::DrawViewPart")]


def _fill(template: Any, sheet: Sheet, subject: Subject) -> None:
    """Write the title block."""
    template.EditableTexts = {**template.EditableTexts, **title_block(sheet, subject)}


GROUP = "Drawings"
"""Name of the folder in the tree that holds what the pages show."""


def _drawn(doc: Any, kind: str, proxy: type, name: str, group: Any) -> Any:
    obj = doc.addObject(kind, f"Drawn_{name}")
    proxy(obj)
    group.addObject(obj)
    if obj.ViewObject is not None:
        obj.ViewObject.Visibility = False  # it lies at the origin, in the cell
    return obj


def _page(group: Any, sheet: Sheet, subject: Subject) -> Any:
    doc = group.Document
    page = doc.addObject("TechDraw::DrawPage", f"Page_{sheet.name[2:]}")
    page.Label = f"{sheet.name[0]} {sheet.title}"
    template = doc.addObject("TechDraw::DrawSVGTemplate", f"Template_{sheet.name[2:]}")
    template.Template = str(ROOT / "templates" / f"{sheet.paper}_landscape.svg")
    page.Template = template
    if page.ViewObject is not None:
        page.ViewObject.ShowFrames = False  # else frames and names of the views lie over the drawing's own words
    _fill(template, sheet, subject)
    group.addObject(page)
    return page


def _symbol(doc: Any, page: Any, sheet: Sheet, common: dict[str, Any], group: Any) -> None:
    source = _drawn(doc, "App::FeaturePython", DrawnSymbol, f"{sheet.name[2:]}_beside", group)
    assign(source, **common)
    shown = doc.addObject("TechDraw::DrawViewSymbol", f"Beside_{sheet.name[2:]}")
    page.addView(shown)
    shown.setExpression("Symbol", f"{source.Name}.Svg")
    width, height = PAPER[sheet.paper]
    assign(shown, X=width / 2, Y=height / 2, ScaleType="Custom", Scale=1.0)


def _view(doc: Any, page: Any, placed: Placed, source: Any) -> None:
    view = doc.addObject("TechDraw::DrawViewPart", f"View_{source.Name[6:]}")
    page.addView(view)
    assign(view, Source=[source], Direction=FreeCAD.Vector(0, 0, 1), XDirection=FreeCAD.Vector(1, 0, 0))
    view.ScaleType = "Custom"
    set_scale(view, placed)
    view.Label = placed.figure.caption
    if view.ViewObject is not None:
        view.ViewObject.LineWidth = 0.35


def recompute(pages: Iterable[Any]) -> None:
    """Recompute pages and what they show, nothing else, and wait until TechDraw has drawn every view.

    Raises
    ------
    InputError
        The parameters do not go together.
    EnvironmentFault
        It does not come to an end.
    """
    views = [view for page in pages for view in page.Views]
    with _without_faces():
        _redraw(views)


@contextmanager
def _without_faces() -> Iterator[None]:
    """Views have edges only: faces would hide what stands beside them in the files, and finding them takes long."""
    general = FreeCAD.ParamGet("User parameter:BaseApp/Preferences/Mod/TechDraw/General")
    former = general.GetBool("HandleFaces", True)
    general.SetBool("HandleFaces", False)
    try:
        yield
    finally:
        general.SetBool("HandleFaces", former)


def _redraw(views: Sequence[Any]) -> None:
    import FreeCADGui

    for obj in (*(source for view in views for source in view.OutList if hasattr(source, "Sheet")), *views):
        obj.recompute()  # not the document: its solids take long
        if not obj.isValid():
            raise InputError(obj.getStatusString())
    end = time.monotonic() + PATIENCE
    parts = [(view, placed_of(view).figure) for view in views if view.isDerivedFrom("TechDraw::DrawViewPart")]
    while waiting := [view for view, figure in parts if not _shows(view, figure)]:
        FreeCADGui.updateGui()
        time.sleep(0.01)
        if time.monotonic() > end:
            msg = f"TechDraw did not draw {waiting[0].Label} within {PATIENCE:g} s; end other programs and try again"
            raise EnvironmentFault(msg)
    for view, figure in parts:
        hold(view, figure, vertices_of(view))
    for view in views:
        if view.isDerivedFrom("TechDraw::DrawViewDimension"):
            view.recompute()  # of the edges as they are now
    FreeCADGui.updateGui()


def _shows(view: Any, figure: Figure) -> bool:
    """Whether a view shows its figure as it is now: its extent, and a vertex wherever something is dimensioned."""
    points, near = vertices_of(view), NEAR * max(figure.size)
    if not view.getVisibleEdges() or np.abs(np.ptp(points, axis=0) - figure.size).max() > near:
        return False
    ends = np.array([end for dim in figure.dims for end in (dim.a, dim.b)]).reshape(-1, 2) - figure.middle
    away = np.linalg.norm(ends[:, None] - points, axis=2).min(axis=1)
    return bool(np.all(away <= near))


def export(pages: Sequence[Any], folder: Path) -> None:
    """Write every page as SVG, PDF and DXF, and the whole set as ``drawings.pdf``; same pages, same bytes.

    Raises
    ------
    OSError
        A file cannot be written.
    EnvironmentFault
        A package that writes them is missing.
    """
    packages.append()
    recompute(pages)
    fonts = Path(FreeCAD.getResourceDir()) / "Mod" / "TechDraw" / "Resources" / "fonts"
    written = []
    with packages.needed():
        for page in pages:
            beside, source = _beside(page)
            sheet = sheet_of(source)
            path = folder / f"{sheet.name}.svg"
            _export_svg(page, beside, path)
            write_svg(path, source.Svg)
            write_pdf([(path, sheet.paper)], fonts, path.with_suffix(".pdf"))
            write_dxf(sheet, subject_of(*_now(source.Design)).code, path.with_suffix(".dxf"))
            written.append((path, sheet.paper))
        write_pdf(written, fonts, folder / "drawings.pdf")


def _beside(page: Any) -> tuple[Any, Any]:
    """The symbol of what stands beside a page's views, and the object that it comes from."""
    shown = next(view for view in page.Views if view.isDerivedFrom("TechDraw::DrawViewSymbol"))
    ((_, expression),) = shown.ExpressionEngine
    return shown, page.Document.getObject(expression.split(".")[0])


def _export_svg(page: Any, beside: Any, path: Path) -> None:
    """Export a page without what stands beside its views: that goes in as it is, so that its words stay words."""
    import FreeCADGui
    import TechDrawGui

    beside.ViewObject.Visibility = False
    page.ViewObject.show()
    FreeCADGui.updateGui()
    TechDrawGui.exportPageAsSvg(page, str(path))
    beside.ViewObject.Visibility = True
