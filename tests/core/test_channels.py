import numpy as np
import pytest
from sheets import b20, design, single

from lce_solver.errors import InputError
from lce_solver.types import Severity
from lce_workbench.core.channels import BLOCK, ChannelField, Channels, corners, empty_domains, hatch
from lce_workbench.core.domains import Domains, partition, signed_area
from lce_workbench.core.job import ChannelSpec

SPEC = ChannelSpec()


def many_triangles(n=300, size=0.3, offset=0.0, seed=3):
    """Triangles of all shapes, slivers among them, that do not touch."""
    rng = np.random.default_rng(seed)
    corner = rng.normal(size=(n, 3, 2)) * size * rng.uniform(0.05, 1, (n, 1, 1))
    turned = signed_area(corner) < 0
    corner[turned] = corner[turned, ::-1]
    place = np.stack(np.divmod(np.arange(n), 20), axis=1)[:, None] * 2.0
    return Domains(
        (corner + place).reshape(-1, 2) + offset,
        np.arange(3 * n).reshape(n, 3),
        rng.uniform(0, np.pi, n),
        rng.uniform(-0.1, 0.1, n),
        np.ones((n, 2)),
    )


def clearance(points, triangles):
    """Distance (n, k) of points (n, k, 2) inside triangles (n, 3, 2) from the nearest edge."""
    edge = np.roll(triangles, -1, axis=1) - triangles
    inward = np.stack([-edge[..., 1], edge[..., 0]], axis=2) / np.linalg.norm(edge, axis=2)[..., None]
    return np.min(np.einsum("nei,nkei->nke", inward, points[:, :, None] - triangles[:, None]), axis=2)


@pytest.mark.parametrize("offset", [0.0, 80.0])
@pytest.mark.parametrize("plate", ["bottom", "top"])
def test_each_channel_is_the_longest_that_keeps_the_guard(plate, offset):
    domains = many_triangles(offset=offset)
    channels = hatch(domains, plate, SPEC)
    triangles = domains.corners[channels.domain]
    found = corners(channels)
    assert clearance(found, triangles).min() >= SPEC.guard - 1e-11
    along = np.stack([np.cos(channels.angle), np.sin(channels.angle)], axis=1)[channels.domain][:, None]
    for sign, end in ((1, (1, 2)), (-1, (0, 3))):  # 0.1 um more at either end would break the guard
        longer = found[:, end] + sign * 1e-4 * along
        assert clearance(longer, triangles).min(axis=1).max() < SPEC.guard


def test_no_further_strip_fits():
    domains = many_triangles()
    channels = hatch(domains, "bottom", ChannelSpec(guard_um=2.0))
    along = np.stack([np.cos(channels.angle), np.sin(channels.angle)], axis=1)
    across = np.stack([-along[:, 1], along[:, 0]], axis=1)
    counts = channels.counts
    ends = np.cumsum(counts)[counts > 0] - 1
    domain = channels.domain[ends]
    last = channels.centre[ends] + SPEC.pitch * across[domain]
    for shift in np.linspace(-0.3, 0.3, 601)[:, None]:  # a 2 um channel in the next strip, anywhere along it
        rectangle = Channels("bottom", last + shift * along[domain], channels.angle, np.full(len(ends), 2.1e-3),
                             domain, SPEC.width, 0.0)  # fmt: skip
        assert clearance(corners(rectangle), domains.corners[domain]).min(axis=1).max() < 2e-3


def test_neighbours_lie_exactly_one_pitch_apart():
    channels = hatch(many_triangles(offset=50.0), "top", SPEC)
    angle = channels.angle[channels.domain]
    across = -np.sin(angle) * channels.centre[:, 0] + np.cos(angle) * channels.centre[:, 1]
    same = np.diff(channels.domain) == 0
    assert np.allclose(np.diff(across)[same], SPEC.pitch, atol=1e-12)
    assert (np.diff(channels.domain) >= 0).all()


def test_lengths_are_multiples_of_a_tenth_of_a_micron():
    length = hatch(many_triangles(), "top", SPEC).length
    assert np.array_equal(length, np.round(length * 1e4) / 1e4)
    assert length.min() >= 0.002


def test_rectangles_have_the_width_and_turn_left():
    channels = hatch(many_triangles(offset=70.0), "bottom", SPEC)
    found = corners(channels)
    side = np.roll(found, -1, axis=1) - found
    assert np.allclose(np.linalg.norm(side, axis=2)[:, [1, 3]], SPEC.width, rtol=1e-9)
    assert np.allclose(np.linalg.norm(side, axis=2)[:, 0], channels.length, rtol=1e-9)
    assert np.allclose(np.einsum("nki,nki->nk", side, np.roll(side, 1, axis=1)), 0, atol=1e-12)
    assert (signed_area(found) > 0).all()
    assert np.array_equal(corners(channels, slice(7, 50)), found[7:50])


def test_the_area_of_a_domain_is_the_sum_of_its_channels():
    channels = hatch(many_triangles(), "bottom", SPEC)
    drawn = np.bincount(channels.domain, signed_area(corners(channels)), minlength=len(channels.angle))
    assert np.allclose(channels.areas, drawn, rtol=1e-9, atol=0)
    assert channels.counts.sum() == len(channels)


def test_guards_and_square_ends_cost_less_than_four_percent():
    domains = b20()
    assert np.isclose(np.sqrt(4 / np.sqrt(3) * domains.area.mean()), 0.35, rtol=0.01)
    for plate in ("bottom", "top"):
        ratio = hatch(domains, plate, SPEC).areas / (domains.area * SPEC.duty)
        assert ratio.min() > 0.96
        assert ratio.max() < 1
        assert np.average(ratio, weights=domains.area) > 0.98


def test_a_turned_and_shifted_sheet_has_turned_and_shifted_channels():
    domains = many_triangles()
    turn, shift = 0.4, np.array([30.0, -20.0])
    rotation = np.array([[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]])
    other = Domains(
        domains.vertices @ rotation + shift,
        domains.polygons,
        np.mod(domains.theta + turn, np.pi),
        domains.dtheta,
        domains.stretch,
    )
    a, b = hatch(domains, "bottom", SPEC), hatch(other, "bottom", SPEC)
    wrapped = np.abs(b.angle - a.angle - turn)[a.domain] > 0.1  # these are counted from the other side
    assert np.array_equal(a.counts, b.counts)
    assert np.allclose(a.length[~wrapped], b.length[~wrapped], atol=1.01e-4)  # rounding down may go the other way
    assert np.allclose((a.centre @ rotation + shift)[~wrapped], b.centre[~wrapped], atol=1e-4)


def test_mirrored_domains_have_mirrored_channels():
    domains = many_triangles()
    other = Domains(
        domains.vertices * [-1, 1],
        domains.polygons[:, ::-1],
        np.pi - domains.theta,
        -domains.dtheta,
        domains.stretch,
    )
    a, b = hatch(domains, "top", SPEC), hatch(other, "top", SPEC)
    back = np.lexsort((np.arange(len(b))[::-1], b.domain))  # the strips follow each other the other way
    assert np.array_equal(a.counts, b.counts)
    assert np.allclose(a.centre * [-1, 1], b.centre[back], atol=1e-4)
    assert np.allclose(a.length, b.length[back], atol=1.01e-4)


def test_channels_parallel_to_an_edge_fill_a_triangle_to_its_guard():
    # right triangle, 41 pitches high less one land: the first strip lies on the guard of the lower edge
    height = 0.0817
    g, w = SPEC.guard, SPEC.width
    triangle = np.array([[0, 0], [0.3, 0], [0, height]])
    channels = hatch(single(triangle, 0.0), "bottom", SPEC)
    slope = np.hypot(0.3, height) / 0.3
    top = height - g * slope - g * height / 0.3  # height of the inset triangle's upper corner
    count = int((top - g - w) / SPEC.pitch) + 1
    middle = (g + top) / 2
    y = middle + (np.arange(count) - (count - 1) / 2) * SPEC.pitch
    longest = 0.3 * (1 - (y + w / 2) / height) - g * np.hypot(0.3, height) / height - g
    expected = np.floor(longest * 1e4)[longest >= 2e-3] / 1e4
    assert np.allclose(channels.length, expected, atol=1e-12)
    assert np.allclose(channels.centre[:, 1], y[longest >= 2e-3], atol=1e-12)


def test_a_domain_too_small_stays_empty_and_is_listed():
    tiny, large = [[0, 0], [0.003, 0], [0, 0.003]], [[1, 1], [1.3, 1], [1, 1.3]]
    folded = [[2, 2], [2, 2.3], [2.3, 2]]
    domains = Domains(
        np.array([tiny, large, folded]).reshape(-1, 2),
        np.arange(9).reshape(3, 3),
        [0.3] * 3,
        [0.0] * 3,
        np.ones((3, 2)),
    )
    channels = hatch(domains, "top", SPEC)
    assert channels.counts[0] == channels.counts[2] == 0
    assert channels.counts[1] > 50
    (finding,) = empty_domains(ChannelField(domains, "top", SPEC))
    assert (finding.severity, finding.value, finding.where) == (Severity.WARNING, 2.0, "domain 0, 2")
    assert empty_domains(ChannelField(partition(design(2, 2)), "top", SPEC)) == ()


def test_channels_that_fit_nowhere_are_refused():
    with pytest.raises(InputError, match=r"channels\.width_um = 90 .* fits into none of the domains; make"):
        hatch(single([[0, 0], [0.1, 0], [0, 0.1]], 0.2), "bottom", ChannelSpec(width_um=90))


@pytest.mark.parametrize("plate", ["bottom", "top"])
def test_a_field_holds_the_same_channels_block_by_block(plate):
    domains = partition(design(6, 8, width=0.6, height=0.6))
    whole, field = hatch(domains, plate, SPEC), ChannelField(domains, plate, SPEC)
    parts = list(field)
    assert len(parts) == -(-len(domains) // BLOCK) == 2
    for name in ("centre", "length", "domain"):
        assert np.array_equal(np.concatenate([getattr(part, name) for part in parts]), getattr(whole, name))
    owners = [set(part.domain.tolist()) for part in parts]
    assert sum(map(len, owners)) == len(set.union(*owners)) == len(domains)
    assert np.array_equal(np.concatenate([corners(part) for part in parts]), corners(whole))
    assert np.array_equal(field.counts, whole.counts)


def test_a_field_that_fits_nowhere_is_refused():
    with pytest.raises(InputError, match="fits into none of the domains"):
        _ = ChannelField(single([[0, 0], [0.1, 0], [0, 0.1]], 0.2), "top", ChannelSpec(width_um=90)).counts
