"""Prisms as polyhedra: points and plane faces, which every kernel and every mesh can be made from without a boolean."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from lce_solver.types import Floats, Ints
from lce_workbench.core.prism import Prism


@dataclass(frozen=True, eq=False)
class Polyhedron:
    """A closed surface of plane faces."""

    points: Floats
    """(n, 3) [mm]."""
    faces: tuple[tuple[Ints, ...], ...]
    """Loops of point indices, the outer one first: counter-clockwise seen from outside, holes clockwise."""

    @property
    def normals(self) -> Floats:
        """(n_f, 3) outward unit normals."""
        found = self._vectors([face[0] for face in self.faces])
        return np.asarray(found / np.linalg.norm(found, axis=1)[:, None])

    @property
    def surface(self) -> float:
        """Area of all faces [mm2]."""
        vectors = self._vectors([loop for face in self.faces for loop in face])
        starts = np.cumsum([0, *(len(face) for face in self.faces)])[:-1]
        return float(np.linalg.norm(np.add.reduceat(vectors, starts), axis=1).sum())

    def _vectors(self, loops: Sequence[Ints]) -> Floats:
        """(n, 3) area times normal of each loop, by Newell's formula about its first point."""
        sizes = np.array([len(loop) for loop in loops])
        starts = np.cumsum(sizes) - sizes
        points = self.points[np.concatenate(loops)]
        points = points - np.repeat(points[starts], sizes, axis=0)
        return np.asarray(np.add.reduceat(np.cross(points, points[following(sizes)]), starts) / 2)


def following(sizes: Ints) -> Ints:
    """(n,) index of the corner after each corner of loops of these sizes, laid end to end."""
    ends = np.cumsum(sizes)
    found = np.arange(1, ends[-1] + 1)
    found[ends - 1] = ends - sizes
    return found


def polyhedron(stack: Sequence[Prism]) -> Polyhedron:
    """The outside of prisms that stand on each other, from below; a single one is its own outside.

    Where two of them meet, their outlines are equal, and a hole of one either goes on in the other or ends there.

    Raises
    ------
    ValueError
        The prisms do not stand on each other.
    """
    for below, above in pairwise(stack):
        if below.z1 != above.z0 or not np.array_equal(below.top, above.outline):
            msg = f"{above.name} does not stand on {below.name}"
            raise ValueError(msg)
    faces = [*_caps(stack[0], stack[-1])]
    for prism in stack:
        faces += _walls(prism)
    for below, above in pairwise(stack):
        faces += _ends(below, above)
    loops = [loop for face in faces for loop in face]
    points, index = np.unique(np.concatenate(loops), axis=0, return_inverse=True)
    numbered = iter(np.split(index.reshape(-1), np.cumsum([len(loop) for loop in loops])[:-1]))
    return Polyhedron(points, tuple(tuple(next(numbered) for _ in face) for face in faces))


Face = list[Floats]
"""Loops (k, 3) of a face."""


def _at(ring: Floats, z: float) -> Floats:
    return np.insert(ring, 2, z, axis=1)


def _caps(first: Prism, last: Prism) -> Iterator[Face]:
    """The lowest and the highest face."""
    yield [_at(ring, first.z0)[::-1] for ring in first.rings]
    yield [_at(ring, last.z1) for ring in (last.top, *last.holes)]


def _walls(prism: Prism) -> Iterator[Face]:
    """A wall over each edge of each ring."""
    for low, high in zip(prism.rings, (prism.top, *prism.holes), strict=True):
        a, b = _at(low, prism.z0), _at(high, prism.z1)
        for wall in np.stack([a, np.roll(a, -1, axis=0), np.roll(b, -1, axis=0), b], axis=1):
            yield [wall]


def _ends(below: Prism, above: Prism) -> Iterator[Face]:
    """Ceilings of the holes that end in ``above``, and floors of those that end in ``below``."""
    known = [{hole.tobytes() for hole in prism.holes} for prism in (below, above)]
    yield from ([_at(hole, below.z1)] for hole in below.holes if hole.tobytes() not in known[1])
    yield from ([_at(hole, below.z1)[::-1]] for hole in above.holes if hole.tobytes() not in known[0])
