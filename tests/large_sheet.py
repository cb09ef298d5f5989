"""A square sheet of many domains in FreeCAD's window."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import sheets
from freecad_call import FreeCAD
from processes import display

from lce_workbench.outputs import write_design


def in_window(benchmark: Any, folder: Path, step: Callable[..., Any], width: float, columns: int, rows: int) -> Any:
    """What ``step`` measures in a window of its own, once, on a sheet ``width`` [mm] wide and high."""
    (folder / "job.toml").write_text(f'[target]\nsurface = "saddle"\n[sheet]\nwidth_mm = {width}\n')
    write_design(sheets.design(columns=columns, rows=rows, width=width, height=width), folder / "design.npz")

    def measured() -> Any:
        freecad = FreeCAD(folder / "home")
        with display() as screen:
            return freecad.window(screen, step, folder=str(folder))

    return benchmark.pedantic(measured, rounds=1)
