"""A session from a mesh to all files in the window; the files are those of `./lce build`."""

import gui_tour as tour
import trimesh
from freecad_call import FreeCAD
from processes import display

from lce_solver.surfaces import SURFACES
from lce_workbench.cli import main

FABRICATED = ("domains.csv", "mask/", "cad/", "drawings/")
BESIDE = {".png", ".FCStd"}
"""Pictures, and the document, which holds the design's record of its starts."""


def test_a_session_ends_with_the_files_of_the_command_line(tmp_path):
    surface, out, built = SURFACES["saddle"](0.2), tmp_path / "out folder", tmp_path / "built"
    trimesh.Trimesh(surface.vertices, surface.faces, process=False).export(tmp_path / "bump.stl")
    freecad = FreeCAD(tmp_path / "home")
    with display() as screen:
        found = freecad.window(screen, tour.whole, mesh=str(tmp_path / "bump.stl"), folder=str(out))
    assert "Traceback" not in freecad.said
    assert set(found["statuses"].values()) == {"current"}
    assert found["rows"] > 30
    exported = out / "out" / "cell"
    assert found["folder"] == str(exported)
    assert main(["build", str(out / "cell.toml"), "--out", str(built), "--quiet"]) in {0, 1, 3}
    names, others = ({p.relative_to(folder) for p in folder.rglob("*") if p.is_file()} for folder in (exported, built))
    assert names == others
    made = [name for name in names if name.as_posix().startswith(FABRICATED) and name.suffix not in BESIDE]
    assert len(made) > 30
    assert [name for name in made if (exported / name).read_bytes() != (built / name).read_bytes()] == []
