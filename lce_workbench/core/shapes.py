"""A small algebra of shapes for marks, labels and test fields.

A shape is an array (n, 4, 2) of convex quadrilaterals, corners counter-clockwise, in mm, seen from above in the closed
cell; every function takes um and gives a shape. The quadrilaterals of a shape never overlap.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from lce_solver.errors import InputError
from lce_solver.types import Floats
from lce_workbench.core.channels import fill, rectangles
from lce_workbench.core.job import ChannelSpec
from lce_workbench.core.units import UM

Shape = Floats

LAND = 1.0
"""Left free where two quadrilaterals of a mark would touch [um]."""

SMALL = 6.0
"""Side of one dot of small print [um]."""

EXACT = 1e-4
"""A mark's grating may leave it by so much, so that rounding never costs a line or a step of length [um]."""

Font = dict[str, tuple[str, ...]]

STENCIL: Font = {
    "B": ("#####", "#...#", "#...#", "#.###", "#...#", "#...#", "#.###"),
    "M": ("#...#", "##.##", "#####", "#.#.#", "#...#", "#...#", "#...#"),
    "O": ("#####", "#...#", "#...#", "#...#", "#...#", "#...#", "##.##"),
    "P": ("#####", "#...#", "#...#", "#.###", "#....", "#....", "#...."),
    "T": ("#####", "..#..", "..#..", "..#..", "..#..", "..#..", "..#.."),
}
"""Letters of 5 x 7 dots, drawn as polygons because the writers take no text. Cut like stencils: no dots touch at a
corner only and none enclose an island, so the recesses of a plate are simple outlines."""

COLUMNS = {
    "0": "3E5149453E", "1": "00427F4000", "2": "4261514946", "3": "2141454B31", "4": "1814127F10", "5": "2745454539",
    "6": "3C4A494930", "7": "0171090503", "8": "3649494936", "9": "064949291E", "A": "7E1111117E", "B": "7F49494936",
    "C": "3E41414122", "D": "7F4141221C", "E": "7F49494941", "F": "7F09090901", "G": "3E4149497A", "H": "7F0808087F",
    "I": "00417F4100", "J": "2040413F01", "K": "7F08142241", "L": "7F40404040", "M": "7F020C027F", "N": "7F0408107F",
    "O": "3E4141413E", "P": "7F09090906", "Q": "3E4151215E", "R": "7F09192946", "S": "4649494931", "T": "01017F0101",
    "U": "3F4040403F", "V": "1F2040201F", "W": "3F4038403F", "X": "6314081463", "Y": "0708700807", "Z": "6151494543",
    "-": "0808080808", "+": "08083E0808", ".": "0060600000", "/": "2010080402", " ": "0000000000",
}  # fmt: skip
"""Characters of 5 x 7 dots: five columns from left to right, a byte each, the lowest bit on top."""


def dots(columns: str) -> tuple[str, ...]:
    """Rows of a character, from the top, as in `STENCIL`."""
    octets = bytes.fromhex(columns)
    return tuple("".join("#" if octet >> row & 1 else "." for octet in octets) for row in range(7))


PLAIN: Font = {letter: dots(columns) for letter, columns in COLUMNS.items()}


def box(x0: float, y0: float, x1: float, y1: float) -> Shape:
    """One rectangle."""
    return np.array([[(x0, y0), (x1, y0), (x1, y1), (x0, y1)]]) * UM


def join(*shapes: Shape) -> Shape:
    """All quadrilaterals together."""
    return np.concatenate([np.empty((0, 4, 2)), *shapes])


def moved(shape: Shape, x: float, y: float) -> Shape:
    """The shape shifted by (x, y)."""
    return np.asarray(shape + np.array([x, y]) * UM)


def turned(shape: Shape) -> Shape:
    """The shape turned by 90 degrees counter-clockwise."""
    return np.stack([-shape[..., 1], shape[..., 0]], axis=2)


def mirrored(shape: Shape) -> Shape:
    """The shape seen from the other side, x -> -x."""
    return np.asarray(shape[:, ::-1] * np.array([-1.0, 1.0]))


def grating(shape: Shape, angle: float, spec: ChannelSpec, inset: float = -EXACT) -> Shape:
    """The shape filled with channels in direction ``angle`` [rad], ``inset`` um from its outlines.

    A filled mark scatters light, so that it is dark in bright field although the relief is transparent.
    """
    if not len(shape):
        return shape
    angles = np.full(len(shape), angle)
    centre, length, owner = fill(shape, angles, replace(spec, guard_um=inset))
    return rectangles(centre, length, angles[owner], spec.width)


def text(label: str, pixel: float, font: Font = PLAIN) -> Shape:
    """Characters as rectangles, centred on the origin, with equal runs of dots in consecutive rows joined.

    Raises
    ------
    InputError
        The font lacks a character.
    """
    unknown = [letter for letter in label if letter not in font]
    if unknown:
        what = f"marks.label {label!a}: the character {unknown[0]!a}"
        msg = f"{what} cannot be drawn; use capitals, digits, space, + - . /"
        raise InputError(msg)
    width = 6 * len(label) - 1
    return join(*(_letter(font[letter], 6 * i - width / 2, pixel) for i, letter in enumerate(label)))


def _letter(rows: tuple[str, ...], x: float, pixel: float) -> Shape:
    """One letter whose left side is ``x`` dots from the origin."""
    open_runs: dict[tuple[int, int], int] = {}
    shapes: list[Shape] = []
    for row, line in enumerate((*rows, "." * 5)):
        runs = _runs(line)
        for run in [r for r in open_runs if r not in runs]:
            top, (a, b) = 3.5 - open_runs.pop(run), run
            shapes.append(box(x + a, 3.5 - row, x + b, top) * pixel)
        for run in runs:
            open_runs.setdefault(run, row)
    return join(*shapes)


def _runs(line: str) -> list[tuple[int, int]]:
    """Start and end of each run of ``#``."""
    padded = f".{line}."
    starts = [i for i in range(len(line)) if padded[i : i + 2] == ".#"]
    ends = [i for i in range(1, len(line) + 1) if padded[i : i + 2] == "#."]
    return list(zip(starts, ends, strict=True))


def rings(pitch: float, count: int, width: float) -> Shape:
    """Concentric rings at multiples of ``pitch``, each of straight pieces with a land between them."""
    pieces = []
    for k in range(1, count + 1):
        sides = 8 + 4 * k
        half = np.pi / sides
        inner, outer = (k * pitch + side * width / 2 for side in (-1, 1))
        reach = np.array([inner, outer]) * np.tan(half) - LAND / 2
        piece = np.array([(inner, -reach[0]), (outer, -reach[1]), (outer, reach[1]), (inner, reach[0])]) * UM
        angle = 2 * half * np.arange(sides)
        c, s = np.cos(angle)[:, None], np.sin(angle)[:, None]
        pieces.append(np.stack([c * piece[:, 0] - s * piece[:, 1], s * piece[:, 0] + c * piece[:, 1]], axis=2))
    return join(*pieces)


def frame(outer: float, inner: float) -> Shape:
    """A square frame of sides ``outer`` and ``inner``, open at its corners."""
    a, b = inner / 2, outer / 2
    reach = a - LAND
    pair = join(box(-reach, a, reach, b), box(-reach, -b, reach, -a))
    return join(pair, turned(pair))


def ell(arm: float, width: float) -> Shape:
    """An L: unlike its mirror image in every turned position."""
    return join(box(0.0, 0.0, width, 1.5 * arm), box(width + LAND, 0.0, arm, width))


def double_arrow(length: float, width: float) -> Shape:
    """An arrow up and down along y, its heads in steps."""
    steps = 6
    head = [box(-(i + 1) * width / 2, -width * i - width + LAND, (i + 1) * width / 2, -width * i) for i in range(steps)]
    tip = moved(join(*head), 0, length / 2)
    shaft = length / 2 - steps * width
    return join(tip, turned(turned(tip)), box(-width / 2, -shaft, width / 2, shaft))
