"""The masks of one plate: every format read, the first against the design, the others against the first."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from scipy.spatial import cKDTree

from lce_solver.types import Finding, Floats
from lce_workbench.verify import channels, clusters
from lce_workbench.verify.finding import Findings, Unreadable, error, guarded, measured, reading, same
from lce_workbench.verify.layouts import LAYERS, Layout, read
from lce_workbench.verify.reference import Plate, Reference
from lce_workbench.verify.shapes import areas, centroids, extent, mirrored, unlike

CELLS = {"bottom": "LCE_BOTTOM", "top": "LCE_TOP"}

GRID = 1e-9
"""[m]"""

COMMON = ("TEST", "PLATE", "DOMAINS", "SPACER", "SEAM")
"""Layers that are alike on both plates, seen from above."""


@dataclass(frozen=True, eq=False)
class Plates:
    """What the other checks need of one plate; seen from above, as the first readable mask file has it."""

    name: str = ""
    """Of that file."""
    areas: Floats = field(default_factory=lambda: np.zeros(0))
    """(n_d,) channels of each domain [mm2]."""
    totals: Mapping[str, tuple[int, float]] = field(default_factory=dict)
    """Layer -> number of polygons and their area [mm2]."""
    common: Mapping[str, Floats] = field(default_factory=dict)
    """Polygons of `COMMON` [nm]."""
    marks: Mapping[str, Floats] = field(default_factory=dict)
    """Middles of the marks, see `clusters.centres` [nm]."""
    places: Mapping[str, Floats] = field(default_factory=dict)
    """Middles of the clusters by the form for their readings [nm]."""


def check(folder: Path, plate: Plate, reference: Reference, counts: Floats | None) -> tuple[Findings, Plates]:
    """Measure every mask file of ``plate``."""
    found: list[Finding] = []
    first: Layout | None = None
    facts = Plates()
    at = None
    try:
        at = clusters.places(folder / "mask" / "readings.csv")
    except Unreadable as fault:
        found.append(error("verify_readings", "mask/readings.csv", str(fault)))
    for ending in reference.job.output.masks:
        name = f"mask/{plate}.{ending}"
        try:
            layout = read(folder / name)
        except Unreadable as fault:
            found.append(error("verify_mask", name, str(fault)))
            continue
        found += guarded("verify_mask", name, _plain, name, layout, plate, reference.seams)
        if first is not None:
            differences = guarded("verify_formats", name, _equal, name, layout, facts.name, first)
            found += differences
            if not any(difference.value for difference in differences):
                continue
        shapes = Seen(name, layout, plate, reference)
        found += guarded("verify_mask", name, shapes.against_design, counts)
        found += guarded("verify_marks", name, shapes.against_form, at)
        if first is None:
            first, facts = layout, shapes.facts(at)
    return tuple(found), facts


def _plain(name: str, layout: Layout, plate: Plate, seams: Floats) -> Iterator[Finding]:
    """Unit, cell, layers, and that there is nothing but polygons on the grid."""
    if layout.cells is not None:
        yield same("verify_cell", name, "the cell's name", " ".join(layout.cells), CELLS[plate])
    if layout.grid is not None:
        unit = f"{layout.grid[0] / GRID:.6g} nm"
        yield same("verify_grid", name, "the grid", unit, "1 nm")
        unit = f"{layout.grid[1] * 1e6:.6g} um"
        yield same("verify_grid", name, "the unit", unit, "0.001 um" if name.endswith(".cif") else "1 um")
    wanted = {*LAYERS.values()} - ({"SEAM"} if not len(seams) else set())
    yield same("verify_layers", name, "the list of layers", _listed({*layout.layers, "TEST"}), _listed(wanted))
    yield same("verify_records", name, "what is no polygon", ", ".join(layout.others) or "nothing", "nothing")
    off = max((float(np.abs(p - np.rint(p)).max(initial=0.0)) for p in layout.layers.values()), default=0.0)
    yield measured("verify_grid", name, "corners are off the grid by", off, 0.0, unit="nm")


def _listed(names: object) -> str:
    order = list(LAYERS.values())
    return ", ".join(sorted(names, key=lambda name: (order.index(name) if name in order else 99, name)))  # type: ignore[call-overload]


def _equal(name: str, layout: Layout, other: str, first: Layout) -> Iterator[Finding]:
    """Polygon by polygon, whatever their order."""
    for layer in dict.fromkeys([*first.layers, *layout.layers]):
        mine, wanted = layout.layers.get(layer), first.layers.get(layer)
        if mine is None or wanted is None:
            yield error("verify_formats", name, f"{layer} is in one of it and {other} only")
            continue
        odd = unlike(mine, wanted)
        if len(odd) or len(mine) != len(wanted):
            size = float(np.ptp(extent([mine])[[0, 2]]) / np.ptp(extent([wanted])[[0, 2]]))
            x, y = (odd[0] if len(odd) else wanted[0]).mean(axis=0) * 1e-6
            text = (
                f"{len(odd)} of {len(mine)} polygons are not in {other}, which has {len(wanted)}; the first at "
                f"({x:.3f}, {y:.3f}) mm, the layer's width is {size:.6f} of the other's"
            )
            difference = max(len(odd), abs(len(mine) - len(wanted)))
            where = f"{name}, {layer}"
            yield measured("verify_formats", where, f"{text}; polygons that differ:", difference, 0)
    yield measured(
        "verify_formats", name, f"polygons more or less than in {other}:", abs(layout.count - first.count), 0
    )


@dataclass(frozen=True, eq=False)
class Seen:
    """One mask file, its layers turned back as seen from above."""

    name: str
    layout: Layout
    plate: Plate
    reference: Reference

    def layer(self, name: str) -> Floats:
        """Polygons of a layer, seen from above [nm]."""
        polygons = self.layout.layers.get(name, np.empty((0, 4, 2)))
        return mirrored(polygons) if self.plate == "top" else polygons

    def against_design(self, counts: Floats | None) -> Iterator[Finding]:
        """Channels and domain borders."""
        written = self.layout.layers.get("CHANNELS", np.empty((0, 4, 2)))
        if written.shape[1] != 4 or not len(written):
            yield error("verify_channels", self.name, "the channels are missing or no quadrilaterals")
            return
        stranger = channels.identity(self.name, written, self.plate, self.reference)
        if stranger:
            yield stranger
            return
        yield from channels.check(self.name, self.layer("CHANNELS"), self.plate, self.reference, counts)
        yield self._borders()
        if len(self.reference.seams):
            yield self._seams()

    def _borders(self) -> Finding:
        """Every domain's outline has its corners at the design's."""
        drawn, corners = self.layer("DOMAINS"), self.reference.corners * 1e6
        if not len(drawn):
            return error("verify_outline", self.name, "the outlines of the domains are missing")
        near = cKDTree(centroids(drawn)).query(centroids(corners))[1]
        off = np.linalg.norm(corners[:, :, None] - drawn[near][:, None], axis=3).min(axis=2).max(axis=1)
        worst = int(np.argmax(off))
        where = f"{self.name}, {self.reference.place(worst)}"
        text = f"{len(drawn)} outlines for {len(corners)} domains; a corner differs by"
        value = float(off[worst]) if len(drawn) == len(corners) else np.inf
        return measured("verify_outline", where, text, value, 1.0, unit="nm", places=int(np.sum(off > 1)))

    def _seams(self) -> Finding:
        """A line lies on every edge of a cut."""
        lines, middles = self.layer("SEAM").mean(axis=1), self.reference.seams.mean(axis=1) * 1e6
        off = cKDTree(lines).query(middles)[0] if len(lines) == len(middles) else np.array([np.inf])
        text = f"{len(lines)} lines for {len(middles)} edges of cuts; one is away from its place by"
        return measured("verify_seams", self.name, text, float(off.max()), 1.0, unit="nm")

    def against_form(self, at: dict[str, Floats] | None) -> Iterator[Finding]:
        """Marks and labels."""
        if at is not None:
            marks, spec = self.layer("MARKS"), self.reference.job.channels
            pitch = (spec.width_um + spec.spacing_um) * 1e3
            yield from clusters.check(self.name, marks, self.layer("LABELS"), at, pitch)
            yield from clusters.placed(self.name, self._middles(at), at)

    def _middles(self, at: dict[str, Floats]) -> dict[str, Floats]:
        return clusters.centres(self.layer("MARKS"), at, self.reference.job.marks.tolerance_um * 1e3)

    def facts(self, at: dict[str, Floats] | None) -> Plates:
        """For the checks of both plates together."""
        quads = self.layer("CHANNELS")
        area = np.zeros(len(self.reference.theta))
        if quads.shape[1] == 4 and len(quads):
            area = channels.rows(quads, self.plate, self.reference).area
        totals = {name: (len(p), float(areas(p).sum()) * 1e-12) for name, p in self.layout.layers.items()}
        common = {name: self.layer(name) for name in COMMON}
        return Plates(self.name, area, totals, common, self._middles(at) if at is not None else {}, at or {})


def both(found: Mapping[str, Plates], form: Path) -> Iterator[Finding]:
    """The plates on each other: marks, test fields, glass, domains, spacer."""
    bottom, top = found["bottom"], found["top"]
    yield from clusters.closed({"bottom": dict(bottom.marks), "top": dict(top.marks)}, clusters.places(form))
    for layer in COMMON:
        odd = len(unlike(top.common[layer], bottom.common[layer])) + len(
            unlike(bottom.common[layer], top.common[layer])
        )
        where = f"{top.name} on {bottom.name}, {layer}"
        yield measured("verify_overlay", where, "polygons that do not lie on their counterpart:", odd, 0)


def job_sheet(path: Path, found: Mapping[str, Plates]) -> Iterator[Finding]:
    """Counts and areas that the operator compares with the converter's log."""
    name = "mask/job_sheet.txt"
    said = {}
    with reading():
        for words in map(str.split, path.read_text(encoding="utf-8").splitlines()):
            if len(words) == 6 and words[0] in LAYERS.values():
                said[words[0]] = [(int(words[2]), float(words[3])), (int(words[4]), float(words[5]))]
    wanted = {*LAYERS.values()} - {layer for layer in ("SEAM",) if layer not in found["bottom"].totals}
    yield same("verify_job_sheet", name, "the list of layers", _listed(said), _listed(wanted))
    for layer, pair in said.items():
        for plate, (count, area) in zip(("bottom", "top"), pair, strict=True):
            have = found[plate].totals.get(layer, (0, 0.0))
            where = f"{name}, {plate} {layer}"
            if have[0] != count or abs(have[1] - area) > 1e-6:
                text = (
                    f"says {count} polygons of {area:.6f} mm2, {found[plate].name} has {have[0]} of {have[1]:.6f} mm2"
                )
                yield error("verify_job_sheet", where, text)
