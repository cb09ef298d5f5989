"""A parameter changed in the window, with the domain table open, on a sheet of 20 mm with 3900 domains.

python -m pytest tests/benchmarks/test_bench_change.py -o addopts=--import-mode=importlib --benchmark-only -s

Seconds of the processor in the window's thread, and of all threads: those that draw in software count there.
"""

import sys

import change_steps as steps
from large_sheet import in_window


def test_changes_with_the_table_open(benchmark, tmp_path):
    found = in_window(benchmark, tmp_path, steps.changed, width=20.0, columns=42, rows=46)
    for name, (clock, own, whole, recomputed) in found.items():
        sys.stdout.write(f"\n{name}: {own} s, all threads {whole} s, clock {clock} s; {len(recomputed)} objects\n")
    benchmark.extra_info.update(found)
    assert "Design" not in found["depth"][3]
    assert "TargetParameters" not in found["gap"][3]
    assert found["gap"][1] < 4.0
