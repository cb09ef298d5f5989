"""What the operator of the laser writer needs beside the files: settings, expected counts and areas, time."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from lce_workbench.core.domains import Plate
from lce_workbench.core.frame import Frame
from lce_workbench.core.job import Job
from lce_workbench.core.mask import EXPOSED, LAYERS, Mask
from lce_workbench.core.replication import advice, settings
from lce_workbench.core.units import NM

MINUTES_PER_MM2 = {1.0: 0.3, 0.0: 0.9}
"""Write time of a DWL 66+ by smallest feature [um], from a cleanroom's public price note."""

OVERHEAD = 1.25
"""Loading, focus and stitching."""

SAME = ("mirror x OFF, positive resist",)
"""What an even number of casts asks for."""


@dataclass(frozen=True)
class Total:
    """What the converter's log has to say of one layer."""

    count: int
    area: float
    """[mm2]"""


def totals(mask: Mask) -> dict[str, Total]:
    """Polygons and their area on every layer, from the written integers."""
    found = {}
    for name, groups in mask.layers.items():
        count, area = 0, 0.0
        for polygons in groups:
            x, y = (polygons[..., i] - polygons[:, :1, i].astype(np.float64) for i in (0, 1))
            area += float(np.sum(x[:, :-1] * y[:, 1:] - x[:, 1:] * y[:, :-1])) / 2
            count += len(polygons)
        found[name] = Total(count, area * NM**2)
    return found


def minutes(area: float, width_um: float) -> float:
    """Estimated write time of a patterned ``area`` [mm2]."""
    rate = next(rate for limit, rate in MINUTES_PER_MM2.items() if width_um >= limit)
    return area * rate * OVERHEAD


def job_sheet(frame: Frame, job: Job, found: Mapping[Plate, Mapping[str, Total]], code: str) -> str:
    """The sheet as plain text."""
    width, height = frame.plate.size
    patterned = frame.sheet.size[0] * frame.sheet.size[1]
    smallest = min(job.channels.width_um, job.channels.spacing_um)
    mirror = "ON (x)" if settings(job.plates.replications).mirror else "OFF"
    lines = [
        f"Laser writer job sheet, design {code}",
        "",
        "Files           bottom.*, top.*: one format each is enough; .gds is the master copy",
        "Unit            .gds, .oas, .cif: 1 nm grid, in the file; .dxf: 1 drawing unit = 1 um, .r12.dxf likewise",
        f"Mirror x / y    {mirror} for both plates (the top plate's file is mirrored already)",
        "Rotation        0      Magnification  1      Automatic centring  OFF (the sheet's centre is the origin)",
        "Exposed         layers " + ", ".join(f"{LAYERS[name]}/0 {name}" for name in EXPOSED),
        "Not exposed     all other layers",
        "Overlaps        none on any layer: OR, CUT and XOR give the same",
        f"Resist          positive; exposed = removed = channel, {job.channels.depth_um:g} um deep (set by dose)",
        f"Copies          {job.plates.replications} casts (2: PDMS, then epoxy); both plates in the same batch",
        *(f"!               {change}" for change in advice(job.plates.replications)),
        "                one cast more or less: " + "; ".join(advice(job.plates.replications + 1) or SAME),
        "Turning over    the top plate is turned about the y axis, as its arrow shows",
        f"Plate           {width:g} x {height:g} mm, smallest line or land {smallest:g} um",
        f"Time            about {minutes(patterned, smallest):.0f} min a plate for {patterned:.0f} mm2 (an estimate)",
        "",
        f"{'expect':10}{'layer':>7}{'bottom: polygons':>18}{'area mm2':>14}{'top: polygons':>18}{'area mm2':>14}",
    ]
    for name, number in ((name, LAYERS[name]) for name in found["bottom"]):
        row = "".join(f"{found[p][name].count:18d}{found[p][name].area:14.6f}" for p in ("bottom", "top"))
        lines.append(f"{name:10}{f'{number}/0':>7}{row}")
    return "\n".join(lines) + "\n"
