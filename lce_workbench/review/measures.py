"""What the review computes itself: small closed forms of the design, each with its source."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from lce_solver.geometry import face_areas
from lce_solver.twist import in_director_frame, second_form, twisted_form
from lce_solver.types import Design, Floats, Ints, line_angle
from lce_workbench.core.align import CONFIDENCE, Readings, fit
from lce_workbench.core.borders import borders
from lce_workbench.core.domains import Domains
from lce_workbench.core.frame import Frame
from lce_workbench.core.job import ChannelSpec, Job
from lce_workbench.core.units import UM

POLARISERS = (0.0, 22.5, 45.0)
"""Angles of the first polariser that are drawn [deg]."""
VERNIER = 1.0 * UM
"""Step of the marks' verniers [mm]."""
PAPERS = {"the paper's channels": (0.6, 2.0), "its authors' former ones": (1.5, 4.0)}
"""The paper's two channel geometries: depth, pitch [um]."""


def transmission(domains: Domains, polariser: float) -> Floats:
    """(n_d,) share of white light that passes crossed polarisers, the first at ``polariser`` [rad].

    Mauguin's limit, where light follows the twist, averaged over the interference orders of white light:
    T = 1/2 [1 - cos 2(phi - theta_bottom) cos 2(phi - theta_top)].
    """
    bottom, top = (np.cos(2 * (polariser - domains.angle(plate))) for plate in ("bottom", "top"))
    passed: Floats = (1 - bottom * top) / 2
    return passed


def anchoring(spec: ChannelSpec) -> dict[str, float]:
    """Berreman's anchoring over that of the paper's geometries (S6): energy density ~ depth^2 / pitch^3."""

    def strength(depth: float, pitch: float) -> float:
        return depth**2 / pitch**3

    own = strength(spec.depth, spec.pitch)
    return {name: own / strength(depth * UM, pitch * UM) for name, (depth, pitch) in PAPERS.items()}


def sides(domains: Domains) -> tuple[Ints, Floats, Ints]:
    """All sides of all domains: corners (n, 2), the smaller number first, length (n,) [mm], and domain (n,)."""
    ends, owner = [], []
    for rows, _ in domains.rings():
        ring = domains.polygons[rows, : domains.sides[rows[0]]]
        ends.append(np.sort(np.stack([ring, np.roll(ring, -1, axis=1)], axis=2).reshape(-1, 2), axis=1))
        owner.append(np.repeat(rows, ring.shape[1]))
    corners = np.concatenate(ends)
    length = np.linalg.norm(np.diff(domains.vertices[corners], axis=1)[:, 0], axis=1)
    return corners, length, np.concatenate(owner)


def jumps(domains: Domains) -> Floats:
    """(n_i,) how far the director turns across each border between two domains [rad]; 0 where there is but one."""
    pairs = borders(domains).pair
    turn = line_angle(np.subtract(*domains.theta[pairs.T]))
    return np.minimum(turn, np.pi - turn) if len(pairs) else np.zeros(1)


@dataclass(frozen=True, eq=False)
class Bending:
    """The target's bending on the heated sheet in the director's frame, and what the twist prescribes [1 / mm]."""

    wanted: Floats
    """(n_f, 2, 2) second form of the target, each axis divided by its stretch."""
    prescribed: Floats
    """(n_f,) off-diagonal part that the twist prescribes."""
    area: Floats
    """(n_f,) of the target [mm2]."""

    def rms(self, part: Floats) -> float:
        """Root of the area mean square of ``part`` (n_f,)."""
        return float(np.sqrt(np.average(part**2, weights=self.area)))


def bending(design: Design) -> Bending:
    """Compare the target's curvature with what the twist can reach (the paper, S4)."""
    along = np.array([design.material.along, design.material.across])
    stretch = np.outer(along, along)
    form = second_form(design.surface, design.uv)
    wanted = in_director_frame(form, design.theta) / stretch
    made = twisted_form(design.dtheta, design.theta, design.material, design.thickness)
    prescribed = (in_director_frame(made, design.theta) / stretch)[:, 0, 1]
    return Bending(wanted, prescribed, face_areas(design.surface))


@dataclass(frozen=True)
class Budget:
    """What the alignment of the plates may cost; lengths in mm, half widths of 95 % intervals."""

    reading: float
    """Of one vernier."""
    shift: float
    """Of the plate, from all clusters."""
    rotation: float
    """[rad]"""
    lever: float
    """From the middle of the sheet to its farthest corner."""
    scale: float
    """Of top over bottom."""
    tolerance: float
    borders: float
    """Length of the borders between domains, per area of the sheet [1 / mm]."""

    @property
    def turned(self) -> float:
        """What the rotation does at the farthest corner."""
        return self.rotation * self.lever

    @property
    def grown(self) -> float:
        """What the scale does there."""
        return self.scale * self.lever

    @property
    def known(self) -> float:
        """Read-out of the mismatch at that corner; as the marks lie symmetrically, the parts are independent."""
        return float(np.linalg.norm([self.shift, self.turned, self.grown]))

    @property
    def left(self) -> float:
        """What remains for the hand."""
        return self.tolerance - self.known

    @property
    def crossed(self) -> float:
        """Share of the sheet where two neighbouring domains face each other when all the tolerance is used up."""
        return 2 / np.pi * self.tolerance * self.borders

    @property
    def twist(self) -> float:
        """Error of the twist if the whole tolerance were a rotation [rad]."""
        return self.tolerance / self.lever


def budget(frame: Frame, domains: Domains, job: Job) -> Budget:
    """The error budget of the alignment, before anything is read: every cluster is read to one step of its vernier."""
    n = len(frame.marks)
    tolerance = job.marks.tolerance_um * UM
    read = Readings(frame.marks, np.zeros((n, 2)), np.full(n, VERNIER), frame.sheet, tolerance)
    halves = fit(read).halves
    return Budget(
        reading=CONFIDENCE * VERNIER / np.sqrt(12),
        shift=float(max(halves[:2])),
        rotation=float(halves[2]),
        lever=float(np.linalg.norm(frame.sheet.ring, axis=1).max()),
        scale=float(halves[3]),
        tolerance=tolerance,
        borders=float(borders(domains).length.sum() / np.abs(domains.area).sum()),
    )
