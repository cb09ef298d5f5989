"""Director fields whose target is known in closed form: the ground truth of the metric solver and of the shell.

Every field has one varying coordinate q: x of a strip, or the distance r from the centre of a disk. The director makes
the angle alpha(q) with the direction of growing q. Then (the paper's eq. 1, with ``along`` = lambda and ``across`` =
lambda^-nu) the metric across q and the mixed term are

    G = along^2 sin^2 alpha + across^2 cos^2 alpha,    F = (along^2 - across^2) sin alpha cos alpha,

and the sheet becomes a surface of revolution: radius sqrt(G)/k of a strip wound k radians per unit of y, or r sqrt(G)
of a disk; circles turn by the integral of F/G dq, or F/(G r) dr, against each other; area gives the meridian.
All functions are analytic and take complex arguments, so derivatives cost no accuracy.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.polynomial import Polynomial
from scipy.optimize import brentq

from lce_solver.errors import InputError
from lce_solver.field import Field
from lce_solver.series import Meridian, Numbers, Profile, Span, integral, interpolant, inverse
from lce_solver.types import Floats, Material

# -- what the constructors share ---------------------------------------------------------------------------------------


def extremes(material: Material) -> tuple[float, float]:
    """Smaller and larger stretch of the material: sqrt(G) lies between them."""
    return min(material.along, material.across), max(material.along, material.across)


def area_factor(material: Material) -> float:
    """Area of the target over area of the sheet."""
    return material.along * material.across


def angle_of(material: Material, g: Numbers) -> Numbers:
    """Director angle in [0, pi/2] whose metric across q is ``g``."""
    a2, b2 = material.along**2, material.across**2
    angle: Numbers = np.arccos((2 * g - a2 - b2) / (b2 - a2)) / 2
    return angle


def slope(material: Material, alpha: Numbers) -> Numbers:
    """F/G: how fast the circles turn against each other."""
    a2, b2 = material.along**2, material.across**2
    c, s = np.cos(alpha), np.sin(alpha)
    ratio: Numbers = (a2 - b2) * s * c / (a2 * s**2 + b2 * c**2)
    return ratio


def strip_turn(material: Material, angle: Profile, span: Span, rate: float) -> Profile:
    """Rotation of the circles of a strip: k times the integral of F/G dx."""
    turned = integral(lambda x: slope(material, angle(x)), span)
    return lambda x: rate * turned(x)


def disk_turn(material: Material, angle: Profile, natural: float) -> Profile:
    """Rotation of the circles of a disk: integral of F/(G r) dr, logarithmic at the centre of a spiral.

    ``natural`` is the radius where the director becomes radial or azimuthal, or the end of the field.
    """
    centre = float(slope(material, angle(np.array(0.0))))

    def regular(t: Numbers) -> Numbers:
        rest: Numbers = (slope(material, angle(natural * np.sin(t))) - centre) / np.tan(t)
        return rest

    series = interpolant(regular, (-np.pi / 2, np.pi / 2)).integ()
    return lambda r: centre * np.log(r / natural) + series(np.arcsin(r / natural))


def revolved(radius: Profile, height: Profile) -> Callable[[Numbers, Numbers], Numbers]:
    """Surface of revolution: (q, longitude) to the point (3, ...)."""
    return lambda q, psi: np.stack([radius(q) * np.cos(psi), radius(q) * np.sin(psi), height(q)])


def constant(value: float) -> Profile:
    """The profile that is the same everywhere."""
    return lambda q: value + 0 * q


def positive(name: str, value: float) -> None:
    """Raise `InputError` unless ``value`` is a positive number."""
    if not (np.isfinite(value) and value > 0):
        msg = f"{name} is {value:g}; give a positive number"
        raise InputError(msg)


def within(material: Material, root: Floats, what: str, remedy: str) -> None:
    """Raise `InputError` unless sqrt(G) stays strictly between the stretches of the material."""
    small, large = extremes(material)
    if not (root.min() > small and root.max() < large):
        msg = (
            f"{what} runs from {root.min():.6g} to {root.max():.6g}, outside the stretches {small:.6g} to {large:.6g} "
            f"of lambda = {material.lambda_:g}; {remedy}"
        )
        raise InputError(msg)


# -- strips and cylinders ----------------------------------------------------------------------------------------------


def strip(material: Material, curvature: float = 1.0, c0: float | None = None, c1: float = 0.0) -> Field:
    """Strip of constant Gauss curvature without defect: cos 2 theta = c0 + c1 x + c2 x^2, c2 fixed by the curvature.

    Without ``c0`` it is symmetric about x = 0 and as wide as it can be.
    """
    if not (np.isfinite(curvature) and curvature != 0):
        msg = f"the curvature of a strip is {curvature:g}; give a number other than 0 (a uniform director stays flat)"
        raise InputError(msg)
    a2, b2, area = material.along**2, material.across**2, area_factor(material)
    c2 = 2 * curvature * area**2 / (a2 - b2)
    c0 = -float(np.sign(c2)) if c0 is None else c0
    cosine = Polynomial([c0, c1, c2])
    span = between(cosine)

    whole = np.arcsin if c2 < 0 else np.arccos  # of x / end: the symmetric strip without a kink at x = 0
    angle: Profile = (lambda x: np.arccos(cosine(x)) / 2) if abs(c0) < 1 else (lambda x: whole(x / span[1]))
    root: Profile = lambda x: np.sqrt((a2 + b2) / 2 + (b2 - a2) / 2 * cosine(x))  # sqrt(G)
    incline: Profile = lambda x: (b2 - a2) / (4 * area) * cosine.deriv()(x)  # k d(radius)/ds
    # Wound this tightly, the meridian exists up to both ends; the symmetric strip of K > 0 becomes a sphere.
    rate = max(np.sqrt(abs(curvature)) * extremes(material)[1], 1.05 * np.abs(incline(np.array(span))).max())
    height = integral(lambda x: area / root(x) * np.sqrt(1 - (incline(x) / rate) ** 2), span)
    return Field(
        "strip", material, False, span, "-1 <= cos 2 theta <= 1", angle, strip_turn(material, angle, span, rate),
        revolved(lambda x: root(x) / rate, height), constant(curvature), rate,
    )  # fmt: skip


def between(cosine: Polynomial) -> Span:
    """Interval about x = 0 in which the quadratic stays between -1 and 1."""
    c0, c1, c2 = (float(c) for c in cosine.coef)
    if abs(c0) == 1 and c0 * c2 < 0 and c1 == 0:
        return -float(np.sqrt(2 / abs(c2))), float(np.sqrt(2 / abs(c2)))
    if not -1 < c0 < 1:
        msg = f"c0 = {c0:g} is not between -1 and 1; it is cos 2 theta at x = 0 (leave it out for the symmetric strip)"
        raise InputError(msg)
    roots = np.concatenate([(cosine - level).roots() for level in (-1.0, 1.0)])
    ends = roots[np.isreal(roots)].real
    return float(ends[ends < 0].max()), float(ends[ends > 0].min())


def spherical_zone(material: Material, radius: float = 1.0) -> Field:
    """Cylinder to the widest zone of a sphere, symmetric about the equator; the sheet wraps once around it."""
    positive("the radius of the sphere", radius)
    zone, (small, large) = strip(material, 1 / radius**2), extremes(material)
    rate = large / radius
    end = zone.limits[1] / np.sqrt(1 - (small / large) ** 2)

    sine: Profile = lambda x: x / end  # of the latitude: equal areas, as Archimedes found
    place = revolved(lambda x: radius * np.sqrt(1 - sine(x) ** 2), lambda x: radius * sine(x))
    turn = strip_turn(material, zone.angle, zone.limits, rate)
    bound = f"cos(latitude) >= {small / large:.4g}"
    return Field("spherical zone", material, False, zone.limits, bound, zone.angle, turn, place, zone.gaussian, rate)


def cylinder(
    material: Material,
    radius: Profile = np.cosh,
    height: Profile = np.positive,
    span: Span = (-0.5, 0.5),
    circumference: float | None = None,
) -> Field:
    """Cylinder to the surface of revolution with the meridian (radius(p), height(p)), by default a catenoid.

    ``circumference`` is the flat cylinder's; without it the director's range is used evenly at both ends.
    """
    if circumference is not None:
        positive("the circumference of the flat cylinder", circumference)
    meridian = Meridian.of(radius, height, span)
    rho = meridian.radius(np.linspace(*span, 2001))
    positive("the smallest radius of the meridian", float(rho.min()))
    (small, large), area = extremes(material), area_factor(material)
    rate = float(np.sqrt(area / (rho.min() * rho.max()))) if circumference is None else 2 * np.pi / circumference
    bound = f"the meridian's ends, where radius max/min <= {large / small:.4g}"
    within(material, rate * rho, "2 pi radius / circumference", f"keep radius max/min below {large / small:.4g}")
    p, limits = inverse(integral(lambda p: rate / area * meridian.radius(p) * meridian.speed(p), span), span)

    angle: Profile = lambda x: angle_of(material, (rate * meridian.radius(p(x))) ** 2)
    return Field(
        "cylinder", material, False, limits, bound, angle, strip_turn(material, angle, limits, rate),
        revolved(lambda x: meridian.radius(p(x)), lambda x: meridian.height(p(x))),
        lambda x: meridian.gaussian(p(x)), rate,
    )  # fmt: skip


# -- disks -------------------------------------------------------------------------------------------------------------


def spherical_cap(material: Material, radius: float = 1.0) -> Field:
    """Disk to a cap of a sphere; the director spirals about the centre (physics: cos 2 alpha is quadratic in r)."""
    positive("the radius of the sphere", radius)
    (small, large), area = extremes(material), area_factor(material)
    end = float(2 * radius * np.sqrt((1 - small / large) / area))

    half: Profile = lambda r: area * r**2 / (4 * radius**2)  # sin^2 of half the polar angle
    angle: Profile = lambda r: angle_of(material, area * (1 - half(r)))
    place = revolved(lambda r: r * np.sqrt(area * (1 - half(r))), lambda r: radius * (1 - 2 * half(r)))
    bound = f"cos(polar angle) >= {2 * small / large - 1:.4g}, K r^2 <= {(end / radius) ** 2:.4g}"
    turn = disk_turn(material, angle, end)
    return Field("spherical cap", material, True, (1e-9 * end, end), bound, angle, turn, place, constant(radius**-2))


def pseudosphere_cap(material: Material, radius: float = 1.0) -> Field:
    """Disk to a geodesic disk of curvature -1/radius^2, laid on the tractricoid without covering itself."""
    positive("the radius of the pseudosphere", radius)
    (small, large), area = extremes(material), area_factor(material)
    wrap = np.log(1 + 2 * np.pi) / 2  # the geodesic radius whose disk just closes around the tractricoid
    natural = 2 * np.arccosh(np.sqrt(large / small))

    def flat(geodesic: float) -> float:
        return float(2 * radius / np.sqrt(area) * np.sinh(geodesic / 2))

    angle: Profile = lambda r: angle_of(material, area * (1 + area * r**2 / (4 * radius**2)))

    def place(r: Numbers, psi: Numbers) -> Numbers:
        s = 2 * np.arcsinh(np.sqrt(area) * r / (2 * radius))
        down = np.exp(wrap) / (np.cosh(s) - np.sinh(s) * np.cos(psi))  # upper half plane, centred at exp(wrap)
        across = down * np.sinh(s) * np.sin(psi)
        meridian = np.arccosh(down) - np.sqrt(1 - down**-2)
        return radius * np.stack([np.cos(across) / down, np.sin(across) / down, meridian])

    end = flat(min(natural, wrap))
    bound = f"geodesic radius <= {min(natural, wrap):.4g} R"
    turn = disk_turn(material, angle, flat(natural))
    return Field(
        "pseudosphere cap", material, True, (1e-9 * end, end), bound, angle, turn, place, constant(-(radius**-2))
    )


def paraboloid(material: Material, radius: float = 1.0) -> Field:
    """Disk to the paraboloid z = -rho^2 / (2 radius), its tip up."""
    positive("the radius of curvature at the tip", radius)
    (small, large), area = extremes(material), area_factor(material)
    tightest = small / large
    # u = sqrt(1 + rho^2/R^2); G = area * 3/2 (u + 1)/(u^2 + u + 1) falls to the smaller stretch at the rim.
    rim = (1.5 - tightest + np.sqrt((1.5 - tightest) ** 2 + 4 * tightest * (1.5 - tightest))) / (2 * tightest)
    end = float(radius * np.sqrt((rim**3 - 1) / (1.5 * area)))

    u: Profile = lambda r: (1 + 1.5 * area * r**2 / radius**2) ** (1 / 3)
    g: Profile = lambda r: 1.5 * area * (u(r) + 1) / (u(r) ** 2 + u(r) + 1)
    angle: Profile = lambda r: angle_of(material, g(r))
    place = revolved(lambda r: r * np.sqrt(g(r)), lambda r: -(r**2) * g(r) / (2 * radius))
    bound = f"rho <= {np.sqrt(rim**2 - 1):.4g} R"
    turn = disk_turn(material, angle, end)
    return Field(
        "paraboloid", material, True, (1e-9 * end, end), bound, angle, turn, place, lambda r: radius**-2 * u(r) ** -4
    )


def disk(
    material: Material, radius: Profile = np.sin, height: Profile = lambda p: np.cos(p) / 2, end: float = 1.0
) -> Field:
    """Disk to the surface of revolution with the meridian (radius(p), height(p)), 0 <= p <= ``end`` (an ellipsoid).

    The meridian must be smooth across the axis: radius odd in p, height even.
    """
    axis = float(radius(np.array(0.0)))
    if abs(axis) > 1e-9 * end:
        msg = f"the meridian of a disk starts {axis:g} from the axis; let radius(0) be 0, or use the cylinder"
        raise InputError(msg)
    span, area = (-end, end), area_factor(material)
    meridian = Meridian.of(radius, height, span)
    nodes, weights = np.polynomial.legendre.leggauss(64)
    inside = (1 + nodes[:, None]) / 2

    # r/p, from equal areas: r^2 = 2/area * integral of rho ds; written so that it is accurate at the axis too
    flat: Profile = lambda p: np.sqrt(weights @ (radius(inside * p) / p * meridian.speed(inside * p)) / area)
    stretched = interpolant(flat, span)
    root = interpolant(lambda p: radius(p) / p / flat(p), span)  # sqrt(G) = rho/r
    p, limits = inverse(lambda p: p * stretched(p), span)
    remedy = "take less of the meridian, or lambda further from 1"
    within(material, root(np.linspace(0, end, 2001)), "sqrt(G) = rho/r", remedy)

    angle: Profile = lambda r: angle_of(material, root(p(r)) ** 2)
    return Field(
        "disk", material, True, (1e-9 * limits[1], limits[1]), f"the meridian's end p = {end:g}", angle,
        disk_turn(material, angle, limits[1]), revolved(lambda r: r * root(p(r)), lambda r: meridian.height(p(r))),
        lambda r: meridian.gaussian(p(r)),
    )  # fmt: skip


def cone(material: Material, alpha: float = np.pi / 2, radius: float = 1.0) -> Field:
    """Disk of flat ``radius`` with one angle between director and radius everywhere (a +1 defect), its tip up.

    Where circles grow less than radii it is a cone, sin(half apex) = G/(along across); otherwise an anticone, a ruled
    cone over a wave around the unit sphere. Sectors of it are flat.
    """
    positive("the radius of the disk", radius)
    area = area_factor(material)
    g = material.along**2 * np.sin(alpha) ** 2 + material.across**2 * np.cos(alpha) ** 2
    sine, slant = g / area, area / np.sqrt(g)
    swirl = float(slope(material, np.array(alpha)))
    spiral = abs(swirl) > 1e-12
    curve = circle(sine) if sine <= 1 else wave(sine)
    return Field(
        "cone", material, True, (1e-9 * radius if spiral else 0.0, radius), "the radius of the disk", constant(alpha),
        (lambda r: swirl * np.log(r / radius)) if spiral else constant(0.0),
        lambda r, psi: slant * r * curve(psi), constant(0.0),
    )  # fmt: skip


def circle(sine: float) -> Profile:
    """Points (3, ...) of the circle of the unit sphere at this distance from the axis, by longitude."""
    return lambda psi: np.stack([sine * np.cos(psi), sine * np.sin(psi), 0 * psi - np.sqrt(1 - sine**2)])


def wave(excess: float) -> Profile:
    """Points (3, ...) of a closed wave on the unit sphere, ``excess`` > 1 times the equator long, at uniform speed."""
    lobes = 2 + int(excess)  # each lobe adds less than half a turn

    def speed(t: Numbers, height: float) -> Numbers:
        w, w1 = height * np.cos(lobes * t), -height * lobes * np.sin(lobes * t)
        root: Numbers = np.sqrt((1 + w1**2) * (1 + w**2) - (w * w1) ** 2)
        return np.asarray(root / (1 + w**2))

    period = np.pi / lobes
    even = np.linspace(0, period, 1024, endpoint=False)
    height = brentq(lambda h: speed(even, h).mean() - excess, 0.0, 100.0)
    time, (lo, _) = inverse(integral(lambda t: speed(t, height) / excess, (0.0, period)), (0.0, period))

    def point(psi: Numbers) -> Numbers:
        whole = period * np.floor(psi.real / period)
        t = whole + time(lo + psi - whole)
        raw = np.stack([np.cos(t), np.sin(t), height * np.cos(lobes * t)])
        unit: Numbers = raw / np.sqrt(1 + raw[2] ** 2)
        return unit

    return point


FIELDS: dict[str, Callable[..., Field]] = {
    "strip": strip,
    "cylinder": cylinder,
    "spherical zone": spherical_zone,
    "disk": disk,
    "spherical cap": spherical_cap,
    "pseudosphere cap": pseudosphere_cap,
    "paraboloid": paraboloid,
    "cone": cone,
}
"""Constructor of each field: a `Material`, then the target's numbers; every default is a target of size about 1."""
