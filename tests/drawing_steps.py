"""What the tests of the drawings do inside FreeCAD."""


def draw(folder, job, changes):
    """Draw the design in ``folder``; change parameters and recompute; draw again over it; export.

    Returns for each state: dimension -> [measured value, text as displayed].
    """
    from pathlib import Path

    import FreeCAD
    from gui_hands import pump

    from lce_workbench.app import annotations, drawings
    from lce_workbench.app.document import new_cell, take_design
    from lce_workbench.core import jobfile

    drawings.hidden_window()
    doc = FreeCAD.newDocument("Test")
    values = jobfile.parse(job)
    take_design(new_cell(doc, values), Path(folder) / "design.npz", values)
    pages = drawings.add_pages(doc.Cell)
    found = {"first": read(doc), "objects": len(doc.Objects)}
    found["order"] = [[view.TypeId for view in page.Views] for page in pages]
    out = Path(folder) / "drawings"
    out.mkdir()
    drawings.export(pages, out)
    moved = doc.Dim_spacer_strip_place_strip_from_edge
    moved.X = 7.0
    doc.SheetParameters.TwistGain = 1.5  # which no drawing shows
    drawings.recompute(pages)
    found["moved"] = moved.X.Value
    for name, prop, value in changes:
        setattr(doc.getObject(name), prop, value)
    doc.recompute()
    if annotations.NEW:
        pump(3.0)  # FreeCAD 1.0 draws views in threads of its own, and measures when they are done
    found["live"] = read(doc)  # as in a window, where nobody asks for the drawings
    drawings.recompute(pages)
    found["changed"], found["scales"] = read(doc), scales(doc)
    texts = [page.Template.EditableTexts for page in pages]
    found["titles"] = [[text["title"], text["subtitle"], text["material"], text["scale"]] for text in texts]
    doc.OutputParameters.Author = "B. Other"
    pages = drawings.add_pages(doc.Cell)  # brings the former set up to date
    found["again"], found["objects again"] = read(doc), len(doc.Objects)
    found["authors"] = [page.Template.EditableTexts["author"] for page in pages]
    found["balloons"] = [obj.Text for obj in doc.Objects if obj.isDerivedFrom("TechDraw::DrawViewBalloon")]
    out = Path(folder) / "changed"
    out.mkdir()
    drawings.export(pages, out)
    return found


def scales(doc):
    """View -> scale."""
    return {obj.Name: obj.Scale for obj in doc.Objects if obj.isDerivedFrom("TechDraw::DrawViewPart")}


def two_cells(folder, job, gap):
    """Draw two cells of one document, which differ in their gap; returns what their drawings measure."""
    from pathlib import Path

    import FreeCAD
    from missing_steps import message

    from lce_workbench.app import drawings, session
    from lce_workbench.app.document import new_cell, take_design
    from lce_workbench.core import jobfile

    drawings.hidden_window()
    doc, found, values = FreeCAD.newDocument("Two"), [], jobfile.parse(job)
    for _ in range(2):
        take_design(new_cell(doc, values), Path(folder) / "design.npz", values)
    doc.SheetParameters001.Gap = gap
    for cell in (doc.Cell, doc.Cell001, doc.Cell):
        pages = drawings.add_pages(cell)
        shown = [view for view in pages[0].Views if view.Name.endswith("_gap")]
        found.append([shown[0].getRawValue(), len(pages), len(doc.Objects)])
    place = Path(folder) / "a new folder" / "in it"
    session.drawings(doc.Cell, str(place))
    return [*found, len(list(place.iterdir())), message(lambda: session.drawings(doc.Cell, "/proc/lce"))[-1:]]


def read(doc):
    """Dimension -> what TechDraw measures [mm], and the text of those that are written by an expression."""
    shown = [obj for obj in doc.Objects if obj.isDerivedFrom("TechDraw::DrawViewDimension")]
    return {obj.Name: [obj.getRawValue(), obj.FormatSpec if obj.Arbitrary else ""] for obj in shown}
