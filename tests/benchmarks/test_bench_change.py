"""A parameter changed in the window, with the domain table open, on a sheet of 20 mm with 3900 domains.

python -m pytest tests/benchmarks/test_bench_change.py -o addopts=--import-mode=importlib --benchmark-only -s

Seconds of the processor in the window's thread, and of all threads: those that draw in software count there.
"""

import sys

import change_steps as steps
import sheets
from freecad_call import FreeCAD
from processes import display

from lce_workbench.outputs import write_design

JOB = '[target]\nsurface = "saddle"\n[sheet]\nwidth_mm = 20.0\n'


def test_changes_with_the_table_open(benchmark, tmp_path):
    (tmp_path / "job.toml").write_text(JOB)
    write_design(sheets.design(columns=42, rows=46, width=20.0, height=20.0), tmp_path / "design.npz")

    def change():
        freecad = FreeCAD(tmp_path / "home")
        with display() as screen:
            return freecad.window(screen, steps.changed, folder=str(tmp_path))

    found = benchmark.pedantic(change, rounds=1)
    for name, (clock, own, whole, recomputed) in found.items():
        sys.stdout.write(f"\n{name}: {own} s, all threads {whole} s, clock {clock} s; {len(recomputed)} objects\n")
    benchmark.extra_info.update(found)
    assert "Design" not in found["depth"][3]
    assert "TargetParameters" not in found["gap"][3]
    assert found["gap"][1] < 4.0
