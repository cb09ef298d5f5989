"""What was designed: `design.npz` and `job.toml`, read as a stranger would, and the angles that follow from them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, Literal

import numpy as np

from lce_solver.types import Floats, Ints
from lce_workbench.core import jobfile
from lce_workbench.core.job import Job
from lce_workbench.verify.finding import Unreadable, reading
from lce_workbench.verify.shapes import areas, centroids

Plate = Literal["bottom", "top"]

PLATES: tuple[Plate, Plate] = ("bottom", "top")

SHAPES: dict[str, tuple[str | int, ...]] = {
    "vertices": ("points", 3),
    "faces": ("domains", 3),
    "uv": ("points", 2),
    "theta": ("domains",),
    "dtheta": ("domains",),
    "stretch": ("domains", 2),
    "lambda_": (),
    "nu": (),
    "thickness": (),
}
"""Array of `design.npz` -> its shape; the domains are its triangles."""

OWN: dict[str, tuple[str | int, ...]] = {
    "domain_vertices": ("corners", 2),
    "domain_polygons": ("domains", "sides"),
    "domain_theta": ("domains",),
    "domain_dtheta": ("domains",),
    "domain_stretch": ("domains", 2),
    "domain_phase": ("phases", 2),
}
"""The same of domains that are stored beside the design."""


@dataclass(frozen=True, eq=False)
class Reference:
    """The design that every file is held against. Lengths in mm, angles in radians."""

    job: Job
    target: Floats
    """(n_v, 3) target [mm]."""
    triangles: Ints
    """(n_t, 3) vertex indices."""
    flat: Floats
    """(n_v, 2) the sheet seen from above [mm]."""
    stretches: Floats
    """(n_t, 2) of every triangle along and across its director."""
    thickness: float
    """[mm]"""
    corners: Floats
    """(n_d, k, 2) of every domain, counter-clockwise; those with fewer than k repeat their last one [mm]."""
    theta: Floats
    """(n_d,) director at the mid-plane [rad]."""
    dtheta: Floats
    """(n_d,) twist [rad]."""
    stretch: Floats
    """(n_d, 2) along and across the director."""
    phase: Floats
    """(n_d, 2) how far left of the origin a channel's middle line runs on the bottom and on the top plate, modulo the
    pitch [mm]; (0, 2) where it is free."""

    @cached_property
    def centres(self) -> Floats:
        """(n_d, 2) centre of mass of every domain [mm]."""
        return centroids(self.corners)

    @cached_property
    def areas(self) -> Floats:
        """(n_d,) of every domain [mm2]."""
        return areas(self.corners)

    @cached_property
    def seams(self) -> Floats:
        """(m, 2, 2) edges of the flat sheet's rim that lie on another one in the target: sides of cuts [mm]."""
        sides = np.concatenate([self.triangles[:, pair] for pair in ([0, 1], [1, 2], [2, 0])])
        _, first, count = np.unique(np.sort(sides, axis=1), axis=0, return_index=True, return_counts=True)
        rim = sides[first[count == 1]]
        place = np.unique(self.target, axis=0, return_inverse=True)[1].ravel()
        _, group, count = np.unique(np.sort(place[rim], axis=1), axis=0, return_inverse=True, return_counts=True)
        return np.asarray(self.flat[rim[count[group.ravel()] == 2]])

    def angle(self, plate: Plate) -> Floats:
        """(n_d,) channel direction seen from above: the film's director turns by dtheta from bottom to top [rad]."""
        half = self.dtheta / 2
        return np.mod(self.theta + (half if plate == "top" else -half), np.pi)

    def place(self, domain: int) -> str:
        """A domain with its middle, as a person finds it."""
        x, y = self.centres[domain]
        return f"domain {domain} at ({x:.2f}, {y:.2f}) mm"


def read(folder: Path) -> Reference:
    """The design of an output folder.

    Raises
    ------
    InputError
        `job.toml` cannot be read.
    Unreadable
        `design.npz` cannot be read, or is no design.
    """
    job = jobfile.load(folder / "job.toml")
    path = folder / "design.npz"
    own = job.domains.kind != "triangles" or job.channels.align_phase
    data = arrays(path, (*SHAPES, *OWN) if own else tuple(SHAPES))
    _require(data, SHAPES, {"points": len(np.atleast_1d(data["uv"])), "domains": len(np.atleast_1d(data["theta"]))})
    faces = _indices(data["faces"], data["uv"], 0)
    given = {name: data[name].astype(np.float64) for name in SHAPES}
    domains = {name: given[name] for name in ("theta", "dtheta", "stretch")}
    domains |= {"corners": given["uv"][faces], "phase": np.empty((0, 2))}
    return Reference(
        job=job,
        target=given["vertices"],
        triangles=faces,
        flat=given["uv"],
        stretches=given["stretch"],
        thickness=float(given["thickness"]),
        **(_own(data, job.channels.align_phase) if own else domains),
    )


def _own(data: Mapping[str, Any], phased: bool) -> dict[str, Floats]:
    """Domains that are stored beside the design."""
    polygons = data["domain_polygons"]
    count = len(np.atleast_1d(data["domain_theta"]))
    sizes = {"corners": len(np.atleast_1d(data["domain_vertices"])), "domains": count}
    _require(data, OWN, sizes | {"sides": polygons.shape[-1] if polygons.ndim else 0, "phases": count * phased})
    rows = _indices(polygons, data["domain_vertices"], -1)
    sides = np.sum(rows >= 0, axis=1)
    if sides.min() < 3:
        msg = "a domain has fewer than three corners"
        raise Unreadable(msg)
    place = np.minimum(np.arange(rows.shape[1]), sides[:, None] - 1)
    found = {name: data[f"domain_{name}"].astype(np.float64) for name in ("theta", "dtheta", "stretch", "phase")}
    return {**found, "corners": data["domain_vertices"].astype(np.float64)[np.take_along_axis(rows, place, axis=1)]}


def _require(data: Mapping[str, Any], shapes: Mapping[str, tuple[str | int, ...]], sizes: Mapping[str, int]) -> None:
    """Refuse arrays of other shapes."""
    for name, shape in shapes.items():
        wanted = tuple(sizes[n] if isinstance(n, str) else n for n in shape)
        if data[name].shape != wanted:
            msg = f"{name} has the shape {data[name].shape} instead of {wanted}; write it again"
            raise Unreadable(msg)


def _indices(rows: Any, points: Floats, low: int) -> Ints:
    """Rows of indices of points."""
    found: Ints = rows.astype(np.int64)
    if not len(found) or found.min() < low or found.max() >= len(points):
        msg = "domains name points that do not exist"
        raise Unreadable(msg)
    return found


def arrays(path: Path, names: tuple[str, ...]) -> dict[str, Floats]:
    """Numeric arrays of an `npz` file.

    Raises
    ------
    Unreadable
        The file is missing, damaged, or lacks one of them.
    """
    if not path.is_file():
        msg = "is missing, or no file; write it again"
        raise Unreadable(msg)
    with reading(), np.load(path, allow_pickle=False) as data:
        found = {name: data[name] for name in names}
    for name, values in found.items():
        if not np.issubdtype(values.dtype, np.number) or not np.all(np.isfinite(values)) or np.iscomplexobj(values):
            msg = f"{name} holds what is no finite number; write it again"
            raise Unreadable(msg)
    return found
