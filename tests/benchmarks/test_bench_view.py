"""The first draw of 1.5 million channels in FreeCAD's window, by a processor that draws in software.

python -m pytest tests/benchmarks/test_bench_view.py -o addopts=--import-mode=importlib --benchmark-only -s
"""

import sys

import sheets
import view_steps as steps
from freecad_call import FreeCAD
from processes import display

from lce_workbench.outputs import write_design

JOB = '[target]\nsurface = "saddle"\n[sheet]\nwidth_mm = 22.0\n'


def test_first_draw_of_all_channels(benchmark, tmp_path):
    (tmp_path / "job.toml").write_text(JOB)
    write_design(sheets.design(columns=60, rows=76, width=22.0, height=22.0), tmp_path / "design.npz")

    def draw():
        freecad = FreeCAD(tmp_path / "home")
        with display() as screen:
            return freecad.window(screen, steps.first_draw, folder=str(tmp_path))

    found = benchmark.pedantic(draw, rounds=1)
    lines = found.pop("lines")
    benchmark.extra_info.update(found, lines=lines)
    sys.stdout.write(f"\n{lines} lines; seconds of the clock and of the processor: {found}\n")
    assert lines > 1_500_000
    assert found["all"][1] < 3.0
