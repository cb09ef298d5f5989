"""The mask of one plate as the laser writes it: integer nanometres, the top plate mirrored."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from lce_solver.types import Floats
from lce_workbench.core.channels import Channels, blocks, corners
from lce_workbench.core.domains import Domains, Plate
from lce_workbench.core.frame import Frame
from lce_workbench.core.job import Job
from lce_workbench.core.marks import marks
from lce_workbench.core.units import NM

Nanometres = NDArray[np.int32]

LAYERS: dict[str, int] = {
    "CHANNELS": 1,
    "MARKS": 2,
    "LABELS": 3,
    "PLATE": 10,
    "DOMAINS": 11,
    "SPACER": 12,
}
"""Layer names (DXF) and numbers (GDSII, datatype 0), in the order in which they are written."""

EXPOSED = ("CHANNELS", "MARKS", "LABELS")
"""Layers that the laser writes; the others are for orientation."""

NAMES: dict[Plate, str] = {"bottom": "LCE_BOTTOM", "top": "LCE_TOP"}


@dataclass(frozen=True, eq=False)
class Mask:
    """What is on one master, seen from its resist side; the sheet's centre is the origin."""

    plate: Plate
    layers: Mapping[str, tuple[Nanometres, ...]]
    """Polygons (n, k, 2) of each layer of `LAYERS`, one array per vertex count k; convex, counter-clockwise [nm].

    ``CHANNELS`` is one array (n, 4, 2) in the order of `Channels`; the first edge runs along the channel.
    """

    @property
    def name(self) -> str:
        """Name of the top cell."""
        return NAMES[self.plate]

    @property
    def channels(self) -> Nanometres:
        """(n, 4, 2) channels as written [nm]."""
        return self.layers["CHANNELS"][0]


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


def compose(frame: Frame, domains: Domains, channels: Channels, job: Job) -> Mask:
    """Everything on the master of the channels' plate.

    The top plate is mirrored, because its patterned face looks down in the cell. Resist -> PDMS -> epoxy mirrors
    twice, so a master has the handedness of its epoxy plate.
    """
    plate = channels.plate
    shapes = {
        **marks(frame, plate, job.marks),
        "PLATE": frame.plate.ring[None],
        "DOMAINS": domains.corners,
        "SPACER": np.stack([strip.ring for strip in frame.strips]),
    }
    layers = {"CHANNELS": _channels(channels)} | {name: written(shape, plate) for name, shape in shapes.items()}
    return Mask(plate, {name: (layers[name],) for name in LAYERS})


def _channels(channels: Channels) -> Nanometres:
    """Channels (n, 4, 2) as written [nm]; in blocks, so that only integers exist for all of them at once."""
    polygons = np.empty((len(channels), 4, 2), dtype=np.int32)
    for rows in blocks(channels):
        polygons[rows] = written(corners(channels, rows), channels.plate)
    return polygons
