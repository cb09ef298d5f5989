"""Mask files through readers that are not ours: gdstk for GDSII and OASIS, ezdxf for DXF; CIF needs none."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from lce_solver.types import Floats
from lce_workbench.verify import drawings
from lce_workbench.verify.finding import Unreadable, reading

LAYERS = {1: "CHANNELS", 2: "MARKS", 3: "LABELS", 4: "TEST", 10: "PLATE", 11: "DOMAINS", 12: "SPACER", 13: "SEAM"}
"""Numbers (GDSII, OASIS) and names (DXF, CIF) of the layers."""

SHORT = {"CHAN": "CHANNELS", "MARK": "MARKS", "LABL": "LABELS", "PLAT": "PLATE", "DOMN": "DOMAINS", "SPCR": "SPACER"}
"""CIF's names of four letters."""

MICRON = 1000.0
"""[nm]"""

MAX_CORNERS = 4000
"""Of a polygon; no reader of GDSII has to take more."""

DXF_UNITS = {"1": 25.4e6, "4": 1e6, "5": 1e7, "6": 1e9, "13": MICRON, "12": 1.0}
"""$INSUNITS -> nm."""

FARTHEST = 1e12
"""No corner lies so far out [nm]."""


@dataclass(frozen=True, eq=False)
class Layout:
    """What a mask file holds."""

    name: str
    """Of the file."""
    layers: Mapping[str, Floats]
    """Layer -> polygons (n, k, 2), those with fewer corners repeat their last one [nm]."""
    cells: tuple[str, ...] | None
    """Names of the cells; None where the format has none."""
    grid: tuple[float, float] | None
    """Smallest step and user unit as the file states them [m]; None where it states none."""
    others: tuple[str, ...]
    """Everything that is not a closed polygon: texts, references, paths, with how many."""

    @property
    def count(self) -> int:
        """Number of polygons."""
        return sum(len(polygons) for polygons in self.layers.values())


def read(path: Path) -> Layout:
    """The polygons of a mask file by layer.

    Raises
    ------
    Unreadable
        The reader of its format cannot read it.
    """
    with reading():
        found = READERS[path.name.partition(".")[2]](path)
    if not all(np.all(np.abs(polygons) < FARTHEST) for polygons in found.layers.values()):
        msg = "has corners that are no finite numbers, or no unit; write it again"
        raise Unreadable(msg)
    return found


def _gdstk(path: Path) -> Layout:
    """GDSII or OASIS."""
    import gdstk

    library = (gdstk.read_oas if path.suffix == ".oas" else gdstk.read_gds)(str(path))
    others: Counter[str] = Counter()
    for cell in library.cells:
        for kind in ("labels", "references", "paths"):
            others[kind] += len(getattr(cell, kind))
        others["properties"] += sum(1 for _ in cell.properties)
    polygons = [polygon for cell in library.cells for polygon in cell.polygons]
    layer = np.array([(polygon.layer, polygon.datatype) for polygon in polygons], dtype=np.int64).reshape(-1, 2)
    names = {(number, 0): name for number, name in LAYERS.items()}
    keys = [names.get(tuple(row), "{}/{}".format(*row)) for row in np.unique(layer, axis=0).tolist()]
    which = np.unique(layer, axis=0, return_inverse=True)[1].ravel()
    corners = [polygon.points for polygon in polygons]
    scale = library.unit / 1e-9
    grouped = {key: _stacked([corners[i] for i in np.flatnonzero(which == k)]) * scale for k, key in enumerate(keys)}
    # Floats come of integers by a factor: back to the integers, unless they never were.
    layers = {key: _snapped(points) for key, points in grouped.items()}
    cells = tuple(cell.name for cell in library.cells)
    return Layout(path.name, layers, cells, (library.precision, library.unit), _told(others))


def _dxf(path: Path) -> Layout:
    """DXF of any version: closed polylines by layer, and what else there is; without a unit it is in um."""
    drawing = drawings.read(path.read_bytes())
    unit = MICRON if drawing.unit is None else DXF_UNITS.get(drawing.unit, np.nan)
    layers = _by_layer(drawing.points * unit, drawing.counts, drawing.layers)
    return Layout(path.name, layers, None, (1e-9, unit * 1e-9), _told(drawing.others))


def _cif(path: Path) -> Layout:
    """CIF 2.0: polygons in 0.01 um, scaled by the cell's a / b."""
    text = path.read_text(encoding="ascii")
    if not text.rstrip().endswith("E"):
        msg = "it ends before its end"
        raise ValueError(msg)
    unit, cells, layer = 10.0, [], ""
    others: Counter[str] = Counter()
    rows: dict[str, list[str]] = {}
    for command in re.sub(r"\([^)]*\)", "", text).split(";"):
        word = command.strip()
        if word.startswith("P"):
            rows.setdefault(layer, []).append(word[1:])
        elif word.startswith("L"):
            layer = SHORT.get(word[1:].strip(), word[1:].strip())
        elif word.startswith("DS"):
            _, _, a, b = word.split()
            unit = 10.0 * int(a) / int(b)
        elif word.startswith("9 "):
            cells.append(word[1:].strip())
        elif word[:1] in {"B", "W", "R", "9"}:
            others[word[:2].strip()] += 1
    layers = {
        key: _snapped(_stacked([np.array(row.split(), dtype=np.float64).reshape(-1, 2) for row in given]) * unit)
        for key, given in rows.items()
    }
    return Layout(path.name, layers, tuple(cells), (unit * 1e-9, unit * 1e-9), _told(others))


def _by_layer(points: Floats, counts: Any, names: Any) -> dict[str, Floats]:
    """Polygons laid end to end -> by layer, padded to the same number of corners."""
    starts = np.cumsum(counts) - counts
    found = {}
    for name in np.unique(names).tolist():
        rows = np.flatnonzero((names == name) & (counts > 0))
        size = _most(counts[rows])
        index = starts[rows, None] + np.minimum(np.arange(size), counts[rows, None] - 1)
        found[name] = _snapped(points[index])
    return found


def _stacked(polygons: list[Any]) -> Floats:
    """Polygons (k, 2) of any k as one array (n, k, 2)."""
    counts = np.array([len(polygon) for polygon in polygons], dtype=np.int64)
    index = np.cumsum(counts) - counts
    points = np.concatenate(polygons) if polygons else np.empty((0, 2))
    size = _most(counts)
    return np.asarray(points[index[:, None] + np.minimum(np.arange(size), counts[:, None] - 1)])


def _most(counts: Any) -> int:
    most = int(counts.max(initial=1))
    if most > MAX_CORNERS:
        msg = f"a polygon has {most} corners"
        raise ValueError(msg)
    return most


def _snapped(points: Floats) -> Floats:
    """Numbers that are integers but for the last bits of a factor become integers."""
    whole = np.rint(points)
    return np.where(np.abs(points - whole) < 1e-3, whole, points)


def _told(others: Mapping[str, int]) -> tuple[str, ...]:
    return tuple(f"{count} {kind}" for kind, count in sorted(others.items()) if count)


READERS: dict[str, Callable[[Path], Layout]] = {
    "gds": _gdstk,
    "oas": _gdstk,
    "dxf": _dxf,
    "r12.dxf": _dxf,
    "cif": _cif,
}
"""Ending -> reader."""
