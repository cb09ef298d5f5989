"""The FreeCAD document of the cell, made and read without a window."""

import pytest

from app import document_steps as steps

JOBS = {
    "defaults": '[target]\nsurface = "face"',
    "everything else": """
[target]
mesh = "faces/μ ü.stl"
subdivision = "midpoint"
flip = true
[material]
lambda = 0.615
nu = 0.47
[sheet]
width_mm = 19.7
gap_um = 150
twist_gain = -2.5
edge_overdrive = true
[domains]
size_um = 333.3
[channels]
width_um = 0.7
spacing_um = 1.1
depth_um = 0.123456789
guard_um = 0.3
[plates]
width_mm = 75.0
glass_mm = 1.1
epoxy_um = 12.0
[marks]
clearance_mm = 2.9
tolerance_um = 5.7
[spacer]
strip_mm = 3.3
clearance_mm = 0.0
glue_mm = 2.1
[solver]
starts = 7
tolerance = 3e-9
max_iterations = 77
[output]
masks = ["dxf"]
freecad = false
step_domains = [0, 17, 4]
""",
    "a curve": '[target]\nsurface = "dome"\n[material]\ncurve = "strain.csv"\ntemperature_C = 0.0',
}


@pytest.mark.parametrize("toml", JOBS.values(), ids=JOBS.keys())
def test_every_section_survives_properties_and_file_exactly(freecad, tmp_path, toml):
    before, after = freecad.console(steps.round_trip, toml=toml, path=tmp_path / "job.FCStd")
    assert after == before
