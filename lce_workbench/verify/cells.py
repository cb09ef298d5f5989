"""The CAD files of the closed cell against job, design and masks."""

from __future__ import annotations

import gzip
from collections.abc import Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from lce_solver.types import Finding, Floats
from lce_workbench.verify.finding import Findings, Unreadable, error, guarded, measured, reading, same
from lce_workbench.verify.goals import STACK, Wanted, wanted
from lce_workbench.verify.masks import Plates
from lce_workbench.verify.reference import PLATES, Plate, Reference
from lce_workbench.verify.solids import READABLE, Part, counted, parts
from lce_workbench.verify.workers import value

PARTS = {f"{plate}_plate.step": tuple(f"{plate}_{layer}" for layer in STACK) for plate in PLATES}
"""File -> the parts it has to hold."""

NM = 1e-6
"""[mm]"""

SAME = 1e-6
"""Relative difference of volumes."""

WIDTH = 2.0
"""What rounding to 1 nm changes in a channel's width on the mask [nm]."""


def files(reference: Reference) -> dict[str, tuple[str, ...]]:
    """File -> the parts it has to hold; the cell comes last, for what the others hold is not measured twice."""
    job = reference.job
    spacer, glue = (tuple(f"{kind}_{side}" for side in ("left", "right")) for kind in ("spacer", "glue"))
    jig = ("alignment_frame",) if job.plates.frame_mm else ()
    beads = glue if min(job.spacer.bead_mm, job.spacer.glue_mm) else ()
    plates = tuple(part for parts in PARTS.values() for part in parts)
    alone = {"sheet.step": ("sheet",)} if "sheet" in job.output.cad else {}
    return {**PARTS, "spacer.step": spacer, **alone, "cell.step": (*plates, *spacer, *beads, "sheet", *jig)}


def readable(folder: Path, reference: Reference) -> list[str]:
    """The STEP files that the kernel can read in some seconds."""
    names = [f"cad/{file}" for file in files(reference)] + [f"cad/combs_{plate}.step" for plate in PLATES]
    for plate in PLATES:
        name = channel_file(plate, reference)
        with suppress(Unreadable):
            if counted(folder / name)[0] <= READABLE:
                names.append(name)
    return names


def channel_file(plate: Plate, reference: Reference) -> str:
    """The file of a plate's channel solids."""
    return f"cad/channels_{plate}.step" + (".gz" if reference.job.output.step_gzip else "")


def read(folder: Path, name: str) -> list[Part]:
    """The parts of a file; the cell's are equal to those of other files, which are validated there."""
    return parts(folder / name, validate=name != "cad/cell.step")


def check(
    folder: Path,
    got: Mapping[str, Any],
    reference: Reference,
    masks: Mapping[Plate, Plates],
    counts: Mapping[Plate, Floats],
) -> tuple[Findings, dict[str, Part]]:
    """Measure every STEP file; also the parts of the cell by name.

    Parameters
    ----------
    got : name -> what `read` returned or raised, of the files of `readable`.
    masks : what was read from both plates' masks.
    counts : (n_d,) channels of each domain by `domains.csv`.
    """
    found: Findings = ()
    goals, known = wanted(reference, masks), {}
    for file, names in files(reference).items():
        name = f"cad/{file}"
        found += guarded("verify_step", name, _parts_of, got[name], name, names, goals, known)
    if "domains" in reference.job.output.cad:
        found += guarded("verify_step", OUTLINES, outlines, folder / OUTLINES, reference)
    for plate in PLATES:
        context = Context(plate, reference, masks.get(plate), counts.get(plate))
        name = channel_file(plate, reference)
        if reference.job.output.step == "exact":
            found += guarded("verify_step", f"cad/channels_{plate}_*.step", exact_solids, folder, context)
        else:
            found += guarded("verify_step", name, channel_solids, folder, name, got.get(name), context)
        name = f"cad/combs_{plate}.step"
        found += guarded("verify_step", name, combs, name, got[name], context)
    return found, known


OUTLINES = "cad/domains.step"


def outlines(path: Path, reference: Reference) -> Iterator[Finding]:
    """The names of all outlines: number, director, both plates' directions seen from above in degrees."""
    lines = [np.degrees(a).round(2) % 180 for a in (reference.theta, reference.angle("bottom"), reference.angle("top"))]
    goal = {
        f"domain_{k:04d}_theta_{theta:06.2f}_bottom_{bottom:06.2f}_top_{top:06.2f}"
        for k, (theta, bottom, top) in enumerate(zip(*lines, strict=True))
    }
    wrong = len(goal ^ set(counted(path)[1]))
    yield measured("verify_outlines", OUTLINES, "names of outlines that are missing, or no domain's:", wrong, 0)


@dataclass(frozen=True, eq=False)
class Context:
    """What the channels of one plate are held against."""

    plate: Plate
    reference: Reference
    mask: Plates | None
    counts: Floats | None
    """(n_d,) channels of each domain by `domains.csv`."""

    @property
    def z(self) -> tuple[float, float]:
        """Lower and upper face of the channels [mm]."""
        half = self.reference.job.sheet.gap_um / 2e3
        return (half, half + self.depth) if self.plate == "top" else (-half - self.depth, -half)

    @property
    def depth(self) -> float:
        """[mm]"""
        return self.reference.job.channels.depth_um / 1e3


def exact_solids(folder: Path, context: Context) -> Iterator[Finding]:
    """Names and number of the channel solids with exact ends, of many files; their shapes are not measured."""
    name = f"cad/channels_{context.plate}_*.step"
    solids, domains = 0, set[str]()
    for path in sorted((folder / "cad").glob(f"channels_{context.plate}_*.step*")):
        with reading():
            text = gzip.decompress(path.read_bytes()) if path.suffix == ".gz" else path.read_bytes()
        solids += text.count(b"MANIFOLD_SOLID_BREP(")
        domains |= set(counted(path)[1])
    if context.counts is not None:
        yield same("verify_channels", name, "the number of domains", len(domains), int((context.counts > 0).sum()))
        yield same("verify_channels", name, "the number of solids", solids, int(context.counts.sum()))


def _parts_of(
    result: Any, name: str, names: tuple[str, ...], goals: Mapping[str, Wanted], known: dict[str, Part]
) -> Iterator[Finding]:
    """The parts of one file."""
    held = {part.name: part for part in value(result)}
    yield same("verify_parts", name, "the list of parts", _listed(held), _listed(names))
    for part in held.values():
        where = f"{name}, {part.name}"
        if part.name in known:
            alike = part.like(known[part.name])
            yield same("verify_parts", where, "equal to the same part in its own file", alike, True)
        known.setdefault(part.name, part)
        if not part.valid or part.count != 1:
            yield error("verify_solid", where, f"is no valid solid: {part.count} solids, valid: {part.valid}")
        if part.name in goals:
            yield from _measure(where, part, goals[part.name])
    yield from _distances(name, held, goals)


def _distances(name: str, held: Mapping[str, Part], goals: Mapping[str, Wanted]) -> Iterator[Finding]:
    """The gap between the epoxy faces and the thickness of the spacer."""
    if {"top_land", "bottom_land"} <= held.keys():
        gap = float(held["top_land"].low[2] - held["bottom_land"].high[2])
        off = abs(gap - goals["top_land"].z[0] + goals["bottom_land"].z[1]) * 1e6
        text = f"the gap between the epoxy faces is {gap * 1e3:.6f} um; from the job's it differs by"
        yield measured("verify_gap", name, text, off, 1.0, unit="nm")
    for side in sorted({"spacer_left", "spacer_right"} & held.keys()):
        thick = float(held[side].high[2] - held[side].low[2])
        off = abs(thick - goals[side].z[1] + goals[side].z[0]) * 1e6
        text = f"the spacer is {thick * 1e3:.6f} um thick; from the job's gap it differs by"
        yield measured("verify_spacer", f"{name}, {side}", text, off, 1.0, unit="nm")


def _listed(names: object) -> str:
    return ", ".join(sorted(names))  # type: ignore[call-overload]


def _measure(where: str, part: Part, goal: Wanted) -> Iterator[Finding]:
    """Heights, outline and volume of a part."""
    z = np.array([part.low[2], part.high[2]])
    text = f"lies between z = {z[0]:.6f} and {z[1]:.6f} mm; from its place it differs by"
    yield measured("verify_height", where, text, float(np.abs(z - goal.z).max()) * 1e6, 1.0, unit="nm")
    inner = part.levels[(part.levels > z[0] + NM) & (part.levels < z[1] - NM)]
    shown = ", ".join(f"{level:.6f}" for level in inner) or "none"
    agree = len(inner) == len(goal.within) and np.allclose(inner, np.sort(goal.within), rtol=0, atol=NM)
    text = f"corners between its faces, at z = {shown} mm, where the job wants them"
    yield same("verify_levels", where, text, bool(agree), True)
    if goal.box is not None:
        box = np.concatenate([part.low[:2], part.high[:2]])
        text = "its outline differs from the mask's or the design's by"
        yield measured("verify_extent", where, text, float(np.abs(box - goal.box).max()) * 1e6, 2.0, unit="nm")
    if goal.volume is not None and goal.engraving:
        less = goal.volume - part.volume
        text = f"letters take {less:.6g} mm3 of it; that is nothing, or more than their room, by"
        off = 0.0 if 0 < less <= goal.engraving else max(abs(less), SAME)
        yield measured("verify_engraving", where, text, off, 0.0, unit="mm3")
    elif goal.volume is not None:
        off = abs(part.volume / goal.volume - 1)
        yield measured("verify_volume", where, "its volume differs by the fraction", off, SAME)


def title(domain: int, plate: Plate, reference: Reference) -> str:
    """Name of a domain's channels: number, plate, direction seen from above in degrees with two decimals."""
    degrees = round(float(np.degrees(reference.angle(plate)[domain])), 2) % 180
    return f"domain_{domain:04d}_theta_{plate}_{degrees:06.2f}"


def channel_solids(folder: Path, name: str, result: Any, held: Context) -> Iterator[Finding]:
    """The channels of the chosen domains, or of all: names, numbers, depth, and area x depth against the mask."""
    number, names = counted(folder / name)
    titles = {title(k, held.plate, held.reference): k for k in range(len(held.reference.theta))}
    strangers = [each for each in names if each not in titles]
    yield same("verify_parts", name, "names that are no domain's", ", ".join(strangers[:5]) or "none", "none")
    chosen = {titles[each] for each in names if each in titles}
    goal = _chosen(held.reference, held.counts) or (chosen if len(chosen) == 1 else {-1})
    missing = sorted(goal ^ chosen)
    text = f"domains that are missing or too many (first: {missing[0]}):" if missing else "domains missing or too many:"
    yield measured("verify_parts", name, text, len(missing), 0)
    if held.counts is not None and not missing:
        total = int(sum(held.counts[k] for k in goal))
        text = f"{number} channels by its text, {total} by domains.csv; they differ by"
        yield measured("verify_channel_solids", name, text, abs(number - total), 0)
    if result is not None:
        for part in value(result):
            if part.name in titles:
                yield from _domain(name, part, titles[part.name], held)


def _chosen(reference: Reference, counts: Floats | None) -> set[int]:
    """Domains whose channels must be solids; none if the job leaves the choice."""
    output = reference.job.output
    if output.step != "chosen":
        return set(np.flatnonzero(counts).tolist()) if counts is not None else set()
    touched = np.flatnonzero(_touched(reference)).tolist() if len(output.step_window_um) == 4 else []
    return {*output.step_domains, *touched}


def _touched(reference: Reference) -> Floats:
    """(n_d,) whether a domain shares a point with the job's window: no edge of either separates them."""
    x0, x1, y0, y1 = (
        np.sort(np.array(reference.job.output.step_window_um[k::2]) / 1e3)[i] for k in (0, 1) for i in (0, 1)
    )
    window, corners = np.array([(x0, y0), (x1, y0), (x1, y1), (x0, y1)]), reference.corners
    near = np.all((corners.max(axis=1) >= window[0]) & (corners.min(axis=1) <= window[2]), axis=1)
    edge = np.roll(corners, -1, axis=1) - corners
    inward = np.stack([-edge[..., 1], edge[..., 0]], axis=2)
    reach = (inward @ window.T).max(axis=2) - np.sum(inward * corners, axis=2)  # of the window, into the domain
    return np.asarray(near & np.all(reach >= 0, axis=1))


def _domain(name: str, part: Part, domain: int, held: Context) -> Iterator[Finding]:
    """Channels of one domain."""
    where = f"{name}, {held.reference.place(domain)}"
    corners = held.reference.corners[domain]
    out = max(float((corners.min(axis=0) - part.low[:2]).max()), float((part.high[:2] - corners.max(axis=0)).max()))
    yield measured("verify_extent", where, "the channels reach out of their domain by", max(out, 0.0) * 1e6, 1.0)
    text = f"the channels are {(part.high[2] - part.low[2]) * 1e3:.6f} um deep; a face is off its height by"
    off = float(np.abs(np.array([part.low[2], part.high[2]]) - held.z).max()) * 1e6
    yield measured("verify_depth", where, text, off, 1.0, unit="nm")
    if held.counts is not None:
        off = abs(part.count - float(held.counts[domain]))
        yield measured("verify_channel_solids", where, "solids more or less than in domains.csv:", off, 0)
    if held.mask is not None and held.mask.name:
        area = float(held.mask.areas[domain])
        off = abs(part.volume / (area * held.depth) - 1) if area > 0 else np.inf
        limit = 2 * WIDTH / (held.reference.job.channels.width_um * 1e3)
        text = "the channels' volume differs from the mask's area x depth by the fraction"
        yield measured("verify_volume", where, text, off, limit)
    if not part.valid:
        yield error("verify_solid", where, "its solids are not valid")


def combs(name: str, result: Any, held: Context) -> Iterator[Finding]:
    """The mold surface of the chosen domains: domain less channels, as deep as they."""
    area = held.reference.areas
    for part in value(result):
        where = f"{name}, {part.name}"
        digits = part.name.split("_")[1] if part.name.count("_") == 2 else ""
        domain = int(digits) if digits.isdecimal() else -1
        if part.name != f"comb_{domain:04d}_{held.plate}" or not 0 <= domain < len(area):
            yield error("verify_parts", where, "is no comb of a domain of this plate")
            continue
        corners = held.reference.corners[domain]
        box = np.concatenate([corners.min(axis=0), corners.max(axis=0)])
        yield from _measure(where, part, Wanted(held.z, box))
        if held.mask is not None and held.mask.name:
            off = abs(part.volume / ((area[domain] - held.mask.areas[domain]) * held.depth) - 1)
            limit = 2 * WIDTH / (held.reference.job.channels.spacing_um * 1e3)
            text = "its volume differs from (domain - channels) x depth by the fraction"
            yield measured("verify_volume", where, text, off, limit)
        if not part.valid:
            yield error("verify_solid", where, "is no valid solid")
