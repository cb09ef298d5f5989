"""What the 3D view shows, as arrays: places, counts, ranges and cuts against independent geometry."""

import numpy as np
import pytest
import sheets
from matplotlib.path import Path

from lce_solver.errors import InputError
from lce_workbench.app.colours import MAPS, Scale, packed
from lce_workbench.app.cuts import apart, cut
from lce_workbench.app.pictures import PICTURES, Shown, flat_skin, sticks, target_skin
from lce_workbench.app.skins import Skin, domain_at, first_hit
from lce_workbench.core.channels import corners, hatch
from lce_workbench.core.domains import PLATES, partition
from lce_workbench.core.job import ChannelSpec, Job
from lce_workbench.core.prism import Prism

JOB = Job(channels=ChannelSpec(width_um=4.0, spacing_um=6.0))


@pytest.fixture(scope="module")
def shown():
    design = sheets.design()
    hot = design.surface.vertices @ turned(0.8).T + [3.0, 4.0, 5.0]
    bulge = 0.02 * np.cos(2 * design.uv[:, :1]) * [[0.0, 0.0, 1.0]]
    return Shown(design, partition(design), JOB, hot + bulge)


def turned(angle):
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


def curved():
    """A sheet on a hill, whose height is known."""
    uv, faces = sheets.lattice(9, 9, 2.0, 2.0)
    return Skin(np.column_stack([uv, 0.3 * uv[:, 0]]), faces, uv, np.ones((1, 3)))


def test_a_ray_hits_the_sheet_where_it_lies():
    skin = curved()
    rng = np.random.default_rng(0)
    for x, y in rng.uniform(-0.9, 0.9, (20, 2)):
        direction = rng.normal(size=3) * [0.3, 0.3, 0.0] - [0, 0, 1]
        place = np.array([x, y, 0.3 * x])
        away, flat = skin.hit(place - 5 * direction, direction)
        assert away == pytest.approx(5)
        assert flat == pytest.approx([x, y])
    assert skin.hit(np.array([3.0, 0, 5]), np.array([0, 0, -1.0])) is None


def test_of_two_sheets_the_nearer_is_hit():
    one = curved()
    other = Skin(one.points + np.array([0, 0, 2.0]), one.faces, one.flat + 10.0, one.colours)
    origin, down = np.array([0.2, 0.3, 9.0]), np.array([0.0, 0.0, -1.0])
    assert first_hit((one, other), origin, down) == pytest.approx([10.2, 10.3])
    assert first_hit((one, other), -origin, -down) == pytest.approx([-0.2, -0.3])
    assert first_hit((one, other), origin + 5, down) is None


def test_points_of_the_flat_sheet_are_lifted_onto_the_shape():
    points = np.random.default_rng(1).uniform(-0.95, 0.95, (30, 2))
    assert curved().lift(points) == pytest.approx(np.column_stack([points, 0.3 * points[:, 0]]))


def test_every_domain_is_found_at_its_centroid_and_none_beside_the_sheet(shown):
    centroid = shown.domains.centroid
    assert [domain_at(shown.domains, point) for point in centroid] == list(range(len(centroid)))
    assert domain_at(shown.domains, np.array([5.0, 0.0])) is None


@pytest.mark.parametrize("plate", PLATES)
def test_there_is_one_line_for_each_channel_and_it_runs_along_it(shown, plate):
    picture = PICTURES[f"channels_{plate}"](shown)
    channels = hatch(shown.domains, plate, JOB.channels)
    *tiles, borders = picture.strokes
    assert sum(map(len, tiles)) == len(channels)
    assert len(tiles) > 20
    assert len(borders) == 3 * len(shown.domains)
    assert picture.count == len(channels)
    drawn = np.sort(np.concatenate([tile.ends.reshape(-1, 2, 3)[..., :2] for tile in tiles]).mean(axis=1), axis=0)
    assert drawn == pytest.approx(np.sort(corners(channels).mean(axis=1), axis=0), abs=1e-6)
    length = np.concatenate([np.linalg.norm(np.diff(t.ends.reshape(-1, 2, 3), axis=1), axis=2) for t in tiles])
    assert length.sum() == pytest.approx(channels.length.sum(), rel=1e-5)


def test_colours_of_channels_tell_their_direction(shown):
    picture = PICTURES["channels_top"](shown)
    for tile in picture.strokes[:-1]:
        along = np.diff(tile.ends.reshape(-1, 2, 3), axis=1)[:, 0]
        angle = np.degrees(np.arctan2(along[:, 1], along[:, 0])) % 180
        assert tile.colours == pytest.approx(picture.scale.colours(angle), abs=0.02)


def test_a_line_for_each_director_lies_inside_its_triangle_and_has_the_colour_of_its_twist(shown):
    picture = PICTURES["directors"](shown)
    design, flat = shown.design, picture.strokes[0]
    ends = flat.ends.reshape(-1, 2, 3)[..., :2].astype(float)
    angle = np.arctan2(*np.diff(ends, axis=1)[:, 0].T[::-1])
    assert np.abs(np.sin(angle - design.theta)).max() < 1e-5
    assert picture.scale.high == np.degrees(np.abs(design.dtheta)).max() == -picture.scale.low
    assert np.array_equal(flat.colours, picture.scale.colours(np.degrees(design.dtheta)))
    for end in (0, 1):
        assert [domain_at(shown.domains, p) for p in ends[:, end]] == list(range(len(ends)))
    lifted = picture.strokes[1].ends.mean(axis=0)  # the surface is the flat sheet itself, moved
    assert lifted == pytest.approx(picture.skins[1].points.mean(axis=0), abs=0.05)
    assert len(sticks(design)) == 2 * len(design.theta)


def test_the_deviation_is_that_of_the_shape_and_not_of_its_place(shown):
    picture = PICTURES["deviation"](shown)
    z = 0.02 * np.cos(2 * shown.design.uv[:, 0])
    assert picture.scale.unit == "µm"
    assert picture.scale.low == 0
    assert 0.4 * 1000 * np.ptp(z) < picture.scale.high < 1000 * np.ptp(z)
    away = np.linalg.norm(picture.skins[0].points - shown.design.surface.vertices, axis=1)
    assert picture.scale.high == pytest.approx(1000 * away.max())
    assert np.array_equal(picture.skins[0].colours, picture.scale.colours(1000 * away))
    with pytest.raises(InputError, match="run Predict first"):
        PICTURES["deviation"](Shown(shown.design, shown.domains, JOB))


def test_sheet_and_target_have_the_same_colours_side_by_side(shown):
    one, other = PICTURES["target"](shown).skins
    assert np.array_equal(one.colours, other.colours)
    assert one.points[:, 0].max() < other.points[:, 0].min()
    assert flat_skin(shown.design).points[:, 2].max() == 0 == target_skin(shown.design).points[:, 2].min()


def test_scales_end_at_their_limits_and_the_cyclic_one_closes():
    scale = Scale("", "", -2.0, 3.0, "sequential")
    ends = scale.colours(np.array([-9.0, -2.0, 3.0, 9.0]))
    assert ends == pytest.approx(np.array(MAPS["sequential"])[[0, 0, -1, -1]])
    assert MAPS["cyclic"][0] == MAPS["cyclic"][-1]
    luminance = np.array(MAPS["sequential"]) @ [0.2126, 0.7152, 0.0722]
    assert (np.diff(luminance) > 0).all()  # it can be read without seeing colours
    assert packed([[1.0, 0.0, 0.2]]).tolist() == [0xFF0033FF]


def ring(low, high):
    (a, b), (c, d) = low, high
    return np.array([[a, b], [c, b], [c, d], [a, d]])


def test_a_cut_has_the_section_of_the_solid():
    hole = 0.3 * np.stack([np.cos(np.arange(0, 6.2, 0.1)), np.sin(np.arange(0, 6.2, 0.1))], axis=1)
    prism = Prism("a", ring((-1, -1), (1, 1)), (hole,), 0.0, 0.5, (1, 0, 0), upper=ring((-0.8, -0.8), (0.8, 0.8)))
    straight = Prism("b", ring((-1, -1), (1, 1)), (hole,), 0.0, 0.5, (1, 0, 0))
    (one,), (tapered,) = cut([straight], 0.1), cut([prism], 0.1)
    x = np.linspace(-1, 1, 200_001)
    solid = ~Path(hole).contains_points(np.column_stack([x, np.full(len(x), 0.1)]))
    assert one.area == pytest.approx(0.5 * 2 * solid.mean(), rel=1e-4)
    assert len(one.quads) == 2
    assert tapered.area == pytest.approx(one.area - 2 * 0.2 * 0.5 / 2)
    assert cut([straight], 1.1) == ()


def test_what_is_apart_keeps_its_order():
    order = ["alignment_frame", "bottom_glass", "channels_bottom", "spacer_left", "sheet", "top_land", "top_glass"]
    heights = [apart(name, 10.0) for name in order]
    assert heights == sorted(heights)
    assert heights[4] == 0 != heights[3]
