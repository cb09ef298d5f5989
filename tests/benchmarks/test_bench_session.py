"""The whole session in FreeCAD's window on a real mesh, against `./lce build` of the same job.

LCE_MESHES=FOLDER python -m pytest tests/benchmarks/test_bench_session.py -o addopts=--import-mode=importlib \
    --benchmark-only -s

``LCE_MESHES`` names a folder with ``face.obj``; ``LCE_PICTURES``, if it is set, a folder for a picture of each step;
``LCE_WIDTH_MM`` another width of the sheet than 20 mm.
"""

import os
import sys
from pathlib import Path

import pytest
import sessions

FACE = Path(os.environ.get("LCE_MESHES", "")) / "face.obj"
SETTINGS = {"NewCell": {"sheet.width_mm": f"{os.environ.get('LCE_WIDTH_MM', '20')} mm"}}
CASES = [FACE] if FACE.is_file() else []


@pytest.mark.parametrize("mesh", CASES, ids=lambda mesh: mesh.name)
def test_the_session_on_a_real_mesh_makes_the_files_of_the_command_line(benchmark, mesh, tmp_path):
    pictures = os.environ.get("LCE_PICTURES", "")
    found = benchmark.pedantic(sessions.held, (mesh, tmp_path, SETTINGS, pictures), rounds=1)
    made, differing = sessions.compared(tmp_path)
    sys.stdout.write(f"\n{len(made)} files, {len(differing)} differ; {found['seconds']}; {found['figures']}\n")
    sys.stdout.write(
        f"window not free for [99 of 100 times by the clock, longest by the processor]: {found['free']} s\n"
    )
    benchmark.extra_info.update(found)
    assert max(found["free"][name][1] for name in ("Design", "Predict")) < 0.1
    assert {"domains.csv", "mask/bottom.gds", "mask/top.gds"} <= set(made)
    assert differing == []
