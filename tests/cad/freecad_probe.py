"""Run inside FreeCAD: what its kernel says about the sample cell and about the STEP files."""

from __future__ import annotations

import json
from pathlib import Path


def main(folder: str) -> None:
    import Part
    from cad.cad_sample import stacks

    from lce_workbench.cad.part import solid

    files = {}
    for path in sorted(Path(folder).rglob("*.step")):
        shape = Part.Shape()
        shape.read(str(path))
        files[path.relative_to(folder).as_posix()] = [measured(s) for s in shape.Solids]
    built = [measured(solid(stack)) for stack in stacks()]
    (Path(folder) / "freecad.json").write_text(json.dumps({"bodies": built, "files": files}))


def measured(shape) -> dict:
    box = shape.BoundBox
    return {
        "volume": shape.Volume,
        "centroid": list(shape.CenterOfMass),
        "valid": shape.isValid(),
        "type": shape.ShapeType,
        "box": [box.XMin, box.YMin, box.ZMin, box.XMax, box.YMax, box.ZMax],
    }
