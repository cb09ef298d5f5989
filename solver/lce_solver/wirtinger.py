"""The inverse map, target to plane, in complex form: two numbers per triangle that are linear in the unknowns.

With the plane coordinate ``w = u + i v`` and the triangle's own coordinate ``z = x + i y``, a linear map has the
derivatives ``a = dw/dz`` and ``b = dw/dz*``. Its signed singular values are ``|a| + |b|`` and ``|a| - |b|``, and the
direction in the plane that the larger one stretches is ``(arg a + arg b) / 2``.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.sparse.linalg import splu

from lce_solver.geometry import face_areas
from lce_solver.types import Floats, Surface, line_angle

Complexes = NDArray[np.complex128]

Term = Callable[[Complexes], tuple[float, Complexes]]

TINY = 1e-150
"""Stands for zero where a direction is divided by its length."""


@dataclass(frozen=True, eq=False)
class Operator:
    """Derivatives on a fixed mesh, and the Laplacian factored once."""

    derivative: sparse.csr_array
    """(2 n_f, n_v) complex: ``w -> (a, b)``."""
    adjoint: sparse.csr_array
    """(n_v, 2 n_f) complex: its conjugate transpose."""
    weight: Floats
    """(2 n_f,) area fraction of each triangle, once for a and once for b."""
    stiffness: sparse.csr_array
    """(n_v, n_v) ``2 adjoint weight derivative``: twice the Laplacian."""
    solve: Callable[[Complexes], Complexes]
    """Inverse of the stiffness, with the first vertex held."""


def operator(surface: Surface) -> Operator:
    """Assemble and factor; the triangles must have positive area."""
    z, area = laid_flat(surface)
    opposite = np.roll(z, -2, axis=1) - np.roll(z, -1, axis=1)
    hat = -0.25j * opposite.conj() / area[:, None]  # d/dz of the function that is 1 at one corner, 0 at the others
    n_f, n_v = len(z), len(surface.vertices)
    rows = np.repeat(np.arange(n_f), 3)
    a = sparse.csr_array((hat.ravel(), (rows, surface.faces.ravel())), shape=(n_f, n_v))
    derivative = sparse.vstack([a, a.conj()], format="csr")
    adjoint = derivative.conj().T.tocsr()
    weight = np.tile(area / area.sum(), 2)
    stiffness = (2 * (adjoint.multiply(weight).tocsr() @ derivative).real).tocsr()
    return Operator(derivative, adjoint, weight, stiffness, inverse(stiffness))


def laid_flat(surface: Surface) -> tuple[Complexes, Floats]:
    """(n_f, 3) corners in each triangle's own plane, the first at 0 and the second on the x axis; (n_f,) areas."""
    origin, p, q = np.moveaxis(surface.vertices[surface.faces], 1, 0)
    p, q = p - origin, q - origin
    area, base = face_areas(surface), np.linalg.norm(p, axis=1)
    tip = (np.einsum("fi,fi->f", p, q) + 2j * area) / base
    return np.stack([np.zeros_like(tip), base.astype(np.complex128), tip], axis=1), area


def inverse(matrix: sparse.csr_array) -> Callable[[Complexes], Complexes]:
    """Solve with a symmetric positive semi-definite matrix whose kernel are the constants (vertex 0 is held)."""
    options = {"SymmetricMode": True}
    lu = splu(matrix[1:, 1:].tocsc(), permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options=options)

    def solve(right: Complexes) -> Complexes:
        out = np.zeros_like(right)
        out[1:] = lu.solve(right[1:].view(np.float64).reshape(-1, 2)).copy(order="C").view(np.complex128)[:, 0]
        return out

    return solve


def moduli(stretches: tuple[float, float]) -> tuple[float, float]:
    """``|a|`` and ``|b|`` of a map whose inverse stretches by ``stretches`` (along, across), in either order."""
    large, small = 1 / min(stretches), 1 / max(stretches)
    return (large + small) / 2, (large - small) / 2


def energy(
    op: Operator, w: Complexes, stretches: tuple[float, float], more: Term | None = None
) -> tuple[float, Complexes]:
    """``1/2 sum weight [(sigma_1 - s_1)^2 + (sigma_2 - s_2)^2]`` (the paper, eq. S3) and its gradient.

    ``s`` are the inverse stretches. In a and b the bracket is ``2 [(|a| - alpha)^2 + (|b| - beta)^2]``, so no
    singular value decomposition is needed. The gradient is ``dE/du + i dE/dv``, (n_v,) complex.

    Parameters
    ----------
    more : a further term, from (2 n_f,) ``(a, b)`` to its value and its derivative by them.
    """
    ab = op.derivative @ w
    size = np.abs(ab)
    excess = size - np.repeat(moduli(stretches), len(size) // 2)
    force = op.weight * excess
    value = float(np.einsum("i,i->", force, excess))
    force /= np.maximum(size, TINY)
    slope = ab * (2 * force)
    if more is not None:
        further, steeper = more(ab)
        value, slope = value + further, slope + steeper
    return value, op.adjoint @ slope


def stretched(w: Complexes, stretches: tuple[float, float], angle: float) -> Complexes:
    """Stretch the plane by ``1/along`` in the direction ``angle`` and by ``1/across`` at right angles to it."""
    along, across = 1 / np.asarray(stretches)
    result: Complexes = (along + across) / 2 * w + (along - across) / 2 * np.exp(2j * angle) * w.conj()
    return result


def director(op: Operator, w: Complexes, stretches: tuple[float, float]) -> Floats:
    """(n_f,) direction in the plane that the inverse map stretches by ``1/along``, modulo pi [rad]."""
    a, b = np.split(op.derivative @ w, 2)
    along, across = stretches
    return line_angle(np.angle(a * b) / 2 + (np.pi / 2 if along > across else 0.0))
