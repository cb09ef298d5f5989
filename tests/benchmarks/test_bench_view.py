"""The first draw of 1.5 million channels in FreeCAD's window, by a processor that draws in software.

python -m pytest tests/benchmarks/test_bench_view.py -o addopts=--import-mode=importlib --benchmark-only -s
"""

import sys

import view_steps as steps
from large_sheet import in_window


def test_first_draw_of_all_channels(benchmark, tmp_path):
    found = in_window(benchmark, tmp_path, steps.first_draw, width=22.0, columns=60, rows=76)
    lines = found.pop("lines")
    benchmark.extra_info.update(found, lines=lines)
    sys.stdout.write(f"\n{lines} lines; seconds of the clock and of the processor: {found}\n")
    assert lines > 1_500_000
    assert found["all"][1] < 3.0
