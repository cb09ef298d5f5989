"""report.pdf: the same review for paper, set by Typst from the same record; same folder, same bytes."""

from __future__ import annotations

import json
import shutil
import tempfile
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from lce_workbench.review.data import Review
from lce_workbench.review.figures import Drawn, maps, shapes
from lce_workbench.review.html import TEMPLATES

COLUMNS = {
    "domain": ("domain", 6, 0), "x_mm": ("x", 9, 3), "y_mm": ("y", 9, 3), "area_mm2": ("area", 9, 5),
    "theta_deg": ("theta", 9, 3), "dtheta_deg": ("dtheta", 8, 3), "theta_top_deg": ("top", 9, 3),
    "theta_bottom_deg": ("bottom", 9, 3), "written_top_deg": ("w_top", 9, 3), "written_bottom_deg": ("w_bottom", 9, 3),
    "stretch_along": ("along", 8, 4), "stretch_across": ("across", 8, 4), "channels_top": ("n_top", 6, 0),
    "channels_bottom": ("n_bot", 6, 0),
}  # fmt: skip
"""Columns of the appendix: heading, width and decimals."""
PIECE = 100
"""Lines that are set as one block."""


def write_pdf(
    review: Review, record: Mapping[str, Any], drawn: tuple[Drawn, ...], pictures: Mapping[str, bytes], path: Path
) -> None:
    """Set the report; ``pictures`` are those between crossed polarisers, PNG by angle.

    Raises
    ------
    OSError
        The file cannot be written.
    """
    import matplotlib as mpl
    import typst

    with tempfile.TemporaryDirectory() as name:
        root = Path(name)
        shutil.copy(TEMPLATES / "report.typ", root)
        kept = {key: value for key, value in record.items() if key != "domains"}
        (root / "report.json").write_text(json.dumps(kept), encoding="utf-8")
        figures = [{"name": f.name, "title": f.title, "caption": f.caption} for f in drawn]
        (root / "figures.json").write_text(json.dumps(figures), encoding="utf-8")
        for figure in drawn:
            (root / f"{figure.name}.svg").write_text(figure.svg, encoding="utf-8")
        for angle, data in pictures.items():
            (root / f"polarised-{angle}.png").write_bytes(data)
        (root / "maps.svg").write_bytes(maps(review))
        if review.prediction is not None:
            (root / "shape.png").write_bytes(shapes(review, review.prediction))
        head, *lines = appendix(review)
        (root / "head.txt").write_text(head, encoding="utf-8")
        pieces = ("\n".join(lines[k : k + PIECE]) for k in range(0, len(lines), PIECE))
        (root / "domains.txt").write_text("\n\n".join(pieces), encoding="utf-8")
        fonts = Path(mpl.get_data_path()) / "fonts" / "ttf"
        made = typst.compile(root / "report.typ", root=root, font_paths=[fonts], ignore_system_fonts=True, timestamp=0)
    path.write_bytes(made)


def appendix(review: Review) -> Iterator[str]:
    """The heading and one line per domain, in columns."""
    yield "".join(f"{heading:>{width}}" for heading, width, _ in COLUMNS.values())
    row = "".join(f"%{width}.{decimals}f" for _, width, decimals in COLUMNS.values())
    for values in zip(*(review.columns[name].tolist() for name in COLUMNS), strict=True):
        yield row % values
