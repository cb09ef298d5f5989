"""A film as the solid that it is: 27-node bricks of St Venant-Kirchhoff material which grows without stress by Fg.

Large displacements, and nothing of plates or shells: no thickness average, no normal, no second form. It judges the
shell model and the sign of the twist. Energies are per Young's modulus.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product

import numpy as np
from scipy import sparse
from scipy.sparse.linalg import splu

POISSON = 0.3
LAME, SHEAR = POISSON / ((1 + POISSON) * (1 - 2 * POISSON)), 1 / (2 * (1 + POISSON))


def lagrange(t):
    """Values and slopes of the three quadratic shape functions on [-1, 1]."""
    return np.array([t * (t - 1) / 2, 1 - t * t, t * (t + 1) / 2]), np.array([t - 0.5, -2 * t, t + 0.5])


@dataclass(frozen=True, eq=False)
class Solid:
    """Bricks of one size, one through the thickness; ``shape`` counts nodes."""

    shape: tuple[int, int, int]
    nodes: np.ndarray
    """(n, 3) where the cold film lies."""
    bricks: np.ndarray
    """(m, 27) nodes."""
    slopes: np.ndarray
    """(m, 27 Gauss points, 27, 3) gradients of the shape functions, in the grown material's frame."""
    weight: np.ndarray
    """(27,) volume of a Gauss point after growth."""

    @property
    def middle(self):
        """Nodes of the middle plane."""
        return np.arange(len(self.nodes)).reshape(self.shape)[:, :, 1].ravel()


def solid(columns, rows, size, theta, dtheta, material):
    """A film of ``size`` = length, width, thickness about the origin; ``theta(x, y)``, ``dtheta(x, y)`` [rad]."""
    shape, edge = (2 * columns + 1, 2 * rows + 1, 3), np.divide(size, (columns, rows, 1))
    axes = [np.linspace(-s / 2, s / 2, n) for s, n in zip(size, shape, strict=True)]
    nodes = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    number = np.arange(len(nodes)).reshape(shape)
    bricks = np.array(
        [number[2 * i : 2 * i + 3, 2 * j : 2 * j + 3].ravel() for i, j in product(range(columns), range(rows))]
    )
    values, slopes, weight = zip(*[shape_at(points) for points in product((-1, 0, 1), repeat=3)], strict=True)
    where = np.einsum("ga,max->mgx", values, nodes[bricks])
    angle = theta(*where.T[:2]).T + dtheta(*where.T[:2]).T * where[..., 2] / size[2]
    c, s, zero = np.cos(angle), np.sin(angle), np.zeros_like(angle)
    turn = np.moveaxis(np.array([[c, -s, zero], [s, c, zero], [zero, zero, zero + 1]]), (0, 1), (2, 3))
    shrink = np.array([material.along, material.across, material.across])
    inverse = turn / shrink @ turn.swapaxes(2, 3)
    grown = np.einsum("gax,mgxy->mgay", 2 * np.array(slopes) / edge, inverse)
    return Solid(shape, nodes, bricks, grown, np.array(weight) * shrink.prod() * edge.prod() / 8)


def shape_at(place):
    """Shape functions (27,), their slopes (27, 3), and the weight of the Gauss point at ``place`` in {-1, 0, 1}^3."""
    values, slopes = zip(*[lagrange(np.sqrt(0.6) * p) for p in place], strict=True)
    gradient = [np.einsum("i,j,k->ijk", *[slopes[d] if d == k else values[d] for d in range(3)]) for k in range(3)]
    weight = np.prod([8 / 9 if p == 0 else 5 / 9 for p in place])
    return np.einsum("i,j,k->ijk", *values).ravel(), np.stack(gradient, axis=-1).reshape(27, 3), weight


def state(body, x):
    """Energy, its gradient (n, 3) and the bricks' stiffness (m, 81, 81) at the shape ``x`` (n, 3)."""
    slopes, weight = body.slopes, body.weight
    stretch = np.einsum("max,mgay->mgxy", x[body.bricks], slopes)
    strain = (stretch.swapaxes(2, 3) @ stretch - np.eye(3)) / 2
    trace = np.trace(strain, axis1=2, axis2=3)
    stress = LAME * trace[..., None, None] * np.eye(3) + 2 * SHEAR * strain
    energy = np.einsum("g,mgxy,mgxy->", weight, stress, strain) / 2
    forces = np.einsum("g,mgxy,mgay->max", weight, stretch @ stress, slopes)
    gradient = np.zeros_like(x)
    np.add.at(gradient, body.bricks, forces)
    carried = np.einsum("mgxy,mgay->mgax", stretch, slopes)
    left = stretch @ stretch.swapaxes(2, 3)
    own = np.einsum("g,mgax,mgxy,mgby->mab", weight, slopes, stress, slopes, optimize=True)
    stiff = np.einsum("mab,xy->maxby", own, np.eye(3))
    stiff += LAME * np.einsum("g,mgax,mgby->maxby", weight, carried, carried, optimize=True)
    stiff += SHEAR * np.einsum("g,mgay,mgbx->maxby", weight, carried, carried, optimize=True)
    stiff += SHEAR * np.einsum("g,mgaz,mgbz,mgxy->maxby", weight, slopes, slopes, left, optimize=True)
    return energy, gradient, stiff.reshape(len(body.bricks), 81, 81)


def settle(body, x, steps=40):
    """Newton's method with held rigid motions from ``x`` (n, 3) to the shape of least energy; it must converge."""
    free = np.setdiff1d(np.arange(x.size), held(body))
    rows = np.repeat((3 * body.bricks[:, :, None] + np.arange(3)).reshape(-1, 81), 81, axis=1).ravel()
    columns = np.tile((3 * body.bricks[:, :, None] + np.arange(3)).reshape(-1, 81), 81).ravel()
    energy, gradient, blocks = state(body, x)
    for _ in range(steps):
        matrix = sparse.csc_matrix((blocks.ravel(), (rows, columns)), shape=(x.size, x.size))[free][:, free]
        step = np.zeros(x.size)
        step[free] = -splu(matrix.tocsc()).solve(gradient.ravel()[free])
        slope = step @ gradient.ravel()
        if abs(slope) < 1e-16 * body.weight.sum():
            return x
        step *= -np.sign(slope)
        for cut in 0.5 ** np.arange(12):
            there = x + cut * step.reshape(-1, 3)
            found = state(body, there)
            if found[0] < energy:
                break
        x, (energy, gradient, blocks) = there, found
    raise AssertionError(slope)


def held(body):
    """Six degrees of freedom that hold the body without force: of three nodes of the middle plane."""
    number = np.arange(len(body.nodes)).reshape(body.shape)[:, :, 1]
    i, j = np.array(number.shape) // 2
    centre, east, north = number[i, j], number[-1, j], number[i, -1]
    return [3 * centre, 3 * centre + 1, 3 * centre + 2, 3 * east + 1, 3 * east + 2, 3 * north + 2]
