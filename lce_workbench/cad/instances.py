"""All channels of a plate in one STEP file: a box for each length that occurs, and a placement for each channel.

Lengths are whole multiples of 0.1 um, so some thousand boxes are exact for a million channels. Each domain is a product
of its own, named by its number and by the channels' direction, which keeps the time to read in proportion to the number
of channels. Nothing is held but the boxes' numbers: the channels stream through.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from lce_solver.types import Finding, Floats, Ints, Severity
from lce_workbench.cad.brep import write_solids
from lce_workbench.cad.part21 import PRODUCT, Part21, Product, part21, real
from lce_workbench.core.cell import LOOKS, domain_name
from lce_workbench.core.channels import BLOCK, STEPS_PER_MM, Channels, joined, slanted
from lce_workbench.core.domains import SIDE
from lce_workbench.core.job import Job
from lce_workbench.core.polyhedron import polyhedron
from lce_workbench.core.prism import Prism

DIRECTION = "@0=DIRECTION('',({x},{y},0.));\n"

MAPPED = """\
@0=CARTESIAN_POINT('',({x:f},{y:f},{z}));
@1=AXIS2_PLACEMENT_3D('',@0,#11,#{direction:d});
@2=MAPPED_ITEM('',#{box:d},@1);
"""

MAP = """\
@0=ADVANCED_BREP_SHAPE_REPRESENTATION('',(#13,#{solid:d}),#9);
@1=REPRESENTATION_MAP(#13,@0);
"""

COMPONENT = """\
@0=CARTESIAN_POINT('',({x:f},{y:f},{z}));
@1=AXIS2_PLACEMENT_3D('',@0,#11,#{direction:d});
@2=ITEM_DEFINED_TRANSFORMATION('','',#13,@1);
@3=(REPRESENTATION_RELATIONSHIP('','',#{box:d},#{representation:d})\
REPRESENTATION_RELATIONSHIP_WITH_TRANSFORMATION(@2)SHAPE_REPRESENTATION_RELATIONSHIP());
@4=NEXT_ASSEMBLY_USAGE_OCCURRENCE('@4','','',#{definition:d},#{part:d},$);
@5=PRODUCT_DEFINITION_SHAPE('','',@4);
@6=CONTEXT_DEPENDENT_SHAPE_REPRESENTATION(@3,@5);
"""

COSTS: dict[str, tuple[str, float, float]] = {
    "comb": ("holes in the lands and combs of both plates", 8e3, 4e-4),
    "domain": ("domain outlines", 1.8e3, 1e-4),
    "mapped": ("channel solids of both plates", 200, 3e-6),
    "assembly": ("channel solids of both plates, as components,", 520, 8e-6),
    "exact": ("channel solids of both plates, each exact,", 5.2e3, 2e-4),
}
"""What there are many of -> in words, bytes of one in its file, and seconds of a common processor to write it."""


def estimate(kind: str, count: int) -> Finding:
    """Size and time of a level of detail, to be told before it is written."""
    words, size, time = COSTS[kind]
    megabytes = count * size / 1e6
    text = f"{count} {words} take about {megabytes:.3g} MB of STEP and {count * time:.2g} s to write"
    return Finding("cad_estimate", Severity.INFO, text, megabytes, unit="MB", where=kind)


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
    for part in _regrouped(parts):
        block = _Block(part, gap)
        products = WAYS[way](out, block, boxes)
        out.place(products, root)
        out.validate(products, *block.properties)


def write_exact(parts: Iterable[Channels], outlines: Floats, job: Job, path: Path) -> None:
    """Write each channel as a solid of its own, its ends along the domain's border, a file for 64 domains each.

    Parameters
    ----------
    outlines : (n_d, 3, 2) corners of all domains [mm].
    path : ``channels_top.step`` becomes ``channels_top_0000.step`` and so on.

    Raises
    ------
    OSError
        A file cannot be written.
    """
    for part in _regrouped(parts):
        block = _Block(part, job.sheet.thickness)
        stem, dot, suffix = path.name.partition(".")
        with part21(path.with_name(f"{stem}_{block.domains[0] // BLOCK:04d}{dot}{suffix}")) as out:
            root = out.product(out.name)
            solids = _slanted(out, block, slanted(part, outlines, job.channels.guard))
            out.place(out.products(block.names, block.split(solids)), root)


def _slanted(out: Part21, block: _Block, rings: Floats) -> Ints:
    """Write a prism over each ring (n, 4, 2)."""
    z0 = block.z
    unit = np.array([(-1.0, -1), (1, -1), (1, 1), (-1, 1)])
    one = polyhedron([Prism("one", unit, (), z0, z0 + block.channels.depth, *LOOKS["channel"])])
    corner = np.array([np.flatnonzero((unit == xy).all(axis=1))[0] for xy in one.points[:, :2]])
    bodies = [replace(one, points=np.column_stack([ring[corner], one.points[:, 2]])) for ring in rings]
    solids = write_solids(out, np.repeat(block.names, block.counts).tolist(), bodies)
    out.paint(solids, *LOOKS["channel"])
    return solids


def _regrouped(parts: Iterable[Channels]) -> Iterator[Channels]:
    """The channels, `BLOCK` domains by their numbers at a time, so that the parts they came in leave no trace."""
    held: list[Channels] = []
    for part in parts:
        group = part.domain // BLOCK
        for number in np.unique(group).tolist():
            if held and held[0].domain[0] // BLOCK != number:
                yield joined(held)
                held = []
            rows = group == number
            held.append(replace(part, **{name: getattr(part, name)[rows] for name in ("centre", "length", "domain")}))
    if held:
        yield joined(held)


@dataclass(frozen=True, eq=False)
class _Block:
    """The channels of some domains."""

    channels: Channels
    gap: float

    @cached_property
    def domains(self) -> Ints:
        """(n_d,) those that have channels."""
        return np.unique(self.channels.domain)

    @cached_property
    def starts(self) -> Ints:
        """(n_d,) first channel of each domain."""
        return np.searchsorted(self.channels.domain, self.domains)

    @property
    def counts(self) -> Ints:
        """(n_d,) channels of each domain."""
        return np.diff(self.starts, append=len(self.channels))

    @property
    def names(self) -> list[str]:
        return [domain_name(self.channels, domain) for domain in self.domains.tolist()]

    @property
    def z(self) -> float:
        """Lower face of the channels [mm]."""
        side = SIDE[self.channels.plate]
        return side * self.gap / 2 + min(0.0, side * self.channels.depth)

    @property
    def properties(self) -> tuple[Floats, Floats, Floats]:
        """Volume (n_d,), surface area (n_d,) and centroid (n_d, 3) of each domain's channels."""
        length, width, depth = self.channels.length, self.channels.width, self.channels.depth
        total = np.add.reduceat(length, self.starts)
        surface = 2 * (total * (width + depth) + self.counts * width * depth)
        centre = np.add.reduceat(self.channels.centre * length[:, None], self.starts) / total[:, None]
        return total * width * depth, surface, np.insert(centre, 2, self.z + depth / 2, axis=1)

    def split(self, items: Ints) -> list[Ints]:
        """Items (n,) of the channels, domain by domain."""
        return np.split(items, self.starts[1:])

    def columns(self, out: Part21) -> dict[str, Any]:
        """Columns of the placements; the direction, which a domain's channels share, is written."""
        angle = self.channels.angle[self.domains]
        axis = {"x": [f"{x:.15f}" for x in np.cos(angle)], "y": [f"{y:.15f}" for y in np.sin(angle)]}
        direction = np.repeat(out.rows(DIRECTION, len(angle), axis), self.counts)
        x, y = self.channels.centre.T
        return {"x": x, "y": y, "z": real(round(self.z, 12)), "direction": direction}

    def boxes(self, out: Part21, known: dict[int, int], write: Callable[[Part21, Sequence[int]], Ints]) -> Ints:
        """(n,) number of each channel's box; those whose length is new are written."""
        steps, which = np.unique(np.rint(self.channels.length * STEPS_PER_MM).astype(np.int64), return_inverse=True)
        new = [step for step in steps.tolist() if step not in known]
        if new:
            known.update(zip(new, write(out, new).tolist(), strict=True))
        return np.array([known[step] for step in steps.tolist()])[which]


def _painted(out: Part21, block: _Block, steps: Sequence[int]) -> Ints:
    """Write a box for each length, about the origin and standing on z = 0."""
    x, y = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)]).T * block.channels.width / 2
    box = polyhedron([Prism("box", np.column_stack([x, y]), (), 0.0, block.channels.depth, *LOOKS["channel"])])
    sides = np.sign(box.points[:, 0]) / (2 * STEPS_PER_MM)
    boxes = [replace(box, points=np.column_stack([step * sides, box.points[:, 1:]])) for step in steps]
    solids = write_solids(out, [_box_name(step) for step in steps], boxes)
    out.paint(solids, *LOOKS["channel"])
    return solids


def _box_name(steps: int) -> str:
    return f"channel_{steps / 10:.1f}_um"


def _mapped(out: Part21, block: _Block, boxes: dict[int, int]) -> list[Product]:
    """Each domain as one representation that maps boxes: three statements a channel."""

    def write(out: Part21, new: Sequence[int]) -> Ints:
        return out.rows(MAP, len(new), {"solid": _painted(out, block, new)}) + 1

    maps = block.boxes(out, boxes, write)
    items = out.rows(MAPPED, len(maps), {**block.columns(out), "box": maps}) + 2
    return out.products(block.names, block.split(items))


def _assembly(out: Part21, block: _Block, boxes: dict[int, int]) -> list[Product]:
    """Each domain as an assembly of boxes: seven statements a channel, for readers that do not know mapped items."""

    def write(out: Part21, new: Sequence[int]) -> Ints:
        names, solids = [_box_name(step) for step in new], _painted(out, block, new)[:, None]
        made = out.products(names, list(solids), "ADVANCED_BREP_SHAPE_REPRESENTATION")
        return np.array([product.definition for product in made])

    parts = block.boxes(out, boxes, write)
    columns = block.columns(out)
    placed = out.next + PRODUCT.count("\n") * len(block.domains) + 1
    products = out.products(block.names, block.split(placed + COMPONENT.count("\n") * np.arange(len(parts))))
    wholes = {
        "definition": np.repeat([product.definition for product in products], block.counts),
        "representation": np.repeat([product.representation for product in products], block.counts),
    }
    shapes = parts - Product.DEFINITION + Product.REPRESENTATION
    out.rows(COMPONENT, len(parts), {**columns, **wholes, "part": parts, "box": shapes})
    return products


WAYS: dict[str, Callable[[Part21, _Block, dict[int, int]], list[Product]]] = {"mapped": _mapped, "assembly": _assembly}
"""How the channels stand in the file."""
