"""The target of the job at the resolution of the domains: a mesh file or a shipped surface."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np

from lce_solver.cut import opened, proposed, seams
from lce_solver.errors import InputError
from lce_solver.facets import rounded
from lce_solver.metric import Stop, flatten, lay_flat
from lce_solver.mirror import even_mesh, mirror_plane, mismatch, twins
from lce_solver.surface import face_areas, load, mean_edge, subdivide
from lce_solver.surfaces import SURFACES
from lce_solver.types import Design, Finding, Floats, Ints, Material, Severity, Surface
from lce_workbench.core.job import Job

TRIAL = 1000
"""Triangles of the trial mesh of a mesh file."""
MAX_DOMAINS = 200_000
"""Domains of a sheet of 120 mm at 350 um; it takes minutes and some gigabytes."""
COARSE = 0.08
"""Edge of the trial mesh of a shipped surface, as a fraction of its size; enough to know the sheet's scale."""


def resolve(job: Job, material: Material, base: Path, times: float = 1.0) -> tuple[Surface, tuple[Finding, ...]]:
    """The target, its triangles about the size of the domains on the flat sheet (in the target's own unit).

    Parameters
    ----------
    times : makes the edges so many times longer, where a design showed that the trial told the sheet's scale wrong.

    Raises
    ------
    InputError
        The mesh is not usable, or the surface's name is unknown.
    """
    surface, found = _shipped(job, material, times) if job.target.surface else _meshed(job, material, base, times)
    return (turned(surface) if job.target.flip else surface), found


def trial(job: Job, base: Path) -> Surface:
    """The target, uncut, with few triangles: enough to know the sheet's scale, and whether it can be reached at all.

    Raises
    ------
    InputError
        As `resolve`.
    """
    if job.target.surface:
        return _surface(job.target.surface)(COARSE)
    return _coarse(load(base / job.target.mesh, cuts=job.target.cuts)[0], job)


def _coarse(surface: Surface, job: Job) -> Surface:
    """About `TRIAL` even triangles."""
    edge = float(np.sqrt(4 / np.sqrt(3) * face_areas(surface).sum() / TRIAL))
    smooth, known = _smooth(surface, edge, job)
    return even_mesh(smooth, edge, known)


def _smooth(surface: Surface, edge: float, job: Job) -> tuple[Surface, float]:
    """A surface without facets longer than ``edge``, and how well it is known: 0 if it has none, or they are meant."""
    return rounded(surface, edge) if job.target.subdivision == "loop" else (surface, 0.0)


def _surface(name: str) -> Callable[[float], Surface]:
    if name not in SURFACES:
        msg = f"target.surface {name!r} is unknown; shipped are {', '.join(SURFACES)}"
        raise InputError(msg)
    return SURFACES[name]


def _shipped(job: Job, material: Material, times: float) -> tuple[Surface, tuple[Finding, ...]]:
    shape = _surface(job.target.surface)
    coarse = shape(COARSE)
    cuts = _cuts(coarse, job, material)
    coarse = opened(coarse, cuts)
    edge = times * job.domains.size / (flat_edge(coarse, job, material) / mean_edge(coarse))
    _require_budget(coarse, edge)
    fine = even_mesh(shape(edge), edge) if job.target.remesh else shape(edge)
    return opened(fine, cuts, straight=job.target.remesh), ()


def _cuts(trial: Surface, job: Job, material: Material) -> tuple[Floats, ...]:
    return proposed(trial, material) if job.target.cuts else ()


def _meshed(job: Job, material: Material, base: Path, times: float) -> tuple[Surface, tuple[Finding, ...]]:
    surface, found = load(base / job.target.mesh, cuts=job.target.cuts)
    if job.target.remesh:
        fine, told = _resampled(surface, job, material, times)
        return fine, (*found, *told)
    surface = opened(surface, _cuts(surface, job, material))
    size, flat = job.domains.size, flat_edge(surface, job, material)
    if flat <= size:
        return surface, found
    _require_budget(surface, mean_edge(surface) * size / flat)
    fine = subdivide(surface, mean_edge(surface) * size / flat, job.target.subdivision)
    text = (
        f"the mesh is coarser than the domains (mean edge {flat * 1e3:.0f} um on the sheet), so it was refined from "
        f"{len(surface.faces)} to {len(fine.faces)} triangles ({job.target.subdivision} subdivision)"
    )
    return fine, (*found, Finding("subdivided", Severity.INFO, text, flat * 1e3, job.domains.size_um, "um"))


def _resampled(surface: Surface, job: Job, material: Material, times: float) -> tuple[Surface, tuple[Finding, ...]]:
    """Even triangles of the domains' size, whatever the input's: a trial with about `TRIAL` of them gives the scale."""
    coarse = _coarse(surface, job)
    cuts = _cuts(coarse, job, material)
    edge = times * job.domains.size * mean_edge(coarse) / flat_edge(opened(coarse, cuts), job, material)
    _require_budget(surface, edge)
    smooth, known = _smooth(surface, edge, job)
    even, scale = even_mesh(smooth, edge, known), job.domains.size_um / edge
    found = (*_smoothed(surface, known, scale, job), *_mirrored(smooth, even, known, scale))
    return opened(even, cuts, straight=True), found


def _smoothed(surface: Surface, known: float, scale: float, job: Job) -> tuple[Finding, ...]:
    """That a scan was coarser than the domains; ``scale`` makes its lengths um on the sheet."""
    if not known:
        return ()
    size = mean_edge(surface) * scale
    text = (
        f"the mesh is coarser than the domains (mean edge {size:.0f} um on the sheet), so a smooth surface was laid "
        f"near its vertices; between them it is known to about {known * scale:.0f} um (rms); give a finer mesh, or "
        'target.subdivision = "midpoint" if its facets are meant'
    )
    return (Finding("smoothed", Severity.INFO, text, size, job.domains.size_um, "um"),)


def _mirrored(surface: Surface, even: Surface, known: float, scale: float) -> tuple[Finding, ...]:
    """That half of a target stands for the whole; ``scale`` makes its lengths um on the sheet."""
    plane = mirror_plane(surface, known) if twins(even) is not None else None
    if plane is None:
        return ()
    off = mismatch(surface, plane) * scale
    rms, (x, y, z) = np.sqrt(np.mean(off**2)), surface.vertices[np.argmax(off)]
    text = (
        f"the target is its own mirror image within {rms:.2g} um rms on the sheet, so one half of it was meshed and "
        f"mirrored; the halves differ most, by {off.max():.2g} um, at ({x:.4g}, {y:.4g}, {z:.4g}) of the mesh"
    )
    return (Finding("symmetric", Severity.INFO, text, float(off.max()), unit="um"),)


def _require_budget(surface: Surface, edge: float) -> None:
    """Refuse a number of domains that would take hours, before anything starts."""
    domains = float(face_areas(surface).sum()) * 4 / (np.sqrt(3) * edge**2)
    if domains > MAX_DOMAINS:
        msg = (
            f"the sheet would have about {domains:.2g} domains, more than the {MAX_DOMAINS:.0g} that can be solved in "
            "reasonable time; make domains.size_um larger or sheet.width_mm smaller"
        )
        raise InputError(msg)


def flat_edge(surface: Surface, job: Job, material: Material) -> float:
    """Mean edge on the flat sheet [mm] that these triangles would have, from one quick flattening."""
    uv = flatten(lay_flat(surface), (material.along, material.across), 0.0, Stop(1e-3)).uv
    return job.sheet.width_mm * _mean_length(uv, surface.faces) / float(np.ptp(uv, axis=0).max())


def _mean_length(uv: Floats, faces: Ints) -> float:
    return float(np.linalg.norm(uv[faces] - uv[np.roll(faces, 1, axis=1)], axis=2).mean())


def turned(surface: Surface) -> Surface:
    """The same surface seen from its other side."""
    return replace(surface, faces=surface.faces[:, ::-1])


def off_size(design: Design, job: Job) -> float:
    """Mean edge of the triangles on the sheet over the size that was asked for."""
    return _mean_length(design.uv, design.surface.faces) / job.domains.size


def sized(design: Design, job: Job) -> tuple[Finding, ...]:
    """Whether the domains have the size that was asked for."""
    asked = job.domains.size_um
    edge_um = off_size(design, job) * asked
    text = f"{len(design.theta)} domains have a mean edge of {edge_um:.0f} um, asked were {asked:g} um"
    fine = edge_um < 0.5 * asked
    if fine:
        way = "ask for larger ones" if job.target.remesh else "let target.remesh be true or ask for smaller ones"
        text += f"; {way}"
    return (
        Finding("domain_edge", Severity.WARNING if fine else Severity.INFO, text, edge_um, asked, "um"),
        *cut(design),
    )


def cut(design: Design) -> tuple[Finding, ...]:
    """Where the sheet has seams: edges that meet again when it is heated."""
    pairs = seams(design.surface)
    if len(pairs) == 0:
        return ()
    ends = design.uv[pairs[:, 0]]
    length = float(np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1).sum())
    x, y = ends[0, 0]
    text = (
        f"the target is cut open along {length:.1f} mm of the sheet's outline, to which as much of it must be joined "
        "when it is heated; the masks show the seam on layer SEAM"
    )
    return (Finding("seam", Severity.INFO, text, length, unit="mm", where=f"outline at ({x:.2f}, {y:.2f}) mm"),)
