"""Koiter energy of a thin shell with prescribed metric and curvature; closed-form gradient and semi-definite Hessian.

    E = sum_t A sqrt(det a_bar) [ h/(8 (1-nu^2)) Q(a_bar^-1 (a - a_bar)) + h^3/(24 (1-nu^2)) Q(a_bar^-1 (b - b_bar)) ],
    Q(T) = nu tr(T)^2 + (1-nu) tr(T^2),  a_ij = x_i . x_j,  b_ij = n . x_ij,  n ~ x_1 cross x_2 (the sheet's top).

Per triangle both terms are sums of three squares: a least-squares problem. Energies are per Young's modulus.
Symmetric 2x2 tensors are stored as their components 11, 22, 12.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from lce_solver.shell_patch import Shell
from lce_solver.types import Floats, Material

POISSON = 0.5
"""Elastic Poisson ratio: elastomers are incompressible (not the material's `nu`, which says how heating stretches)."""


@dataclass(frozen=True, eq=False)
class Reference:
    """What the heated sheet wants to be, per triangle."""

    metric: Floats
    """(n_f, 3) prescribed metric a_bar."""
    curvature: Floats
    """(n_f, 3) prescribed second form b_bar in sheet coordinates [1/mm]."""
    whitening: Floats
    """(n_f, 3, 3) W: the energy is 1/2 |W (a - a_bar)|^2 + 1/2 |W (b - b_bar)|^2 thickness^2 / 3 [mm^1.5]."""
    thickness: float
    """Thickness of the heated sheet [mm]."""


def reference(
    sheet: Shell, theta: Floats, dtheta: Floats, material: Material, *, thickness: float, poisson: float = POISSON
) -> Reference:
    """Prescribed metric (paper, eq. S1) and curvature (eq. S4, its sign fixed by b = n . x_ij, n towards the top).

    ``theta``, ``dtheta`` (n_f,) rad; ``thickness`` of the prepared film [mm].
    """
    frame = np.moveaxis(np.array([[np.cos(theta), -np.sin(theta)], [np.sin(theta), np.cos(theta)]]), 2, 0)
    stretch = np.array([material.along, material.across])
    metric = frame * stretch**2 @ frame.swapaxes(1, 2)
    mixed = frame @ np.array([[0.0, 1.0], [1.0, 0.0]]) @ frame.swapaxes(1, 2)
    heated = thickness * material.through
    slope = -(material.along**2 - material.across**2) / (2 * heated)
    weight = sheet.area * stretch.prod() * heated / (4 * (1 - poisson**2))
    whitening = _principal(frame / stretch, poisson) * np.sqrt(weight)[:, None, None]
    return Reference(_voigt(metric), _voigt((slope * dtheta)[:, None, None] * mixed), whitening, heated)


def _voigt(tensor: Floats) -> Floats:
    """Components 11, 22, 12 (..., 3) of symmetric tensors (..., 2, 2)."""
    return np.stack([tensor[..., 0, 0], tensor[..., 1, 1], tensor[..., 0, 1]], axis=-1)


def _principal(basis: Floats, poisson: float) -> Floats:
    """Return C (n_f, 3, 3) with ``|C t|^2 = Q(basis^T t basis)`` for components t of a tensor."""
    p, q = basis[:, :, 0], basis[:, :, 1]

    def row(x: Floats, y: Floats) -> Floats:
        """Coefficients of x^T t y."""
        return np.stack([x[:, 0] * y[:, 0], x[:, 1] * y[:, 1], x[:, 0] * y[:, 1] + x[:, 1] * y[:, 0]], axis=1)

    # Q = (1+nu)/2 (t_pp + t_qq)^2 + (1-nu)/2 (t_pp - t_qq)^2 + 2 (1-nu) t_pq^2
    spherical, deviator, shear = row(p, p) + row(q, q), row(p, p) - row(q, q), row(p, q)
    scales = np.sqrt([(1 + poisson) / 2, (1 - poisson) / 2, 2 * (1 - poisson)])
    return np.stack([spherical, deviator, shear], axis=1) * scales[:, None]


@dataclass(frozen=True, eq=False)
class _Forms:
    """First and second form of all triangles at one shape."""

    tangent: Floats
    """(2, n_f, 3)"""
    normal: Floats
    """(n_f, 3) unit normals."""
    dual: Floats
    """(2, 3, n_f) Christoffel symbols: second derivatives along the two dual tangents."""
    first: Floats
    """(n_f, 3) a."""
    second: Floats
    """(n_f, 3) b."""


def _dot(p: Floats, q: Floats) -> Floats:
    product: Floats = np.einsum("...i,...i->...", p, q)
    return product


def _forms(sheet: Shell, x: Floats) -> _Forms:
    n_f = len(sheet.faces)
    tangent = (sheet.tangents @ x).reshape(2, n_f, 3)
    curve = (sheet.curves @ x).reshape(3, n_f, 3)
    along, across = tangent
    normal = np.cross(along, across)
    squared = _dot(normal, normal)
    normal /= np.sqrt(squared)[:, None]
    a11, a22, a12 = _dot(along, along), _dot(across, across), _dot(along, across)
    covariant = np.stack([_dot(curve, along), _dot(curve, across)])
    dual = np.stack([a22 * covariant[0] - a12 * covariant[1], a11 * covariant[1] - a12 * covariant[0]]) / squared
    return _Forms(tangent, normal, dual, np.stack([a11, a22, a12], axis=1), _dot(curve, normal).T)


def _stresses(aim: Reference, forms: _Forms) -> tuple[Floats, Floats, Floats]:
    """Residuals (2, n_f, 3) of both terms, and their conjugates to a and to b, each (n_f, 3)."""
    bending = aim.thickness / np.sqrt(3)
    strain = np.stack([forms.first - aim.metric, bending * (forms.second - aim.curvature)])
    residual = np.einsum("tij,stj->sti", aim.whitening, strain)
    stretch, bend = np.einsum("tji,stj->sti", aim.whitening, residual)
    return residual, stretch, bending * bend


def parts(sheet: Shell, aim: Reference, x: Floats) -> tuple[float, float]:
    """Stretching and bending energy per Young's modulus [mm^3] of the shape ``x`` (n_v, 3) [mm]."""
    residual = _stresses(aim, _forms(sheet, x))[0]
    return float(_dot(residual[0], residual[0]).sum() / 2), float(_dot(residual[1], residual[1]).sum() / 2)


def energy(sheet: Shell, aim: Reference, x: Floats) -> tuple[float, Floats]:
    """Energy per Young's modulus [mm^3] of ``x`` (n_v, 3) [mm] and its gradient (n_v, 3); NaN where x is singular."""
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        forms = _forms(sheet, x)
        residual, stretch, bend = _stresses(aim, forms)
        (along, across), (s11, s22, s12) = forms.tangent, stretch.T[:, :, None]
        # dn = -x^i (n . dx_i), hence db = n . (dx_ij - Gamma^k_ij dx_k): all bending forces are along the normal
        pull = np.einsum("atg,gt->at", forms.dual.swapaxes(1, 2), bend.T)[..., None] * forms.normal
        on_tangents = np.stack([2 * s11 * along + s12 * across, 2 * s22 * across + s12 * along]) - pull
        on_curves = bend.T[:, :, None] * forms.normal
        gradient = sheet.tangents.T @ on_tangents.reshape(-1, 3) + sheet.curves.T @ on_curves.reshape(-1, 3)
        return float(np.vdot(residual, residual) / 2), gradient


def residual_strain(sheet: Shell, aim: Reference, x: Floats) -> float:
    """Area rms of the relative errors of both stretches, the roots of the eigenvalues of a_bar^-1 a."""
    a11, a22, a12 = _forms(sheet, x).first.T
    p11, p22, p12 = aim.metric.T
    prescribed = p11 * p22 - p12**2
    mean = (p22 * a11 + p11 * a22 - 2 * p12 * a12) / (2 * prescribed)
    spread = np.sqrt(np.maximum(mean**2 - (a11 * a22 - a12**2) / prescribed, 0))
    error = (np.sqrt(mean + spread) - 1) ** 2 + (np.sqrt(np.maximum(mean - spread, 0)) - 1) ** 2
    return float(np.sqrt(np.average(error / 2, weights=sheet.area)))


def stiffness(sheet: Shell, aim: Reference, x: Floats) -> Floats:
    """Positive semi-definite Hessian of each triangle, (n_f, 6, 6, 3, 3) over pairs of patch nodes.

    Gauss-Newton of both terms, and the geometric stiffness of the tensile part of the membrane stress.
    """
    forms = _forms(sheet, x)
    _, stress, _ = _stresses(aim, forms)
    element = _gauss_newton(sheet, aim, forms)
    tension = sheet.slopes @ _tensile(stress) @ sheet.slopes.swapaxes(1, 2)
    element[:, :3, :3] += tension[..., None, None] * np.eye(3)
    return element


def _outward(forms: _Forms) -> Floats:
    """(n_f, 1, 1, 3, 3) n n^T."""
    normal = forms.normal[:, None, None]
    product: Floats = normal[..., :, None] * normal[..., None, :]
    return product


def _gauss_newton(sheet: Shell, aim: Reference, forms: _Forms) -> Floats:
    """Both terms' derivatives squared, (n_f, 6, 6, 3, 3)."""
    bent = aim.whitening @ _curvature_slopes(sheet, forms).swapaxes(1, 2) * (aim.thickness / np.sqrt(3))
    element: Floats = (bent.swapaxes(1, 2) @ bent)[..., None, None] * _outward(forms)
    stretched = np.einsum("tij,tjkx->tikx", aim.whitening, _metric_slopes(sheet, forms)).reshape(-1, 3, 9)
    inner = (stretched.swapaxes(1, 2) @ stretched).reshape(-1, 3, 3, 3, 3).swapaxes(2, 3)
    element[:, :3, :3] += inner
    return element


def hessian(sheet: Shell, aim: Reference, x: Floats) -> Floats:
    """Second derivatives of each triangle's energy, (n_f, 6, 6, 3, 3) over pairs of patch nodes; may be indefinite.

    Gauss-Newton of both terms, all of the membrane stress, and of the moments m the second variation of b,
    ``-2 (n . dx_k) (x^k . (dx_ij - Gamma^l_ij dx_l)) - b_ij a^kl (n . dx_k) (n . dx_l)``.
    """
    forms = _forms(sheet, x)
    _, stress, moment = _stresses(aim, forms)
    element = _gauss_newton(sheet, aim, forms)
    s11, s22, s12 = stress.T
    tension = sheet.slopes @ np.moveaxis(np.array([[2 * s11, s12], [s12, 2 * s22]]), 2, 0)
    element[:, :3, :3] += (tension @ sheet.slopes.swapaxes(1, 2))[..., None, None] * np.eye(3)
    a11, a22, a12 = forms.first.T
    inverse = np.moveaxis(np.array([[a22, -a12], [-a12, a11]]) / (a11 * a22 - a12**2), 2, 0)
    slopes = np.concatenate([sheet.slopes, np.zeros_like(sheet.slopes)], axis=1)
    dual = slopes @ inverse @ forms.tangent.swapaxes(0, 1)  # (n_f, 6, 3): of each node's motion along the normal
    pulled = np.einsum("tjg,tg->tj", _curvature_slopes(sheet, forms), moment)
    tilt = np.einsum("ta,tib,tj->tijab", forms.normal, dual, pulled)
    element -= tilt + tilt.transpose(0, 2, 1, 4, 3)
    turned = _dot(moment, forms.second)[:, None, None] * (slopes @ inverse @ slopes.swapaxes(1, 2))
    element -= turned[..., None, None] * _outward(forms)
    return element


TURN = np.array([[0.0, 0.0, 2.0], [0.0, 0.0, -2.0], [-1.0, 1.0, 0.0]])
"""Derivative of the components of R^T t R with respect to the angle of R."""


def pattern_forces(sheet: Shell, aim: Reference, unit: Reference, x: Floats) -> Floats:
    """Derivatives of each triangle's gradient with respect to director and twist, (n_f, 6, 3, 2) over patch nodes.

    ``unit`` is what the sheet wants to be where its twist is 1. To turn the director is to turn the sheet back.
    """
    forms = _forms(sheet, x)
    _, stress, moment = _stresses(aim, forms)
    stiff = aim.whitening.swapaxes(1, 2) @ aim.whitening
    bend = aim.thickness**2 / 3
    turned = stress @ TURN + np.einsum("tij,tj->ti", stiff, forms.first @ TURN.T)
    bent = moment @ TURN + bend * np.einsum("tij,tj->ti", stiff, forms.second @ TURN.T)
    twisted = -bend * np.einsum("tij,tj->ti", stiff, unit.curvature)
    along_normal = np.einsum("tjg,tgp->tjp", _curvature_slopes(sheet, forms), np.stack([bent, twisted], axis=2))
    forces: Floats = along_normal[:, :, None, :] * forms.normal[:, None, :, None]
    forces[:, :3, :, 0] += np.einsum("tgjx,tg->tjx", _metric_slopes(sheet, forms), turned)
    return forces


def bias(sheet: Shell, plain: Reference, twisted: Reference, x: Floats) -> Floats:
    """(n_f,) energy by which each triangle's twist favours the shape over its mirror image; their sum is the sheet's.

    In bending energies of the plain sheet; ``plain`` is what the sheet without twist wants to be. Positive: the shape
    costs less than its mirror image. Proportional to the twist.
    """
    form = _forms(sheet, x).second
    white = np.einsum("tij,tj->ti", plain.whitening, form)
    wanted = np.einsum("tij,tj->ti", plain.whitening, twisted.curvature)
    favour: Floats = 4 * _dot(white, wanted) / np.vdot(white, white)
    return favour


def bent_form(sheet: Shell, x: Floats) -> Floats:
    """(n_f, 2, 2) second form of the shape in sheet coordinates [1/mm]."""
    b11, b22, b12 = _forms(sheet, x).second.T
    form: Floats = np.stack([b11, b12, b12, b22], axis=1).reshape(-1, 2, 2)
    return form


def _curvature_slopes(sheet: Shell, forms: _Forms) -> Floats:
    """Derivatives (n_f, 6, 3) of b with respect to each patch node's motion along the normal."""
    slopes = sheet.bends.copy()
    slopes[:, :3] -= np.einsum("tja,agt->tjg", sheet.slopes, forms.dual)
    return slopes


def _metric_slopes(sheet: Shell, forms: _Forms) -> Floats:
    """Derivatives (n_f, 3, 3, 3) of a's components with respect to each corner's position."""
    (along, across), d = forms.tangent, sheet.slopes
    first = 2 * d[:, :, :1] * along[:, None]
    second = 2 * d[:, :, 1:] * across[:, None]
    mixed = d[:, :, :1] * across[:, None] + d[:, :, 1:] * along[:, None]
    return np.stack([first, second, mixed], axis=1)


def _tensile(stress: Floats) -> Floats:
    """Positive semi-definite part (n_f, 2, 2) of the form 2 s11 du^2 + 2 s12 du dv + 2 s22 dv^2."""
    mean, half, shear = stress[:, 0] + stress[:, 1], stress[:, 0] - stress[:, 1], stress[:, 2]
    radius = np.hypot(half, shear) + np.finfo(float).tiny
    upper, lower = np.maximum(mean + radius, 0) / 2, np.maximum(mean - radius, 0) / 2
    centre, spread = upper + lower, (upper - lower) / radius
    tensor = [[centre + spread * half, spread * shear], [spread * shear, centre - spread * half]]
    return np.moveaxis(np.array(tensor), 2, 0)
