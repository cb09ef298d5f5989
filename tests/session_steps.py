"""What the tests of the session do inside FreeCAD: the whole work on a cell, by the functions that scripts call."""

import time


def work(mesh, folder):
    """From a mesh to its masks; returns what was found on the way."""
    import FreeCAD

    from lce_workbench import packages

    packages.append()
    from lce_workbench.app import cells, session

    found = {}
    doc = FreeCAD.newDocument("Session")
    cell = session.new_cell(doc, {"target.mesh": mesh, "sheet.width_mm": 3.0, "domains.size_um": 300.0})
    found["new"] = statuses(doc)
    session.design(cell)
    found["designed"] = statuses(doc)
    found["refused"] = refused(session, cell)
    session.plates(cell)
    session.predict(cell)
    found["predicted"] = [doc.Prediction.Status, doc.Prediction.Verdict, doc.Prediction.Rms]
    found["twist"], found["mask"] = figures(doc)
    recomputed = watch(doc)
    session.set_parameters(cell, {"sheet.gap_um": 150.0})
    found["gap"] = {"recomputed": recomputed(), "statuses": statuses(doc), "figures": figures(doc)}
    session.inspect(cell)
    found["said"] = [text for text in doc.Review.Findings if "by the formula alone" in text]
    began = time.process_time()
    session.set_parameters(cell, {"channels.depth_um": 0.7})
    found["depth"] = {"recomputed": recomputed(), "seconds": time.process_time() - began}
    land, glass = doc.BottomLand.Shape, doc.BottomGlass.Shape
    session.set_parameters(cell, {"plates.glass_mm": 0.9})
    found["kept"] = [doc.BottomLand.Shape.isPartner(land), doc.BottomGlass.Shape.isPartner(glass)]
    doc.BottomLand.Shape = glass
    doc.recompute()
    found["restored"] = doc.BottomLand.Shape.isPartner(land)
    session.channel_window(cell, (3, 7))
    found["window"] = len(doc.ChannelsTop.Shape.Solids)
    session.mask(cell, folder)
    found["masked"], found["drawn"] = statuses(doc), figures(doc)
    session.set_parameters(cell, {"output.step_domains": (4,)})
    found["window moved"] = statuses(doc)
    session.set_parameters(cell, {"prediction.correct": "off"})
    found["off"] = [statuses(doc), figures(doc)]
    session.set_parameters(cell, {"prediction.correct": "full"})
    doc.addObject("Spreadsheet::Sheet", "Table").set("A1", "=20 um")
    doc.Table.setAlias("A1", "layer")
    doc.recompute()
    doc.PlatesParameters.setExpression("Epoxy", "Table.layer + 10 * ChannelsParameters.Width")
    doc.recompute()
    found["expression"] = [doc.PlatesParameters.Epoxy.Value, doc.BottomEpoxy.Shape.BoundBox.ZLength]
    session.set_parameters(cell, {"sheet.width_mm": 4.0})
    found["stale"] = statuses(doc)
    found["too late"] = message(lambda: session.mask(cell, folder))
    found["children"] = [o.Label for o in cell.Group]
    found["cell"] = cells.the_cell(doc, [doc.BottomGlass]).Name
    return found


def statuses(doc):
    """Label -> status of the results."""
    return {o.Label: o.Status for o in doc.Objects if "MadeFor" in o.PropertiesList}


def figures(doc):
    return doc.Design.LargestTwist.Value, [doc.Mask.ChannelsBottom, doc.Mask.ChannelsTop, doc.Mask.Code]


def message(call):
    """The sentence of the mistake that a call refuses."""
    from lce_solver.errors import LceError

    try:
        call()
    except LceError as fault:
        return str(fault)
    return ""


def refused(session, cell):
    """Sentences for wrong settings, which change nothing."""
    before = session.job(cell)
    wrong = [{"sheet.gap_um": -1.0}, {"sheet.gap": 1.0}, {"channels.depth_um": 60.0}, {"target.mesh": "/no/such.stl"}]
    wrong += [{"marks.label": "ä"}, {"output.writer_um": 2.0}]
    said = [message(lambda s=settings: session.set_parameters(cell, s)) for settings in wrong]
    return [*said, session.job(cell) == before]


def watch(doc):
    """Count what FreeCAD recomputes; call the result to get the names since the last call."""
    import FreeCAD

    class Observer:
        def __init__(self):
            self.names = []

        def slotRecomputedObject(self, obj):  # noqa: N802
            self.names.append(obj.Name)

    observer = Observer()
    FreeCAD.addDocumentObserver(observer)

    def since():
        found, observer.names = sorted(set(observer.names)), []
        return found

    return since


def old(path, save_as):
    """Open a document of an older schema, use it, save it and open it again."""
    import FreeCAD

    import lce_workbench  # noqa: F401
    from lce_workbench import packages

    packages.append()
    doc = FreeCAD.openDocument(path)
    found = {"versions": sorted({o.SchemaVersion for o in doc.Objects if "SchemaVersion" in o.PropertiesList})}
    found["labels"] = {o.Name: o.Label for o in doc.Objects}
    from lce_workbench.app import cells, document, session

    cell = cells.the_cell(doc)
    found["job"] = repr(session.job(cell))
    volume = doc.BottomLand.Shape.Volume
    doc.ChannelsParameters.Depth = doc.ChannelsParameters.Depth * 2
    doc.recompute()
    found["ratio"] = doc.BottomLand.Shape.Volume / volume
    found["invalid"] = [o.Name for o in doc.Objects if not o.isValid()]
    found["status"] = doc.Design.Status
    document.add_result(cell, "Mask")
    doc.SheetParameters.Width = "9 mm"
    doc.recompute()
    found["stale"] = doc.Design.Status
    doc.saveAs(save_as)
    FreeCAD.closeDocument(doc.Name)
    doc = FreeCAD.openDocument(save_as)
    found["again"] = [doc.Design.Status, doc.MarksParameters.PrintedLabel, doc.MarksParameters.Label]
    return found


def third(path):
    """Open a document of schema 3 and change what its results depend on."""
    import FreeCAD

    import lce_workbench  # noqa: F401
    from lce_workbench import packages

    packages.append()
    doc, found = FreeCAD.openDocument(path), {}
    doc.recompute()
    versions = sorted({o.SchemaVersion for o in doc.Objects if "SchemaVersion" in o.PropertiesList})
    found["opened"] = [versions, doc.Design.Status, doc.Mask.Status]
    from lce_workbench.app import session

    for name, settings in {
        "gap": {"sheet.gap_um": 150.0},
        "uncorrected": {"prediction.correct": "off"},
        "back": {"sheet.gap_um": 100.0, "prediction.correct": "full", "spacer.bead_mm": 0.5},
    }.items():
        session.set_parameters(doc.Cell, settings)
        found[name] = [doc.Design.Status, doc.Mask.Status]
    return found


def sources(mesh_file, folder):
    """Targets from a mesh and from a face of a part."""
    import FreeCAD
    import Mesh
    import Part

    from lce_workbench import packages

    packages.append()
    from lce_workbench.app import session

    found = {}
    doc = FreeCAD.newDocument("Sources")
    obj = doc.addObject("Mesh::Feature", "Scan")
    obj.Mesh = Mesh.Mesh(mesh_file)
    cell = session.new_cell(doc, {"sheet.width_mm": 3.0}, obj)
    target = next(o for o in cell.Group if getattr(o, "Section", "") == "target")
    found["mesh"] = [target.Mesh, open(target.File).read(), target.Surface]  # noqa: SIM115, PTH123
    ball = doc.addObject("Part::Feature", "Ball")
    ball.Shape = Part.makeSphere(10, FreeCAD.Vector(), FreeCAD.Vector(0, 0, 1), 30, 90, 360)
    other = session.new_cell(doc, {"sheet.width_mm": 12.0, "domains.size_um": 600.0}, (ball, "Face1"))
    target = next(o for o in other.Group if getattr(o, "Section", "") == "target")
    found["face"] = open(target.File).read()  # noqa: SIM115, PTH123
    ball.Shape = Part.makeSphere(20, FreeCAD.Vector(), FreeCAD.Vector(0, 0, 1), 30, 90, 360)
    doc.recompute()
    found["moved"] = open(target.File).read()  # noqa: SIM115, PTH123
    box = doc.addObject("App::FeaturePython", "NoShape")
    target.Source = (box, "")
    doc.recompute()
    found["wrong"] = target.getStatusString()
    return found
