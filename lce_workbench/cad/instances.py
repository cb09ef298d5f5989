"""All channels of a plate in one STEP file: a box for each length that occurs, and a placement for each channel.

Lengths are whole multiples of 0.1 um, so some thousand boxes are exact for a million channels. Each domain is a product
of its own, named by its number and by the channels' direction, which keeps the time to read in proportion to the number
of channels. Nothing is held but the boxes' numbers: the channels stream through.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np

from lce_solver.types import Finding, Floats, Ints, Severity
from lce_workbench.cad.brep import write_solid
from lce_workbench.cad.part21 import PRODUCT, Part21, Product, real
from lce_workbench.core.cell import LOOKS, Prism, domain_name
from lce_workbench.core.channels import STEPS_PER_MM, Channels
from lce_workbench.core.domains import SIDE

DIRECTION = "@0=DIRECTION('',({x:.15f},{y:.15f},0.));\n"

MAPPED = """\
@0=CARTESIAN_POINT('',({x:%.9f},{y:%.9f},{z}));
@1=AXIS2_PLACEMENT_3D('',@0,#11,{direction});
@2=MAPPED_ITEM('',#{box:%d},@1);
"""

MAP = """\
@0=ADVANCED_BREP_SHAPE_REPRESENTATION('',(#13,#{solid}),#9);
@1=REPRESENTATION_MAP(#13,@0);
"""

COMPONENT = """\
@0=CARTESIAN_POINT('',({x:%.9f},{y:%.9f},{z}));
@1=AXIS2_PLACEMENT_3D('',@0,#11,{direction});
@2=ITEM_DEFINED_TRANSFORMATION('','',#13,@1);
@3=(REPRESENTATION_RELATIONSHIP('','',#{box:%d},{representation})\
REPRESENTATION_RELATIONSHIP_WITH_TRANSFORMATION(@2)SHAPE_REPRESENTATION_RELATIONSHIP());
@4=NEXT_ASSEMBLY_USAGE_OCCURRENCE('@4','','',{definition},#{part:%d},$);
@5=PRODUCT_DEFINITION_SHAPE('','',@4);
@6=CONTEXT_DEPENDENT_SHAPE_REPRESENTATION(@3,@5);
"""

BYTES: dict[str, int] = {"mapped": 200, "assembly": 520}
"""Size of one channel in the file, with its share of the boxes."""

SECONDS: dict[str, float] = {"mapped": 4e-6, "assembly": 9e-6}
"""Time to write one channel on a common machine."""


def estimate(channels: int, way: str) -> Finding:
    """Size and time of the channel solids, to be told before they are written."""
    megabytes, seconds = channels * BYTES[way] / 1e6, channels * SECONDS[way]
    text = (
        f"{channels} channel solids of both plates take about {megabytes:.3g} MB of STEP and {seconds:.2g} s to write"
    )
    return Finding("cad_estimate", Severity.INFO, text, megabytes, unit="MB")


def write_channels(out: Part21, parts: Iterable[Channels], gap: float, way: str) -> None:
    """Write the channels as solids in the closed cell, a product per domain that has any.

    Parameters
    ----------
    parts : channels of one plate; a domain is never split between two of them.
    gap : thickness of the film [mm].
    way : key of `WAYS`.
    """
    root = out.product(out.name)
    boxes: dict[int, int] = {}
    for part in parts:
        starts = [0, *(np.flatnonzero(np.diff(part.domain)) + 1).tolist(), len(part)]
        for start, stop in pairwise(starts):
            if start < stop:
                run = _Run(part, slice(start, stop), gap)
                product = WAYS[way](out, run, boxes)
                out.place(product, root)
                out.validate(product, *run.properties)


@dataclass(frozen=True, eq=False)
class _Run:
    """The channels of one domain."""

    channels: Channels
    rows: slice
    gap: float

    @property
    def domain(self) -> int:
        return int(self.channels.domain[self.rows.start])

    @property
    def name(self) -> str:
        return domain_name(self.channels, self.domain)

    @property
    def length(self) -> Floats:
        return self.channels.length[self.rows]

    @property
    def z(self) -> float:
        """Lower face of the channels [mm]."""
        side = SIDE[self.channels.plate]
        return side * self.gap / 2 + min(0.0, side * self.channels.depth)

    @property
    def properties(self) -> tuple[float, float, Floats]:
        """Volume, surface area and centroid of all of them."""
        length, width, depth = self.length, self.channels.width, self.channels.depth
        total = float(length.sum())
        surface = 2 * (total * (width + depth) + len(length) * width * depth)
        centre = length @ self.channels.centre[self.rows] / total
        return total * width * depth, surface, np.array([*centre, self.z + depth / 2])

    def columns(self, out: Part21) -> dict[str, Any]:
        """Columns of the placements; the direction, which they share, is written."""
        angle = float(self.channels.angle[self.domain])
        direction = out.add(DIRECTION, x=math.cos(angle), y=math.sin(angle))
        x, y = self.channels.centre[self.rows].T
        return {"x": x, "y": y, "z": real(round(self.z, 12)), "direction": f"#{direction}"}

    def boxes(self, out: Part21, known: dict[int, int], write: Callable[[Part21, Prism], int]) -> Ints:
        """(n,) number of each channel's box; those whose length is new are written."""
        steps, which = np.unique(np.rint(self.length * STEPS_PER_MM).astype(np.int64), return_inverse=True)
        for step in steps.tolist():
            if step not in known:
                known[step] = write(out, _box(step, self.channels))
        return np.array([known[step] for step in steps.tolist()])[which]


def _box(steps: int, channels: Channels) -> Prism:
    """The channel of a length, about the origin and standing on z = 0."""
    x, y = steps / STEPS_PER_MM / 2, channels.width / 2
    ring = np.array([(-x, -y), (x, -y), (x, y), (-x, y)])
    return Prism(f"channel_{steps / 10:.1f}_um", ring, (), 0.0, channels.depth, *LOOKS["channel"])


def _painted(out: Part21, box: Prism) -> int:
    solid = write_solid(out, box)
    out.paint(solid, box.colour, box.opacity)
    return solid


def _mapped(out: Part21, run: _Run, boxes: dict[int, int]) -> Product:
    """The domain as one representation that maps boxes: three statements a channel."""

    def write(out: Part21, box: Prism) -> int:
        return out.add(MAP, solid=_painted(out, box)) + 1

    maps = run.boxes(out, boxes, write)
    first = out.rows(MAPPED, len(maps), {**run.columns(out), "box": maps})
    return out.product(run.name, range(first + 2, first + 3 * len(maps), 3))


def _assembly(out: Part21, run: _Run, boxes: dict[int, int]) -> Product:
    """The domain as an assembly of boxes: seven statements a channel, for readers that do not know mapped items."""

    def write(out: Part21, box: Prism) -> int:
        return out.product(box.name, [_painted(out, box)], "ADVANCED_BREP_SHAPE_REPRESENTATION").definition

    parts = run.boxes(out, boxes, write)
    columns = run.columns(out)
    placed = out.next + PRODUCT.count("\n") + 1
    product = out.product(run.name, range(placed, placed + 7 * len(parts), 7))
    shapes = parts - Product.DEFINITION + Product.REPRESENTATION
    whole = {"definition": f"#{product.definition}", "representation": f"#{product.representation}"}
    out.rows(COMPONENT, len(parts), {**columns, **whole, "part": parts, "box": shapes})
    return product


WAYS: dict[str, Callable[[Part21, _Run, dict[int, int]], Product]] = {"mapped": _mapped, "assembly": _assembly}
"""How the channels stand in the file."""
