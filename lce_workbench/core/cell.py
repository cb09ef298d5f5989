"""The mold and the closed cell as a stack of prisms, in sheet coordinates seen from above.

::

    +======================+  top_glass
    +----------------------+  top_epoxy
    +--+  +----------+  +--+  top_land: as thick as the channels are deep, with a hole for every mark and channel
       [M]            [M]     spacer strips, and between them the film: z = -gap/2 ... +gap/2
    +--+  +----------+  +--+  bottom_land
    +----------------------+  bottom_epoxy
    +======================+  bottom_glass

Nothing here is mirrored: only the master of the top plate is, when its mask is composed.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from lce_solver.errors import InputError
from lce_solver.types import Floats
from lce_workbench.core.channels import ChannelField, Channels, corners
from lce_workbench.core.domains import PLATES, SIDE, Domains, Plate
from lce_workbench.core.frame import Frame, Rect
from lce_workbench.core.job import Job, Output
from lce_workbench.core.marks import fingerprint
from lce_workbench.core.merge import merged
from lce_workbench.core.prism import Colour, Prism
from lce_workbench.core.units import UM
from lce_workbench.core.workshop import alignment_frame, beads, carrier, engraved, glass_levels, inset, release

MAX_SOLIDS = 10_000
"""Channel solids of both plates; about 30 domains."""

SECONDS = 4e-3
"""Time to build and write one channel solid."""

MEGABYTES = 8e-3
"""Size of one channel solid in a STEP file."""

MAX_CUT = 300
"""Channels cut into one land; the time to write and read a face grows with the square of its holes."""

LOOKS: dict[str, tuple[Colour, float]] = {
    "glass": ((0.66, 0.84, 0.90), 0.25),
    "epoxy": ((0.93, 0.79, 0.42), 0.30),
    "land": ((0.87, 0.60, 0.22), 0.40),
    "mylar": ((0.56, 0.61, 0.67), 1.0),
    "film": ((0.80, 0.22, 0.30), 1.0),
    "glue": ((0.95, 0.95, 0.80), 0.6),
    "jig": ((0.35, 0.38, 0.42), 1.0),
    "channel": ((0.16, 0.44, 0.72), 1.0),
}
"""Material -> colour (red, green, blue in [0, 1], sRGB) and opacity."""


@dataclass(frozen=True, eq=False)
class Cell:
    """The closed cell, z = 0 at the film's mid-plane."""

    parts: tuple[Prism, ...]
    """Plates, spacer and film."""
    channels: tuple[Prism, ...]
    """The trenches of the chosen domains as solids, grouped as ``channels_bottom`` and ``channels_top``."""
    combs: tuple[Prism, ...]
    """The land of each chosen domain with all its channels, grouped as ``combs_bottom`` and ``combs_top``."""
    chosen: tuple[int, ...]
    """The domains whose channels are solids."""
    domains: Domains
    """Those of the sheet in it."""

    def group(self, name: str) -> tuple[Prism, ...]:
        """The prisms of one assembly."""
        return tuple(prism for prism in (*self.parts, *self.channels, *self.combs) if prism.group == name)


def assemble(
    frame: Frame,
    job: Job,
    domains: Domains,
    marks: Mapping[Plate, Sequence[Floats]],
    channels: Mapping[Plate, Channels],
) -> Cell:
    """Build the cell. The lands hold the marks, and the channels of the chosen domains up to `MAX_CUT`.

    Parameters
    ----------
    marks : exposed polygons (k, 2) of each plate; where they touch, axis-parallel rectangles [mm].
    channels : all channels of each plate.

    Raises
    ------
    InputError
        A chosen domain does not exist or has no channels, or the solids would be too many.
    """
    chosen = choose(domains, channels, wanted(domains, job.output))
    gap, code = job.sheet.thickness, fingerprint(domains, job.channels)
    trenches = {plate: {k: corners(channels[plate], _rows(channels[plate], k)) for k in chosen} for plate in PLATES}
    cut = _few_enough(channels, chosen)
    bottom, top = (
        _plate(frame, job, plate, [*merged(marks[plate]), *(ring for k in cut for ring in trenches[plate][k])], code)
        for plate in PLATES
    )
    between = (-gap / 2, gap / 2)
    film = _part("sheet", "film", [domains.outline, *domains.holes], between)
    spacer = _pair("spacer", "mylar", frame.strips, between)
    glue = _pair("glue", "glue", beads(frame, job), between)
    solids = [
        _channel_solid(channels[plate], k, ring, gap)
        for plate, rings in trenches.items()
        for k in chosen
        for ring in rings[k]
    ]
    combs = [
        _part(f"comb_{k:04d}_{plate}", "land", [domains.ring(k), *rings[k]], _heights(job, plate), f"combs_{plate}")
        for plate, rings in trenches.items()
        for k in chosen
    ]
    return Cell(
        (*bottom[::-1], *spacer, *glue, film, *top, *_jig(frame, job)), tuple(solids), tuple(combs), chosen, domains
    )


def wanted(domains: Domains, output: Output) -> tuple[int, ...]:
    """The domains that the job names, and those that its window touches.

    Raises
    ------
    InputError
        The window is not four numbers, or touches no domain.
    """
    if not output.step_window_um:
        return output.step_domains
    if len(output.step_window_um) != 4:
        msg = f"output.step_window_um has {len(output.step_window_um)} numbers; give x0, y0, x1, y1"
        raise InputError(msg)
    window = np.array(output.step_window_um).reshape(2, 2) * UM
    rect = Rect(*window.min(axis=0), *window.max(axis=0)).ring
    touched = np.flatnonzero([_meet(corners, rect) for corners in domains.corners])
    if not len(touched):
        msg = "output.step_window_um lies outside the sheet, whose middle is 0, 0; move it"
        raise InputError(msg)
    return tuple(sorted({*output.step_domains, *touched.tolist()}))


def _meet(one: Floats, other: Floats) -> bool:
    """Whether two convex polygons share a point: no edge of either separates them."""
    for ring in (one, other):
        edge = np.roll(ring, -1, axis=0) - ring
        for normal in np.stack([edge[:, 1], -edge[:, 0]], axis=1):
            if (other @ normal).min() > (one @ normal).max() or (one @ normal).min() > (other @ normal).max():
                return False
    return True


def choose(
    domains: Domains, channels: Mapping[Plate, Channels | ChannelField], named: Sequence[int]
) -> tuple[int, ...]:
    """The domains whose channels become solids: those ``named``, or the most central one.

    Raises
    ------
    InputError
        A domain does not exist or has no channels, or the solids would exceed `MAX_SOLIDS`.
    """
    counts = np.array([channels[plate].counts for plate in PLATES])
    if not named:
        far = np.linalg.norm(domains.centroid, axis=1)
        return (int(np.argmin(np.where(counts.all(axis=0), far, np.inf))),)
    for domain in named:
        if not 0 <= domain < len(domains):
            msg = f"output.step_domains: domain {domain} does not exist; the sheet has 0 to {len(domains) - 1}"
            raise InputError(msg)
        if not counts[:, domain].all():
            msg = f"output.step_domains: domain {domain} is too small for a channel; choose another"
            raise InputError(msg)
    chosen = tuple(sorted(set(named)))
    _require_budget(int(counts[:, chosen].sum()))
    return chosen


def select(channels: Channels, chosen: Sequence[int]) -> Channels:
    """The channels of some domains alone."""
    keep = np.isin(channels.domain, chosen)
    return replace(channels, centre=channels.centre[keep], length=channels.length[keep], domain=channels.domain[keep])


def _require_budget(solids: int) -> None:
    """Refuse more than `MAX_SOLIDS` channels, with what they would cost."""
    if solids > MAX_SOLIDS:
        msg = (
            f"output.step_domains and step_window_um ask for {solids} channel solids, "
            f"about {solids * SECONDS:.0f} s and {solids * MEGABYTES:.0f} MB of STEP; the limit is {MAX_SOLIDS}, "
            'so choose fewer domains, or all of them, which are written otherwise, with output.step = "all"'
        )
        raise InputError(msg)


def _few_enough(channels: Mapping[Plate, Channels], chosen: Sequence[int]) -> Sequence[int]:
    """The first of the chosen domains, as many as have `MAX_CUT` channels together."""
    counts = [channels[plate].counts[list(chosen)] for plate in PLATES]
    return chosen[: int(np.searchsorted(np.cumsum(np.max(counts, axis=0)), MAX_CUT, side="right"))]


def _plate(frame: Frame, job: Job, plate: Plate, recesses: Sequence[Floats], code: str) -> tuple[Prism, ...]:
    """Land, epoxy and glass, from the film outwards; the layers of the glass bear one name."""
    group, outline = f"{plate}_plate", carrier(frame, job, plate)
    faces = np.cumsum([job.sheet.thickness / 2, job.channels.depth, job.plates.epoxy_um * UM, job.plates.glass_mm])
    narrow = inset(outline, release(frame, job))
    letters, glass_mm = engraved(frame, job, plate, code), job.plates.glass_mm

    def layer(kind: str, near: float, far: float, rings: tuple[Floats, Floats], holes: Sequence[Floats]) -> Prism:
        """Between two distances from the mid-plane, with an outline at each."""
        z, ends = (near, far) if plate == "top" else (-far, -near), rings if plate == "top" else rings[::-1]
        return _part(f"{plate}_{kind}", kind, [ends[0], *holes], z, group, top=ends[1])

    glass = []
    for low, high, at_low, at_high, deep in glass_levels(job):
        near, far = (faces[2] + (glass_mm - depth) for depth in (low, high))  # so that both meet exactly
        rings = inset(outline, at_low), inset(outline, at_high)
        glass.append(layer("glass", near, far, rings, letters if deep else []))
    return (
        layer("land", faces[0], faces[1], (narrow, narrow), recesses),
        layer("epoxy", faces[1], faces[2], (narrow, outline), []),
        *glass,
    )


def _pair(name: str, kind: str, places: Sequence[Rect], z: tuple[float, float]) -> tuple[Prism, ...]:
    """A left and a right part, if there are any, as an assembly."""
    sides = zip(("left", "right"), places, strict=False)
    return tuple(_part(f"{name}_{side}", kind, [place.ring], z, name) for side, place in sides)


def _jig(frame: Frame, job: Job) -> tuple[Prism, ...]:
    """The alignment frame, from the bottom plate's outer face to the film's mid-plane and as far above it."""
    rings = alignment_frame(frame, job)
    reach = job.sheet.thickness / 2 + job.channels.depth + job.plates.epoxy_um * UM + job.plates.glass_mm
    return () if rings is None else (_part("alignment_frame", "jig", [*rings], (-reach, reach / 2)),)


def _part(
    name: str, kind: str, rings: Sequence[Floats], z: tuple[float, float], group: str = "", *, top: Floats | None = None
) -> Prism:
    """A prism of one of the materials of `LOOKS`."""
    colour, opacity = LOOKS[kind]
    low, high = sorted(map(float, z))
    slanted = top is not None and not np.array_equal(top, rings[0])
    return Prism(name, rings[0], tuple(rings[1:]), low, high, colour, opacity, group, top if slanted else None)


def _heights(job: Job, plate: Plate) -> tuple[float, float]:
    """Both faces of a land."""
    near = job.sheet.thickness / 2
    return SIDE[plate] * near, SIDE[plate] * (near + job.channels.depth)


def _channel_solid(channels: Channels, domain: int, ring: Floats, gap: float) -> Prism:
    """One trench."""
    plate = channels.plate
    z = SIDE[plate] * gap / 2, SIDE[plate] * (gap / 2 + channels.depth)
    return _part(domain_name(channels, domain), "channel", [ring], z, f"channels_{plate}")


def domain_name(channels: Channels, domain: int) -> str:
    """Name of a domain's channels: its number and their direction seen from above, in degrees."""
    degrees = round(float(np.degrees(channels.angle[domain])), 2) % 180
    return f"domain_{domain:04d}_theta_{channels.plate}_{degrees:06.2f}"


def _rows(channels: Channels, domain: int) -> slice:
    """Rows of the channels of one domain."""
    return slice(*map(int, np.searchsorted(channels.domain, [domain, domain + 1])))
