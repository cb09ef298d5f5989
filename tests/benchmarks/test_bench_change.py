"""A parameter changed in the window, with the domain table open, on sheets of 10 mm (as the demo) and of 20 mm.

python -m pytest tests/benchmarks/test_bench_change.py -o addopts=--import-mode=importlib --benchmark-only -s

Seconds of the processor in the window's thread, and of all threads: those that draw in software count there.
"""

import sys

import change_steps as steps
import pytest
from large_sheet import in_window


@pytest.mark.parametrize(("width", "columns", "rows"), [(10.0, 29, 33), (20.0, 42, 46)])
def test_changes_with_the_table_open(benchmark, tmp_path, width, columns, rows):
    found = in_window(benchmark, tmp_path, steps.changed, width=width, columns=columns, rows=rows)
    for name, (clock, own, whole, recomputed) in found.items():
        sys.stdout.write(f"\n{name}: {own} s, all threads {whole} s, clock {clock} s; {len(recomputed)} objects\n")
    benchmark.extra_info.update(found)
    assert "Design" not in found["depth"][3]
    assert "TargetParameters" not in found["gap"][3]
    assert found["depth, hidden"][1] < 1.0
