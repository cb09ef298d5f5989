"""Channels of neighbouring domains that meet: one phase for each domain, chosen for all borders together.

Channels of two domains meet at a point x of their border when n_a . x - phase_a and n_b . x - phase_b are the same
modulo the pitch, n the normal of each domain's channels. With the phases as unit complex numbers z this is z_a = r z_b,
which cannot hold on every border of a ring of domains at once; the best z in the mean is found as for a synchronisation
problem (Singer, Appl. Comput. Harmon. Anal. 30, 20 (2011)): from a tree of the smallest steps, then by averaging.
Between directions that differ by d the offset grows by d times the distance from the middle of the border: channels of
1 um at 2 um pitch meet along a border of 350 um only while d is below a tenth of a degree.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array
from scipy.sparse.csgraph import breadth_first_order, minimum_spanning_tree

from lce_solver.types import Finding, Floats, Ints, Severity, line_angle
from lce_workbench.core.borders import Borders
from lce_workbench.core.domains import PLATES, Domains, Plate
from lce_workbench.core.job import ChannelSpec
from lce_workbench.core.units import UM

Complexes = NDArray[np.complex128]

LARGEST = np.radians(5.0)
"""Channels of neighbours meet if their directions differ by less [rad]."""

SWEEPS = 50
"""Rounds of averaging over the neighbours."""

PROBES = 33
"""Places along a border where the offset is measured."""


@dataclass(frozen=True, eq=False)
class Links:
    """Borders whose domains have nearly one direction on a plate."""

    a: Ints
    """(n,) one domain."""
    b: Ints
    """(n,) the other."""
    turned: NDArray[np.bool_]
    """(n,) whether their normals point to opposite sides, as those of 1 and 179 degrees do."""
    step: Floats
    """(n,) difference of the directions [rad]."""
    ratio: Complexes
    """(n,) z_a / z_b, or z_a z_b where they are turned, with which channels meet at the middle of the border."""
    length: Floats
    """(n,) length of the border [mm]."""


def links(domains: Domains, plate: Plate, found: Borders, pitch: float) -> Links:
    """The borders at which channels can meet, with the ratio of the phases that makes them."""
    angle = domains.angle(plate)
    a, b = found.pair.T
    step = np.abs(line_angle(angle[a] - angle[b] + np.pi / 2) - np.pi / 2)
    near = step < LARGEST
    a, b, middle = a[near], b[near], ((found.start + found.end) / 2)[near]
    turned = np.cos(angle[a] - angle[b]) < 0
    normal = np.stack([-np.sin(angle), np.cos(angle)], axis=1)
    reach = np.sum((normal[a] - np.where(turned, -1, 1)[:, None] * normal[b]) * middle, axis=1)
    return Links(a, b, turned, step[near], np.exp(2j * np.pi * reach / pitch), found.length[near])


def aligned(domains: Domains, found: Borders, spec: ChannelSpec) -> Floats:
    """(n_d, 2) phases of both plates with which channels of neighbours meet as well as they can [mm]."""
    phases = []
    for plate in PLATES:
        link = links(domains, plate, found, spec.pitch)
        z = _averaged(link, _spread(link, len(domains)))
        phases.append(np.angle(z) / (2 * np.pi) * spec.pitch)
    return np.stack(phases, axis=1)


def _spread(link: Links, n: int) -> Complexes:
    """Phases (n,) that meet on a tree of borders with the smallest steps, from one domain of each group."""
    graph = csr_array((link.step + 1e-9, (link.a, link.b)), shape=(n, n))
    tree = minimum_spanning_tree(graph)
    number = {pair: k for k, pair in enumerate(zip(link.a.tolist(), link.b.tolist(), strict=True))}
    z = np.ones(n, dtype=np.complex128)
    seen = np.zeros(n, dtype=bool)
    for root in range(n):
        if seen[root]:
            continue
        order, before = breadth_first_order(tree, root, directed=False)
        seen[order] = True
        for i in order[1:].tolist():
            j = int(before[i])
            k = number.get((i, j), number.get((j, i), -1))
            z[i] = link.ratio[k] * np.conj(z[j]) if link.turned[k] else _onward(link, k, i, z[j])
    return z


def _onward(link: Links, k: int, i: int, other: complex) -> complex:
    """Phase of domain ``i`` across border ``k``, whose normals agree."""
    ratio = complex(link.ratio[k])
    return (ratio if i == link.a[k] else ratio.conjugate()) * other


def _averaged(link: Links, z: Complexes) -> Complexes:
    """Phases after rounds in which each becomes the mean of what its neighbours ask for and itself."""
    ends = np.concatenate([link.a, link.b])
    own = np.bincount(ends, np.tile(link.length, 2), len(z))
    for _ in range(SWEEPS):
        for_a = np.where(link.turned, link.ratio * np.conj(z[link.b]), link.ratio * z[link.b])
        for_b = np.where(link.turned, link.ratio * np.conj(z[link.a]), np.conj(link.ratio) * z[link.a])
        asked = np.concatenate([for_a, for_b]) * np.tile(link.length, 2)
        total = own * z + np.bincount(ends, asked.real, len(z)) + 1j * np.bincount(ends, asked.imag, len(z))
        z = np.where(total == 0, z, total / np.where(total == 0, 1, np.abs(total)))
    return z


def offsets(domains: Domains, plate: Plate, found: Borders, spec: ChannelSpec) -> tuple[Floats, Floats]:
    """How far channels of neighbours miss each other, at `PROBES` places along each border where they can meet.

    Returns
    -------
    Offsets (n, `PROBES`) across the channels, at most half a pitch [mm]; length (n,) of each border [mm].
    """
    angle, phase = domains.angle(plate), domains.phase[:, PLATES.index(plate)]
    a, b = found.pair.T
    near = np.abs(line_angle(angle[a] - angle[b] + np.pi / 2) - np.pi / 2) < LARGEST
    a, b = a[near], b[near]
    at = np.linspace(found.start[near], found.end[near], PROBES, axis=1)
    sign = np.where(np.cos(angle[a] - angle[b]) < 0, -1, 1)[:, None]
    position = [
        at[..., 1] * np.cos(angle[d])[:, None] - at[..., 0] * np.sin(angle[d])[:, None] - phase[d][:, None]
        for d in (a, b)
    ]
    turns = (position[0] - sign * position[1]) / spec.pitch
    return np.abs(turns - np.rint(turns)) * spec.pitch, found.length[near]


def meeting(domains: Domains, found: Borders, spec: ChannelSpec) -> tuple[Finding, ...]:
    """How well channels meet on each plate: in the middle of the borders, and along them."""
    findings = []
    for plate in PLATES:
        off, length = offsets(domains, plate, found, spec)
        if not len(off):
            continue
        middle = float(np.sqrt(np.average(off[:, PROBES // 2] ** 2, weights=length))) / UM
        along = float(np.average(np.mean(off < spec.width / 2, axis=1), weights=length))
        text = (
            f"on the {plate} plate {len(off)} of {len(found.pair)} borders turn by less than 5 degrees; there channels "
            f"meet within {middle:.2f} um rms in the border's middle (by chance: {spec.pitch / UM / 12**0.5:.2f} um), "
            f"and within half their width along {along:.0%} of its length (by chance: {spec.width / spec.pitch:.0%})"
        )
        findings.append(Finding("channel_phase", Severity.INFO, text, middle, unit="um", where=f"{plate} plate"))
    return tuple(findings)
