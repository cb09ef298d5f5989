"""What the tests of the document do inside FreeCAD."""

from dataclasses import fields


def round_trip(toml, path):
    """Write every section of a job to properties, save, open, read; return the jobs before and after as text."""
    import FreeCAD

    from lce_workbench.app.properties import declare, read, write
    from lce_workbench.core import jobfile

    job = jobfile.parse(toml)
    doc = FreeCAD.newDocument("Properties")
    for section in fields(job):
        obj = doc.addObject("App::FeaturePython", section.name)
        declare(obj, type(getattr(job, section.name)), section.name)
        write(obj, getattr(job, section.name))
        declare(obj, type(getattr(job, section.name)), section.name)  # a second time changes nothing
    doc.saveAs(path)
    FreeCAD.closeDocument(doc.Name)
    doc = FreeCAD.openDocument(path)
    parts = {f.name: read(doc.getObject(f.name), type(getattr(job, f.name))) for f in fields(job)}
    return [repr(job), repr(type(job)(**parts))]


def run(folder):
    """Write the document of an output folder."""
    from pathlib import Path

    from lce_solver.errors import LceError
    from lce_workbench.app.document import run_document

    try:
        run_document(Path(folder))
    except LceError as fault:
        return [str(fault), fault.exit_code]
    return ["", 0]


def bodies(doc):
    """Name -> what is measured of each shape."""
    found = {}
    for obj in doc.findObjects("Part::FeaturePython"):
        box, shape = obj.Shape.BoundBox, obj.Shape
        if shape.isNull():  # an option of the workshop that is off
            continue
        found[obj.Name] = {
            "volume": shape.Volume,
            "solids": len(shape.Solids),
            "low": [box.XMin, box.YMin, box.ZMin],
            "high": [box.XMax, box.YMax, box.ZMax],
            "valid": shape.isValid() if len(shape.Faces) < 500 else True,
        }
    return found


def open_document(path):
    """Open a document whose proxies are ours."""
    import FreeCAD

    import lce_workbench  # noqa: F401 - FreeCAD restores only proxies of loaded addons

    return FreeCAD.openDocument(path)


AIDS = ("App::Origin", "App::Line", "App::Plane")
"""What an App::Part brings with it."""


def read_only(path):
    """Tree (name -> containers) and bodies as a document opens, and whether an optional value can be edited."""
    doc = open_document(path)
    objects = [o for o in doc.Objects if o.TypeId not in AIDS]
    tree = {o.Name: [p.Name for p in o.InList if o in getattr(p, "Group", ())] for o in objects}
    plates = doc.PlatesParameters
    modes = [plates.getEditorMode("Width")]
    plates.WidthGiven = True
    modes.append(plates.getEditorMode("Width"))
    return {"tree": tree, "bodies": bodies(doc), "modes": modes}


def recomputed(doc):
    """Recompute, measure, and name the objects that are invalid with their sentences."""
    doc.recompute()
    return {"bodies": bodies(doc), "invalid": invalid(doc)}


def invalid(doc):
    """Name -> sentence of the objects that FreeCAD marks."""
    return {o.Name: o.getStatusString() for o in doc.Objects if not o.isValid()}


def change(doc, changes):
    """Set properties, given as (object, property, value); return the former values in the order of undoing."""
    former = []
    for name, prop, value in changes:
        former.insert(0, (name, prop, getattr(doc.getObject(name), prop)))
        setattr(doc.getObject(name), prop, value)
    return former


def edit(path, changes, save_as):
    """Change and recompute; save and open again; recompute everything."""
    import FreeCAD

    doc = open_document(path)
    change(doc, changes)
    found = {"edited": recomputed(doc)}
    doc.ChannelsParameters.removeProperty("Guard")  # as in a file from before this parameter
    doc.saveAs(save_as)
    FreeCAD.closeDocument(doc.Name)
    doc = open_document(save_as)
    found["reopened"] = {"bodies": bodies(doc), "invalid": invalid(doc)}
    found["guard"] = doc.ChannelsParameters.Guard.Value
    for obj in doc.Objects:
        obj.touch()
    found["recomputed"] = recomputed(doc)
    return found


def attempt(path, cases):
    """Make each change on its own and undo it; return what FreeCAD said, and the state at the end."""
    doc = open_document(path)
    before = {o.Name: o.Shape for o in doc.findObjects("Part::FeaturePython")}
    said = {}
    for case, changes in cases.items():
        former = change(doc, changes)
        doc.recompute()
        said[case] = {
            "invalid": invalid(doc),
            "design": [doc.Design.Label, doc.Design.Status],
            "moved": [name for name, shape in before.items() if not doc.getObject(name).Shape.isSame(shape)],
        }
        change(doc, former)
    return {"said": said, "end": recomputed(doc)}


def edit_without_scipy(path, changes):
    """Edit where SciPy is not installed."""
    import sys

    sys.modules["scipy"] = None
    doc = open_document(path)
    change(doc, changes)
    return recomputed(doc)


def looks(path, picture):
    """Open in the window; return what each view provider shows, and save a picture of the view as it opens."""
    import FreeCAD
    import FreeCADGui

    doc = FreeCAD.openDocument(path)
    for _ in range(20):
        FreeCADGui.updateGui()
    FreeCADGui.activeDocument().activeView().saveImage(picture, 800, 600, "White")
    found = {}
    for obj in doc.Objects:
        view = obj.ViewObject
        found[obj.Name] = {
            "visible": view.Visibility,
            "colour": getattr(view, "ShapeColor", None),
            "transparency": getattr(view, "Transparency", None),
            "proxy": type(getattr(view, "Proxy", None)).__name__,
            "shine": shine(view),
        }
    return found


def shine(view):
    """Specular colour of a body; `None` for what has no material."""
    if "ShapeAppearance" in view.PropertiesList:
        return view.ShapeAppearance[0].SpecularColor[:3]
    return view.ShapeMaterial.SpecularColor[:3] if "ShapeMaterial" in view.PropertiesList else None


def looks_and_edit(path, picture, changes, save_as, other, other_picture):
    """Look, edit, recompute and save in the window; then look at another document."""
    import FreeCAD

    found = {"first": looks(path, picture)}
    doc = FreeCAD.ActiveDocument
    change(doc, changes)
    doc.recompute()
    found["invalid"] = invalid(doc)
    doc.saveAs(save_as)
    FreeCAD.closeDocument(doc.Name)
    return found | {"other": looks(other, other_picture)}
