"""Masks of several output folders on one plate of the laser writer, with a map of what stands where."""

from __future__ import annotations

import csv
import io
from collections import Counter
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from lce_solver.errors import InputError
from lce_workbench.core.domains import PLATES
from lce_workbench.core.mask import LAYERS
from lce_workbench.export.together import STREET, Piece, Placed, arranged, polygons, write
from lce_workbench.outputs import MANIFEST, read_manifest, require_unchanged, staged, write_manifest
from lce_workbench.pipeline import versions

STAGES = ["plate"]
"""What the manifest says of a folder of ours."""

SIZES = {"4in": 101.6, "5in": 127.0, "6in": 152.4}
"""Sides of mask plates [mm]."""


def combine(folders: Sequence[Path], size: str, out: Path) -> int:
    """Write ``plate.gds``, ``plate.csv`` and ``plate.png`` into the folder ``out``; the number of polygons.

    Raises
    ------
    LceError
        A folder has no masks of ours, or they do not fit; nothing is written.
    """
    if len({folder.resolve() for folder in folders}) < len(folders):
        msg = "a folder is named twice; name each design once"
        raise InputError(msg)
    if (out / MANIFEST).is_file() and read_manifest(out)["stages"] != STAGES:
        msg = f"{out} is the output folder of a design and would be lost; choose another folder with --out"
        raise InputError(msg)
    pieces = [_piece(folder, name, plate) for folder, name in _named(folders).items() for plate in PLATES]
    side = SIZES[size]
    placed = arranged(pieces, side)
    with staged(out) as stage:
        count = write(placed, side, stage / "plate.gds")
        (stage / "plate.csv").write_text(table(placed), encoding="utf-8")
        _picture(placed, side, stage / "plate.png")
        inputs = [{"path": str(piece.path)} for piece in pieces]
        write_manifest(
            stage, {"versions": versions(), "stages": STAGES, "inputs": inputs, "findings": [], "exit_code": 0}
        )
    return count


def _named(folders: Sequence[Path]) -> dict[Path, str]:
    """Each folder with its name; those of the same name with their path."""
    names = Counter(folder.resolve().name for folder in folders)
    return {folder: name if names[name := folder.resolve().name] == 1 else str(folder) for folder in folders}


def _piece(folder: Path, name: str, plate: str) -> Piece:
    if not any(entry["path"] == f"mask/{plate}.gds" for entry in read_manifest(folder)["files"]):
        msg = f"{folder} has no masks as GDSII; let its output.masks name gds and run `./lce mask` on it"
        raise InputError(msg)
    require_unchanged(folder, f"mask/{plate}.gds")
    path = folder / "mask" / f"{plate}.gds"
    glass = next(found for layer, found in polygons(path) if layer == LAYERS["PLATE"])
    width, height = np.ptp(glass[0], axis=0) / 1e6
    return Piece(name, plate, path, (float(width), float(height)))


def table(placed: Sequence[Placed]) -> str:
    """The map as text: which mask stands where, whether its pattern is the sheet's mirror image."""
    text = io.StringIO()
    rows = csv.writer(text, lineterminator="\n")
    rows.writerow(["design", "plate", "x_mm", "y_mm", "width_mm", "height_mm", "mirrored", "file"])
    for item in placed:
        places = [f"{value:.6f}" for value in (item.x, item.y, *item.piece.size)]
        mirrored = "yes" if item.piece.plate == "top" else "no"
        rows.writerow([item.piece.design, item.piece.plate, *places, mirrored, item.piece.path])
    return text.getvalue()


def _picture(placed: Sequence[Placed], side: float, path: Path) -> None:
    """The map as a picture, seen on the resist side; dashed: where the saw runs."""
    from matplotlib.figure import Figure  # noqa: PLC0415 (slow, and only here)
    from matplotlib.patches import Rectangle  # noqa: PLC0415

    figure = Figure(figsize=(8, 8), layout="constrained")
    axes = figure.add_subplot(aspect="equal", xlim=(-side / 2 - 2, side / 2 + 2), ylim=(-side / 2 - 2, side / 2 + 2))
    axes.add_patch(Rectangle((-side / 2, -side / 2), side, side, fill=False, lw=2))
    for item in placed:
        width, height = item.piece.size
        colour = "tab:red" if item.piece.plate == "top" else "tab:blue"
        axes.add_patch(
            Rectangle((item.x - width / 2, item.y - height / 2), width, height, fc=colour, ec="k", alpha=0.3)
        )
        whole = item.x - (width + STREET) / 2, item.y - (height + STREET) / 2
        axes.add_patch(Rectangle(whole, width + STREET, height + STREET, fill=False, ls="--", lw=0.6))
        said = "mirrored" if item.piece.plate == "top" else "not mirrored"
        axes.text(
            item.x,
            item.y,
            f"{item.piece.design}\n{item.piece.plate}\n{said}",
            ha="center",
            va="center",
            size=8,
            parse_math=False,
        )
    axes.set(xlabel="x [mm]", ylabel="y [mm]")
    figure.savefig(path, dpi=130, metadata={"Software": None})
