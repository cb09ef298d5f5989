"""What was designed: `design.npz` and `job.toml`, read as a stranger would, and the angles that follow from them."""

from __future__ import annotations

import zipfile
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import numpy as np

from lce_solver.types import Floats, Ints
from lce_workbench.core import jobfile
from lce_workbench.core.job import Job
from lce_workbench.verify.finding import Unreadable

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
"""Array of `design.npz` -> its shape."""


@dataclass(frozen=True, eq=False)
class Reference:
    """The design that every file is held against. Lengths in mm, angles in radians."""

    job: Job
    target: Floats
    """(n_v, 3) target [mm]."""
    triangles: Ints
    """(n_d, 3) vertex indices."""
    flat: Floats
    """(n_v, 2) the sheet seen from above [mm]."""
    theta: Floats
    """(n_d,) director at the mid-plane [rad]."""
    dtheta: Floats
    """(n_d,) twist [rad]."""
    stretch: Floats
    """(n_d, 2) along and across the director."""
    thickness: float
    """[mm]"""

    @property
    def corners(self) -> Floats:
        """(n_d, 3, 2) of every domain [mm]."""
        return self.flat[self.triangles]

    @property
    def centres(self) -> Floats:
        """(n_d, 2) of every domain [mm]."""
        return np.asarray(self.corners.mean(axis=1))

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
    data = arrays(folder / "design.npz", tuple(SHAPES))
    sizes = {"points": len(np.atleast_1d(data["uv"])), "domains": len(np.atleast_1d(data["theta"]))}
    for name, shape in SHAPES.items():
        wanted = tuple(sizes.get(n, n) if isinstance(n, str) else n for n in shape)
        if data[name].shape != wanted or not np.all(np.isfinite(data[name].astype(np.float64))):
            msg = f"design.npz: {name} has the shape {data[name].shape} instead of {wanted}, or holds no finite numbers"
            raise Unreadable(msg)
    faces = data["faces"].astype(np.int64)
    if not len(faces) or faces.min() < 0 or faces.max() >= sizes["points"]:
        msg = "design.npz: faces name points that do not exist"
        raise Unreadable(msg)
    given = {name: data[name].astype(np.float64) for name in SHAPES}
    return Reference(
        job=job,
        target=given["vertices"],
        triangles=faces,
        flat=given["uv"],
        theta=given["theta"],
        dtheta=given["dtheta"],
        stretch=given["stretch"],
        thickness=float(given["thickness"]),
    )


def arrays(path: Path, names: tuple[str, ...]) -> dict[str, Floats]:
    """Numeric arrays of an `npz` file.

    Raises
    ------
    Unreadable
        The file is missing, damaged, or lacks one of them.
    """
    if not path.is_file():
        msg = f"{path.name} is missing, or no file; run `./lce design` again"
        raise Unreadable(msg)
    try:
        with np.load(path, allow_pickle=False) as data:
            return {name: data[name] for name in names}
    except (OSError, ValueError, KeyError, EOFError, zipfile.BadZipFile, AttributeError) as fault:
        msg = f"{path.name} cannot be read ({fault}); run `./lce design` again"
        raise Unreadable(msg) from None
