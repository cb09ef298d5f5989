"""Outlines of the cell's parts seen from above, in true millimetres: SVG for the eye and the cutter, DXF for CAD."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np

from lce_solver.types import Floats
from lce_workbench.core.cell import Cell
from lce_workbench.core.prism import bodies
from lce_workbench.export.dxf import fixed_stamps

MILLIMETRES = 4
"""$INSUNITS of mm."""

STROKE = 0.02
"""Width of the lines in the SVG [mm]."""

MARGIN = 1.0
"""Around everything in the SVG [mm]."""


def rings(cell: Cell) -> dict[str, list[Floats]]:
    """Name of a part -> its outlines (k, 2), each once: edges, chamfers, recesses and the channels cut into it [mm]."""
    return {
        name: list({ring.tobytes(): ring for prism in stack for ring in (*prism.rings, prism.top)}.values())
        for name, stack in bodies(cell.parts).items()
    }


def write_svg(cell: Cell, path: Path) -> None:
    """Write a drawing of 1 mm per mm: a group for each part, y upwards.

    Raises
    ------
    OSError
        The file cannot be written.
    """
    parts = rings(cell)
    colours = {prism.name: "#" + "".join(f"{round(255 * c):02x}" for c in prism.colour) for prism in cell.parts}
    points = np.concatenate([ring for each in parts.values() for ring in each])
    low, (width, height) = points.min(axis=0) - MARGIN, np.ptp(points, axis=0) + 2 * MARGIN
    groups = "\n".join(
        f'<g id="{name}" stroke="{colours[name]}">\n<path d="{" ".join(map(_path, each))}"/>\n</g>'
        for name, each in parts.items()
    )
    box = f"{low[0]:.6f} {-(low[1] + height):.6f} {width:.6f} {height:.6f}"
    path.write_text(
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{width:.6f}mm" height="{height:.6f}mm" viewBox="{box}">\n'
        f'<g transform="scale(1,-1)" fill="none" stroke-width="{STROKE}">\n{groups}\n</g>\n</svg>\n',
        encoding="ascii",
    )


def _path(ring: Floats) -> str:
    return "M" + "L".join(f"{x:.6f},{y:.6f}" for x, y in ring.tolist()) + "Z"


def write_dxf(cell: Cell, path: Path) -> None:
    """Write R2000 in mm: closed polylines on a layer for each part.

    Raises
    ------
    OSError
        The file cannot be written.
    """
    import ezdxf

    with fixed_stamps():
        document = ezdxf.new("R2000", units=MILLIMETRES)
        for number, (name, each) in enumerate(rings(cell).items(), 1):
            document.layers.add(name.upper(), color=number)
            for ring in each:
                document.modelspace().add_lwpolyline(ring.tolist(), close=True, dxfattribs={"layer": name.upper()})
        document.saveas(path)


OUTLINES: dict[str, Callable[[Cell, Path], None]] = {"svg": write_svg, "dxf": write_dxf}
"""Names that `output.cad` may hold -> what writes cad/outlines.*."""
