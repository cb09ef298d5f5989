"""What may go wrong between design and oven, as changes of the film that is heated. Each is a pure function."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from scipy.spatial import cKDTree

from lce_solver.shell import Film, film_of
from lce_solver.twist import edge_factor
from lce_solver.types import Design, Floats, line_angle
from lce_workbench.core.domains import Domains
from lce_workbench.core.job import PredictionSpec
from lce_workbench.core.overlap import shared_area
from lce_workbench.core.sampling import as_made
from lce_workbench.core.units import UM
from lce_workbench.core.weight import loaded

NEAR = 16
"""The domains that share area with a triangle are looked for among so many with the nearest centres."""


@dataclass(frozen=True, eq=False)
class Bench:
    """What every sample of a study starts from."""

    plan: Design
    """The design; its surface is the target."""
    domains: Domains
    film: Film
    """The film as the molds make it, without fault."""
    spec: PredictionSpec


def bench(plan: Design, domains: Domains, spec: PredictionSpec) -> Bench:
    """Prepare the film of a design for the samples of a study."""
    return Bench(plan, domains, loaded(film_of(as_made(plan, domains)), spec), spec)


IMPERFECTION = "imperfection"
"""The value that is no fault of the film, but of its start: what `predict` calls so."""
Fault = Callable[..., Film]
"""From the bench, a random generator and the values of a `Study` to the film."""


def _rough(at: Bench, _: np.random.Generator, imperfection: float) -> Film:  # noqa: ARG001
    return at.film


def _twisted(at: Bench, _: np.random.Generator, gain: float, overdrive: float) -> Film:
    """Twist times ``gain``; with ``overdrive`` 1 also times the paper's factor near the edge."""
    factor = edge_factor(at.plan.uv, at.plan.surface.faces) if overdrive else 1.0
    return replace(at.film, dtheta=gain * factor * at.film.dtheta)


def _at_lambda(at: Bench, _: np.random.Generator, percent: float) -> Film:
    matter = at.film.material
    return replace(at.film, material=replace(matter, lambda_=1 + (matter.lambda_ - 1) * (1 + percent / 100)))


def _at_nu(at: Bench, _: np.random.Generator, change: float) -> Film:
    matter = at.film.material
    return replace(at.film, material=replace(matter, nu=matter.nu + change))


def _thicker(at: Bench, _: np.random.Generator, percent: float) -> Film:
    return loaded(replace(at.film, thickness=at.film.thickness * (1 + percent / 100)), at.spec)


def _noisy(at: Bench, rng: np.random.Generator, deviation_deg: float) -> Film:
    noise = np.deg2rad(deviation_deg) * rng.standard_normal(len(at.domains))
    return _of_domains(at, replace(at.domains, theta=line_angle(at.domains.theta + noise)))


def _rounded(at: Bench, _: np.random.Generator, step_deg: float) -> Film:
    """As the masks would be: the angle of each plate is rounded."""
    if step_deg == 0:
        return at.film
    step = np.deg2rad(step_deg)
    bottom, top = (step * np.round((at.domains.theta + s * at.domains.dtheta / 2) / step) for s in (-1, 1))
    return _of_domains(at, replace(at.domains, theta=line_angle((bottom + top) / 2), dtheta=top - bottom))


def _of_domains(at: Bench, domains: Domains) -> Film:
    made = as_made(at.plan, domains)
    return replace(at.film, theta=made.theta, dtheta=made.dtheta)


def _misaligned(at: Bench, rng: np.random.Generator, shift_um: float, rotation_deg: float) -> Film:
    """The top plate is shifted in a random direction, and turned about the sheet's middle in a random sense."""
    direction, sense = rng.uniform(0, 2 * np.pi), rng.choice([-1, 1])
    shift = shift_um * UM * np.array([np.cos(direction), np.sin(direction)])
    return misaligned(at, shift, sense * np.deg2rad(rotation_deg))


def misaligned(at: Bench, shift: Floats, rotation: float) -> Film:
    """The film between plates of which the top one is turned by ``rotation`` [rad], then moved by ``shift`` (2,) [mm].

    Every triangle gets the mean directions (as lines) of the parts of top and bottom domains that face each other in
    it: a film evens out what is narrower than its thickness. Beyond the top plate's pattern its nearest domain goes on.
    """
    if rotation == 0 and not np.any(shift):
        return at.film
    c, s = np.cos(rotation), np.sin(rotation)
    seen = ((at.plan.uv - shift) @ np.array([[c, -s], [s, c]]))[at.plan.surface.faces]
    count = min(NEAR, len(at.domains))
    near = np.asarray(cKDTree(at.domains.centroid).query(seen.mean(axis=1), k=count)[1]).reshape(len(seen), count)
    share = shared_area(np.repeat(seen, count, axis=0), at.domains.corners[near.ravel()]).reshape(near.shape)
    share[share.sum(axis=1) <= 0, 0] = 1.0
    lines = np.exp(2j * at.domains.angle("top"))[near]
    top = np.angle((share * lines).sum(axis=1)) / 2 + rotation
    bottom = at.film.theta - at.film.dtheta / 2
    twist = line_angle(top - bottom + np.pi / 2) - np.pi / 2
    return replace(at.film, theta=line_angle(bottom + twist / 2), dtheta=twist)


@dataclass(frozen=True)
class Study:
    """One question to the simulation, with the values that are tried."""

    question: str
    axis: str
    """What the values are, with their unit."""
    values: tuple[dict[str, float], ...]
    """Arguments of ``fault``, one set for each point of the table; the plain film is among them."""
    fault: Fault


def _each(name: str, *values: float) -> tuple[dict[str, float], ...]:
    return tuple({name: value} for value in values)


STUDIES: dict[str, Study] = {
    "robustness": Study(
        "How uneven may the film be at the start and still reach the target, unmirrored?",
        "imperfection [thicknesses]",
        _each(IMPERFECTION, 0.001, 0.005, 0.02, 0.1, 0.5),
        _rough,
    ),
    "twist": Study(
        "How strongly does the twist bias the sheet to the right side: none, half, as designed, double, wrong sign, "
        "and as designed but overdriven at the edge?",
        "twist [of the design's], edge overdriven (0, 1)",
        tuple(
            {"gain": gain, "overdrive": edge}
            for gain, edge in ((0.0, 0.0), (0.5, 0.0), (1.0, 0.0), (2.0, 0.0), (-1.0, 0.0), (1.0, 1.0))
        ),
        _twisted,
    ),
    "misalignment": Study(
        "How far may the plates be shifted and turned against each other?",
        "shift [um], rotation [deg]",
        tuple(
            {"shift_um": shift, "rotation_deg": turn}
            for shift, turn in ((0, 0), (5, 0), (10, 0), (20, 0), (0, 0.25), (0, 0.5), (0, 1), (10, 1))
        ),
        _misaligned,
    ),
    "lambda": Study(
        "What if the film stretches otherwise along the director than its material says?",
        "change of the strain lambda - 1 [%]",
        _each("percent", -20, -10, -5, 0, 5, 10, 20),
        _at_lambda,
    ),
    "nu": Study(
        "What if the film stretches otherwise across the director than its material says?",
        "change of nu",
        _each("change", -0.1, -0.05, -0.02, 0.0, 0.02, 0.05, 0.1),
        _at_nu,
    ),
    "gap": Study(
        "What if the film is thinner or thicker than the spacer says?",
        "change of the thickness [%]",
        _each("percent", -50, -20, -10, 0, 10, 20, 50),
        _thicker,
    ),
    "director_noise": Study(
        "How exactly must the director follow the channels?",
        "deviation of the director [deg]",
        _each("deviation_deg", 0, 1, 2, 5, 10),
        _noisy,
    ),
    "rounding": Study(
        "How coarsely may the channels' angles be rounded on the masters?",
        "angles rounded to [deg]",
        _each("step_deg", 0, 0.1, 0.5, 1, 2, 5, 15),
        _rounded,
    ),
}
