"""Tampering with an output folder so that its manifest does not tell."""

from __future__ import annotations

import csv
import hashlib
import json
import re

import gdstk
import numpy as np

from lce_solver.types import Severity
from lce_workbench.verify import verify


def refresh(folder):
    """Make the manifest agree with the files that are there."""
    path = folder / "manifest.json"
    manifest = json.loads(path.read_text())
    files = sorted(p for p in folder.rglob("*") if p.is_file() and p != path)
    manifest["files"] = [
        {
            "path": p.relative_to(folder).as_posix(),
            "size": p.stat().st_size,
            "sha256": hashlib.sha256(p.read_bytes()).hexdigest(),
        }
        for p in files
    ]
    path.write_text(json.dumps(manifest))


def errors(folder):
    """Check -> the errors of it, after the manifest was made to agree."""
    refresh(folder)
    return grouped(verify(folder))


def grouped(findings):
    found = {}
    for finding in findings:
        if finding.severity is not Severity.INFO:
            found.setdefault(finding.check, []).append(finding)
    return found


def redraw(path, change):
    """Write a GDSII file anew with its polygons ``change``d: a list of (layer, corners (k, 2) [um])."""
    library = gdstk.read_gds(path)
    name = library.cells[0].name
    shapes = change([(polygon.layer, polygon.points) for polygon in library.cells[0].polygons])
    out = gdstk.Library("LCE", unit=1e-6, precision=1e-9)
    cell = out.new_cell(name)
    cell.add(*(gdstk.Polygon(points, layer=layer) for layer, points in shapes))
    out.write_gds(path)


def channels_of(folder, plate, domain):
    """Whether corners [um], as written, are a channel of a domain: a function of (layer, points)."""
    with np.load(folder / "design.npz") as data:
        triangle = data["uv"][data["faces"][domain]] * 1e3
    triangle = triangle * ([-1, 1] if plate == "top" else [1, 1])
    edges = np.roll(triangle, -1, axis=0) - triangle

    def held(layer, points):
        to = points.mean(axis=0) - triangle
        sides = edges[:, 0] * to[:, 1] - edges[:, 1] * to[:, 0]
        return layer == 1 and (np.all(sides > 0) or np.all(sides < 0))

    return held


def turned(points, degrees, about):
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    return (points - about) @ np.array([[c, s], [-s, c]]) + about


def replaced(path, pattern, text, count=0):
    """Replace a pattern in a text file; it has to be there."""
    new, number = re.subn(pattern, text, path.read_text(), count=count)
    assert number
    path.write_text(new)


def rewritten(path, row, column, change):
    """Change one number of a CSV file."""
    lines = list(csv.reader(path.read_text().splitlines()))
    k = lines[0].index(column)
    lines[row + 1][k] = change(lines[row + 1][k])
    path.write_text("\n".join(map(",".join, lines)) + "\n")
