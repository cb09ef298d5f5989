"""Run inside FreeCAD: what its kernel says about the sample cell and about the STEP files."""

from __future__ import annotations

import json
from pathlib import Path


def main(folder: str) -> None:
    import Part
    from cad.cad_sample import cell

    from lce_workbench.cad.part import solid

    built = cell()
    shapes = {f"{i} {p.name}": solid(p) for i, p in enumerate((*built.parts, *built.channels))}
    files = {}
    for path in sorted(Path(folder).rglob("*.step")):
        shape = Part.Shape()
        shape.read(str(path))
        files[path.relative_to(folder).as_posix()] = [measured(s) for s in shape.Solids]
    prisms = {name: measured(shape) for name, shape in shapes.items()}
    (Path(folder) / "freecad.json").write_text(json.dumps({"prisms": prisms, "files": files}))


def measured(shape) -> dict:
    box = shape.BoundBox
    return {
        "volume": shape.Volume,
        "centroid": list(shape.CenterOfMass),
        "valid": shape.isValid(),
        "box": [box.XMin, box.YMin, box.ZMin, box.XMax, box.YMax, box.ZMax],
    }
