"""From a target to a design: metric, then orientation and size of the sheet, then twist, and what was measured."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np

from lce_solver import judge
from lce_solver.assess import assess
from lce_solver.bounded import FOLLOWED, cost, retwisted
from lce_solver.contest import Finalist, compete
from lce_solver.errors import InputError
from lce_solver.family import steer
from lce_solver.feasible import bounded
from lce_solver.geometry import area_vectors, face_areas
from lce_solver.metric import Stop
from lce_solver.plane import rectangle_angles, turn
from lce_solver.twist import bending_left, second_form
from lce_solver.types import Design, Finding, Flattening, Floats, Material, Progress, Surface, line_angle, silent

SMOOTHING = 0.002
"""Takes the worst jumps of the director for no error of the stretches to speak of. Ten times as much halves the jumps
on a real face, but the sheet then ends farther from it."""
MOST_SMOOTHING, MOST_GAIN = 1e3, 1e3
"""Far beyond what is of use, far from where the solver's matrices lose their digits."""
SAME = 1e-3
"""Finalists whose scores differ by less than this part are one solution."""
SIDEWAYS = 0.1
"""If less than this of the x axis is seen along the mean normal, the y axis points right instead."""


def design(surface: Surface, material: Material, width: float, thickness: float, **how: Any) -> Design:
    """The best of `designs`, which says what ``how`` may be."""
    return next(designs(surface, material, width, thickness, **how))


def designs(
    surface: Surface,
    material: Material,
    width: float,
    thickness: float,
    *,
    twist_gain: float = 1.0,
    edge_overdrive: bool = False,
    twist_filter: float = FOLLOWED,
    twist_limit: float = np.inf,
    starts: int = 12,
    tolerance: float = 1e-8,
    max_iterations: int = 5000,
    smoothing: float = SMOOTHING,
    progress: Progress = silent,
) -> Iterator[Design]:
    """Design the flat sheet that heats into ``surface``: one of each finalist of the competition, the best first.

    A sheet with flipped triangles or a crossing outline comes back too, with findings of severity error: look at
    ``flattening.status`` before you call it a success.

    Parameters
    ----------
    surface : the target, in any unit of length.
    width : longest side of the sheet's bounding box [mm]; it fixes the size of the target too.
    thickness : of the film as prepared [mm].
    twist_gain : multiplies the twist; 2 gives the paper's S5 as printed, up to the stretch of the thickness.
    edge_overdrive : multiply the twist by the paper's ``1 + 5 exp(-d / 2 mm)``, d = distance to the sheet's edge.
    twist_filter : length over which the bending is averaged before the twist is taken from it [thicknesses].
    twist_limit : largest twist either way; what is beyond is cut off [rad].
    starts : number of directions of the first stretch that compete.
    smoothing : weight of the squared `smoothness.jumps` between triangles against the error of the stretches.

    Raises
    ------
    InputError
        Width or thickness is not a positive length, or a setting is out of its range.
    """
    for name, length in (("width", width), ("thickness", thickness)):
        if not (np.isfinite(length) and length > 0):
            msg = f"the sheet's {name} is {length:g} mm; give a positive length"
            raise InputError(msg)
    _check_settings(
        starts=(starts, 1, np.inf),
        max_iterations=(max_iterations, 1, np.inf),
        tolerance=(tolerance, 0, 1),
        smoothing=(smoothing, 0, MOST_SMOOTHING),
        twist_limit=(twist_limit, 0, np.inf),
        twist_filter=(twist_filter, 0, np.finfo(float).max),
        twist_gain=(twist_gain, -MOST_GAIN, MOST_GAIN),
    )
    stop = Stop(tolerance, max_iterations)
    finalists, competed = compete(surface, material, starts, stop, progress, smoothing=smoothing)
    for one in _distinct(finalists):
        flat = steer(surface, one.flat, material, stop, smoothing=smoothing)
        plan, form = _laid(surface, flat, material, width, thickness)
        records = tuple(replace(start, winner=start.angle == one.start.angle) for start in competed)
        plan = retwisted(
            replace(plan, starts=records),
            form,
            thickness,
            twist_gain=twist_gain,
            edge_overdrive=edge_overdrive,
            twist_filter=twist_filter,
            twist_limit=twist_limit,
        )
        yield replace(plan, findings=measured(plan, form, twist_limit))


def _check_settings(**ranges: tuple[float, float, float]) -> None:
    """Refuse, by name, what is not in its range: value, least, most."""
    for name, (value, least, most) in ranges.items():
        if not least <= value <= most:
            msg = f"{name} is {value:g}; give a number from {least:g} to {most:g}"
            raise InputError(msg)


def _distinct(finalists: tuple[Finalist, ...]) -> list[Finalist]:
    """Without those that are the same solution as a better one."""
    kept: list[Finalist] = []
    for one in finalists:
        if all(abs(one.start.score - other.start.score) > SAME * other.start.score for other in kept):
            kept.append(one)
    return kept


def _laid(
    surface: Surface, flat: Flattening, material: Material, width: float, thickness: float
) -> tuple[Design, Floats]:
    """A flattening at real size, lying as the target is seen, yet without twist; and its `second_form`."""
    angle = sheet_angle(flat.uv, surface)
    lying = turn(flat.uv, angle)
    low, high = lying.min(axis=0), lying.max(axis=0)
    scale = width / (high - low).max()
    target = Surface(surface.vertices * scale, surface.faces)
    uv = (lying - (low + high) / 2) * scale
    theta, form = line_angle(flat.theta + angle), second_form(target, uv)
    plan = Design(
        surface=target,
        uv=uv,
        theta=theta,
        dtheta=np.zeros_like(theta),
        stretch=judge.stretches(target, uv, material),
        material=material,
        thickness=thickness,
        flattening=replace(flat, uv=uv, theta=theta),
        bending_left=bending_left(form, theta, material, face_areas(target)),
    )
    return plan, form


def measured(result: Design, form: Floats, twist_limit: float) -> tuple[Finding, ...]:
    """What a design is worth; ``form`` is its `second_form`."""
    return (bounded(result.surface, result.material), *assess(result), cost(form, result, twist_limit))


def renewed(findings: tuple[Finding, ...], plan: Design, twist_limit: float) -> tuple[Finding, ...]:
    """The findings of a design whose director or twist was changed; what its solver said stays."""
    fresh = {one.check: one for one in measured(plan, second_form(plan.surface, plan.uv), twist_limit)}
    del fresh["solver"]  # it tells of all starts
    return tuple(fresh.get(one.check, one) for one in findings)


def sheet_angle(uv: Floats, surface: Surface) -> float:
    """Turn of the sheet that makes its smallest rectangle axis-parallel and the target's x and y come out best [rad].

    The target is seen against its mean normal, with its x axis (y when that is hidden) to the right.
    """
    quarter_turns = np.arange(4) * np.pi / 2
    candidates = (quarter_turns - rectangle_angles(uv)[:, None]).ravel()
    seen, flat = (points - points.mean(axis=0) for points in (_seen_from_above(surface), uv))
    agreement = (turn(flat[None], candidates[:, None]) * seen).sum(axis=(1, 2))
    return float(candidates[np.argmax(agreement)])


def _seen_from_above(surface: Surface) -> Floats:
    """(n_v, 2) the target in a view against its mean normal."""
    total = area_vectors(surface).sum(axis=0)
    normal = total / np.linalg.norm(total)
    right = next(e for e in np.eye(3)[:2] - np.outer(normal[:2], normal) if np.linalg.norm(e) > SIDEWAYS)
    right = right / np.linalg.norm(right)
    seen: Floats = surface.vertices @ np.column_stack([right, np.cross(normal, right)])
    return seen
