"""What scripts do to a document without a window, and what is left of a damaged one."""

DOCUMENT = "tests/documents/schema3.FCStd"


def opened(path):
    import FreeCAD

    import lce_workbench  # noqa: F401

    return FreeCAD.openDocument(str(path))


def refused(root):
    """Settings that cannot be taken, and what they change."""
    from missing_steps import message

    doc = opened(f"{root}/{DOCUMENT}")
    from lce_workbench.app import session

    cell, sheet = doc.Cell, doc.addObject("Spreadsheet::Sheet", "Values")
    sheet.set("A1", "=1.2 um")
    sheet.setAlias("A1", "depth")
    doc.recompute()
    doc.ChannelsParameters.setExpression("Depth", "Values.depth")
    doc.recompute()
    former, found = session.job(cell), {"depth": doc.BottomLand.Shape.BoundBox.ZLength}
    calls = {
        "driven": lambda: session.set_parameters(cell, {"channels.depth_um": 0.5, "sheet.gap_um": 150.0}),
        "unknown": lambda: session.set_parameters(cell, {"sheet.nosuch": None}),
        "no section": lambda: session.set_parameters(cell, {"gap": None}),
        "no domain": lambda: session.channel_window(cell, (99999,)),
        "no window": lambda: session.drawings(cell),
    }
    for name, call in calls.items():
        found[name] = [*message(call), session.job(cell) == former, [o.Name for o in doc.Objects if not o.isValid()]]
    session.set_parameters(cell, {"sheet.gap_um": 150.0})
    sheet.set("A1", "=2 um")
    doc.recompute()
    found["free"] = [doc.BottomLand.Shape.BoundBox.ZLength, session.job(cell).sheet.gap_um]
    return found


def damaged(root, folder):
    """A document without its design's file, and one that was cut off in the middle."""
    import zipfile
    from pathlib import Path

    from missing_steps import message

    found, whole, path = {}, Path(root) / DOCUMENT, Path(folder) / "lost.FCStd"
    with zipfile.ZipFile(whole) as old, zipfile.ZipFile(path, "w") as new:
        for name in old.namelist():
            if not name.endswith(".npz"):
                new.writestr(name, old.read(name))
    doc = opened(path)
    from lce_workbench.app import session

    found["volume"] = doc.BottomLand.Shape.Volume
    found["lost"] = [doc.Design.Status]
    for call in (session.plates, session.inspect, lambda cell: session.mask(cell, folder)):
        found["lost"] += message(lambda call=call: call(doc.Cell))[-1:]
    short = Path(folder) / "short.FCStd"
    short.write_bytes(whole.read_bytes()[: cut(whole)])
    doc = opened(short)
    found["short"] = [doc.TopLand.Shape.isNull(), message(lambda: session.inspect(doc.Cell))[-1]]
    session.plates(doc.Cell)
    session.inspect(doc.Cell)
    found["mended"] = [doc.Design.Status, doc.TopLand.Shape.isNull(), doc.Review.Errors]
    doc.ChannelsParameters.Depth = "-3 um"
    doc.recompute()
    session.inspect(doc.Cell)
    found["impossible"] = [text for text in doc.Review.Findings if "could not be computed" in text]
    return found


def cut(path):
    """Bytes of a document up to the middle of its shapes."""
    import zipfile

    with zipfile.ZipFile(path) as file:
        shapes = [info.header_offset for info in file.infolist() if info.filename.endswith(".brp")]
    return shapes[len(shapes) // 2]


def without_addon(path, save_as):
    """A parameter is edited, and the document saved, where nobody knows our proxies."""
    import FreeCAD

    doc = FreeCAD.openDocument(str(path))
    lost = [obj.Name for obj in doc.Objects if getattr(obj, "Proxy", obj) is None]
    doc.ChannelsParameters.Depth = "1.2 um"
    doc.recompute()
    doc.saveAs(str(save_as))
    return [len(lost), doc.BottomLand.Shape.BoundBox.ZLength]


def with_addon_again(path):
    """The same document at home."""
    doc = opened(path)
    from lce_workbench.app import cells, session

    found = {"cells": [cell.Name for cell in cells.cells(doc)]}
    found["lost"] = [obj.Name for obj in doc.Objects if getattr(obj, "Proxy", obj) is None]
    found["labels"] = [doc.ChannelsParameters.Label, doc.BottomLand.Label]
    doc.recompute()
    found["depth"] = doc.BottomLand.Shape.BoundBox.ZLength
    session.set_parameters(doc.Cell, {"sheet.gap_um": 150.0})
    found["gap"] = [doc.SpacerLeft.Shape.BoundBox.ZLength, doc.Design.Status]
    session.inspect(doc.Cell)
    found["review"] = [doc.Review.Errors, [o.Name for o in doc.Objects if not o.isValid()]]
    return found
