"""The closed forms behind the review, against independent computations of the same thing."""

from dataclasses import replace

import numpy as np
import pytest
from matplotlib.tri import Triangulation
from sheets import SPEC, design, single

from lce_solver.twist import second_form, twist
from lce_solver.types import Surface
from lce_workbench.core.domains import partition
from lce_workbench.core.frame import arrange
from lce_workbench.core.job import ChannelSpec, DomainSpec, Job
from lce_workbench.core.partition import divide
from lce_workbench.review.measures import anchoring, bending, budget, jumps, transmission

TRIANGLE = [[0, 0], [1, 0], [0, 1]]


def test_transmission_of_a_domain_is_malus_law_and_twist_lightens_the_dark():
    for theta in (0.0, 0.3, 1.2, 3.0):
        for phi in np.radians([0.0, 22.5, 45.0]):
            passed = transmission(single(TRIANGLE, theta), phi)
            assert passed == pytest.approx(np.sin(2 * (theta - phi)) ** 2 / 2, abs=1e-14)
    turn = np.radians(3.0)
    dark = transmission(single(TRIANGLE, 0.7, turn), 0.7)
    assert dark == pytest.approx(np.sin(turn) ** 2 / 2, rel=1e-12)


def test_transmission_is_what_a_stack_of_plates_passes_in_white_light():
    """200 retarders that follow the twist (Jones), averaged over the visible, against the closed form."""
    turn, theta, phi, slices = np.radians(8.0), 0.5, 0.2, 200
    waves = 0.17 * 0.1 / np.linspace(420e-6, 680e-6, 800)  # birefringence x 0.1 mm over the wavelength
    light = np.stack([np.full(len(waves), np.cos(phi)), np.full(len(waves), np.sin(phi))]).astype(complex)
    for k in range(slices):
        a = theta + turn * ((k + 0.5) / slices - 0.5)
        along, across = np.array([np.cos(a), np.sin(a)]), np.array([-np.sin(a), np.cos(a)])
        late = np.exp(2j * np.pi * waves / slices)
        light = along[:, None] * late * (along @ light) + across[:, None] * (across @ light)
    passed = np.mean(np.abs(np.array([-np.sin(phi), np.cos(phi)]) @ light) ** 2)
    assert transmission(single(TRIANGLE, theta, turn), phi)[0] == pytest.approx(passed, abs=0.003)


def test_anchoring_is_berremans_ratio_to_both_of_the_papers_geometries():
    here, former = anchoring(ChannelSpec(width_um=1.0, spacing_um=1.0, depth_um=0.6)).values()
    assert here == pytest.approx(1.0)
    assert former == pytest.approx((0.6 / 1.5) ** 2 * 8)
    assert next(iter(anchoring(replace(SPEC, depth_um=1.2)).values())) == pytest.approx(4.0)


def test_the_budget_is_the_scatter_of_many_readings():
    plan = design()
    frame = arrange(plan.uv, Job())
    found = budget(frame, partition(plan), Job())
    x, y = frame.marks.T
    one, none = np.ones(len(x)), np.zeros(len(x))
    rows = np.concatenate([np.stack([one, none, -y, x], axis=1), np.stack([none, one, x, y], axis=1)])
    read = np.random.default_rng(3).uniform(-0.5e-3, 0.5e-3, (20000, 2 * len(x)))
    tx, _, phi, s = np.linalg.pinv(rows) @ read.T
    cx, cy = frame.sheet.ring[2]
    assert found.known == pytest.approx(1.959964 * np.std(tx - phi * cy + s * cx), rel=0.05)
    assert found.rotation == pytest.approx(1.959964 * phi.std(), rel=0.05)
    assert found.left == pytest.approx(0.010 - found.known)


def test_the_share_of_crossed_domains_is_what_a_shifted_sheet_shows():
    """Points of the sheet, shifted in random directions by the tolerance: how many change their domain."""
    plan = design(columns=12, rows=16)
    domains = partition(plan)
    share = budget(arrange(plan.uv, Job()), domains, Job()).crossed
    finder = Triangulation(*domains.vertices.T, domains.polygons).get_trifinder()
    rng = np.random.default_rng(5)
    points = rng.uniform(-0.98, 0.98, (100_000, 2)) * [1.0, 1.1]
    way = rng.uniform(0, 2 * np.pi, len(points))
    moved = points + 0.010 * np.column_stack([np.cos(way), np.sin(way)])
    assert share == pytest.approx(np.mean(finder(*points.T) != finder(*moved.T)), rel=0.06)


def test_jumps_are_zero_for_a_uniform_director_and_wrap_at_180_degrees():
    domains = partition(design())
    assert jumps(replace(domains, theta=np.full(len(domains), 0.4))).max() == 0
    turned = np.where(np.arange(len(domains)) % 2 == 0, 0.01, np.pi - 0.01)
    assert jumps(replace(domains, theta=turned)).max() == pytest.approx(0.02)


def test_bending_of_a_twisted_saddle_is_all_shear_and_all_prescribed():
    plan = design(columns=24, rows=28)
    x, y = plan.uv.T
    bent = Surface(np.column_stack([0.6 * x, 0.6**-0.5 * y, 0.03 * x * y]), plan.surface.faces)
    plan = replace(plan, surface=bent, theta=np.zeros(len(plan.theta)))
    plan = replace(plan, dtheta=twist(second_form(bent, plan.uv), plan.theta, plan.material, plan.thickness))
    found = bending(plan)
    shear = found.rms(found.wanted[:, 0, 1])
    assert found.rms(found.prescribed) == pytest.approx(shear, rel=1e-9)
    assert shear == pytest.approx(0.03 / (0.6 * 0.6**-0.5), rel=0.01)
    assert found.rms(found.wanted[:, 0, 0]) < 0.02 * shear


def length(ring):
    """Of a closed line."""
    return np.linalg.norm(ring - np.roll(ring, 1, axis=0), axis=1).sum()


@pytest.mark.parametrize("kind", ["triangles", "hexagons", "voronoi"])
def test_every_kind_of_domains_has_borders_and_one_domain_has_none(kind):
    """Each inner border counts once: what is left of all sides is the rim."""
    plan = design()
    domains, _ = divide(plan, Job(domains=DomainSpec(kind=kind, size_um=300.0)))
    around = sum(length(domains.ring(k)) for k in range(len(domains)))
    rim = length(domains.outline)
    share = budget(arrange(plan.uv, Job()), domains, Job()).borders * np.abs(domains.area).sum()
    assert share == pytest.approx((around - rim) / 2, rel=0.03)
    assert len(jumps(domains)) > len(domains)
    assert jumps(single(TRIANGLE, 0.3)).tolist() == [0.0]
