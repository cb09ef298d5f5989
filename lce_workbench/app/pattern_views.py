"""The figures of what is microscopic: alignment marks and channels. Knows no FreeCAD."""

from __future__ import annotations

import numpy as np

from lce_solver.types import Floats
from lce_workbench.app.cell_views import Subject
from lce_workbench.app.figures import Balloon, Dim, Figure, Label, Stroke, rectangle
from lce_workbench.core.domains import Plate
from lce_workbench.core.frame import MARK_BOX
from lce_workbench.core.marks import MARKS, PITCH, Wanted, cross, vernier, windows
from lce_workbench.core.shapes import Shape, ell, frame, moved
from lce_workbench.core.units import UM

COLOURS: dict[Plate, str] = {"bottom": "#6f8fbf", "top": "#e39a8b"}
"""Of the marks; the plates are told apart by the outlines too: only the bottom plate's are drawn."""

Spot = tuple[float, float]

ITEMS: dict[str, tuple[str, str, Spot, Spot]] = {
    "gauge": ("a", "go / no-go gauge", (-600, 550), (-88, 64)),
    "box in box": ("b", "box in box", (-180, -30), (-30, -50)),
    "vernier_x": ("c", "vernier along x, 1 µm", (720, 560), (88, 64)),
    "vernier_y": ("d", "vernier along y, 1 µm", (-610, -30), (-88, -10)),
    "moire": ("e", "moiré rings", (13, 470), (20, 83)),
    "chirality": ("f", "tells a mirrored plate", (-720, -720), (-88, -66)),
    "first corner": ("g", "first corner (M1 only)", (-400, -640), (-44, -88)),
    "flip axis": ("h", "axis of turning over", (120, -500), (44, -50)),
    "code, closed cell": ("i", "label, design code", (490, -270), (88, -20)),
    "bottom": ("j", "names of the plates", (690, 150), (88, 22)),
}
"""Element of a cluster -> its letter, what it is, where the balloon points [um], and its place on paper [mm], both
from the cluster's middle."""


def cluster(subject: Subject) -> Figure:
    """Cluster M1 of both plates, as in the closed cell from above."""
    wanted = Wanted(subject.job.marks, subject.code)
    half = MARK_BOX / 2
    chosen = [element for element in MARKS.values() if 0 in element.clusters]
    strokes = [
        Stroke(ring, "none", fill=COLOURS[plate], layer=f"{element.layer}_{plate.upper()}")
        for plate in ("bottom", "top")
        for element in chosen
        for draw in [{"bottom": element.bottom, "top": element.top}[plate]]
        if draw is not None
        for ring in moved(draw(wanted), *element.at)
    ]
    return Figure(
        "cluster",
        "CLUSTER M1, CLOSED CELL FROM ABOVE",
        (rectangle(-half, -half, half, half),),
        (Dim("cluster", (half, -half), (half, half), "y", 22, "um"),),
        tuple(strokes),
        balloons=tuple(Balloon(letter, (x * UM, y * UM), at) for letter, _, (x, y), at in ITEMS.values()),
    )


def gauge(subject: Subject) -> Figure:
    """The go / no-go gauge: the top plate's cross in the windows of the bottom plate."""
    wanted = Wanted(subject.job.marks)
    squares, arms = windows(wanted), cross(wanted)
    (far, _), inner = squares[0].max(axis=0), float(squares[0].min())
    arm, reach = float(arms[0][:, 1].max()), float(arms[0][:, 0].max())
    lowest = float(arms[..., 1].min())
    return Figure(
        "gauge",
        "a  GAUGE",
        (*squares, *arms),
        (
            Dim("square", (inner, far), (far, far), "x", 8, "um"),
            Dim("window", (-inner, far), (inner, far), "x", 16, "um"),
            Dim("clearance", (reach, arm), (far, inner), "y", 9, "um", side=-1),
            Dim("arm", (-arm, lowest), (arm, lowest), "x", -8, "um"),
            Dim("reach", (-reach, -arm), (reach, -arm), "x", -16, "um"),
        ),
        _filled(squares, arms),
    )


def boxes(_: Subject) -> Figure:
    """Box in box: the bottom plate's frame around the top plate's."""
    outer, inner = frame(401, 361), frame(321, 281)
    rows = (
        ("outer_out", outer, -1, 16),
        ("outer_in", outer, 0, 8),
        ("inner_out", inner, -1, -8),
        ("inner_in", inner, 0, -16),
    )
    return Figure(
        "boxes",
        "b  BOX IN BOX",
        (*outer, *inner),
        tuple(Dim(name, *_sides(shape, which, 1 if at > 0 else 0), "x", at, "um") for name, shape, which, at in rows),
        _filled(outer, inner),
    )


def _sides(shape: Shape, which: int, end: int) -> tuple[Spot, Spot]:
    """Points of a frame's upright pieces: their outer (-1) or inner (0) corners at the lower (0) or upper (1) end."""
    upright = [ring for ring in shape if np.ptp(ring[:, 0]) < np.ptp(ring[:, 1])]
    corners = np.concatenate(upright)
    x = np.sort(np.abs(corners[:, 0]))[which]
    y = np.sort(corners[:, 1])[-1 if end else 0]
    return (-float(x), float(y)), (float(x), float(y))


def verniers(_: Subject) -> Figure:
    """The middle of a vernier: the top plate's bars above, the bottom plate's below."""
    shown = 4
    rows = {plate: vernier(plate) for plate in PITCH}
    rows = {
        plate: np.array([q for q in row if abs(q[:, 0].mean()) < (shown + 1.5) * PITCH[plate] * UM])
        for plate, row in rows.items()
    }
    bottom, top = rows["bottom"], rows["top"]
    up, down = np.argsort(top[:, :, 0].mean(axis=1)), np.argsort(bottom[:, :, 0].mean(axis=1))
    top, bottom = top[up], bottom[down]
    last = len(bottom) - 1

    def corner(ring: Floats, x: str, y: str) -> tuple[float, float]:
        pick = {"low": np.min, "high": np.max}
        return float(pick[x](ring[:, 0])), float(pick[y](ring[:, 1]))

    middle = last // 2
    return Figure(
        "vernier",
        "c, d  VERNIERS, MIDDLE PART",
        (*bottom, *top),
        (
            Dim("pitch_top", corner(top[0], "low", "high"), corner(top[1], "low", "high"), "x", 8, "um"),
            Dim(
                "pitch_bottom", corner(bottom[0], "low", "low"), corner(bottom[1], "low", "low"), "x", -8, "um", side=-1
            ),
            Dim("bar", corner(bottom[last], "low", "low"), corner(bottom[last], "high", "low"), "x", -8, "um"),
            Dim("tip_gap", corner(bottom[last], "high", "high"), corner(top[last], "high", "low"), "y", 7, "um"),
            Dim(
                "bar_long",
                corner(top[middle], "low", "low"),
                corner(top[middle], "low", "high"),
                "y",
                -16,
                "um",
                side=-1,
            ),
            Dim("bar_short", corner(top[0], "low", "low"), corner(top[1], "low", "high"), "y", -8, "um", side=-1),
        ),
        _filled(bottom, top),
    )


def chirality(_: Subject) -> Figure:
    """The L of each plate, which tells a mirrored plate at once."""
    outer, inner = ell(161, 31), moved(ell(101, 31), 50, 50)
    (width, height), (arm, thick) = outer[0].max(axis=0).tolist(), outer[1].max(axis=0).tolist()
    (x, y), right, (small, top) = (
        inner[0].min(axis=0).tolist(),
        inner[1].max(axis=0).tolist(),
        inner[0].max(axis=0).tolist(),
    )
    return Figure(
        "chirality",
        "f  CHIRALITY",
        (*outer, *inner),
        (
            Dim("ell_arm", (0.0, 0.0), (arm, 0.0), "x", -16, "um"),
            Dim("ell_bar", (0.0, 0.0), (width, 0.0), "x", -8, "um"),
            Dim("ell_height", (0.0, 0.0), (0.0, height), "y", -8, "um"),
            Dim("ell_thick", (arm, 0.0), (arm, thick), "y", 8, "um", side=-1),
            Dim("small_bar", (x, top), (small, top), "x", 14, "um"),
            Dim("small_arm", (x, y), (right[0], y), "x", -24, "um"),
        ),
        _filled(outer, inner),
    )


def _filled(bottom: Shape, top: Shape) -> tuple[Stroke, ...]:
    shapes = {"bottom": bottom, "top": top}
    return tuple(
        Stroke(ring, "none", fill=COLOURS[plate], layer=f"MARKS_{plate.upper()}")  # type: ignore[index]
        for plate, shape in shapes.items()
        for ring in shape
    )


CHANNELS = 4
"""Channels in the section."""


def channel_section(subject: Subject) -> Figure:
    """Some channels cut across, the epoxy broken off below."""
    spec = subject.job.channels
    w, s, d = spec.width, spec.spacing_um * UM, spec.depth
    base, end = -max(2.2 * d, 0.5 * w), CHANNELS * spec.pitch
    profile = [(-s, 0.0)]
    for x in spec.pitch * np.arange(CHANNELS):
        profile += [(x, 0.0), (x, -d), (x + w, -d), (x + w, 0.0)]
    top = np.array([*profile, (end, 0.0)])
    broken = _wave(-s, end, base)
    return Figure(
        "channel_section",
        "SECTION ACROSS THE CHANNELS",
        (),
        (
            Dim("channel_width", (0.0, 0.0), (w, 0.0), "x", 10, "um", side=-1),
            Dim("channel_spacing", (w, 0.0), (spec.pitch, 0.0), "x", 10, "um"),
            Dim("channel_pitch", (0.0, 0.0), (spec.pitch, 0.0), "x", 20, "um"),
            Dim("channel_depth", (end - s, -d), (end, 0.0), "y", 12, "um"),
        ),
        (
            Stroke(np.concatenate([top, broken]), "none", hatch="epoxy"),
            Stroke(np.concatenate([top[-1:], broken, top[:1]]), "thin", closed=False),
        ),
        lines=(top,),
    )


def _wave(x0: float, x1: float, y: float) -> Floats:
    """Points (81, 2) of a freehand line along a broken edge, from right to left."""
    t = np.linspace(0, 1, 81)
    return np.column_stack([x1 + (x0 - x1) * t, y + 0.01 * (x1 - x0) * np.sin(7 * np.pi * t) * np.sin(3 * t + 0.4)])


def channel_ends(subject: Subject) -> Figure:
    """Where channels of two domains meet a border: both end a guard inside their own."""
    spec = subject.job.channels
    g, w, p = spec.guard, spec.width, spec.pitch
    reach = 3 * p
    lying = [rectangle(-reach, k * p, -g, k * p + w) for k in range(3)]
    standing = [rectangle(g + k * p, 0.0, g + k * p + w, 2 * p + w) for k in range(2)]
    low, high = -0.5 * p, 2.5 * p + w
    border = Stroke(np.array([(0.0, low), (0.0, high)]), "phantom", closed=False, layer="DOMAINS")
    return Figure(
        "channel_ends",
        "CHANNEL ENDS AT A BORDER OF DOMAINS",
        (*lying, *standing),
        (
            Dim("guard_both", (-g, 2 * p + w), (g, 2 * p + w), "x", 10, "um"),
            Dim("channel_width", (-reach, 2 * p), (-reach, 2 * p + w), "y", -10, "um"),
            Dim("channel_pitch", (-reach, 0.0), (-reach, p), "y", -20, "um"),
        ),
        (*(Stroke(ring, "none", fill="#dfe3e9") for ring in (*lying, *standing)), border),
        (Label("border of the domains", (0.0, low), (0.0, -4.5)),),
    )
