"""The FreeCAD document, opened by FreeCAD in a process of its own."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import tempfile
from collections.abc import Iterator, Mapping
from contextlib import suppress
from pathlib import Path

import numpy as np

from lce_solver.types import Finding, Severity
from lce_workbench.verify.finding import Unreadable, error, measured, same
from lce_workbench.verify.solids import Part

NAME = "cad/cell.FCStd"

SCRIPT = """
import json, sys, FreeCAD
doc = FreeCAD.openDocument({path!r})
found = []
for obj in doc.Objects:
    shape = getattr(obj, "Shape", None)
    if obj.TypeId.startswith("Part::") and shape is not None and shape.Solids:
        box = shape.BoundBox
        found.append([obj.Label, len(shape.Solids), shape.Volume, [box.XMin, box.YMin, box.ZMin],
                      [box.XMax, box.YMax, box.ZMax], shape.isValid()])
with open({answer!r}, "w") as file:
    json.dump(found, file)
"""

BODIES = {"Film": "sheet"}
"""Bodies whose label is not their part's name: in the document "Sheet" is what holds the sheet's parameters."""

PATIENCE = 600.0
"""So long FreeCAD may open it [s]."""

LOOSE = 1e-6
"""FreeCAD's boxes are as wide as the kernel's tolerance [mm]."""


def program() -> str | None:
    """FreeCAD without a window, if it is installed."""
    return shutil.which("freecadcmd") or shutil.which("FreeCADCmd")


def parts(path: Path) -> list[Part]:
    """Bodies of the document by their labels, written as the STEP files' names are.

    Raises
    ------
    Unreadable
        FreeCAD cannot open it.
    """
    with tempfile.TemporaryDirectory() as home:
        answer = Path(home) / "answer.json"
        code = SCRIPT.format(path=str(path.resolve()), answer=str(answer))
        place = {"LC_ALL": "C.UTF-8", "FREECAD_USER_HOME": home, "PYTHONPATH": ""}
        call = [program() or "freecadcmd", "-c", code]
        with suppress(subprocess.TimeoutExpired):  # then there is no answer
            subprocess.run(call, capture_output=True, check=False, env={**os.environ, **place}, timeout=PATIENCE)
        if not path.is_file() or not answer.is_file():
            msg = "FreeCAD cannot open it; run `./lce cad` again"
            raise Unreadable(msg)
        rows = json.loads(answer.read_text(encoding="utf-8"))
    named = [(BODIES.get(label, label.lower().replace(" ", "_")), *row) for label, *row in rows]
    return [
        Part(name, count, volume, np.array(low), np.array(high), valid, np.empty(0))
        for name, count, volume, low, high, valid in named
    ]


def absent() -> Finding:
    """Says that FreeCAD is not there to read its document."""
    text = f"{NAME}: not verified, because FreeCAD is not installed"
    return Finding("verify_document", Severity.WARNING, text, where=NAME)


def check(held: list[Part], known: Mapping[str, Part]) -> Iterator[Finding]:
    """The bodies against the parts of the STEP files."""
    named = {part.name: part for part in held}
    missing = sorted(known.keys() - named.keys())
    yield same("verify_document", NAME, "the list of missing parts", ", ".join(missing) or "empty", "empty")
    for name in sorted(known.keys() & named.keys()):
        one, other = named[name], known[name]
        where = f"{NAME}, {name}"
        off = np.abs(np.concatenate([one.low - other.low, one.high - other.high])).max()
        yield measured("verify_document", where, "its box differs from the STEP file's by", off, LOOSE, unit="mm")
        off = abs(one.volume - other.volume) / max(abs(other.volume), 1e-12)
        yield measured("verify_document", where, "its volume differs from the STEP file's by the fraction", off, 1e-6)
        if not one.valid:
            yield error("verify_document", where, "is no valid solid")
