"""What every part of the closed cell has to be: heights by the job, outlines by the masks and by the design."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from lce_solver.types import Floats
from lce_workbench.core.job import Job
from lce_workbench.verify.masks import Plates
from lce_workbench.verify.reference import PLATES, Plate, Reference
from lce_workbench.verify.shapes import areas

STACK = ("land", "epoxy", "glass")
"""Of a plate, from the film outwards."""

CLUSTER_MM = 1.5
"""Side of a cluster of marks; the glue beads lie beside the outer ones."""


LETTERS_MM = 0.7
"""Height of the engraved letters, which run along the plate's side."""


@dataclass(frozen=True, eq=False)
class Wanted:
    """What a part has to be."""

    z: tuple[float, float]
    """Lower and upper face [mm]."""
    box: Floats | None = None
    """(4,) low x, low y, high x, high y [mm]; None if not known."""
    volume: float | None = None
    """[mm3]; None if not known."""
    within: tuple[float, ...] = ()
    """Heights between the faces at which it has corners too [mm]."""
    engraving: float = 0.0
    """What letters may take of the volume at most; if there are none, 0 [mm3]."""


def wanted(reference: Reference, masks: Mapping[Plate, Plates]) -> dict[str, Wanted]:
    """Every part of the cell: heights by the job, outlines by the mask of its plate and by the design."""
    job, found = reference.job, {}
    thickness = {"land": job.channels.depth_um / 1e3, "epoxy": job.plates.epoxy_um / 1e3, "glass": job.plates.glass_mm}
    half = job.sheet.gap_um / 2e3
    for plate in PLATES:
        level, glass = half, _outlines(masks.get(plate), "PLATE")
        for layer in STACK:
            z = level, level + thickness[layer]
            level = z[1]
            heights = z if plate == "top" else (-z[1], -z[0])
            narrow = job.plates.epoxy_um / 1e3 * math.tan(math.radians(job.plates.release_deg)) * (layer == "land")
            box = glass[0] + narrow * np.array([1, 1, -1, -1]) if glass else None
            volume = _volume(layer, job, glass[0]) if glass else None
            found[f"{plate}_{layer}"] = Wanted(heights, box, volume, *_outside(layer, job, heights, plate, glass))
    strips = sorted(_outlines(masks.get("bottom"), "SPACER"), key=lambda box: float(box[0]))
    for k, side in enumerate(("left", "right")):
        box = strips[k] if len(strips) == 2 else None
        volume = None if box is None else float(np.prod(box[2:] - box[:2])) * 2 * half
        found[f"spacer_{side}"] = Wanted((-half, half), box, volume)
    found |= _workshop(job, masks, half, level)
    low, high = reference.flat.min(axis=0), reference.flat.max(axis=0)
    area = float(areas(reference.flat[reference.triangles]).sum())
    found["sheet"] = Wanted((-half, half), np.concatenate([low, high]), area * 2 * half)
    return found


def _outside(
    layer: str, job: Job, heights: tuple[float, float], plate: Plate, glass: list[Floats]
) -> tuple[tuple[float, ...], float]:
    """Heights of chamfer and engraving in the outer face of a glass, and what the letters may take of it."""
    if layer != "glass":
        return (), 0.0
    depths = {job.plates.chamfer_mm, job.plates.engraving_um / 1e3} - {0.0}
    within = tuple(heights[1] - depth if plate == "top" else heights[0] + depth for depth in sorted(depths))
    side = float(glass[0][3] - glass[0][1]) if glass else np.inf
    return within, LETTERS_MM * side * job.plates.engraving_um / 1e3


def _outlines(plate: Plates | None, layer: str) -> list[Floats]:
    """Boxes of the polygons of a layer [mm]."""
    polygons = plate.common.get(layer) if plate else None
    if polygons is None:
        return []
    return [np.concatenate([p.min(axis=0), p.max(axis=0)]) * 1e-6 for p in polygons]


def _volume(layer: str, job: Job, box: Floats) -> float | None:
    """Of a layer of a plate [mm3]: a stack of convex sections, whose area is A - P d + K d^2 at a distance d inwards.

    P is the perimeter; K adds tan(half the turn) of the corners: 1 at a right angle, twice tan(22.5 deg) at a notch.
    None for the land, where marks and channels are cut in; letters are not taken off.
    """
    plates, (a, b) = job.plates, box[2:] - box[:2]
    if layer == "land":
        return None
    cut = plates.notch_mm
    area, perimeter = a * b - cut**2 / 2, 2 * (a + b) - (2 - math.sqrt(2)) * cut
    corners = 3 + 2 * math.tan(math.pi / 8) if cut else 4.0

    def tapered(height: float, d: float) -> float:
        """From no distance at one end to ``d`` at the other."""
        return float(height * (area - perimeter * d / 2 + corners * d**2 / 3))

    if layer == "epoxy":
        height = plates.epoxy_um / 1e3
        return tapered(height, height * math.tan(math.radians(plates.release_deg)))
    return float(area * (plates.glass_mm - plates.chamfer_mm)) + tapered(plates.chamfer_mm, plates.chamfer_mm)


def _workshop(job: Job, masks: Mapping[Plate, Plates], half: float, outside: float) -> dict[str, Wanted]:
    """Glue beads and alignment frame, whose glass ends at the height ``outside`` [mm]."""
    found: dict[str, Wanted] = {}
    width, plate = min(job.spacer.bead_mm, job.spacer.glue_mm), masks.get("bottom")
    if width:
        found = {f"glue_{side}": Wanted((-half, half)) for side in ("left", "right")}
        at = np.array(list(plate.places.values())) * 1e-6 if plate and plate.places else None
        if at is not None:
            (x0, y0), (x1, y1) = at.min(axis=0) - CLUSTER_MM / 2, at.max(axis=0) + CLUSTER_MM / 2
            near, far = (job.spacer.glue_mm - width) / 2, (job.spacer.glue_mm + width) / 2
            volume = float(width * (y1 - y0) * 2 * half)
            for side, x in (("left", (x0 - far, x0 - near)), ("right", (x1 + near, x1 + far))):
                found[f"glue_{side}"] = Wanted((-half, half), np.array([x[0], y0, x[1], y1]), volume)
    if job.plates.frame_mm:
        glass = _outlines(plate, "PLATE")
        wall, play = job.plates.frame_mm, job.plates.frame_clearance_um / 1e3
        found["alignment_frame"] = Wanted((-outside, outside / 2))
        if glass:
            inner, outer = (glass[0] + grow * np.array([-1, -1, 1, 1]) for grow in (play, play + wall))
            area = float(np.prod(outer[2:] - outer[:2]) - np.prod(inner[2:] - inner[:2]))
            found["alignment_frame"] = Wanted((-outside, outside / 2), outer, area * 1.5 * outside)
    return found
