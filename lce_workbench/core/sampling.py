"""Directors for domains that are not the design's triangles, and back: what the triangles get from the domains."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from lce_solver.directors import Lines, sampled, vertex_line_field
from lce_solver.types import Design, Floats, Ints, line_angle
from lce_workbench.core.borders import locate
from lce_workbench.core.domains import Domains, partition, signed_area

DIVISION = 3
"""Each triangle of the design is asked at the centres of this number squared of equal parts."""


def sample(design: Design, rings: Sequence[Floats]) -> Domains:
    """Domains with outlines (k, 2) and the means of the design's smooth fields over each.

    The director is interpolated between the vertices and averaged as a line, exp(2 i theta), over the area; the twist
    and the metric of the map likewise, from means about the vertices.
    """
    points, weight, owner = _quadrature(rings)
    fields: dict[str, Floats | Lines] = {"line": vertex_line_field(design), "twist": _about(design, design.dtheta)}
    metric = _metric(design)
    fields |= {name: _about(design, metric[:, i, j]) for name, i, j in (("xx", 0, 0), ("xy", 0, 1), ("yy", 1, 1))}
    mean = {
        name: _means(np.asarray(sampled(field, design.uv, design.surface.faces, points)), weight, owner, len(rings))
        for name, field in fields.items()
    }
    theta = line_angle(np.angle(mean["line"]) / 2)
    inside = np.array([[mean["xx"].real, mean["xy"].real], [mean["xy"].real, mean["yy"].real]]).transpose(2, 0, 1)
    width = max(map(len, rings))
    ends = np.cumsum([len(ring) for ring in rings])
    polygons = np.full((len(rings), width), -1)
    for row, end, ring in zip(polygons, ends.tolist(), rings, strict=True):
        row[: len(ring)] = np.arange(end - len(ring), end)
    sheet, stretch = partition(design), _stretches(inside, theta)
    return Domains(np.concatenate(rings), polygons, theta, mean["twist"].real, stretch, sheet.outline, sheet.holes)


def _quadrature(rings: Sequence[Floats]) -> tuple[Floats, Floats, Ints]:
    """Points (n, 2) in the rings with weights (n,), and which ring each is of: four parts of each triangle of a fan."""
    fans, owner = [], []
    for k, ring in enumerate(rings):
        middle = np.broadcast_to(ring.mean(axis=0), ring.shape)
        fans.append(np.stack([middle, ring, np.roll(ring, -1, axis=0)], axis=1))
        owner.append(np.full(len(ring), k))
    triangles, which = np.concatenate(fans), np.concatenate(owner)
    points = _parts(triangles, 2)
    weight = np.repeat(signed_area(triangles) / points.shape[1], points.shape[1])
    return points.reshape(-1, 2), weight, np.repeat(which, points.shape[1])


def _parts(triangles: Floats, division: int) -> Floats:
    """Centres (n, division**2, 2) of equal parts of triangles (n, 3, 2)."""
    n = division
    up = [(i + 1 / 3, j + 1 / 3) for i in range(n) for j in range(n - i)]
    down = [(i + 2 / 3, j + 2 / 3) for i in range(n - 1) for j in range(n - 1 - i)]
    share = np.array(up + down) / n
    weight = np.column_stack([1 - share.sum(axis=1), share])
    parts: Floats = np.einsum("pk,nkc->npc", weight, triangles)
    return parts


def _about(design: Design, values: Floats) -> Floats:
    """(n_v,) mean of ``values`` (n_f,) over the triangles about each vertex, by area."""
    faces, n = design.surface.faces.ravel(), len(design.uv)
    area = np.repeat(signed_area(design.uv[design.surface.faces]), 3)
    return np.asarray(np.bincount(faces, area * np.repeat(values, 3), n) / np.bincount(faces, area, n))


def _means(values: Floats, weight: Floats, owner: Ints, n: int) -> Floats:
    """Weighted means (n,) of real or complex values."""
    total = np.bincount(owner, weight * values.real, n) + 1j * np.bincount(owner, weight * values.imag, n)
    mean: Floats = total / np.bincount(owner, weight, n)
    return mean


def _metric(design: Design) -> Floats:
    """(n_f, 2, 2) metric of the map from the sheet to the target: the stretches are its principal ones."""
    n = np.stack([np.cos(design.theta), np.sin(design.theta)], axis=1)
    m = np.stack([-n[:, 1], n[:, 0]], axis=1)
    along, across = design.stretch.T[:, :, None, None] ** 2
    metric: Floats = along * n[:, :, None] * n[:, None] + across * m[:, :, None] * m[:, None]
    return metric


def _stretches(metric: Floats, theta: Floats) -> Floats:
    """(n, 2) stretches of metrics (n, 2, 2) along and across directions ``theta`` (n,)."""
    c, s = np.cos(theta), np.sin(theta)
    xx, xy, yy = metric[:, 0, 0], metric[:, 0, 1], metric[:, 1, 1]
    along = c * c * xx + 2 * c * s * xy + s * s * yy
    across = s * s * xx - 2 * c * s * xy + c * c * yy
    return np.sqrt(np.stack([along, across], axis=1))


def seen_by_triangles(design: Design, domains: Domains) -> Ints:
    """(n_f, p) domains at the centres of equal parts of each of the design's triangles."""
    points = _parts(design.uv[design.surface.faces], DIVISION)
    return locate(domains, points.reshape(-1, 2))[0].reshape(points.shape[:2])


def as_made(design: Design, domains: Domains) -> Design:
    """The design with the director and the twist that its triangles get from the domains: what the molds make."""
    if np.array_equal(domains.polygons, design.surface.faces):
        return replace(design, theta=domains.theta, dtheta=domains.dtheta)
    which = seen_by_triangles(design, domains)
    line = np.exp(2j * domains.theta)[which].mean(axis=1)
    return replace(design, theta=line_angle(np.angle(line) / 2), dtheta=domains.dtheta[which].mean(axis=1))


def mismatch(design: Design, domains: Domains) -> tuple[Floats, Floats, Floats]:
    """What the domains do to the metric, at equal parts (n,) of the design's triangles.

    Returns
    -------
    Angle (n,) from the triangle's director to the domain's, in [-pi/2, pi/2) [rad]; relative errors (n, 2) of the
    material's stretches against the map's along and across the domain's director; area (n,) of each part [mm2].
    """
    which = seen_by_triangles(design, domains)
    theta = domains.theta[which]
    angle = line_angle(theta - design.theta[:, None] + np.pi / 2) - np.pi / 2
    metric = np.repeat(_metric(design), which.shape[1], axis=0)
    wanted = np.array([design.material.along, design.material.across])
    area = np.repeat(signed_area(design.uv[design.surface.faces]) / which.shape[1], which.shape[1])
    return angle.ravel(), _stretches(metric, theta.ravel()) / wanted - 1, area
