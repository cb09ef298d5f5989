"""report.html: one file with everything in it; it loads nothing, and shows strings as text, never as markup."""

from __future__ import annotations

import base64
from collections.abc import Mapping
from typing import Any

import numpy as np
from jinja2 import Environment, FileSystemLoader, StrictUndefined

from lce_workbench import ROOT
from lce_workbench.review.data import Part, Review
from lce_workbench.review.figures import Drawn, palette, themed

TEMPLATES = ROOT / "templates" / "report"

PALETTES = {"twilight": "twilight", "diverging": "PuOr", "viridis": "viridis", "cividis": "cividis"}
"""Name on the page -> name in matplotlib; cyclic, diverging and two sequential, all safe for the colour-blind."""

SECTIONS = {
    "summary": "Summary", "findings": "Findings", "map": "Map", "solids": "3D", "domains": "Domains",
    "figures": "Figures", "alignment": "Alignment", "polarisers": "Polarisers", "process": "Process",
    "provenance": "Provenance",
}  # fmt: skip

APART = 3.0
"""Between two parts of the cell that are pulled apart all the way, in thicknesses of the whole."""


def as_html(review: Review, record: Mapping[str, Any], drawn: tuple[Drawn, ...], pictures: Mapping[str, bytes]) -> str:
    """The page as text."""
    found = review.prediction
    return _environment().get_template("page.html").render(
        r=record,
        sections=SECTIONS.items(),
        count=len(review.domains),
        table=review.table,
        figures=[{"name": f.name, "title": f.title, "caption": f.caption, "svg": themed(f.svg, f.name)} for f in drawn],
        pictures={angle: base64.b64encode(png).decode() for angle, png in pictures.items()},
        meta=_meta(review),
        arrays=_arrays(review),
        cell=review.cell is not None,
        lambdas=[] if found is None else found.lambdas.tolist(),
        deviation=0.0 if found is None else float(found.deviation.max()),
    )  # fmt: skip


def _environment() -> Environment:
    made = Environment(
        loader=FileSystemLoader(TEMPLATES), autoescape=True, undefined=StrictUndefined, keep_trailing_newline=True
    )
    made.filters["short"] = lambda value: "" if value is None else f"{value:.4g}"
    return made


def _meta(review: Review) -> dict[str, Any]:
    """Small data of the scripts."""
    spec, found, cell = review.job.channels, review.prediction, review.cell or ()
    tall = max((float(part.vertices[:, 2].max()) for part in cell), default=0.0)
    return {
        "palettes": {name: _base64(np.round(255 * palette(known)), "u1") for name, known in PALETTES.items()},
        "channels": {"width": spec.width, "pitch": spec.pitch, "guard": spec.guard},
        "corners": review.domains.corners.shape[1],
        "lambdas": None if found is None else found.lambdas.tolist(),
        "deviation": None if found is None else float(found.deviation.max()),
        "parts": [_part(part) for part in cell],
        "apart": APART * tall,
    }


def _part(part: Part) -> dict[str, Any]:
    return {
        "name": part.name.replace("_", " "),
        "colour": [round(255 * share) for share in part.colour],
        "level": round(float(part.vertices[:, 2].mean()), 4),
    }


def _arrays(review: Review) -> dict[str, str]:
    """Large data of the scripts, each by the name and type under which they read it."""
    found = review.prediction
    arrays = {
        "corners": (review.domains.corners, "<f8"),
        "phase": (review.domains.phase, "<f8"),
        "faces": (review.design.surface.faces, "<i4"),
        "residual": (100 * np.abs(review.errors).max(axis=1), "<f4"),
        "target": (review.design.surface.vertices, "<f4"),
    }
    if found is not None:
        arrays |= {"frames": (found.frames, "<f4"), "deviation": (found.deviation, "<f4")}
    for k, part in enumerate(review.cell or ()):
        arrays |= {f"part-at-{k}": (part.vertices, "<f4"), f"part-faces-{k}": (part.faces, "<u4")}
    return {name: _base64(values, kind) for name, (values, kind) in arrays.items()}


def _base64(values: Any, kind: str) -> str:
    return base64.b64encode(np.ascontiguousarray(values, dtype=kind).tobytes()).decode()
