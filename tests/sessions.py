"""A session in the window against `./lce build` of the job that it leaves."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import gui_tour
from freecad_call import FreeCAD
from processes import display

from lce_workbench import stages
from lce_workbench.cli import main

FABRICATED = ("domains.csv", "mask/", "cad/", "drawings/")
PATIENCE = 3600.0
"""For a session [s]."""
BESIDE = {".png", ".FCStd"}
"""Pictures, and the document, which holds the design's record of its starts."""


def held(mesh: Path, folder: Path, settings: dict[str, dict[str, str]], pictures: str = "") -> dict[str, Any]:
    """What the window showed of a session with a mesh, which exports below ``folder / "out folder"``."""
    freecad = FreeCAD(folder / "home")
    freecad.seconds = PATIENCE
    out = str(folder / "out folder")
    with display() as screen:
        found: dict[str, Any] = freecad.window(
            screen, gui_tour.whole, mesh=str(mesh), folder=out, settings=settings, pictures=pictures
        )
    assert "Traceback" not in freecad.said
    assert set(found["statuses"].values()) == {"current"}
    assert found["folder"] == str(folder / "out folder" / "out" / "cell")
    return found


def compared(folder: Path) -> tuple[list[str], list[str]]:
    """Build the job that a session left in ``folder``; names of the fabricated files, and of those that differ.

    Both have the same files, but for the review, which is left out here; or this raises.
    """
    exported, built = folder / "out folder" / "out" / "cell", folder / "built"
    assert main(["design", str(folder / "out folder" / "cell.toml"), "--out", str(built), "--quiet"]) in {0, 3}
    for stage in ("predict", "mask", "cad", "drawings"):
        assert main([stage, str(built), "--quiet"]) in {0, 1, 3}
    names, others = ({p.relative_to(at) for p in at.rglob("*") if p.is_file()} for at in (exported, built))
    assert names - others == {Path(name) for name in stages.OUTPUTS["review"]}
    made = sorted(n.as_posix() for n in names if n.as_posix().startswith(FABRICATED) and n.suffix not in BESIDE)
    return made, [name for name in made if (exported / name).read_bytes() != (built / name).read_bytes()]
