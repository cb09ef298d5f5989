"""Alignment marks and labels: a small algebra of shapes, and the table of what stands in each corner cluster.

A shape is an array (n, 4, 2) of axis-parallel rectangles, corners counter-clockwise, in mm, seen from above in the
closed cell. Shapes of one layer never overlap, so it does not matter whether the writer's converter joins or XORs them.
The top plate's elements lie in clear windows of the bottom plate's.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from lce_solver.types import Floats
from lce_workbench.core.domains import Plate
from lce_workbench.core.frame import Frame
from lce_workbench.core.job import Marks
from lce_workbench.core.units import UM

Shape = Floats

ARM = 20.0
"""Width of the gauge cross [um]."""
SQUARE = 120.0
"""Side of the gauge's squares [um]."""
BAR = 8.0
"""Width of a vernier bar [um]."""
BARS = 10
"""Vernier bars on each side of the middle one: with pitches 20 and 21 um the range is +-10 um, one bar a um."""
TIP_GAP = 15.0
"""Between the tips of the two verniers [um]."""
PIXEL = 14.0
"""Side of one dot of a letter [um]."""

FONT = {
    "B": ("#.###", "#...#", "#...#", "#####", "#...#", "#...#", "#.###"),
    "M": ("#####", "#.#.#", "#.#.#", "#.#.#", "#.#.#", "#.#.#", "#.#.#"),
    "O": ("##.##", "#...#", "#...#", "#...#", "#...#", "#...#", "##.##"),
    "P": ("#.###", "#...#", "#...#", "#####", "#....", "#....", "#...."),
    "T": ("#####", "..#..", "..#..", "..#..", "..#..", "..#..", "..#.."),
}
"""Letters of 5 x 7 dots, drawn as polygons because the writers take no text. Cut like stencils: no dots touch at a
corner only and none enclose an island, so the recesses of a plate are simple outlines."""


def box(x0: float, y0: float, x1: float, y1: float) -> Shape:
    """One rectangle, given in um."""
    return np.array([[(x0, y0), (x1, y0), (x1, y1), (x0, y1)]]) * UM


def join(*shapes: Shape) -> Shape:
    """All rectangles together."""
    return np.concatenate(shapes)


def moved(shape: Shape, x: float, y: float) -> Shape:
    """The shape shifted by (x, y) um."""
    return np.asarray(shape + np.array([x, y]) * UM)


def turned(shape: Shape) -> Shape:
    """The shape turned by 90 degrees counter-clockwise."""
    return np.stack([-shape[..., 1], shape[..., 0]], axis=2)


def mirrored(shape: Shape) -> Shape:
    """The shape seen from the other side, x -> -x."""
    return np.asarray(shape[:, ::-1] * np.array([-1.0, 1.0]))


def windows(spec: Marks) -> Shape:
    """Bottom half of the go/no-go gauge: four squares that leave a cross-shaped window."""
    near = ARM / 2 + spec.tolerance_um
    far = near + SQUARE
    pair = join(box(near, near, far, far), box(-far, near, -near, far))
    return join(pair, turned(turned(pair)))


def cross(spec: Marks) -> Shape:
    """Top half of the gauge: a cross with the tolerance as clearance to each side of its window."""
    half, reach = ARM / 2, ARM / 2 + spec.tolerance_um + SQUARE + 10.0
    upper = box(-half, half, half, reach)
    return join(box(-reach, -half, reach, half), upper, turned(turned(upper)))


def vernier(pitch: float, side: int) -> Shape:
    """Bars at multiples of ``pitch`` (um) along x, tips towards y = 0, longer at 0, +-5, +-10; ``side`` +1: above."""
    shapes = []
    for k in range(-BARS, BARS + 1):
        tip, end = TIP_GAP / 2, TIP_GAP / 2 + (60.0 if k % 5 else 90.0)
        low, high = (tip, end) if side > 0 else (-end, -tip)
        shapes.append(box(k * pitch - BAR / 2, low, k * pitch + BAR / 2, high))
    return join(*shapes)


def ell(arm: float, width: float) -> Shape:
    """An L: unlike its mirror image in every turned position."""
    return join(box(0.0, 0.0, width, 1.5 * arm), box(width, 0.0, arm, width))


def text(label: str) -> Shape:
    """Letters as rectangles, centred on the origin, with equal runs of dots in consecutive rows joined."""
    width = 6 * len(label) - 1
    letters = [_letter(letter, 6 * i - width / 2) for i, letter in enumerate(label)]
    return join(*letters)


def _letter(letter: str, x: float) -> Shape:
    """One letter whose left side is ``x`` dots from the origin."""
    open_runs: dict[tuple[int, int], int] = {}
    shapes: list[Shape] = []
    for row, dots in enumerate((*FONT[letter], "." * 5)):
        runs = _runs(dots)
        for run in [r for r in open_runs if r not in runs]:
            top, (a, b) = 3.5 - open_runs.pop(run), run
            shapes.append(box(x + a, 3.5 - row, x + b, top) * PIXEL)
        for run in runs:
            open_runs.setdefault(run, row)
    return join(*shapes)


def _runs(dots: str) -> list[tuple[int, int]]:
    """Start and end of each run of ``#``."""
    padded = f".{dots}."
    starts = [i for i in range(len(dots)) if padded[i : i + 2] == ".#"]
    ends = [i for i in range(1, len(dots) + 1) if padded[i : i + 2] == "#."]
    return list(zip(starts, ends, strict=True))


Draw = Callable[[Marks], Shape]


@dataclass(frozen=True)
class Element:
    """One entry of a cluster."""

    layer: str
    at: tuple[float, float]
    """Place in the cluster, from its centre [um]."""
    bottom: Draw | None
    """The bottom plate's half."""
    top: Draw | None
    """The top plate's half."""
    clusters: tuple[int, ...] = (0, 1, 2, 3)
    """Lower left, lower right, upper right, upper left."""


def _fixed(shape: Shape) -> Draw:
    return lambda _: shape


MARKS: dict[str, Element] = {
    "gauge": Element("MARKS", (-400, 400), windows, cross),
    "vernier_x": Element("MARKS", (400, 400), _fixed(vernier(20, -1)), _fixed(vernier(21, +1))),
    "vernier_y": Element("MARKS", (-400, -400), _fixed(turned(vernier(20, -1))), _fixed(turned(vernier(21, +1)))),
    "chirality": Element("MARKS", (300, -700), _fixed(ell(160, 30)), _fixed(moved(ell(100, 30), 50, 50))),
    "first corner": Element("MARKS", (0, 0), _fixed(box(-120, -50, -20, 50)), _fixed(box(20, -50, 120, 50)), (0,)),
    "bottom": Element("LABELS", (380, -130), _fixed(text("BOTTOM")), None),
    "top, closed cell": Element("LABELS", (380, -260), None, _fixed(text("TOP"))),
    "top, loose plate": Element("LABELS", (380, -390), None, _fixed(mirrored(text("TOP")))),
}
"""Every mark of a cluster (a square of side `frame.MARK_BOX`). The top plate's file is mirrored when it is written,
so its first label reads from above through the closed cell, its second on the loose plate's patterned face."""


def marks(frame: Frame, plate: Plate, spec: Marks) -> dict[str, Shape]:
    """All marks of ``plate`` by layer: arrays (n, 4, 2) in sheet coordinates seen from above [mm]."""
    layers: dict[str, list[Shape]] = {"MARKS": [], "LABELS": []}
    for element in MARKS.values():
        draw = {"bottom": element.bottom, "top": element.top}[plate]
        if draw is not None:
            shape = moved(draw(spec), *element.at)
            layers[element.layer].extend(shape + frame.marks[i] for i in element.clusters)
    return {name: join(*shapes) for name, shapes in layers.items()}
