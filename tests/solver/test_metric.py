"""The metric solver against its definition, exact solutions and the paper's method."""

from dataclasses import replace

import numpy as np
import pytest
from targets import COOLED, LCE, flat, hill, line_difference, mirrored, moved, patch, ramp, renumbered, scaled

from lce_solver import judge
from lce_solver.contest import compete, ranking
from lce_solver.errors import Cancelled
from lce_solver.geometry import face_areas
from lce_solver.metric import Stop, flatten, lay_flat, local_global
from lce_solver.plane import convex_map
from lce_solver.surfaces import SURFACES
from lce_solver.types import Material, Start, Status, Surface
from lce_solver.wirtinger import director, energy, operator, stretched

STRETCHES = (LCE.along, LCE.across)
EXACT = Stop(1e-14, 20000)


def a_map(surface, seed=3):
    """A valid map of the surface that solves nothing, as complex numbers."""
    uv = convex_map(surface) @ [[1.3, 0.4], [-0.2, 0.8]]
    noise = np.random.default_rng(seed).normal(scale=0.005, size=uv.shape)
    assert len(judge.flipped(uv + noise, surface.faces)) == 0
    return (uv + noise) @ (1, 1j)


def plane(w):
    return np.column_stack([w.real, w.imag])


def rms(surface, uv, material):
    return judge.rms(judge.stretch_errors(judge.stretches(surface, uv, material), material), face_areas(surface))


@pytest.mark.parametrize("material", [LCE, COOLED])
def test_energy_is_the_one_of_singular_values(material):
    surface = hill()
    w = a_map(surface)
    large_first = 1 / np.linalg.svd(judge.jacobians(surface, plane(w)), compute_uv=False)[:, ::-1]
    wanted = np.sort([1 / material.along, 1 / material.across])[::-1]
    area = face_areas(surface)
    by_definition = 0.5 * np.average(((large_first - wanted) ** 2).sum(axis=1), weights=area)
    value, _ = energy(operator(surface), w, (material.along, material.across))
    assert value == pytest.approx(by_definition, rel=1e-12)


@pytest.mark.parametrize("material", [LCE, COOLED])
def test_gradient_is_the_derivative(material):
    surface = hill(4, 3)
    op, w, stretches = operator(surface), a_map(surface), (material.along, material.across)
    _, gradient = energy(op, w, stretches)
    step = 1e-5
    for unit in (1, 1j):
        for vertex in range(len(w)):
            nudge = step * unit * (np.arange(len(w)) == vertex)
            slope = (energy(op, w + nudge, stretches)[0] - energy(op, w - nudge, stretches)[0]) / (2 * step)
            assert slope == pytest.approx((gradient[vertex] * np.conj(unit)).real, abs=1e-7 * np.abs(gradient).max())


@pytest.mark.parametrize("material", [LCE, COOLED])
def test_director_is_the_singular_direction(material):
    """The sheet's direction that f stretches by lambda, from an SVD of f."""
    surface = hill()
    w = a_map(surface)
    _, _, right = np.linalg.svd(judge.jacobians(surface, plane(w)))
    row = right[:, 0 if material.along > material.across else 1]
    expected = np.arctan2(row[:, 1], row[:, 0])
    found = director(operator(surface), w, (material.along, material.across))
    assert line_difference(found, expected).max() < 1e-9
    assert found.min() >= 0
    assert found.max() < np.pi


@pytest.mark.parametrize("angle", [0.0, 0.7, 2.0])
@pytest.mark.parametrize("material", [LCE, COOLED])
def test_flat_target_is_met_exactly(material, angle):
    surface = moved(flat())
    result = flatten(lay_flat(surface), (material.along, material.across), angle)
    assert result.status is Status.CONVERGED
    assert rms(surface, result.uv, material) < 1e-10
    assert line_difference(result.theta, angle).max() < 1e-8


def test_equal_stretches_scale_a_flat_target():
    surface = flat()
    result = flatten(lay_flat(surface), (0.8, 0.8), 0.3)
    stretch = np.linalg.svd(judge.jacobians(surface, result.uv), compute_uv=False)
    np.testing.assert_allclose(stretch, 0.8, rtol=1e-10)


def test_rolled_sheet_is_unrolled():
    """A cylinder is developable: the vertices of its chords lie on a flat sheet up to O(h^2)."""
    error = []
    for n in (8, 16):
        surface = patch(lambda x, y: (np.sin(x), y, np.cos(x)), n, n)[1]
        error.append(rms(surface, flatten(lay_flat(surface), STRETCHES, 0.0).uv, LCE))
    assert error[0] < 5e-3
    assert np.log2(error[0] / error[1]) > 1.5


@pytest.mark.parametrize("name", ["dome", "sphere-zone", "cone", "saddle"])
def test_residual_falls_with_the_mesh(name):
    """A smooth solution exists, so what is left is the mesh: first order."""
    error = []
    for edge in (0.09, 0.03):
        _, starts = compete(SURFACES[name](edge), LCE, starts=2, stop=Stop(1e-5))
        error.append(min(start.rms for start in starts))
    assert np.log(error[0] / error[1]) / np.log(3) > 0.7, error


@pytest.mark.parametrize("change", [moved, lambda s: scaled(s, 1e3), lambda s: scaled(s, 1e-3)])
def test_position_and_unit_of_the_target_do_not_matter(change):
    surface = hill()
    before, after = (flatten(lay_flat(s), STRETCHES, 0.4, EXACT) for s in (surface, change(surface)))
    assert after.energy[-1] == pytest.approx(before.energy[-1], rel=1e-8)
    assert line_difference(before.theta, after.theta).max() < 1e-4


def test_numbering_of_the_target_does_not_matter():
    surface = hill()
    other, faces = renumbered(surface)
    before, after = (flatten(lay_flat(s), STRETCHES, 0.4, EXACT) for s in (surface, other))
    assert after.energy[-1] == pytest.approx(before.energy[-1], rel=1e-8)
    assert line_difference(before.theta[faces], after.theta).max() < 1e-4


def test_mirrored_target_mirrors_the_director():
    surface = hill()
    before = flatten(lay_flat(surface), STRETCHES, 0.4, EXACT)
    after = flatten(lay_flat(mirrored(surface)), STRETCHES, -0.4, EXACT)
    assert after.energy[-1] == pytest.approx(before.energy[-1], rel=1e-8)
    assert line_difference(before.theta, -after.theta).max() < 1e-4


def test_local_global_step_is_projection_and_least_squares():
    """One iteration against the paper's two steps written out with an SVD and a dense solve."""
    surface = hill(5, 4)
    rigid = lay_flat(surface)
    result = local_global(rigid, STRETCHES, 0.3, Stop(1e-8, 1))
    start = plane(stretched(rigid.w, STRETCHES, 0.3))
    edges = np.moveaxis(np.diff(surface.vertices[surface.faces], axis=1), 1, 2)
    to_edges = np.diff(np.eye(len(start))[surface.faces], axis=1)  # (n_f, 2, n_v)
    gradient = np.linalg.pinv(edges).transpose(0, 2, 1) @ to_edges  # (n_f, 3, n_v): plane coordinate -> its slope
    slopes = np.einsum("fin,nk->fki", gradient, start)
    left, _, right = np.linalg.svd(slopes, full_matrices=False)
    nearest = left @ np.diag(np.sort([1 / s for s in STRETCHES])[::-1]) @ right
    weight = np.sqrt(face_areas(surface))
    system = (weight[:, None, None] * gradient).reshape(-1, len(start))
    wanted = (weight[:, None, None] * nearest.transpose(0, 2, 1)).reshape(-1, 2)
    expected = np.linalg.lstsq(system, wanted, rcond=None)[0]
    np.testing.assert_allclose(np.ptp(result.uv - expected, axis=0), 0, atol=1e-12)


@pytest.mark.parametrize("name", ["dome", "face"])
def test_both_methods_reach_the_same_energy(name):
    rigid = lay_flat(SURFACES[name](0.07))
    fast = flatten(rigid, STRETCHES, 0.2)
    slow = local_global(rigid, STRETCHES, 0.2, Stop(1e-7, 20000))
    assert fast.energy[-1] == pytest.approx(slow.energy[-1], rel=0.01)
    assert np.all(np.diff(fast.energy) <= 0)
    assert np.all(np.diff(slow.energy) <= 0)
    assert fast.iterations < slow.iterations / 2


def test_iteration_limit_is_reported():
    result = flatten(lay_flat(hill()), STRETCHES, 0.0, Stop(1e-8, 3))
    assert result.status is Status.ITERATION_LIMIT
    assert result.iterations == 3


def test_fold_is_reported():
    rigid = lay_flat(flat())
    folded = np.abs(rigid.w.real) + 1j * rigid.w.imag
    result = flatten(replace(rigid, w=folded), (1.0, 1.0), 0.0, Stop(1e-8, 0))
    uv = plane(folded)
    turned = np.flatnonzero(np.linalg.det(np.diff(uv[rigid.surface.faces], axis=1)) <= 0)
    assert result.status is Status.FLIPPED
    np.testing.assert_array_equal(result.flipped, turned)


def test_sheet_that_covers_itself_is_reported():
    surface = ramp()
    result = flatten(lay_flat(surface), STRETCHES, 0.0)
    assert len(result.flipped) == 0
    assert result.status is Status.OVERLAP
    for first, second in result.crossings:
        assert np.linalg.norm(result.uv[first] - result.uv[second]) < 1


def test_not_a_number_is_reported():
    rigid = lay_flat(flat())
    result = flatten(replace(rigid, w=rigid.w * np.nan), STRETCHES, 0.0)
    assert result.status is Status.NOT_FINITE


def test_crossings_agree_with_every_pair():
    rng = np.random.default_rng(5)
    points = rng.uniform(size=(60, 2))
    edges = np.column_stack([np.arange(60), np.roll(np.arange(60), -1)])

    def cross(a, b):
        (p, q), (r, s) = points[edges[a]], points[edges[b]]
        t = np.linalg.solve(np.column_stack([q - p, r - s]), r - p)
        return bool(np.all((t > 0) & (t < 1)))

    apart = [(a, b) for a in range(60) for b in range(a + 1, 60) if not set(edges[a]) & set(edges[b])]
    expected = {pair for pair in apart if cross(*pair)}
    assert {tuple(pair) for pair in judge.crossings(points, edges)} == expected
    assert len(expected) > 100


def test_touching_outline_counts_as_crossing():
    points = np.array([[0, 0], [2, 0], [2, 1], [1, 0], [0, 1.0]])
    edges = np.column_stack([np.arange(5), np.roll(np.arange(5), -1)])
    assert {(0, 2), (0, 3)} == {tuple(pair) for pair in judge.crossings(points, edges)}


@pytest.mark.parametrize("name", SURFACES)
def test_first_map_is_valid(name):
    surface = SURFACES[name](0.08)
    assert len(judge.flipped(convex_map(surface), surface.faces)) == 0


def test_first_map_takes_a_corner_of_nearly_180_degrees():
    points = np.array([(0, 0, 0), (2, 0, 0), (1, 1, 0), (1, -1, 0), (1, 1e-9, 0)], float)
    faces = np.array([(0, 3, 1), (0, 1, 4), (0, 4, 2), (4, 1, 2)])
    uv = convex_map(Surface(points, faces))
    assert len(judge.flipped(uv, faces)) == 0
    assert uv[4] == pytest.approx(uv[[0, 1]].mean(axis=0), abs=1e-6)  # on the edge that it all but touches


def test_best_start_wins():
    """On this saddle the smallest rms is not the best: the director must lie across the principal curvatures."""
    surface = SURFACES["saddle"](0.06)
    (winner, *_), starts = compete(surface, LCE, starts=4, stop=Stop(1e-6))
    best = min(starts, key=lambda start: start.score)
    assert winner.start == best
    assert rms(surface, winner.flat.uv, LCE) == pytest.approx(best.rms)
    assert best.score < 0.9 * max(start.score for start in starts)


def first_of(starts):
    return ranking(starts)[0]


def test_valid_starts_come_before_good_scores():
    def start(rms, left, flipped=0, crossings=0):
        return Start(0.0, Status.CONVERGED, rms, left, flipped, crossings)

    assert (
        first_of([start(0.01, 0.5, flipped=1), start(0.02, 0.9), start(0.03, 0.5), start(0.001, 0.1, crossings=1)]) == 2
    )
    assert first_of([start(0.01, 0.5), start(0.01 - 1e-12, 0.5)]) == 0  # a tie but for rounding
    assert first_of([start(0.01, 0.5, flipped=3), start(0.02, 0.5, flipped=1)]) == 1


def test_progress_runs_to_one_and_can_stop():
    heard = []
    finalists, _ = compete(hill(), LCE, starts=2, progress=lambda stage, fraction: heard.append((stage, fraction)))
    found = finalists[0].flat
    fractions = [fraction for _, fraction in heard]
    assert fractions == sorted(fractions)
    assert fractions[0] == 0
    assert heard[-1] == ("flatten", 1)
    energies = [stage.energy for stage, _ in heard[:-1]]
    assert min(energies) > 0
    assert found.energy[-1] < energies[-1] < (1 + 1e-4) * found.energy[-1]  # told before the last iteration

    def stop(stage, fraction):
        if fraction > 0.3:
            raise Cancelled

    with pytest.raises(Cancelled):
        compete(hill(), LCE, starts=2, progress=stop)


def test_two_runs_are_identical():
    first, second = (compete(hill(), Material(0.7, 0.3), starts=2)[0][0].flat for _ in range(2))
    np.testing.assert_array_equal(first.uv, second.uv)
    np.testing.assert_array_equal(first.theta, second.theta)
