"""A design that arrives: director and twist corrected until the heated sheet, not only its metric, is the target.

The equilibrium x of a pattern p (director and twist) has zero gradient g(x, p). A small change of the pattern moves it
by dx with ``H dx + G dp = -g``. The correction minimises

    |x + dx - target|^2 / (CLOSE diagonal)^2 + sum |p + dp|^2 / (size of a change)^2,

both area means, changes smooth over `REACH` [mm], by Gauss-Newton steps; after each the sheet relaxes (a step that
does not help is cut), and after each round the sheet is heated from flat, because only that tells where it goes.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from scipy import sparse
from scipy.sparse.linalg import splu

from lce_solver.compare import align, residual_strain, vertex_areas
from lce_solver.onset import Onset, onset
from lce_solver.shell import Film, film_of, predict, settle
from lce_solver.shell_energy import energy, hessian, pattern_forces
from lce_solver.types import (
    Design,
    Finding,
    Floats,
    Ints,
    Prediction,
    Progress,
    Severity,
    Stage,
    Status,
    line_angle,
    silent,
)

PARTS = {"dtheta": (1,), "full": (0, 1)}
"""What may change: columns of the pattern, 0 the director and 1 the twist."""
CLOSE = 3e-4
"""Distance from the target that weighs as much as a change of the usual size [diagonals of the target]."""
USUAL = np.deg2rad([2.0, 0.5])
"""Usual size of a change of director and of twist [rad]."""
REACH = 0.3
"""Changes are smooth over this length [mm]: a domain, three thicknesses of the film."""
ENOUGH = 0.05
"""A sheet as near as this to its target is left as it is [% of the diagonal]."""
LOST = 1.0
"""Further away than this the sheet has not taken the target's shape [% of the diagonal]."""
ROUNDS, STEPS, CUTS = 3, 5, 4
"""Most heatings after which the sheet is corrected; steps of one correction; lengths tried of one step."""
HEATING = 0.2
"""Share of the heating in a round's time."""
SAME = 1.05
"""A sheet heated from flat that ends within this factor of the corrected equilibrium has found it."""
SAVED = 0.5
"""A step along which the side is held, and that saves less than this share of what the linear problem says, is tried
shorter too: it turns the director farther."""
GAIN = 0.95
"""A step that leaves more than this of the misfit is the last of its round."""
BIAS = 0.1
"""Least energy by which the twist has to favour the target over its mirror image where the flat sheet buckles, in
bending energies of a sheet without twist; doubled each time the sheet still ends in the mirror image."""
FIRM = 0.8
"""Share of it below which a sheet may still take the mirror image: of ten imperfections one did at 0.56."""
THINNER = 10.0
"""A film as many times thinner tells whether stiffness keeps a sheet from its target."""
CAPPED = 0.05
"""Share of the triangles with the largest twist allowed from which on the limit is what keeps a sheet away."""
MISSED = 0.01
"""Area rms of the stretches' errors at the target from which on the metric does."""
SEED = 1
"""Of the imperfection."""
LARGEST = 20_000
"""Triangles up to which designs are corrected: the cost grows faster than the rest of the job's."""


@dataclass(frozen=True, eq=False)
class Try:
    """One design on its way."""

    film: Film
    heated: Prediction
    rms: float
    """Distance of the heated sheet from the target [% of the diagonal]."""
    mirror: float
    """The same from its mirror image."""

    @property
    def mirrored(self) -> bool:
        """Whether the sheet took the mirror image."""
        return self.mirror < self.rms

    @property
    def firm(self) -> bool:
        """Whether the twist, and not chance, chose the side; or there is none to choose."""
        return not self.onset.buckled or self.onset.favour >= FIRM * BIAS

    @cached_property
    def onset(self) -> Onset:
        """Where it chose its side."""
        return onset(self.film, self.heated, mirrored=self.mirrored)


@dataclass(frozen=True, eq=False)
class State:
    """A pattern and its equilibrium."""

    x: Floats
    """(n_v, 3) [mm]."""
    change: Floats
    """(n_v, k) of director, twist or both at the vertices [rad]."""
    off: Floats
    """(n_v, 3) distance from the target [mm]."""
    misfit: float
    """What is minimised, twice."""


@dataclass(frozen=True, eq=False)
class Correction:
    """The least-squares problem of one design."""

    plan: Design
    film: Film
    limit: float
    """Largest twist [rad]."""
    columns: tuple[int, ...]
    lever: Floats
    """(n_f,) as in `Onset`."""
    least: float
    """Favour that the correction may not give away for a shape nearer to the target; -inf: all of it."""

    @cached_property
    def mean(self) -> Any:
        """Sparse (n_f, n_v): values at vertices to triangles."""
        faces = self.film.sheet.faces
        rows = np.arange(0, faces.size + 1, 3)
        shape = (len(faces), len(self.plan.uv))
        return sparse.csr_matrix((np.full(faces.size, 1 / 3), faces.ravel(), rows), shape=shape)

    @cached_property
    def weights(self) -> Floats:
        """(n_v,) of the squared distances from the target, in 1 / mm^2."""
        areas = vertex_areas(self.plan.surface.vertices, self.plan.surface.faces)
        scaled: Floats = areas / areas.sum() / (CLOSE * _diagonal(self.plan)) ** 2
        return scaled

    @cached_property
    def price(self) -> Any:
        """Sparse (k n_v, k n_v): what a change costs, column after column."""
        sheet = self.film.sheet
        total = sheet.area.sum()
        lumped = np.bincount(sheet.faces.ravel(), np.repeat(sheet.area / 3, 3)) / total
        gradients = sheet.slopes @ sheet.slopes.swapaxes(1, 2) * (sheet.area / total)[:, None, None]
        rough = _assemble(gradients, sheet.faces, sheet.faces, (len(sheet.uv), len(sheet.uv)))
        one = sparse.diags(lumped) + REACH**2 * rough
        return sparse.block_diag([one / USUAL[k] ** 2 for k in self.columns], format="csc")

    def pattern(self, change: Floats) -> Film:
        """The film with its director and twist changed, within the limit of the twist."""
        turn = np.zeros((len(self.film.theta), 2))
        turn[:, self.columns] = self.mean @ change
        twisted = np.clip(self.film.dtheta + turn[:, 1], -self.limit, self.limit)
        return replace(self.film, theta=self.film.theta + turn[:, 0], dtheta=twisted)

    def sided(self, at: Onset, change: Floats, wanted: float, *, hold: bool) -> Correction:
        """The same with twist that favours the target by ``wanted``, and if asked for the correction held to it."""
        film = replace(self.film, dtheta=self.film.dtheta + at.lacking(wanted))
        more = replace(self, film=film, lever=at.lever)
        favour = float(at.lever @ more.pattern(change).dtheta)
        return replace(more, least=min(wanted, favour) if hold else -np.inf)

    def state(self, x: Floats, change: Floats) -> State:
        """Measure the equilibrium ``x`` of a pattern."""
        off = x - align(self.plan.surface.vertices, x, self.weights).moved
        return State(x, change, off, self.misfit(off, change))

    def misfit(self, off: Floats, change: Floats) -> float:
        """What is minimised, of distances (n_v, 3) and changes (n_v, k)."""
        flat = change.T.ravel()
        return float(self.weights @ (off**2).sum(axis=1) + flat @ (self.price @ flat))

    def step(self, at: State) -> tuple[Floats, Floats]:
        """Changes of shape (n_v, 3) and pattern (n_v, k) that minimise the linearised misfit, the side held."""
        film = self.pattern(at.change)
        matrix, right = self.linearised(film, at)
        factors = splu(matrix, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=1e-3, options={"SymmetricMode": True})

        def solved(right: Floats) -> Floats:
            found = factors.solve(right)
            found += factors.solve(right - matrix @ found)
            return np.asarray(found)

        n, parts = len(at.x), len(self.columns)
        side = np.zeros_like(right)
        side[(2 + parts) * n : (3 + parts) * n] = (self.lever * (np.abs(film.dtheta) < self.limit)) @ self.mean
        found = solved(right)
        short = self.least - float(self.lever @ film.dtheta + side @ found)
        if short > 0 and side.any():
            held = solved(side)
            found += short / float(side @ held) * held
        return found[: 3 * n].reshape(n, 3), found[3 * n : (3 + parts) * n].reshape(parts, n).T

    def linearised(self, film: Film, at: State) -> tuple[Any, Floats]:
        """One symmetric indefinite system and its right-hand side: shape, pattern, multipliers of the equilibrium."""
        sheet, aim = film.sheet, film.at(film.material.lambda_)
        unit = replace(film, dtheta=np.ones_like(film.dtheta)).at(film.material.lambda_)
        n, n_f = len(at.x), len(film.theta)
        nodes = (3 * sheet.patch[:, :, None] + np.arange(3)).reshape(n_f, 18)
        blocks = hessian(sheet, aim, at.x).transpose(0, 1, 3, 2, 4).reshape(n_f, 18, 18)
        stiff = _assemble(blocks, nodes, nodes, (3 * n, 3 * n))
        forces = pattern_forces(sheet, aim, unit, at.x).reshape(n_f, 18, 2)
        forces[np.abs(film.dtheta) >= self.limit, :, 1] = 0.0
        each = np.arange(n_f)[:, None]
        pulls = [_assemble(forces[..., [k]], nodes, each, (3 * n, n_f)) @ self.mean for k in self.columns]
        scale = 1 / stiff.diagonal().mean()
        stiff, pull = scale * stiff, scale * sparse.hstack(pulls)
        distance = sparse.diags(np.repeat(self.weights, 3))
        hold = -1e-16 * sparse.identity(3 * n)  # rigid motions have no multiplier
        matrix = sparse.bmat([[distance, None, stiff], [None, self.price, pull.T], [stiff, pull, hold]], format="csc")
        off, cost = np.repeat(self.weights, 3) * at.off.ravel(), self.price @ at.change.T.ravel()
        return matrix, -np.concatenate([off, cost, scale * energy(sheet, aim, at.x)[1].ravel()])

    def descend(self, at: State, progress: Progress) -> State:
        """Gauss-Newton steps, each followed by the sheet's own relaxation, while they help."""
        for step in range(STEPS):
            before, at = at, self.along(at, *self.step(at), _within(progress, step / STEPS, step / STEPS))
            if at.misfit > GAIN * before.misfit:
                return at
        return at

    def along(self, at: State, moved: Floats, changed: Floats, progress: Progress = silent) -> State:
        """The best of shorter and shorter steps, down to the first that saves about what it should."""
        hoped = at.misfit - self.misfit(at.off + moved, at.change + changed)
        best, share = at, SAVED if np.isfinite(self.least) else 0.0
        for cut in 3.0 ** -np.arange(CUTS):
            change = at.change + cut * changed
            found = settle(self.pattern(change), at.x + cut * moved, progress=progress)
            there = self.state(found.vertices, change)
            worse, best = there.misfit > best.misfit, min(best, there, key=lambda state: state.misfit)
            if at.misfit - best.misfit > share * cut * hoped or (worse and best is not at):
                return best
        return best


def arrive(plan: Design, part: str, limit: float, progress: Progress = silent) -> tuple[Design, Finding]:
    """Correct a design until the sheet, heated from flat, takes its target's shape; say how near it comes.

    Parameters
    ----------
    part : a name in `PARTS`.
    limit : largest twist either way [rad].
    """
    if why := _hopeless(plan):
        return plan, Finding("equilibrium", Severity.INFO, f"director and twist are not corrected by simulation: {why}")
    columns = PARTS[part]
    change = np.zeros((len(plan.uv), len(columns)))
    work = Correction(plan, film_of(plan), limit, columns, lever=np.zeros_like(plan.theta), least=-np.inf)
    tries: list[Try] = []
    expected = 0.0
    for round_ in range(ROUNDS + 1):
        begin, corrected = round_ / (ROUNDS + 1), (round_ + HEATING) / (ROUNDS + 1)
        tries.append(heated(plan, work.pattern(change), _within(progress, begin, corrected)))
        last = tries[-1]
        if round_ == ROUNDS or (last.firm and last.rms < max(ENOUGH, SAME * expected)):
            break
        wanted = BIAS * 2 ** sum(t.mirrored for t in tries[1:])
        work = work.sided(last.onset, change, wanted, hold=any(t.rms < LOST and not t.firm for t in tries[1:]))
        start = plan.surface.vertices if last.rms > LOST else last.heated.vertices
        there = settle(work.pattern(change), start).vertices
        at = work.descend(work.state(there, change), _within(progress, corrected, (round_ + 1) / (ROUNDS + 1)))
        change, expected = at.change, float(np.sqrt(np.average((at.off**2).sum(axis=1), weights=work.weights)))
        expected *= 100 / _diagonal(plan)
    best = min(tries, key=lambda one: one.rms + LOST * (not one.firm))
    progress("equilibrium", 1.0)
    made = replace(plan, theta=line_angle(best.film.theta), dtheta=best.film.dtheta)
    return made, _told(plan, made, tries[0], best, limit)


def _within(progress: Progress, begin: float, end: float) -> Progress:
    """The progress of a part of the work, from 0 to 1: its minimisations, with their energy."""

    def tell(stage: str, fraction: float) -> None:
        if isinstance(stage, Stage):
            progress(Stage("equilibrium", stage.energy), begin + (end - begin) * fraction)

    return tell


def heated(plan: Design, film: Film, progress: Progress = silent) -> Try:
    """Heat the film from flat and measure how far from the target it ends."""
    found = predict(film, seed=SEED, progress=progress)
    target = plan.surface.vertices
    areas = vertex_areas(target, plan.surface.faces)
    direct, mirror = (align(found.vertices, target, areas, reflect=reflect).rms for reflect in (False, True))
    percent = 100 / _diagonal(plan)
    return Try(film, found, direct * percent, mirror * percent)


def _diagonal(plan: Design) -> float:
    return float(np.linalg.norm(np.ptp(plan.surface.vertices, axis=0)))


def _assemble(blocks: Floats, rows: Ints, columns: Ints, shape: tuple[int, int]) -> Any:
    """Sparse sum of (n, i, j) ``blocks`` at ``rows`` (n, i) and ``columns`` (n, j)."""
    row, column = np.broadcast_arrays(rows[:, :, None], columns[:, None, :])
    return sparse.coo_matrix((blocks.ravel(), (row.ravel(), column.ravel())), shape=shape).tocsc()


def _hopeless(plan: Design) -> str:
    """Why a design is left as it is; empty if it is not."""
    if plan.flattening.status is not Status.CONVERGED:
        return str(plan.flattening.status.value)
    if len(plan.theta) > LARGEST:
        return f"more than {LARGEST} triangles take hours"
    size = np.linalg.norm(np.ptp(plan.uv, axis=0))
    if abs(np.log(plan.material.along / plan.material.across)) < (plan.thickness / size) ** 2:
        return "lambda is so near to 1 that a film of this thickness stays flat"
    return ""


def _told(plan: Design, made: Design, first: Try, best: Try, limit: float) -> Finding:
    turned = np.rad2deg(np.abs((made.theta - plan.theta + np.pi / 2) % np.pi - np.pi / 2))
    twisted = np.rad2deg(np.abs(made.dtheta - plan.dtheta))
    text = f"heated from flat the sheet ends {best.rms:.2g}% rms of the diagonal from its target"
    if best is not first:
        text += (
            f", and {first.rms:.2g}% before the simulation corrected the director (by {_rms(turned):.1f} deg rms, "
            f"{turned.max():.1f} at most) and the twist (by {_rms(twisted):.1f}, {twisted.max():.1f})"
        )
    text += f"; where it buckles, its twist favours this side by {abs(best.onset.favour):.2g} of its bending energy"
    short = best.rms > LOST
    if short:
        text += f"; {_obstacle(plan, best, limit)}"
    return Finding("equilibrium", Severity.WARNING if short else Severity.INFO, text, best.rms, LOST, "%")


def _rms(values: Floats) -> float:
    return float(np.sqrt(np.mean(values**2)))


def _obstacle(plan: Design, best: Try, limit: float) -> str:
    """What keeps a sheet from its target."""
    if best.mirror < LOST:
        return f"it takes the mirror image: twist within {np.rad2deg(limit):.0f} deg is too weak to choose the side"
    film, target = best.film, plan.surface.vertices
    thin = replace(film, thickness=film.thickness / THINNER, dtheta=film.dtheta / THINNER)
    there, thinner = (_away(plan, settle(one, target)) for one in (film, thin))
    if there < LOST:
        return "it would stay at the target, but from flat it takes another shape with the same metric"
    capped = float(np.mean(np.abs(film.dtheta) > limit * (1 - 1e-6)))
    if capped > CAPPED:
        return (
            f"its twist is cut off at {np.rad2deg(limit):.0f} deg in {capped:.0%} of the triangles: "
            "raise sheet.twist_limit_deg, make the sheet wider or the film thinner"
        )
    if thinner < there / 2:
        return "its stiffness against bending keeps it away: make the sheet wider or the film thinner"
    if residual_strain(plan.uv, plan.surface.faces, film.theta, film.material, target) > MISSED:
        return "its director misses the target's metric: use smaller domains or choose lambda further from 1"
    return "many shapes have this metric, and the twist carries too little of the bending to choose among them"


def _away(plan: Design, found: Prediction) -> float:
    """Distance from the target [% of the diagonal]."""
    target = plan.surface.vertices
    return align(found.vertices, target, vertex_areas(target, plan.surface.faces)).rms * 100 / _diagonal(plan)
