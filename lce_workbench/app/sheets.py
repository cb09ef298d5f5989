"""The set of drawings of a cell: which figures stand on which sheet, where and at which scale. Knows no FreeCAD."""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache
from pathlib import Path

import numpy as np

from lce_workbench.app import cell_views, map_views, part_views, pattern_views
from lce_workbench.app.cell_views import Subject
from lce_workbench.app.figures import Figure, Placed, Point, Sheet, fitting, micrometres, ratio
from lce_workbench.app.geometry import assembled, changed_at, domains_of, stored
from lce_workbench.core.domains import Plate
from lce_workbench.core.frame import arrange
from lce_workbench.core.job import Job
from lce_workbench.core.marks import fingerprint
from lce_workbench.core.replication import settings
from lce_workbench.core.units import UM
from lce_workbench.core.workshop import beads

CUT = "ISO 2768-m"
PATTERN = "as the mask (1 nm grid)"


def _in(figure: Figure, room: tuple[float, float], at: Point) -> Placed:
    """A figure as large as fits into ``room``, its middle at ``at`` on paper [mm]."""
    return Placed(figure, fitting(figure, room), at)


def assembly(subject: Subject) -> Sheet:
    """The closed cell: plan, section A-A, the gap at a strip, parts list."""
    job, plate = subject.job, "{:g} x {:g}".format(*subject.frame.plate.size)
    glass = f"{plate} x {job.plates.glass_mm:g}"
    strip = "{:g} x {:g} x {:g}".format(*subject.frame.strips[0].size, job.sheet.thickness)
    layer = f"{plate} x {job.plates.epoxy_um * UM + job.channels.depth:g}"
    return Sheet(
        "1_assembly",
        "Cell assembly",
        f"closed cell, gap {job.sheet.gap_um:g} µm",
        "see parts list",
        CUT,
        "A3",
        (
            _in(cell_views.plan(subject), cell_views.PLAN_ROOM, (96, 176)),
            _in(cell_views.section(subject), (170, 22), (284, 258)),
            Placed(cell_views.detail(subject), cell_views.detail_scale(subject), (284, 182)),
        ),
        (
            "Plan seen from above. Origin: middle of the sheet; z = 0: middle of the film.",
            "Turn the top plate over about the y axis and lay it on the strips, patterned faces inwards.",
            f"Align on the marks M1 to M8; mismatch of the plates at most {job.marks.tolerance_um:g}\xa0µm.",
            "Glue along the left and right edges, outside the strips.",
            "Fill by capillarity from the filling edge. Relief of the channels: sheet 6.",
        ),
        (
            ("Item", "Qty", "Part", "Material", "Size in mm", "Sheet"),
            ("1", "1", "Carrier, bottom", "glass", glass, "2"),
            ("2", "1", "Channel layer, bottom", "epoxy", layer, "2, 6"),
            ("3", "2", "Spacer strip", "Mylar (PET film)", strip, "4"),
            ("4", "1", "Film", "LCE, see design", f"thickness {job.sheet.thickness:g}", "7"),
            ("5", "1", "Channel layer, top", "epoxy", layer, "3, 6"),
            ("6", "1", "Carrier, top", "glass", glass, "3"),
            *((str(7 + k), *row, "") for k, row in enumerate([*_bead(subject), *_jig(subject)])),
        ),
        (168, 110),
        (14, 13, 66, 52, 70, 22),
    )


Row = tuple[str, str, str, str]


def _bead(subject: Subject) -> list[Row]:
    """The glue beads of the parts list, if there are any."""
    wide = [bead.size[0] for bead in beads(subject.frame, subject.job)[:1]]
    return [("2", "Glue bead", "adhesive", f"{width:g} wide") for width in wide]


def _jig(subject: Subject) -> list[Row]:
    """The alignment frame of the parts list, if the job asks for one; it is not drawn, being no part of the cell."""
    frames = [prism for prism in subject.cell.parts if prism.name == "alignment_frame"]
    wall = subject.job.plates.frame_mm
    return [
        ("1", f"Alignment frame, {frame.z1 - frame.z0:g} high (a tool)", "printed, not drawn", f"opening {size}")
        for frame in frames
        for size in ["{:g} x {:g}, wall {:g}".format(*np.ptp(frame.holes[0], axis=0), wall)]
    ]


def _workshop(job: Job) -> list[str]:
    """What the workshop does to the glass, which the views do not show."""
    plates = job.plates
    done = (
        (plates.chamfer_mm, f"Chamfer of the outer edges: {plates.chamfer_mm:g}\xa0mm x 45°."),
        (plates.notch_mm, f"Handling notch: {plates.notch_mm:g}\xa0mm x 45°."),
        (plates.engraving_um, f"Name engraved in the outer face, {plates.engraving_um:g}\xa0µm deep."),
        (plates.release_deg, f"Release taper of the epoxy: {plates.release_deg:g}°."),
    )
    return [text for value, text in done if value]


def bottom_plate(subject: Subject) -> Sheet:
    """The bottom plate on its patterned face, which looks up."""
    notes = ("Seen on the patterned face, which looks up in the cell: same as from above.", *_casts(subject.job))
    return _plate(subject, "bottom", 2, "seen on its patterned face", notes)


def top_plate(subject: Subject) -> Sheet:
    """The top plate on its patterned face, mirrored against the assembly."""
    notes = (
        "SEEN ON THE PATTERNED FACE, which looks down in the cell: mirrored against the assembly (x to -x).",
        *(_casts(subject.job) or ["The mask files top.* are mirrored in the same way: do not mirror them again."]),
    )
    return _plate(subject, "top", 3, "seen on its patterned face: MIRRORED", notes)


def _casts(job: Job) -> list[str]:
    """What an odd number of casts asks for at the writer."""
    casts = job.plates.replications
    if not settings(casts).mirror:
        return []
    return [f"Odd number of casts, {casts}: mirror BOTH mask files, and invert them; see the job sheet of the masks."]


def _plate(subject: Subject, plate: Plate, number: int, subtitle: str, notes: tuple[str, ...]) -> Sheet:
    face, side = part_views.plate_face(subject, plate), part_views.plate_side(subject, plate)
    scale = fitting(face, (160, 165))
    sign = -1.0 if plate == "top" else 1.0
    rows = [(f"M{k + 1}", f"{sign * x + 0.0:.4f}", f"{y + 0.0:.4f}") for k, (x, y) in enumerate(subject.frame.marks)]
    return Sheet(
        f"{number}_{plate}_plate",
        f"{plate.capitalize()} plate",
        subtitle,
        f"glass {subject.job.plates.glass_mm:g} mm with epoxy {subject.job.plates.epoxy_um:g} µm",
        f"outline {CUT}; pattern {PATTERN}",
        "A3",
        (Placed(face, scale, (140, 170)), Placed(side, scale, (270, 170))),
        (
            *notes,
            "Phantom lines: the spacer strips." + " Dashed: test fields." * bool(subject.job.marks.fields),
            *_workshop(subject.job),
            "Origin: middle of the sheet. Details of the marks: sheet 5; of the channels: sheet 6.",
        ),
        (("Mark", "x in mm", "y in mm"), *rows),
        (318, 262),
        (20, 33, 33),
    )


def spacer(subject: Subject) -> Sheet:
    """The strips between the plates."""
    job = subject.job
    return Sheet(
        "4_spacer",
        "Spacer strip",
        "2 pieces",
        f"Mylar (PET film) {job.sheet.gap_um:g} µm",
        f"{CUT}; thickness: as the stock",
        "A4",
        (
            _in(part_views.spacer_strip(subject), (155, 30), (110, 160)),
            _in(part_views.spacer_edge(subject), (80, 25), (80, 110)),
            _in(part_views.spacer_place(subject), (60, 80), (240, 130)),
        ),
        ("Cut without burr: the thickness sets the gap.", "Cut line for a plotter: the DXF of this sheet, in mm."),
    )


def marks(subject: Subject) -> Sheet:
    """The alignment marks."""
    tolerance = subject.job.marks.tolerance_um
    figures = (
        (pattern_views.cluster(subject), (160, 160), (118, 184)),
        (pattern_views.gauge(subject), (65, 65), (268, 226)),
        (pattern_views.boxes(subject), (65, 65), (364, 226)),
        (pattern_views.verniers(subject), (65, 65), (268, 115)),
        (pattern_views.chirality(subject), (65, 65), (364, 130)),
    )
    return Sheet(
        "5_marks",
        "Alignment marks",
        f"mismatch at most {tolerance:g} µm",
        "relief in epoxy",
        PATTERN,
        "A3",
        tuple(_in(*figure) for figure in figures),
        (
            "Blue: bottom plate. Red: top plate. Middles of the clusters: sheets 2 and 3.",
            "All marks are filled with the channels' grating." if subject.job.marks.grating else "Marks are solid.",
            f"Aligned: the cross touches no square; each vernier's middle bars meet to {tolerance:g} bars.",
        ),
        (("", "Element", "", "Element"), *zip(*(iter(_letters()),) * 4, strict=True)),
        (24, 86),
        (8, 50, 8, 50),
    )


def _letters() -> list[str]:
    """Letter and meaning of the elements of a cluster, the second half beside the first."""
    items = [(letter, what) for letter, what, *_ in pattern_views.ITEMS.values()]
    half = len(items) // 2
    return [word for pair in zip(items[:half], items[half:], strict=True) for item in pair for word in item]


def channels(subject: Subject) -> Sheet:
    """A section of the channels and their ends, at large scale."""
    spec = subject.job.channels
    return Sheet(
        "6_channels",
        "Alignment channels",
        f"{micrometres(spec.width)} µm wide, {micrometres(spec.depth)} µm deep, both plates",
        "epoxy",
        PATTERN,
        "A4",
        (
            _in(pattern_views.channel_section(subject), (200, 45), (140, 156)),
            _in(pattern_views.channel_ends(subject), (100, 55), (95, 81)),
        ),
        (
            "A part of the pattern. The channels of a domain",
            "run along its director: bottom at theta - dtheta/2,",
            "top at theta + dtheta/2 (domains.csv).",
            "Ends are square; each lies at least the guard",
            "inside its domain (half the dimension shown).",
            "Section of the bottom plate; the top plate's",
            "channels open downwards in the cell.",
        ),
    )


def domain_map(subject: Subject) -> Sheet:
    """Where the domains lie and which way their directors point."""
    number = len(subject.domains)
    few = map_views.numbered(subject)
    found = "by their numbers" if few else "by the grid (x, y in mm)"
    return Sheet(
        "7_domains",
        "Domain map",
        f"{number} domains, director at mid-film",
        "LCE film, see design",
        "angles: as domains.csv",
        "A3",
        (_in(map_views.domain_map(subject), map_views.MAP_ROOM, (178, 165)),),
        (
            "Seen from above.",
            f"Domains are found in domains.csv {found}.",
            "Colours, in steps of 5°" + (": the director." if few else ", and lines: the director."),
        ),
        legend=(330, 250),
    )


SHEETS: tuple[Callable[[Subject], Sheet], ...] = (
    assembly,
    bottom_plate,
    top_plate,
    spacer,
    marks,
    channels,
    domain_map,
)
"""The set, in order."""


def sheets(path: Path, job: Job, made_for: Job | None = None) -> tuple[Sheet, ...]:
    """The set of drawings of the design in a file, for a job; ``made_for`` is the one that it was solved for."""
    return _sheets(path, changed_at(path), job, made_for)


@lru_cache(maxsize=4)
def _sheets(path: Path, changed: int, job: Job, made_for: Job | None) -> tuple[Sheet, ...]:  # noqa: ARG001
    return tuple(sheet(subject_of(path, job, made_for)) for sheet in SHEETS)


def subject_of(path: Path, job: Job, made_for: Job | None = None) -> Subject:
    """What is drawn of the design in a file."""
    return _subject(path, changed_at(path), job, made_for)


@lru_cache(maxsize=4)
def _subject(path: Path, changed: int, job: Job, made_for: Job | None) -> Subject:  # noqa: ARG001
    design = stored(path, job, made_for)
    domains = domains_of(path, job, made_for)
    code = fingerprint(domains, job.channels)
    return Subject(job, arrange(design.uv, job), domains, assembled(path, job, made_for), code)


def title_block(sheet: Sheet, subject: Subject) -> dict[str, str]:
    """The texts of the template's title block."""
    names = [make.__name__ for make in SHEETS]
    number = int(sheet.name[0])
    return {
        "title": sheet.title,
        "subtitle": sheet.subtitle,
        "scale": sheet.scale,
        "sheet": f"{number} of {len(names)}",
        "material": sheet.material,
        "tolerance": sheet.tolerance,
        "author": shortened(subject.job.output.author, 27),
        "date": shortened(subject.job.output.date, 21),
        "design": subject.code,
        "number": f"{subject.code}-{number}",
        "units": "in mm unless a unit stands beside it",
        "maker": "LCE molds",
    }


def shortened(text: str, most: int) -> str:
    """A text on one line of so many characters at most."""
    line = " ".join(text.split())
    return line if len(line) <= most else line[: most - 3] + "..."


def caption(view: Placed) -> str:
    """What stands above a view, with its scale."""
    return f"{view.figure.caption}  {ratio(view.scale)}"
