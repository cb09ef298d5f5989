"""Masks of several output folders on one plate of the laser writer, with a map of what stands where."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from lce_solver.errors import InputError
from lce_workbench.core.domains import PLATES
from lce_workbench.core.mask import LAYERS
from lce_workbench.export.together import Piece, Placed, arranged, polygons, write
from lce_workbench.outputs import require_unchanged, staged, write_manifest
from lce_workbench.pipeline import versions

SIZES = {"4in": 101.6, "5in": 127.0, "6in": 152.4}
"""Sides of mask plates [mm]."""


def combine(folders: Sequence[Path], size: str, out: Path) -> int:
    """Write ``plate.gds``, ``plate.csv`` and ``plate.png`` into the folder ``out``; the number of polygons.

    Raises
    ------
    LceError
        A folder has no masks of ours, or they do not fit; nothing is written.
    """
    names = [folder.resolve().name for folder in folders]
    if len({folder.resolve() for folder in folders}) < len(folders):
        msg = "a folder is named twice; name each design once"
        raise InputError(msg)
    pieces = [_piece(folder, name, plate) for folder, name in zip(folders, names, strict=True) for plate in PLATES]
    side = SIZES[size]
    placed = arranged(pieces, side)
    with staged(out) as stage:
        count = write(placed, side, stage / "plate.gds")
        (stage / "plate.csv").write_text(table(placed), encoding="utf-8")
        _picture(placed, side, stage / "plate.png")
        inputs = [{"path": str(piece.path)} for piece in pieces]
        write_manifest(
            stage, {"versions": versions(), "stages": ["plate"], "inputs": inputs, "findings": [], "exit_code": 0}
        )
    return count


def _piece(folder: Path, name: str, plate: str) -> Piece:
    require_unchanged(folder, f"mask/{plate}.gds")
    path = folder / "mask" / f"{plate}.gds"
    glass = next(found for layer, found in polygons(path) if layer == LAYERS["PLATE"])
    width, height = np.ptp(glass[0], axis=0) / 1e6
    return Piece(name, plate, path, (float(width), float(height)))


def table(placed: Sequence[Placed]) -> str:
    """The map as text: which mask stands where, whether its pattern is the sheet's mirror image."""
    rows = [
        f"{item.piece.design},{item.piece.plate},{item.x:.6f},{item.y:.6f},{item.piece.size[0]:.6f},"
        f"{item.piece.size[1]:.6f},{'yes' if item.piece.plate == 'top' else 'no'},{item.piece.path}"
        for item in placed
    ]
    return "\n".join(["design,plate,x_mm,y_mm,width_mm,height_mm,mirrored,file", *rows]) + "\n"


def _picture(placed: Sequence[Placed], side: float, path: Path) -> None:
    """The map as a picture, seen on the resist side."""
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
        said = "mirrored" if item.piece.plate == "top" else "not mirrored"
        axes.text(item.x, item.y, f"{item.piece.design}\n{item.piece.plate}\n{said}", ha="center", va="center", size=8)
    axes.set(xlabel="x [mm]", ylabel="y [mm]")
    figure.savefig(path, dpi=130, metadata={"Software": None})
