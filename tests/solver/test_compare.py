from dataclasses import replace

import numpy as np
import pytest
import trimesh
from flatsheets import disk, rectangle
from meshes import octahedron
from scipy.spatial.transform import Rotation

from lce_solver.compare import (
    Verdict,
    align,
    angle_deficit,
    compare,
    distance_to_surface,
    distance_to_triangle,
    hausdorff,
    residual_strain,
    vertex_areas,
)
from lce_solver.design import design
from lce_solver.shell import film_of, predict, settle
from lce_solver.types import Design, Flattening, Material, Prediction, Status, Surface

LCE = Material(0.6, 0.5)
TURN = Rotation.from_rotvec([0.4, -1.1, 0.7]).as_matrix()
MIRROR = np.diag([1.0, 1.0, -1.0])


def bumpy(rings=8):
    """A surface without symmetry."""
    uv, faces = disk(rings)
    x, y = uv.T
    return np.column_stack([x, y, 0.3 * x**2 - 0.2 * x * y + 0.1 * y**3]), faces


# --- alignment ---------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("reflect", [False, True])
@pytest.mark.parametrize("factor", [1.0, 2.5])
def test_a_known_motion_is_recovered(reflect, factor):
    points, faces = bumpy()
    motion = TURN @ MIRROR if reflect else TURN
    there = factor * points @ motion.T + (1, -2, 3)
    found = align(points, there, vertex_areas(points, faces), reflect=reflect, scale=factor != 1)
    assert np.abs(found.rotation - motion).max() < 1e-12
    assert np.abs(found.moved - there).max() < 1e-12 * 10
    assert found.scale == pytest.approx(factor, rel=1e-12)
    assert found.rms < 1e-12


def test_without_reflection_a_mirror_image_stays_away_and_the_other_way_round():
    points, faces = bumpy()
    weights = vertex_areas(points, faces)
    assert align(points, points @ MIRROR, weights).rms > 0.05
    assert align(points, points, weights, reflect=True).rms > 0.05
    assert np.linalg.det(align(points, points, weights, reflect=True).rotation) == pytest.approx(-1)


def test_no_motion_fits_better():
    """The optimum is stationary: small rotations and shifts only add to the weighted squares."""
    points, faces = bumpy()
    weights = vertex_areas(points, faces)
    other = points + 0.05 * np.random.default_rng(0).standard_normal(points.shape)
    best = align(points, other, weights)
    for seed in range(8):
        vector = 1e-3 * np.random.default_rng(seed).standard_normal((2, 3))
        moved = best.moved @ Rotation.from_rotvec(vector[0]).as_matrix().T + vector[1]
        assert np.average(((moved - other) ** 2).sum(axis=1), weights=weights) > best.rms**2


def test_weights_are_areas():
    """The rms does not move when one half of the mesh is refined."""
    uv, faces = rectangle(12, 12, 1, 1, jitter=0)
    stretched = np.sign(uv[:, 0]) * np.abs(2 * uv[:, 0]) ** 1.5 / 2  # the same plane, other vertices
    shapes = [np.column_stack([x, uv[:, 1], 0.2 * x**2]) for x in (uv[:, 0], stretched)]
    flat = [np.column_stack([x, uv[:, 1], 0 * x]) for x in (uv[:, 0], stretched)]
    one, two = (align(s, f, vertex_areas(f, faces)).rms for s, f in zip(shapes, flat, strict=True))
    assert two == pytest.approx(one, rel=0.05)


# --- distances ---------------------------------------------------------------------------------------------------


def test_distance_to_a_triangle_agrees_with_trimesh():
    rng = np.random.default_rng(0)
    corners, points = rng.normal(size=(3000, 3, 3)), rng.normal(size=(3000, 3))
    corners[:100, 2] = corners[:100, 1]  # degenerate
    corners[:100, 0] = corners[:100, 1] + rng.normal(size=(100, 3))
    reference = np.linalg.norm(trimesh.triangles.closest_point(corners[100:], points[100:]) - points[100:], axis=1)
    assert np.abs(distance_to_triangle(points, corners)[100:] - reference).max() < 1e-12
    assert np.isfinite(distance_to_triangle(points, corners)).all()


def test_distance_to_a_surface_is_the_least_over_all_triangles():
    vertices, faces = bumpy(6)
    vertices = vertices * (5, 0.3, 1)  # slivers: the nearest centre is often not the nearest triangle
    points = np.random.default_rng(1).normal(size=(80, 3)) * (5, 1, 1)
    every = [distance_to_triangle(np.broadcast_to(p, (len(faces), 3)), vertices[faces]).min() for p in points]
    assert np.abs(distance_to_surface(points, vertices, faces) - every).max() < 1e-13


def test_hausdorff_sees_a_dent_from_both_sides():
    uv, faces = rectangle(10, 10, 1, 1, jitter=0)
    flat = np.column_stack([uv, 0 * uv[:, 0]])
    dented = flat.copy()
    dented[np.argmin(np.hypot(*uv.T)), 2] = 0.25
    assert hausdorff(flat, flat + np.array([0, 0, 0.125]), faces) == pytest.approx(0.125, rel=1e-12)
    assert hausdorff(dented, flat, faces) == hausdorff(flat, dented, faces) == pytest.approx(0.25, rel=1e-12)
    assert hausdorff(flat[:, [1, 0, 2]], flat, faces) < 1e-15  # other vertices, the same square


# --- intrinsic measures ------------------------------------------------------------------------------------------


def test_angle_deficits_of_a_closed_surface_sum_to_four_pi():
    assert angle_deficit(*octahedron()).sum() == pytest.approx(4 * np.pi, rel=1e-14)


def test_angle_deficits_of_a_cone_are_at_its_tip():
    uv, faces = disk(8, jitter=0)
    r = np.hypot(*uv.T)
    half = np.radians(40)
    cone = np.column_stack([uv * np.sin(half), r * np.cos(half)])
    deficit = angle_deficit(cone, faces)
    pyramid = 12 * np.arcsin(np.sin(half) * np.sin(np.pi / 6))  # the tip is a hexagonal one
    assert deficit[0] == pytest.approx(2 * np.pi - pyramid, rel=1e-12)
    assert not deficit[r > 1 - 1e-9].any()


def test_residual_strain_is_the_rms_of_both_errors():
    uv, faces = disk(4)
    theta = np.full(len(faces), 0.3)
    frame = np.array([[np.cos(0.3), -np.sin(0.3)], [np.sin(0.3), np.cos(0.3)]])
    map_ = frame @ np.diag([LCE.along * 1.02, LCE.across * 0.99]) @ frame.T
    bent = np.column_stack([uv @ map_.T, 0 * uv[:, 0]]) @ TURN.T
    assert residual_strain(uv, faces, theta, LCE, bent) == pytest.approx(np.sqrt((0.02**2 + 0.01**2) / 2), rel=1e-10)
    other = residual_strain(uv, faces, theta + 1, LCE, bent)
    assert other > 0.3


# --- verdicts ----------------------------------------------------------------------------------------------------


def roll(uv, axis):
    """The flat sheet rolled about one of its axes: all are isometric."""
    u, v = np.roll(uv, axis, axis=1).T
    rolled = np.column_stack([np.sin(1.5 * u) / 1.5, v, (1 - np.cos(1.5 * u)) / 1.5])
    return rolled[:, [1, 0, 2]] if axis else rolled


def judged(shape, settled=None, status=Status.CONVERGED):
    """The verdict on a shape, the target being the rolled sheet."""
    uv, faces = rectangle(10, 10, 1, 1)
    n = len(faces)
    sheet = Design(
        surface=Surface(roll(uv, 0), faces),
        uv=uv,
        theta=np.zeros(n),
        dtheta=np.zeros(n),
        stretch=np.ones((n, 2)),
        material=LCE,
        thickness=0.1,
        flattening=Flattening(uv, np.zeros(n), Status.CONVERGED, np.zeros(1), 0, (), np.empty((0, 2))),
        bending_left=0.0,
    )
    one, other = (s if s is None else s(uv) for s in (shape, settled))
    runs = [s if s is None else Prediction(s, 2.0, 1.0, 0.0, status, (), s[None]) for s in (one, other)]
    return compare(sheet, *runs)


def test_verdict_target():
    found = judged(lambda uv: roll(uv, 0) @ TURN.T + 3)
    assert found.verdict is Verdict.TARGET
    assert found.rms_pct < 1e-12 * 100
    assert found.hausdorff_pct < 1e-10
    assert not found.mirrored
    assert found.energy_ratio is None
    assert found.curvature == pytest.approx(found.target_curvature, abs=1e-12)


def test_verdict_mirror():
    """A cylinder is its own mirror image as a surface, but not as a sheet: what was the top is inside now."""
    found = judged(lambda uv: roll(uv, 0) @ MIRROR @ TURN.T)
    assert found.verdict is Verdict.MIRROR
    assert found.mirrored
    assert found.mirror_rms_pct < 1e-10
    assert found.rms_pct > 1


def test_verdict_isometry():
    found = judged(lambda uv: roll(uv, 1), lambda uv: roll(uv, 0))
    assert found.verdict is Verdict.ISOMETRY
    assert found.energy_ratio == 1
    assert found.settled_rms_pct == pytest.approx(found.rms_pct)


def test_verdict_equilibrium():
    """The run from the target goes to the same wrong shape: then no path leads to the target."""
    assert judged(lambda uv: roll(uv, 1), lambda uv: roll(uv, 1) @ TURN.T).verdict is Verdict.EQUILIBRIUM


def test_verdict_not_converged():
    assert judged(lambda uv: roll(uv, 0), status=Status.ITERATION_LIMIT).verdict is Verdict.NOT_CONVERGED


def test_verdict_depends_on_the_reach():
    assert judged(lambda uv: roll(uv, 0) * 1.05).verdict is Verdict.ISOMETRY
    found = judged(lambda uv: roll(uv, 0) * 1.05)
    assert found.scale == pytest.approx(1 / 1.05)
    assert found.scaled_rms_pct < 1e-10


# --- the whole way: target, design, heating, verdict ---------------------------------------------------------------


@pytest.fixture(scope="module")
def hills():
    """Hills and a hollow on a round sheet of 20 mm, designed for a film of 0.1 mm."""
    uv, faces = disk(14, jitter=0.1)
    x, y = uv.T
    places = ((0.45, 0.1, 0.22), (-0.35, 0.4, -0.2), (-0.2, -0.45, 0.22))
    z = sum(h * np.exp(-((x - a) ** 2 + (y - b) ** 2) / 0.08) for a, b, h in places)
    return design(Surface(np.column_stack([x, y, z]), faces), LCE, 20.0, 0.1, starts=4)


def test_hills_and_hollows_are_reached_from_flat_and_a_flipped_twist_gives_the_mirror(hills):
    flat = film_of(hills)
    settled = settle(flat, hills.surface.vertices)
    straight, flipped = predict(flat, seed=1), predict(replace(flat, dtheta=-flat.dtheta), seed=1)
    right, wrong = compare(hills, straight, settled), compare(hills, flipped, settled)
    assert right.verdict is Verdict.TARGET
    assert right.rms_pct < 1
    assert right.energy_ratio == pytest.approx(1, abs=2e-3)
    assert right.residual_strain_rms == pytest.approx(straight.residual_strain, rel=1e-9)
    assert wrong.verdict is Verdict.MIRROR
    assert wrong.mirror_rms_pct < 1
    assert flipped.energy == pytest.approx(straight.energy, rel=1e-4)
