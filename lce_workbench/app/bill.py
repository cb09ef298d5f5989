"""The bill of materials: a spreadsheet of the document whose volumes and masses follow the bodies.

Its cells are formulas, so it is right after every recompute, also in a FreeCAD without this workbench. Figures have
aliases (``bottom_carrier_mass``, ``total_mass``) for expressions and scripts.
"""

from __future__ import annotations

import tomllib
from dataclasses import dataclass
from functools import cache
from typing import Any

from lce_workbench import ROOT
from lce_workbench.app import cells, works
from lce_workbench.app.objects import prisms_around
from lce_workbench.app.properties import properties
from lce_workbench.core.job import PredictionSpec

NAME = "BillOfMaterials"
"""Of the spreadsheet, and in front of another cell's."""


@dataclass(frozen=True)
class Item:
    """One line: parts that are ordered or made together."""

    alias: str
    title: str
    material: str
    """Table of resources/densities.toml, or "film", whose density the job states."""
    prisms: tuple[str, ...]
    """Names of the prisms that belong to it."""
    several: bool = False
    """Whether they are pieces, not layers of one."""


ITEMS = (
    Item("bottom_carrier", "Carrier, bottom", "glass", ("bottom_glass",)),
    Item("bottom_layer", "Channel layer, bottom", "epoxy", ("bottom_epoxy", "bottom_land")),
    Item("spacer", "Spacer strip", "mylar", ("spacer_left", "spacer_right"), several=True),
    Item("film", "Film", "film", ("sheet",)),
    Item("top_layer", "Channel layer, top", "epoxy", ("top_epoxy", "top_land")),
    Item("top_carrier", "Carrier, top", "glass", ("top_glass",)),
    Item("glue", "Glue bead", "glue", ("glue_left", "glue_right"), several=True),
    Item("frame", "Alignment frame", "jig", ("alignment_frame",)),
)
"""In the order of the drawings' parts list."""

DENSITY = next(p.name for p in properties(PredictionSpec) if p.field == "density_kg_m3")
"""The property that states the film's density."""

HEAD = (
    "Item", "Part", "Pieces", "Material", "Volume (all)", "Density", "Mass (all)", "Source of the density", "Alias",
)  # fmt: skip
LETTERS = "ABCDEFGHI"
WIDTHS = (50, 170, 60, 160, 120, 110, 100, 560, 120)
"""Of the columns [pixels]."""

FIGURES = {"E": ("volume", "mm^3"), "F": ("density", "kg/m^3"), "G": ("mass", "g")}
"""Column -> the end of its cells' aliases, and their unit."""


@cache
def densities() -> dict[str, dict[str, Any]]:
    """Material -> name, density [kg/m3], whether it is an estimate, source."""
    return tomllib.loads((ROOT / "resources" / "densities.toml").read_text(encoding="utf-8"))


def add_bill(cell: Any) -> Any:
    """Add the cell's bill of materials, or bring the one that it has up to date; it is computed with the document."""
    sheet, rows = bill_of(cell), table(cell)
    if sheet is None:
        sheet = cell.Document.addObject("Spreadsheet::Sheet", NAME)
        sheet.Label = "Bill of materials"
        cell.addObject(sheet)
    elif _holds(sheet, rows):
        return sheet  # FreeCAD forgets the values of cells when their writing is undone
    sheet.clearAll()
    for row, texts in enumerate(rows, start=1):
        for letter, text in zip(LETTERS, texts, strict=True):
            if text:
                sheet.set(f"{letter}{row}", text)
    _dress(sheet, rows)
    return sheet


def bill_of(cell: Any) -> Any:
    """The cell's bill of materials, or `None`."""
    sheets = (obj for obj in cell.Group if obj.isDerivedFrom("Spreadsheet::Sheet"))
    return next((obj for obj in sheets if obj.Name.startswith(NAME)), None)


def table(cell: Any) -> list[tuple[str, ...]]:
    """The contents of the spreadsheet, row by row: head, items, sums."""
    present = {prism.name for prism in prisms_around(cell).parts}
    bodies = {obj.Prisms: obj.Name for obj in works.bodies(cell) if obj.Prisms in present}
    heating = cells.sections(cell)["prediction"].Name
    items = [(item, [bodies[name] for name in item.prisms if name in bodies]) for item in ITEMS]
    items = [(item, names) for item, names in items if names]
    last = len(items) + 1
    return [
        tuple(f"'{word}" for word in HEAD),
        *(_line(row, item, names, heating) for row, (item, names) in enumerate(items, start=2)),
        ("", "'Closed cell", "", "", f"=sum(E2:E{last})", "", f"=sum(G2:G{last})", "", "'total"),
    ]


def _line(row: int, item: Item, names: list[str], heating: str) -> tuple[str, ...]:
    """One item; its parts are those of ``names``, and ``heating`` names the object that knows the film's density."""
    if item.material == "film":
        name, density, source = "LCE film", f"={heating}.{DENSITY} * 1 kg/m^3", "prediction.density_kg_m3 of the job"
    else:
        matter = densities()[item.material]
        name, density = matter["name"], f"={matter['kg_m3']:g} kg/m^3"
        source = matter["source"] + "; an ESTIMATE" * matter["estimate"]
    volume = "=" + " + ".join(f"{body}.Volume" for body in names)
    pieces = f"={len(names) if item.several else 1}"
    words = f"={row - 1}", f"'{item.title}", pieces, f"'{name}"
    return (*words, volume, density, f"=E{row} * F{row}", f"'{source}", f"'{item.alias}")


def _holds(sheet: Any, rows: list[tuple[str, ...]]) -> bool:
    """Whether a spreadsheet holds these rows and none more; FreeCAD writes some contents in a way of its own."""
    there = [sheet.getContents(f"{letter}{row}") for row in range(1, len(rows) + 2) for letter in LETTERS]
    wanted = [text for row in (*rows, ("",) * len(LETTERS)) for text in row]
    return [*map(_plain, there)] == [*map(_plain, wanted)]


def _plain(text: str) -> str:
    return text.lstrip("'=").replace(" ", "")


def _dress(sheet: Any, rows: list[tuple[str, ...]]) -> None:
    """Widths, bold rows, units and aliases."""
    for letter, width in zip(LETTERS, WIDTHS, strict=True):
        sheet.setColumnWidth(letter, width)
    for row in (1, len(rows)):
        sheet.setStyle(f"A{row}:I{row}", "bold")
    for row, texts in enumerate(rows[1:], start=2):
        for letter, (kind, unit) in FIGURES.items():
            sheet.setDisplayUnit(f"{letter}{row}", unit)
            if texts[LETTERS.index(letter)]:
                sheet.setAlias(f"{letter}{row}", f"{texts[-1].strip(chr(39))}_{kind}")
