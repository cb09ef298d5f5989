"""A session from a mesh to all files in the window; the files are those of `./lce build`."""

import sessions
import trimesh

from lce_solver.surfaces import SURFACES

SETTINGS = {
    "NewCell": {"sheet.width_mm": "2 mm", "domains.size_um": "400 um"},
    "Design": {"solver.starts": "3"},
    "Predict": {"prediction.steps": "4"},
    "Plates": {"marks.grating": "no", "marks.fields": ""},
    "Mask": {"output.masks": "gds", "output.pictures": "no"},
}
"""What makes little work, and is another value than the default in each panel."""


def test_a_session_ends_with_the_files_of_the_command_line(tmp_path):
    surface = SURFACES["saddle"](0.2)
    trimesh.Trimesh(surface.vertices, surface.faces, process=False).export(tmp_path / "bump.stl")
    found = sessions.held(tmp_path / "bump.stl", tmp_path, SETTINGS)
    assert found["rows"] > 30
    made, differing = sessions.compared(tmp_path)
    assert len(made) > 30
    assert differing == []
