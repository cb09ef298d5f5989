"""Alignment marks and labels: the table of what stands in each cluster, and the scale bars between the clusters.

Shapes of one plate never overlap, so it does not matter whether the writer's converter joins or XORs them. The top
plate's elements lie in clear windows of the bottom plate's; only the moire rings lie on each other.
All are filled with the channels' grating, the bottom plate's at 90 and the top plate's at 0 degrees: so they are dark
under the microscope, and show whose they are.
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from lce_solver.errors import InputError
from lce_workbench.core.domains import Domains, Plate
from lce_workbench.core.frame import EDGE, MARK_BOX, Frame
from lce_workbench.core.job import ChannelSpec, Job, Marks
from lce_workbench.core.shapes import (
    LAND,
    SMALL,
    STENCIL,
    Shape,
    box,
    double_arrow,
    ell,
    frame,
    grating,
    join,
    mirrored,
    moved,
    rings,
    text,
    turned,
)
from lce_workbench.core.units import NM

# Sizes are odd multiples of 1 um, so that the grating of 1 um lines and lands ends on both outlines.
ARM = 21.0
"""Width of the gauge cross [um]."""
SQUARE = 121.0
"""Side of the gauge's squares [um]."""
BAR = 9.0
"""Width of a vernier bar [um]."""
BARS = 10
"""Vernier bars on each side of the middle one: with pitches 20 and 21 um the range is +-10 um, one bar a um."""
DIGITS = {-10: "10", -5: "+5", 0: "0", 5: "-5", 10: "10"}
"""What stands under the bottom vernier's long bars, by the number of the bar."""
PITCH: dict[Plate, float] = {"bottom": 20.0, "top": 21.0}
"""Of verniers and moire rings [um]."""
TIP_GAP = 15.0
"""Between the tips of the two verniers [um]."""
RINGS = 12
"""Moire rings; with pitches 20 and 21 um the fringes move 20 times as far as the plates."""
PIXEL = 14.0
"""Side of one dot of a large letter [um]."""

ANGLE: dict[Plate, float] = {"bottom": np.pi / 2, "top": 0.0}
"""Direction of the grating that fills the marks [rad]."""

LABEL_INSET = LAND / 2
"""The runs of a letter touch; their gratings must not [um]."""

LONGEST = 20
"""Characters of the user's label; a dot of more would be too small for the lines that fill it."""

SCALE_MM = (0, 1, 5, 10)
"""Ticks of the scale bars."""


@dataclass(frozen=True)
class Wanted:
    """What the drawing of a mark may depend on."""

    spec: Marks
    code: str = ""
    """Of the design, see `fingerprint`."""


Draw = Callable[[Wanted], Shape]


def windows(wanted: Wanted) -> Shape:
    """Bottom half of the go/no-go gauge: four squares that leave a cross-shaped window."""
    near = ARM / 2 + wanted.spec.tolerance_um
    far = near + SQUARE
    pair = join(box(near, near, far, far), box(-far, near, -near, far))
    return join(pair, turned(turned(pair)))


def cross(wanted: Wanted) -> Shape:
    """Top half of the gauge: a cross with the tolerance as clearance to each side of its window."""
    half, reach = ARM / 2, ARM / 2 + wanted.spec.tolerance_um + SQUARE + 11.0
    upper = box(-half, half + LAND, half, reach)
    return join(box(-reach, -half, reach, half), upper, turned(turned(upper)))


def vernier(plate: Plate) -> Shape:
    """Bars at multiples of the plate's pitch along x, tips towards y = 0, longer at 0, +-5, +-10; the top's above."""
    shapes = []
    for k in range(-BARS, BARS + 1):
        tip, end = TIP_GAP / 2, TIP_GAP / 2 + (61.0 if k % 5 else 91.0)
        low, high = (tip, end) if plate == "top" else (-end, -tip)
        middle = k * PITCH[plate]
        shapes.append(box(middle - BAR / 2, low, middle + BAR / 2, high))
    return join(*shapes)


def digits() -> Shape:
    """Numbers under the bottom vernier's long bars: the top plate's shift along x [um].

    The top bar -s meets the bottom bar -s when the top plate is shifted by +s, so positive numbers stand on the left.
    Only the inner ones have room for their sign.
    """
    y = -(TIP_GAP / 2 + 91.0 + 28.0)
    return join(*(moved(text(word, SMALL), k * PITCH["bottom"], y) for k, word in DIGITS.items()))


def code(wanted: Wanted) -> Shape:
    """The design's code, with the user's label before it.

    Raises
    ------
    InputError
        The label is too long to be read, or holds a character that cannot be drawn.
    """
    label = wanted.spec.label
    if len(label) > LONGEST:
        msg = f"marks.label has {len(label)} characters, too many to be read; give {LONGEST} at most"
        raise InputError(msg)
    return text(f"{label} {wanted.code}".strip(), min(10.0, 900.0 / (6 * len(label) + 54)))


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
    clusters: tuple[int, ...] = tuple(range(8))
    """Which of `Frame.marks` have it."""
    recess: bool = True
    """Whether the CAD model shows it: axis-parallel rectangles, none of them fine."""


def _fixed(shape: Shape) -> Draw:
    return lambda _: shape


MARKS: dict[str, Element] = {
    "gauge": Element("MARKS", (-490, 490), windows, cross),
    "box in box": Element("MARKS", (-180, -30), _fixed(frame(401, 361)), _fixed(frame(321, 281))),
    "vernier_x": Element("MARKS", (512, 590), _fixed(vernier("bottom")), _fixed(vernier("top")), recess=False),
    "vernier_y": Element(
        "MARKS", (-610, -30), _fixed(turned(vernier("bottom"))), _fixed(turned(vernier("top"))), recess=False
    ),
    "digits_x": Element("LABELS", (512, 590), _fixed(digits()), None, recess=False),
    "digits_y": Element("LABELS", (-610, -30), _fixed(turned(digits())), None, recess=False),
    "moire": Element(
        "MARKS",
        (13, 470),
        _fixed(rings(PITCH["bottom"], RINGS, BAR)),
        _fixed(rings(PITCH["top"], RINGS, BAR)),
        recess=False,
    ),
    "chirality": Element("MARKS", (-720, -720), _fixed(ell(161, 31)), _fixed(moved(ell(101, 31), 50, 50))),
    "first corner": Element(
        "MARKS", (-400, -640), _fixed(box(-121, -50, -20, 51)), _fixed(box(20, -50, 121, 51)), (0,)
    ),
    "flip axis": Element("LABELS", (120, -500), None, _fixed(double_arrow(300, 12)), recess=False),
    "bottom": Element("LABELS", (420, 150), _fixed(text("BOTTOM", PIXEL, STENCIL)), None),
    "top, closed cell": Element("LABELS", (280, 20), None, _fixed(text("TOP", PIXEL, STENCIL))),
    "top, loose plate": Element("LABELS", (585, 20), None, _fixed(mirrored(text("TOP", PIXEL, STENCIL)))),
    "code, closed cell": Element("LABELS", (250, -270), code, None, recess=False),
    "code, loose plate": Element("LABELS", (250, -700), None, lambda wanted: mirrored(code(wanted)), recess=False),
}
"""Every mark of a cluster (a square of side `frame.MARK_BOX`). The top plate's file is mirrored when it is written:
what is drawn mirrored here reads on the loose plate's patterned face, the rest from above through the closed cell.
The arrow is the axis about which the top plate is turned over."""


def fingerprint(domains: Domains, spec: ChannelSpec) -> str:
    """Eight hexadecimal digits of the design: the same for the same channels, to 1 nm and 1 urad."""
    parts = [domains.vertices / NM, domains.theta * 1e6, domains.dtheta * 1e6, np.array([spec.width, spec.pitch]) / NM]
    parts += [domains.phase / NM] if spec.align_phase else []
    found = hashlib.sha256(b"".join(np.rint(part).astype("<i8").tobytes() for part in parts))
    return found.hexdigest()[:8].upper()


def marks(frame: Frame, plate: Plate, spec: Marks) -> dict[str, Shape]:
    """The marks that the CAD model shows as recesses, by layer: arrays (n, 4, 2) seen from above [mm].

    They are rectangles whose recesses are simple outlines; gratings, verniers, rings and small print are left out.
    """
    chosen = [element for element in MARKS.values() if element.recess]
    return _placed(frame, plate, Wanted(spec), chosen)


def exposed(frame: Frame, plate: Plate, job: Job, code: str) -> dict[str, Shape]:
    """All marks of ``plate`` as exposed, by layer: arrays (n, 4, 2) in sheet coordinates seen from above [mm].

    Raises
    ------
    InputError
        The job's label cannot be drawn.
    """
    layers = _placed(frame, plate, Wanted(job.marks, code), list(MARKS.values()))
    bars, numbers = scale_bars(frame, plate)
    layers = {"MARKS": join(layers["MARKS"], bars), "LABELS": join(layers["LABELS"], numbers)}
    if not job.marks.grating:
        return layers
    return {
        "MARKS": grating(layers["MARKS"], ANGLE[plate], job.channels),
        "LABELS": grating(layers["LABELS"], ANGLE[plate], job.channels, LABEL_INSET),
    }


def _placed(frame: Frame, plate: Plate, wanted: Wanted, elements: Sequence[Element]) -> dict[str, Shape]:
    layers: dict[str, list[Shape]] = {"MARKS": [], "LABELS": []}
    for element in elements:
        draw = {"bottom": element.bottom, "top": element.top}[plate]
        if draw is not None:
            shape = moved(draw(wanted), *element.at)
            layers[element.layer].extend(shape + frame.marks[i] for i in element.clusters)
    return {name: join(*shapes) for name, shapes in layers.items()}


def scale_bars(frame: Frame, plate: Plate) -> tuple[Shape, Shape]:
    """Ticks at 0, 1, 5, 10 mm along x, below the marks, and along y, above the first; they measure PDMS shrinkage.

    Also the numbers of the bottom plate's. The two plates' ticks face each other; those without room are left out.
    """
    first, second = frame.marks[0], frame.marks[7]
    gap = MARK_BOX / 2 + 0.1
    below = np.array([frame.sheet.x0 + 0.1, first[1] - MARK_BOX / 2 - EDGE / 2])
    bars: list[Shape] = []
    numbers: list[Shape] = []
    for start, room, turn in (
        (below, frame.sheet.size[0] - 0.2, False),
        (first + np.array([0.0, gap]), second[1] - first[1] - 2 * gap, True),
    ):
        for mm in (mm for mm in SCALE_MM if mm <= room):
            tick = box(-BAR / 2, 8, BAR / 2, 109) if plate == "top" else box(-BAR / 2, -109, BAR / 2, -8)
            number = moved(text(str(mm), SMALL), 0, -140) if plate == "bottom" else join()
            for shapes, shape in ((bars, tick), (numbers, number)):
                placed = moved(shape, mm * 1000, 0)
                shapes.append((turned(placed) if turn else placed) + start)
    return join(*bars), join(*numbers)
