"""Alignment marks: eight clusters that are alike, where the form for their readings says, handed, both plates' on top.

Places are those of the marks' drawing, from the middle of a cluster, seen from above.
"""

from __future__ import annotations

import csv
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from scipy.spatial import cKDTree

from lce_solver.types import Finding, Floats
from lce_workbench.verify.finding import Unreadable, error, measured, reading
from lce_workbench.verify.shapes import areas, boxes

HALF = 750e3
"""Half the side of a cluster [nm]."""

FEATURES = {
    "go/no-go gauge": ((-490e3, 490e3), 143e3, (True, True)),
    "box in box": ((-180e3, -30e3), 205e3, (True, True)),
    "moire": ((13e3, 470e3), 262e3, (True, True)),
    "vernier x": ((512e3, 590e3), 216e3, (True, False)),
    "vernier y": ((-610e3, -30e3), 216e3, (False, True)),
}
"""Marks of both plates with a common middle -> it, half their size, and along which of x and y they are symmetric [nm].

The gauge's size is that without the tolerance, which is its clearance."""

CHIRALITY = ((-725e3, -725e3), (-550e3, -470e3))
"""Around the L, whose long leg points up and whose short one to the right [nm]."""

FIRST = ((-530e3, -700e3), (-270e3, -580e3))
"""Around the squares that only the first cluster has [nm]."""

SAME = 2.0
"""Rounding of both, and of the form's six decimals [nm]."""


def places(path: Path) -> dict[str, Floats]:
    """Names and middles of the clusters [nm] from `readings.csv`.

    Raises
    ------
    Unreadable
        It is missing, or no such form.
    """
    with reading():
        lines = path.read_text(encoding="utf-8-sig").splitlines()
        table = csv.DictReader(line for line in lines if not line.startswith("#"))
        found = {row["mark"]: np.array([float(row["x_mm"]), float(row["y_mm"])]) * 1e6 for row in table}
    if len(found) != 8 or not np.all(np.isfinite(list(found.values()))):
        msg = f"is no form for readings: it places {len(found)} clusters instead of 8, or one nowhere"
        raise Unreadable(msg)
    return found


def _within(polygons: Floats, low: Floats, high: Floats) -> Floats:
    """Those that lie in a box."""
    b = boxes(polygons)
    return polygons[np.all(b[:, :2] >= low, axis=1) & np.all(b[:, 2:] <= high, axis=1)]


def check(name: str, marks: Floats, labels: Floats, at: dict[str, Floats], pitch: float) -> Iterator[Finding]:
    """All marks of one plate (n, 4, 2), seen from above [nm].

    Parameters
    ----------
    pitch : of the channels [nm]; in print as fine as two or three of them, rounding decides about one line.
    """
    for layer, polygons, limit in (("MARKS", marks, SAME), ("LABELS", labels, pitch / 2 + SAME)):
        yield from _alike(f"{name}, {layer}", polygons, at, limit)
    for mark, centre in at.items():
        yield from _handed(f"{name}, {mark} cluster", marks, centre)
    low, high = (np.array(corner) for corner in FIRST)
    holders = [mark for mark, centre in at.items() if len(_within(marks, centre + low, centre + high))]
    first = next(iter(at))
    if holders != [first]:
        found = ", ".join(holders) or "no cluster"
        yield error("verify_chirality", name, f"the first corner's mark stands in {found}, it should in {first}")


def _handed(where: str, marks: Floats, centre: Floats) -> Iterator[Finding]:
    """The L's middle of area lies left of and below the middle of its box."""
    low, high = (centre + np.array(corner) for corner in CHIRALITY)
    ell = _within(marks, low, high)
    if not len(ell):
        yield error("verify_chirality", where, "the chirality mark is missing or on the other side: a mirrored plate")
        return
    b = boxes(ell)
    middle = (b[:, :2].min(axis=0) + b[:, 2:].max(axis=0)) / 2
    weight = areas(ell)
    off = (weight @ ell.mean(axis=1)) / weight.sum() - middle
    if not np.all(off < 0):
        yield error("verify_chirality", where, "the chirality mark is turned or mirrored")


def _alike(where: str, polygons: Floats, at: dict[str, Floats], limit: float) -> Iterator[Finding]:
    """Every cluster holds the same shapes at the same places as the others do."""
    low, high = (np.array(corner) for corner in FIRST)
    sets = []
    for centre in at.values():
        near = _within(polygons, centre - HALF, centre + HALF) - centre
        b = boxes(near)
        first = np.all(b[:, :2] >= low, axis=1) & np.all(b[:, 2:] <= high, axis=1)
        sets.append(np.column_stack([b, np.sqrt(areas(near))])[~first])
    if not all(map(len, sets)):
        empty = [mark for mark, found in zip(at, sets, strict=True) if not len(found)]
        yield error("verify_marks", where, f"there are no marks in the {empty[0]} cluster")
        return
    trees = [cKDTree(found) for found in sets]
    apart = np.zeros((len(sets), len(sets), 2))
    for i, mine in enumerate(sets):
        for j, tree in enumerate(trees):
            off = tree.query(mine, p=np.inf)[0]
            back = trees[i].query(sets[j], p=np.inf)[0]
            apart[i, j] = max(off.max(), back.max()), np.sum(off > limit) + np.sum(back > limit)
    typical = np.median(apart, axis=1)
    worst = int(np.argmax(typical[:, 0]))
    text = f"{typical[worst, 1]:.0f} shapes differ from those of the other clusters, the farthest by"
    where = f"{where}, {list(at)[worst]} cluster"
    yield measured("verify_marks", where, text, float(typical[worst, 0]), limit, unit="nm")


def centres(marks: Floats, at: dict[str, Floats], tolerance: float) -> dict[str, Floats]:
    """Mark -> middles (8, 2) in the clusters [nm], nan where there is none; seen from above.

    Parameters
    ----------
    tolerance : of the gauge [nm].
    """
    found = {}
    for feature, (place, half, _) in FEATURES.items():
        reach = half + tolerance + 12e3 if feature.startswith("go") else half
        middles = []
        for centre in at.values():
            near = _within(marks, centre + place - reach, centre + place + reach)
            b = boxes(near)
            middle = (b[:, :2].min(axis=0) + b[:, 2:].max(axis=0)) / 2 if len(near) else np.full(2, np.nan)
            middles.append(middle)
        found[feature] = np.array(middles)
    return found


def placed(name: str, found: dict[str, Floats], at: dict[str, Floats]) -> Iterator[Finding]:
    """Marks of one plate against the places in the form."""
    for feature, (place, _, axes) in FEATURES.items():
        off = np.abs(found[feature] - np.array(list(at.values())) - np.array(place))[:, list(axes)]
        yield _farthest("verify_mark_place", name, f"the {feature} is away from its place by", off, at)


def closed(found: dict[str, dict[str, Floats]], at: dict[str, Floats]) -> Iterator[Finding]:
    """Middles of both plates' marks in the closed cell."""
    for feature, (_, _, axes) in FEATURES.items():
        off = np.abs(found["top"][feature] - found["bottom"][feature])[:, list(axes)]
        text = f"the {feature} of the top plate is away from the bottom plate's by"
        yield _farthest("verify_overlay", "closed cell", text, off, at)


def _farthest(check: str, name: str, text: str, off: Floats, at: dict[str, Floats]) -> Finding:
    size = np.where(np.isnan(off), np.inf, off).max(axis=1)
    worst = int(np.argmax(size))
    where = f"{name}, {list(at)[worst]} cluster"
    return measured(check, where, text, float(size[worst]), SAME, unit="nm", places=int(np.sum(size > SAME)))
