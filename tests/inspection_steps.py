"""What the tests of the design review do inside FreeCAD."""

import json


def cell_of(design_npz):
    """A document with the cell of a design."""
    from pathlib import Path

    import FreeCAD

    from lce_workbench.app import document
    from lce_workbench.core import jobfile

    doc = FreeCAD.newDocument("Inspected")
    cell = document.build(doc, Path(design_npz), jobfile.parse('[target]\nsurface = "saddle"\n[sheet]\nwidth_mm = 2.2'))
    doc.recompute()
    return doc, cell


def records(doc):
    """Check -> severity, value, where."""
    found = [json.loads(text) for text in doc.Review.Records]
    return {r["check"]: [r["severity"], r["value"], r["where"]] for r in found}


def sound_and_faulty(design_npz):
    """Inspect a sound cell, and cells with one fault each."""
    from FreeCAD import Vector

    from lce_workbench.app import session

    doc, cell = cell_of(design_npz)
    session.inspect(cell)
    found = {"sound": records(doc), "errors": doc.Review.Errors, "status": doc.Review.Status}
    into = doc.Sheet.Shape.BoundBox.XMin - doc.SpacerLeft.Shape.BoundBox.XMax + 0.1
    for name, obj, move in (
        ("strip in the film", doc.SpacerLeft, Vector(into, 0, 0)),
        ("strip under a mark", doc.SpacerRight, Vector(2.0, 0, 0)),
        ("top plate too low", doc.TopPlate, Vector(0, 0, -0.01)),
        ("top plate aside", doc.TopPlate, Vector(0.03, 0.04, 0)),
        ("the whole cell elsewhere", cell, Vector(3, 4, 5)),
    ):
        obj.Placement.Base += move
        session.inspect(cell)
        found[name] = records(doc)
        obj.Placement.Base -= move
    doc.BottomEpoxy.Shape = doc.BottomGlass.Shape
    doc.BottomEpoxy.purgeTouched()  # as if another program had put it there
    session.inspect(cell)
    found["another shape"] = records(doc)
    doc.PlatesParameters.Epoxy = "30 um"
    doc.recompute()
    found["changed"] = doc.Review.Status
    return found


def bill(design_npz):
    """The bill of materials, before and after a change."""
    from lce_workbench.app import bill

    doc, cell = cell_of(design_npz)
    sheet = doc.BillOfMaterials
    found = {"rows": [[sheet.get(f"{c}{row}") for c in "BCDH"] for row in range(2, 8)], "first": figures(sheet)}
    found["solids"] = {name: doc.getObject(name).Shape.Volume for name in ("BottomGlass", "BottomLand", "BottomEpoxy")}
    doc.ChannelsParameters.Depth = "1 um"
    doc.PredictionParameters.DensityKgM3 = 1100.0
    doc.recompute()
    found["second"] = figures(sheet)
    same = bill.add_bill(cell)
    untouched = same.State
    doc.recompute()
    found["again"] = [same.Name, figures(sheet) == found["second"], "Touched" in untouched]
    return found


def figures(sheet):
    """Alias -> value in mm3, kg/m3, g."""
    units = {"E": "mm^3", "F": "kg/m^3", "G": "g"}
    named = ((column, sheet.getAlias(f"{column}{row}")) for column in units for row in range(2, 12))
    return {name: getattr(sheet, name).getValueAs(units[column]).Value for column, name in named if name}


def places(design_npz):
    """Where findings lead to: objects and outlines."""
    from lce_workbench.app import places

    _, cell = cell_of(design_npz)
    found = {}
    for where in (
        "bottom plate, domain 3", "top plate, domain 3", "domains 4, 5", "triangle 7 at (0.20, 0.30) mm",
        "corner 2, spacer_left", "spacer_left and sheet", "top plate", "cell.step", "",
    ):  # fmt: skip
        place = places.place_of(cell, where)
        found[where] = [[obj.Name for obj in place.objects], [ring.tolist() for ring in place.outlines]]
    return found


def older(path):
    """Inspect a document of an older schema."""
    import FreeCAD

    import lce_workbench  # noqa: F401

    doc = FreeCAD.openDocument(path)
    from lce_workbench.app import cells, session

    cell = cells.the_cell(doc)
    session.inspect(cell)
    parts = [o for o in doc.Objects if getattr(o, "Prisms", "channels")[:8] != "channels" and not o.Shape.isNull()]
    shapes = {o.Prisms: o.Shape.Volume for o in parts}
    versions = sorted({o.SchemaVersion for o in doc.Objects if "SchemaVersion" in o.PropertiesList})
    found = {"new": int(FreeCAD.Version()[0]) >= 1, "versions": versions, "errors": doc.Review.Errors}
    return {**found, "shapes": shapes, **figures(doc.BillOfMaterials)}
