"""What is measured on the solids and on the written files, as findings of the cad stage."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from itertools import combinations
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from lce_solver.types import Finding, Severity
from lce_workbench.cad.mates import gauges, mated
from lce_workbench.cad.reread import channels_in, solids_in, tally, volume_of
from lce_workbench.cad.solids import solid
from lce_workbench.cad.step import CHANNEL_FILES, files, stored_as
from lce_workbench.core.cell import Cell
from lce_workbench.core.channels import Channels
from lce_workbench.core.domains import Plate
from lce_workbench.core.frame import Frame
from lce_workbench.core.job import Job
from lce_workbench.core.prism import Prism, bodies, together
from lce_workbench.core.units import NM, UM

if TYPE_CHECKING:
    import cadquery as cq

SAME = 1e-9
"""Relative difference at which two kernels, or a file and the design, agree."""

READABLE = 20_000
"""Solids of a file that is read back by a kernel; larger files are counted (a million takes minutes to read)."""

HOLES = 200
"""Holes of a face that is read back by a kernel, whose time grows with their square; larger ones are counted."""


def check(
    cell: Cell, channels: Mapping[Plate, Iterable[Channels]], frame: Frame, job: Job, folder: Path
) -> tuple[Finding, ...]:
    """Measure the cell and the STEP files in ``folder``.

    Parameters
    ----------
    channels : the channels that were written as solids.
    """
    stacks = bodies((*cell.parts, *cell.combs))
    shapes = {name: solid(stack) for name, stack in stacks.items()}
    found = [
        _kernel(stacks, shapes),
        _interference(cell.parts, shapes),
        _gap(shapes, job),
        _marks(cell, frame),
        _mates(cell, frame, job),
        *(_parts_in(folder / name, pick(cell)) for name, pick in files(job).items() if name.endswith(".step")),
    ]
    for name, plate in CHANNEL_FILES.items():
        path = folder / stored_as(name, job)
        if job.output.step == "exact":
            written = sum(tally(each)["solids"] for each in folder.glob(path.name.replace(".", "_*.", 1)))
            found.append(_counted(path, "channels", written, sum(map(len, channels[plate]))))
        else:
            found.append(_channels_in(channels[plate], path, job.output.step_instances))
    if "domains" in job.output.cad:
        path = folder / "domains.step"
        found.append(_counted(path, "domains", tally(path)["faces"], len(cell.domains)))
    return tuple(found)


def _kernel(stacks: Mapping[str, Sequence[Prism]], shapes: Mapping[str, cq.Solid]) -> Finding:
    """Volume, centroid and box of every solid against its prisms' own, relative to volume and size; and validity."""
    worst, where = max((_deviation(stack, shapes[name]), name) for name, stack in stacks.items())
    return judged("cad_kernel", f"{len(stacks)} solids differ from their prisms by up to", worst, SAME, where=where)


def _deviation(stack: Sequence[Prism], shape: cq.Solid) -> float:
    """Largest relative difference; infinite if the solid is not valid."""
    box, centre = shape.BoundingBox(), shape.Center()
    outlines = np.concatenate([outline for prism in stack for outline in (prism.outline, prism.top)])
    low, high = outlines.min(axis=0), outlines.max(axis=0)
    volume, centroid = together(stack)
    want = np.array([*low, stack[0].z0, *high, stack[-1].z1, *centroid])
    have = np.array([box.xmin, box.ymin, box.zmin, box.xmax, box.ymax, box.zmax, centre.x, centre.y, centre.z])
    off = max(float(np.abs(have - want).max() / max(high - low)), abs(shape.Volume() / volume - 1))
    return off if shape.isValid() else float("inf")


def _interference(parts: Sequence[Prism], shapes: Mapping[str, cq.Solid]) -> Finding:
    """The largest volume that two parts share [mm3]."""
    shared = [
        (shapes[a.name].intersect(shapes[b.name]).Volume(), f"{a.name} and {b.name}")
        for a, b in combinations(parts, 2)
        if a.name != b.name and min(a.z1, b.z1) - max(a.z0, b.z0) > NM and _boxes_meet(a, b)
    ]
    worst, where = max(shared, default=(0.0, ""))
    return judged("cad_interference", "the volume that two parts share is up to", worst, 0.0, unit="mm3", where=where)


def _boxes_meet(a: Prism, b: Prism) -> bool:
    low = np.maximum(a.outline.min(axis=0), b.outline.min(axis=0))
    high = np.minimum(a.outline.max(axis=0), b.outline.max(axis=0))
    return bool(np.all(high - low > 0))


def _gap(shapes: Mapping[str, cq.Solid], job: Job) -> Finding:
    """Between the epoxy faces, measured on the solids, against the spacer."""
    gap = shapes["top_land"].BoundingBox().zmin - shapes["bottom_land"].BoundingBox().zmax
    text = f"the gap between the epoxy faces is {gap / UM:.6f} um; from the spacer it differs by"
    return judged("cad_gap", text, abs(gap - job.sheet.thickness) / NM, 1.0, unit="nm")


def _marks(cell: Cell, frame: Frame) -> Finding:
    """Distance of the centres of both halves of the gauge, at each cluster."""
    bottom, top = gauges(cell, frame)
    off = np.linalg.norm(top - bottom, axis=1)
    at = int(np.argmax(off))
    text = "the gauges of both plates are apart by up to"
    return judged("cad_marks", text, float(off[at] / NM), 1.0, unit="nm", where=f"corner {at}")


def _mates(cell: Cell, frame: Frame, job: Job) -> Finding:
    """How far parts that are mated by their faces and marks lie off their place in the cell."""
    worst, where = mated(cell, frame, job)
    text = "the parts, put together by their faces and marks, lie off their place by up to"
    return judged("cad_mates", text, worst / NM, 1.0, unit="nm", where=where)


def _parts_in(path: Path, prisms: Sequence[Prism]) -> Finding:
    """Number and total volume of the solids that OpenCASCADE finds in a file."""
    count = len(bodies(prisms))
    if max(len(prism.holes) for prism in prisms) <= HOLES:
        return _compared(path, count, sum(prism.volume for prism in prisms))
    return _counted(path, "solids", tally(path)["solids"], count)


def _channels_in(parts: Iterable[Channels], path: Path, way: str) -> Finding:
    """The channels of a file: their number and, where a kernel reads them, their volume: written area x depth."""
    counts, volumes = zip(*((len(part), float(part.areas.sum()) * part.depth) for part in parts), strict=True)
    counted = channels_in(path, way)
    if path.suffix == ".gz" or sum(counts) > READABLE or counted != sum(counts):
        return _counted(path, "channels", counted, sum(counts))
    return _compared(path, sum(counts), sum(volumes))


def _counted(path: Path, what: str, found: int, want: int) -> Finding:
    text = f"{path.name} holds {found} of {want} {what} by its text; it lacks"
    return judged("cad_step", text, abs(want - found), 0.0, where=path.name)


def _compared(path: Path, count: int, volume: float) -> Finding:
    shapes = solids_in(path)
    text = f"{path.name} is read back as {len(shapes)} of {count} solids; their volume differs relatively by"
    off = abs(sum(map(volume_of, shapes)) / volume - 1) if len(shapes) == count else float("inf")
    return judged("cad_step", text, off, SAME, where=path.name)


def judged(check: str, text: str, value: float, limit: float, *, unit: str = "", where: str = "") -> Finding:
    """A finding, an error when ``value`` exceeds ``limit``."""
    severity = Severity.INFO if value <= limit else Severity.ERROR
    return Finding(
        check, severity, f"{text} {value:.3g} {unit}".rstrip() + f" (limit {limit:g})", value, limit, unit, where
    )
