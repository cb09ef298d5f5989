"""Targets deeper than a hemisphere, or that hang over themselves; each a disk about 1 long."""

from __future__ import annotations

from functools import partial

import numpy as np

from lce_solver.mesher import mesh

CORNERS = (0.0, 0.25, 0.5, 0.75)


def _circle(t):
    return np.column_stack([np.cos(2 * np.pi * t), np.sin(2 * np.pi * t)])


def _square(t):
    x, y = (-1, 1, 1, -1, -1), (-1, -1, 1, 1, -1)
    return np.column_stack([np.interp(t % 1, (*CORNERS, 1), side) for side in (x, y)])


def _revolved(slant, edge):
    """The profile that leaves the pole level and descends at ``slant(s)`` [rad], s in [0, 1] its length to the rim."""
    s = np.linspace(0, 1, 2001)
    angle = slant((s[1:] + s[:-1]) / 2)
    radius, height = (np.append(0, np.cumsum(step)) / 2000 for step in (np.cos(angle), -np.sin(angle)))

    def embed(uv):
        length = np.linalg.norm(uv, axis=1)
        outwards = uv / np.maximum(length, 1e-12)[:, None]
        return np.column_stack([outwards * np.interp(length, s, radius)[:, None], np.interp(length, s, height)])

    return mesh(embed, _circle, edge)


def cap(edge, degrees):
    """A spherical cap of this half angle."""
    return _revolved(lambda s: np.radians(degrees) * s, edge)


def bell(edge):
    """Down at up to 80 degrees, and out again to a level rim; deeper than it is wide at half its depth."""
    return _revolved(lambda s: np.radians(80) * np.sin(np.pi * s), edge)


def mushroom(edge):
    """A cap whose rim curls under: 110 degrees from level."""
    return _revolved(lambda s: np.radians(110) * s**2, edge)


def vase(edge):
    """A bulb that narrows to a neck and stands on it."""

    def slant(s):
        return np.radians(90 + 30 * np.sin(np.pi * np.clip((s - 0.6) / 0.4, 0, 1))) * np.minimum(1, s / 0.6)

    return _revolved(slant, edge)


def finger(edge):
    """Half an ellipsoid of revolution, half again as deep as a hemisphere."""

    def embed(uv):
        s = np.linalg.norm(uv, axis=1)
        outwards = uv / np.maximum(s, 1e-12)[:, None]
        return np.column_stack([outwards * np.sin(np.pi / 2 * s)[:, None], 1.5 * np.cos(np.pi / 2 * s)]) / 2

    return mesh(embed, _circle, edge)


def hook(edge):
    """A gutter, 150 degrees of a tube, bent along 200 degrees of a ring."""

    def embed(uv):
        along, across = (uv * np.radians((200, 150)) / 2).T
        out = 1 + np.cos(across) / 2.2
        return np.column_stack([out * np.sin(along), np.sin(across) / 2.2, out * np.cos(along)]) / 2

    return mesh(embed, _square, edge, corners=CORNERS)


def stairs(edge):
    """A ribbon of a helicoid that passes over itself: 1.3 turns."""

    def embed(uv):
        turn, out = 1.3 * np.pi * uv[:, 0], 0.675 + 0.325 * uv[:, 1]
        return np.column_stack([out * np.cos(turn), out * np.sin(turn), 0.55 * turn]) / 2

    return mesh(embed, _square, edge, corners=CORNERS)


def scroll(edge):
    """A rectangle rolled up over 250 degrees: no curvature that a metric could bring about."""

    def embed(uv):
        turn, radius = uv[:, 0] * np.radians(125), 1 / np.radians(250)
        return np.column_stack([radius * np.sin(turn), 0.3 * uv[:, 1], radius * np.cos(turn)])

    return mesh(embed, _square, edge, corners=CORNERS)


DEEP = {
    "stairs": stairs,
    "mushroom": mushroom,
    "finger": finger,
    "bell": bell,
    "hook": hook,
    "scroll": scroll,
    "cap 120": partial(cap, degrees=120.0),
    "vase": vase,
}
