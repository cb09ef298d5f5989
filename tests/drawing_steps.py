"""What the tests of the drawings do inside FreeCAD."""


def draw(folder, job, changes):
    """Draw the design in ``folder``; change parameters and recompute; draw again over it; export.

    Returns for each state: dimension -> [measured value, text as displayed].
    """
    from pathlib import Path

    import FreeCAD

    from lce_workbench.app import drawings
    from lce_workbench.app.document import new_cell, take_design
    from lce_workbench.core import jobfile

    drawings.hidden_window()
    doc = FreeCAD.newDocument("Test")
    values = jobfile.parse(job)
    take_design(new_cell(doc, values), Path(folder) / "design.npz", values)
    pages = drawings.add_pages(doc)
    found = {"first": read(doc), "objects": len(doc.Objects)}
    found["order"] = [[view.TypeId for view in page.Views] for page in pages]
    out = Path(folder) / "drawings"
    out.mkdir()
    drawings.export(pages, out)
    for name, prop, value in changes:
        setattr(doc.getObject(name), prop, value)
    drawings.recompute(pages)
    found["changed"] = read(doc)
    doc.OutputParameters.Author = "B. Other"
    pages = drawings.add_pages(doc)  # brings the former set up to date
    found["again"], found["objects again"] = read(doc), len(doc.Objects)
    found["authors"] = [page.Template.EditableTexts["author"] for page in pages]
    return found


def read(doc):
    """Dimension -> what TechDraw measures [mm], and the text of those that are written by an expression."""
    shown = [obj for obj in doc.Objects if obj.isDerivedFrom("TechDraw::DrawViewDimension")]
    return {obj.Name: [obj.getRawValue(), obj.FormatSpec if obj.Arbitrary else ""] for obj in shown}
