"""The mask of one plate as the laser writes it: integer nanometres, the top plate mirrored."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from lce_solver.errors import InputError
from lce_solver.types import Floats
from lce_workbench.core.channels import ChannelField, corners
from lce_workbench.core.domains import Plate
from lce_workbench.core.fields import fields, require_known
from lce_workbench.core.frame import Frame
from lce_workbench.core.job import Job
from lce_workbench.core.marks import Wanted, code, exposed, fingerprint
from lce_workbench.core.units import NM

Nanometres = NDArray[np.int32]

LAYERS: dict[str, int] = {
    "CHANNELS": 1,
    "MARKS": 2,
    "LABELS": 3,
    "TEST": 4,
    "PLATE": 10,
    "DOMAINS": 11,
    "SPACER": 12,
    "SEAM": 13,
}
"""Layer names (DXF) and numbers (GDSII, datatype 0), in the order in which they are written."""

EXPOSED = ("CHANNELS", "MARKS", "LABELS", "TEST")
"""Layers that the laser writes; the others are for orientation."""

NO_SEAMS = np.empty((0, 2, 2))
SEAM_WIDTH = 0.01
"""Width of the lines that show a seam [mm]."""

NAMES: dict[Plate, str] = {"bottom": "LCE_BOTTOM", "top": "LCE_TOP"}


@dataclass(frozen=True, eq=False)
class Mask:
    """What is on one master, seen from its resist side; the sheet's centre is the origin."""

    plate: Plate
    layers: Mapping[str, Iterable[Nanometres]]
    """Polygons of each layer of `LAYERS`, as arrays (n, k, 2); convex, counter-clockwise [nm]. ``SEAM`` may be missing.

    ``CHANNELS`` comes in the blocks of a `ChannelField`, each an array (n, 4, 2) that exists only while it is used;
    the first edge runs along the channel. Every layer can be gone through many times.
    """

    @property
    def name(self) -> str:
        """Name of the top cell."""
        return NAMES[self.plate]

    @property
    def channels(self) -> Nanometres:
        """(n, 4, 2) all channels as written, in memory at once [nm]."""
        return np.concatenate([*self.layers["CHANNELS"]])


def nanometres(polygons: Floats) -> Nanometres:
    """Round mm to the mask's 1 nm grid. The only place where a length becomes an integer."""
    return np.rint(polygons / NM).astype(np.int32)


def flipped(polygons: Nanometres) -> Nanometres:
    """Polygons (n, k, 2) seen from the other side, x -> -x; still counter-clockwise, quadrilaterals keep edge 0."""
    turned = polygons[:, ::-1].copy()
    np.negative(turned[..., 0], out=turned[..., 0])
    return turned


def written(polygons: Floats, plate: Plate) -> Nanometres:
    """Polygons (n, k, 2) in sheet coordinates [mm] as they are on the master of ``plate`` [nm]."""
    return flipped(nanometres(polygons)) if plate == "top" else nanometres(polygons)


@dataclass(frozen=True, eq=False)
class WrittenChannels:
    """Channels as written, block by block (n, 4, 2) [nm]."""

    field: ChannelField

    def __iter__(self) -> Iterator[Nanometres]:
        """Yield the integers of each block of the field."""
        return (written(corners(part), part.plate) for part in self.field)


def compose(frame: Frame, field: ChannelField, job: Job, seams: Floats = NO_SEAMS) -> Mask:
    """Everything on the master of the field's plate, with the sheet's ``seams`` (k, 2, 2), segments [mm].

    The top plate is mirrored, because its patterned face looks down in the cell. Resist -> PDMS -> epoxy mirrors
    twice, so a master has the handedness of its epoxy plate.

    Raises
    ------
    InputError
        Lines or lands are finer than the writer's mode, or a label or test field is not known.
    """
    refuse_unwritable(job)
    plate = field.plate
    shapes = {
        **exposed(frame, plate, job, fingerprint(field.domains, field.spec)),
        "TEST": fields(frame, job),
        "PLATE": frame.plate.ring[None],
        "SPACER": np.stack([strip.ring for strip in frame.strips]),
    }
    layers: dict[str, Iterable[Nanometres]] = {name: (written(shape, plate),) for name, shape in shapes.items()}
    layers["DOMAINS"] = tuple(written(rings, plate) for _, rings in field.domains.rings())
    layers["CHANNELS"] = WrittenChannels(field)
    if len(seams):
        layers["SEAM"] = (written(_lines(seams), plate),)
    return Mask(plate, {name: layers[name] for name in LAYERS if name in layers})


def _lines(segments: Floats) -> Floats:
    """(k, 4, 2) segments (k, 2, 2) as rectangles of `SEAM_WIDTH`."""
    along = segments[:, 1] - segments[:, 0]
    side = along[:, ::-1] * (-1, 1) / np.linalg.norm(along, axis=1, keepdims=True) * SEAM_WIDTH / 2
    start, end = segments[:, 0], segments[:, 1]
    return np.stack([start - side, end - side, end + side, start + side], axis=1)


def refuse_unwritable(job: Job) -> None:
    """Refuse what no mask can hold, whatever the design will be.

    Raises
    ------
    InputError
        Lines or lands are finer than the writer's mode, or a label or test field cannot be drawn.
    """
    finest, spec = job.output.writer_um, job.channels
    for key, found, fault in (
        ("width_um", spec.width_um, "so the channels cannot be written"),
        ("spacing_um", spec.spacing_um, "so a channel would merge with its neighbours"),
        ("guard_um", 2 * spec.guard_um, "even doubled, so channels would merge across the domains' borders"),
    ):
        if found < finest:
            msg = (
                f"channels.{key} = {getattr(spec, key):g} is finer than output.writer_um = {finest:g} um, the writer's "
                f"finest line and land, {fault}; make it larger or choose a finer mode"
            )
            raise InputError(msg)
    code(Wanted(job.marks))
    require_known(job.marks.fields)
