"""Domains that are not the design's triangles: their shape, their directors, what they do to the metric, the masks."""

from dataclasses import replace

import numpy as np
import pytest
from sheets import design
from targets import LCE, line_difference

from lce_solver import judge
from lce_solver.errors import InputError
from lce_solver.field import sample as exact
from lce_solver.field import sheet
from lce_solver.fields import FIELDS
from lce_solver.types import Flattening, Severity, Status
from lce_workbench.core.borders import borders, locate
from lce_workbench.core.channels import ChannelField
from lce_workbench.core.domains import PLATES, partition, signed_area
from lce_workbench.core.frame import arrange
from lce_workbench.core.job import ChannelSpec, DomainSpec, Job
from lce_workbench.core.mask import compose
from lce_workbench.core.mask_checks import check
from lce_workbench.core.partition import covered, divide
from lce_workbench.core.sampling import as_made, mismatch, sample
from lce_workbench.core.tessellation import TESSELLATIONS, voronoi
from lce_workbench.divided import arrays, read_domains
from lce_workbench.outputs import write_design

KINDS = ("triangles", "hexagons", "voronoi")
TURN = 2 * np.pi * np.arange(120) / 120
BEAN = (2.5 + 0.6 * np.cos(2 * TURN) + 0.3 * np.sin(3 * TURN))[:, None] * np.stack([np.cos(TURN), np.sin(TURN)], axis=1)


def of_field(name, edge, twist=0.03):
    """A design that becomes an exact surface; 1 mm is the field's unit."""
    field = FIELDS[name](LCE)
    uv, faces = sheet(field, edge)
    found = exact(field, uv, faces)
    stretch = judge.stretches(found.surface, uv, LCE)
    flat = Flattening(uv, found.theta, Status.CONVERGED, [0.0], 1, [], np.empty((0, 2)))
    plan = replace(
        design(2, 2), surface=found.surface, uv=uv, theta=found.theta, dtheta=twist * uv[faces].mean(axis=1)[:, 0],
        stretch=stretch, material=LCE, flattening=flat,
    )  # fmt: skip
    return field, plan


FIELD, PLAN = of_field("strip", 0.1)


def job(kind, size_um=200.0, align=False):
    return Job(domains=DomainSpec(kind=kind, size_um=size_um), channels=ChannelSpec(align_phase=align))


def convex(ring):
    edge = np.roll(ring, -1, axis=0) - ring
    after = np.roll(edge, -1, axis=0)
    return (edge[:, 0] * after[:, 1] - edge[:, 1] * after[:, 0] > 0).all()


@pytest.mark.parametrize("kind", TESSELLATIONS)
def test_pieces_are_convex_disjoint_and_cover_the_sheet(kind):
    rings = TESSELLATIONS[kind]([BEAN], 0.3)
    assert all(convex(ring) for ring in rings)
    area = np.array([signed_area(ring[None])[0] for ring in rings])
    whole = signed_area(BEAN[None])[0]
    assert 0.998 < area.sum() / whole <= 1 + 1e-12
    nominal = 0.3**2 * np.sqrt(3) / 2
    assert np.median(area) == pytest.approx(nominal, rel=0.05)
    assert area.max() < 1.35 * nominal


def test_voronoi_cells_hold_what_is_nearest_to_their_centre_of_mass():
    rings = voronoi([BEAN], 0.3)
    centre = np.array([sum_of(ring) for ring in rings])
    rng = np.random.default_rng(4)
    right = []
    for k, ring in enumerate(rings):
        weight = rng.dirichlet(np.ones(len(ring)), 40)
        right.append(np.argmin(np.linalg.norm((weight @ ring)[:, None] - centre, axis=2), axis=1) == k)
    assert np.mean(right) > 0.98
    assert len({len(ring) for ring in rings}) > 2


def sum_of(ring):
    """Centre of mass by the shoelace formula."""
    x, y = ring.T
    u, v = np.roll(ring, -1, axis=0).T
    cross = x * v - u * y
    return np.array([((x + u) * cross).sum(), ((y + v) * cross).sum()]) / (3 * cross.sum())


@pytest.mark.parametrize("kind", TESSELLATIONS)
def test_the_director_is_the_exact_one_at_the_centre(kind):
    domains, _ = divide(PLAN, job(kind))
    error = np.degrees(line_difference(domains.theta, FIELD.theta(domains.centroid)))
    whole = domains.area > 0.9 * np.median(domains.area)
    assert np.sqrt(np.mean(error[whole] ** 2)) < 0.4
    assert np.sqrt(np.mean(error**2)) < 0.6
    assert np.allclose(domains.dtheta[whole], 0.03 * domains.centroid[whole, 0], atol=5e-4)
    np.testing.assert_allclose(domains.stretch, [[LCE.along, LCE.across]] * len(domains), rtol=0.03)


def test_twice_as_fine_domains_are_twice_as_near_to_the_design():
    turns = []
    for edge in (0.1, 0.05):
        _, plan = of_field("strip", edge)
        domains, findings = divide(plan, job("hexagons", 2e3 * edge))
        turns.append({f.check: f.value for f in findings}["partition_angle"])
        angle, _, area = mismatch(plan, domains)
        assert turns[-1] == pytest.approx(np.degrees(np.sqrt(np.average(angle**2, weights=area))))
    assert turns[0] / turns[1] == pytest.approx(2, rel=0.15)


def test_the_mismatch_knows_a_turn_and_what_it_does_to_the_stretches():
    plan = design(8, 8, width=1.0, height=1.0)
    plan = replace(plan, theta=np.full(len(plan.theta), 0.3))
    domains = partition(plan)
    turned = replace(domains, theta=domains.theta + 0.1)
    angle, errors, area = mismatch(plan, turned)
    np.testing.assert_allclose(angle, 0.1, atol=1e-12)
    along, across = plan.material.along, plan.material.across
    want = np.hypot(along * np.cos(0.1), across * np.sin(0.1)) / along - 1
    np.testing.assert_allclose(errors[:, 0], want, atol=1e-12)
    assert area.sum() == pytest.approx(1)


def test_triangles_get_the_directors_of_the_domains_on_them():
    domains = sample(PLAN, TESSELLATIONS["hexagons"]([partition(PLAN).outline], 0.1))
    made = as_made(PLAN, domains)
    assert np.degrees(np.sqrt(np.mean(line_difference(made.theta, PLAN.theta) ** 2))) < 1.5
    one = as_made(PLAN, replace(domains, theta=np.full(len(domains), 3.1), dtheta=np.full(len(domains), 0.02)))
    np.testing.assert_allclose(one.theta, 3.1)
    np.testing.assert_allclose(one.dtheta, 0.02)
    assert np.array_equal(as_made(PLAN, partition(PLAN)).theta, PLAN.theta)


@pytest.mark.parametrize("kind", KINDS)
def test_masks_of_every_kind_pass_their_checks(kind):
    wanted = job(kind, align=True)
    domains, _ = divide(PLAN, wanted)
    frame = arrange(PLAN.uv, wanted)
    for plate in PLATES:
        field = ChannelField(domains, plate, wanted.channels)
        for finding in check(compose(frame, field, wanted), field, frame, wanted):
            assert finding.severity is not Severity.ERROR, finding.message


@pytest.mark.parametrize("kind", KINDS)
def test_the_report_says_sizes_steps_and_residual(kind):
    _, findings = divide(PLAN, job(kind))
    found = {f.check: f for f in findings}
    whole = {"domain_cover", "partition_angle", "partition_stretch"} if kind != "triangles" else set()
    assert set(found) == {"domain_widths", "domain_steps"} | whole
    if kind == "hexagons":
        assert found["domain_widths"].value == pytest.approx(200, rel=1e-3)


def test_domains_larger_than_the_sheet_are_refused():
    with pytest.raises(InputError, match="larger than the sheet"):
        divide(PLAN, job("hexagons", 1e5))


def test_a_rim_that_loses_too_much_is_a_warning():
    """A comb of teeth narrower than a speck."""
    tooth = np.array([(0.0, 0.0), (0.02, 0.0), (0.02, 0.3), (0.08, 0.3), (0.08, 0.0)])
    teeth = np.concatenate([tooth + np.array([0.1 * k, 0.0]) for k in range(20)])
    outline = np.concatenate([[(0.0, 1.0)], teeth, [(2.0, 1.0)]])
    rings = TESSELLATIONS["hexagons"]([outline], 0.5)
    found = covered(replace(sample(PLAN, rings), outline=outline))
    assert found.value > found.limit
    assert found.severity is Severity.WARNING


@pytest.mark.parametrize("kind", KINDS)
def test_neighbours_share_their_borders(kind):
    domains, _ = divide(PLAN, job(kind))
    found = borders(domains)
    middle = (found.start + found.end) / 2
    for side in found.pair.T:
        edge = np.roll(domains.corners, -1, axis=1)[side] - domains.corners[side]
        normal = np.stack([edge[..., 1], -edge[..., 0]], axis=2) / np.linalg.norm(edge, axis=2)[..., None]
        beyond = np.sum(normal * (middle[:, None] - domains.corners[side]), axis=2).max(axis=1)
        assert np.abs(beyond).max() < 2e-4
    assert (found.pair[:, 0] < found.pair[:, 1]).all()
    if kind == "triangles":
        edges = np.sort(np.stack([domains.polygons, np.roll(domains.polygons, -1, axis=1)], axis=2), axis=2)
        _, count = np.unique(edges.reshape(-1, 2), axis=0, return_counts=True)
        assert len(found.pair) == np.sum(count == 2)


def test_a_point_is_found_in_its_domain():
    domains = partition(PLAN)
    found, outside = locate(domains, np.concatenate([domains.centroid, domains.outline.mean(axis=0)[None] + 100]))
    assert np.array_equal(found[:-1], np.arange(len(domains)))
    assert (outside[:-1] < 0).all()
    assert outside[-1] > 10


def test_a_folded_sheet_keeps_its_triangles():
    folded = replace(PLAN, flattening=replace(PLAN.flattening, status=Status.FLIPPED))
    domains, findings = divide(folded, job("voronoi"))
    assert np.array_equal(domains.polygons, PLAN.surface.faces)
    assert findings == ()


def test_stored_domains_come_back_bit_for_bit(tmp_path):
    domains, _ = divide(PLAN, job("voronoi", align=True))
    write_design(PLAN, tmp_path / "design.npz", arrays(domains))
    found = read_domains(tmp_path / "design.npz")
    for name, value in vars(domains).items():
        assert np.array_equal(getattr(found, name), value), name
    write_design(PLAN, tmp_path / "design.npz")
    assert np.array_equal(read_domains(tmp_path / "design.npz").polygons, PLAN.surface.faces)
