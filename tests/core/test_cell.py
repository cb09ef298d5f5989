import re
from itertools import pairwise

import numpy as np
import pytest
from cad.cad_sample import cell, cross, domains, hatched, job

from lce_solver.errors import InputError
from lce_workbench.core.cell import LOOKS, MAX_CUT, MAX_SOLIDS, assemble, choose
from lce_workbench.core.channels import Channels
from lce_workbench.core.domains import PLATES, SIDE, signed_area
from lce_workbench.core.frame import arrange
from lce_workbench.core.job import Job
from lce_workbench.core.marks import marks
from lce_workbench.core.merge import merged
from lce_workbench.core.prism import Prism

WHITE = (1.0, 1.0, 1.0)


def square(side, x=0.0, y=0.0):
    return np.array([(0, 0), (1, 0), (1, 1), (0, 1)]) * side + np.array([x, y])


def prism(outline, *holes, z0=0.0, z1=1.0):
    return Prism("p", outline, holes, z0, z1, WHITE)


def moved(p, angle, shift):
    turn = np.array([(np.cos(angle), np.sin(angle)), (-np.sin(angle), np.cos(angle))])
    return prism(p.outline @ turn + shift, *(hole @ turn + shift for hole in p.holes))


def test_prism_with_a_hole_by_hand():
    p = prism(square(4.0), square(1.0, 2.0, 1.0), z0=1.0, z1=1.5)
    assert p.area == 15.0
    assert p.volume == 7.5
    np.testing.assert_allclose(p.centroid, [(16 * 2 - 2.5) / 15, (16 * 2 - 1.5) / 15, 1.25], rtol=1e-15)


def test_rings_run_as_the_kernels_need_them_whichever_way_they_are_given():
    for outline in (square(4.0), square(4.0)[::-1]):
        for hole in (square(1.0, 1, 1), square(1.0, 1, 1)[::-1]):
            p = prism(outline, hole)
            assert p.area == 15.0
            assert signed_area(p.outline[None])[0] == 16.0
            assert signed_area(p.holes[0][None])[0] == -1.0


def test_a_channel_far_from_the_origin_keeps_its_digits():
    channel = prism(np.array([(0, 0), (0.2, 0), (0.2, 0.001), (0, 0.001)]))
    for angle in (0.3, 1.2, 2.9):
        assert moved(channel, angle, np.array([10.0, -7.0])).area == pytest.approx(2e-4, rel=1e-11)


def test_volume_and_centroid_move_with_the_prism():
    p = prism(np.array([(0, 0), (5, 1), (6, 4), (2, 3), (1, 5)]), square(0.5, 2, 1.5))
    shift = np.array([3.0, -2.0])
    q = moved(p, 0.7, shift)
    turn = np.array([(np.cos(0.7), np.sin(0.7)), (-np.sin(0.7), np.cos(0.7))])
    assert q.volume == pytest.approx(p.volume, rel=1e-14)
    np.testing.assert_allclose(q.centroid[:2], p.centroid[:2] @ turn + shift, rtol=1e-14)


def test_a_prism_without_height_is_refused():
    with pytest.raises(ValueError, match=r"p: z1 = 0.0 must lie above z0 = 0.0"):
        prism(square(1.0), z1=0.0)


def test_prisms_cannot_be_changed():
    p = prism(square(1.0), square(0.1, 0.5, 0.5))
    for ring in p.rings:
        with pytest.raises(ValueError, match="read-only"):
            ring[0, 0] = 7


# ---------------------------------------------------------------- the stack


@pytest.mark.parametrize("gap_um", [100.0, 150.0])
def test_the_stack_has_no_gaps_and_the_film_fills_the_spacer_s_height(gap_um):
    parts = {p.name: p for p in cell(gap_um=gap_um).parts}
    column = ["bottom_glass", "bottom_epoxy", "bottom_land", "sheet", "top_land", "top_epoxy", "top_glass"]
    for below, above in pairwise(column):
        assert parts[below].z1 == parts[above].z0
    assert parts["sheet"].z1 == -parts["sheet"].z0 == gap_um / 2000
    for side in ("left", "right"):
        strip = parts[f"spacer_{side}"]
        assert (strip.z0, strip.z1) == (parts["sheet"].z0, parts["sheet"].z1)


def test_lands_are_as_thick_as_the_channels_are_deep():
    for name in ("bottom_land", "top_land"):
        (land,) = (p for p in cell().parts if p.name == name)
        assert land.z1 - land.z0 == pytest.approx(0.6e-3, rel=1e-12)


def test_land_volume_is_the_plate_less_marks_and_channels():
    """What is cut from a land is its marks (each cross once) and exactly the channel solids of its plate."""
    built = cell()
    for plate, n_marks in (("bottom", 4), ("top", 5)):
        (land,) = (p for p in built.parts if p.name == f"{plate}_land")
        solids = built.group(f"channels_{plate}")
        cross_area = 0.2 * 0.04 + 2 * 0.04 * 0.08
        cut = n_marks * cross_area * 0.6e-3 + sum(p.volume for p in solids)
        assert len(land.holes) == n_marks + len(solids)
        assert 25 * 25 * 0.6e-3 - land.volume == pytest.approx(cut, rel=1e-8)


def test_sheet_is_the_outline_of_the_domains():
    (film,) = (p for p in cell().parts if p.name == "sheet")
    assert film.area == pytest.approx(domains().area.sum(), rel=1e-13)
    assert len(film.outline) == 20


def test_spacer_leaves_sheet_marks_and_the_filling_edges_free():
    built = cell()
    left, right = built.group("spacer")
    (land,) = (p for p in built.parts if p.name == "bottom_land")
    for x in (hole[:, 0] for hole in land.holes):
        for strip in (left.outline[:, 0], right.outline[:, 0]):
            assert x.max() < strip.min() or x.min() > strip.max()
    sheet = next(p for p in built.parts if p.name == "sheet").outline
    assert left.outline[:, 0].max() < sheet[:, 0].min()
    assert right.outline[:, 0].min() > sheet[:, 0].max()
    assert left.outline[:, 1].min() == land.outline[:, 1].min()
    assert left.outline[:, 0].min() > land.outline[:, 0].min()


def test_every_name_is_ascii_and_parts_are_unique():
    built = cell()
    names = [p.name for p in built.parts]
    assert len(set(names)) == len(names) == 11
    assert all(re.fullmatch(r"[\w.]+", p.name, re.ASCII) for p in (*built.parts, *built.channels))


def test_colours_come_from_the_table():
    assert {p.colour for p in (*cell().parts, *cell().channels)} == {
        colour for kind, (colour, _) in LOOKS.items() if kind != "jig"
    }


# ---------------------------------------------------------------- channel solids


def test_channel_solids_are_length_by_width_by_depth_under_their_domain_s_name():
    channels = hatched(domains(), job())
    built = cell(chosen=(7, 31))
    for plate in PLATES:
        solids = built.group(f"channels_{plate}")
        rows = np.flatnonzero(np.isin(channels[plate].domain, [7, 31]))
        want = channels[plate].length[rows] * 1e-3 * 0.6e-3
        np.testing.assert_allclose([p.volume for p in solids], want, rtol=1e-10)
        names = [f"domain_{k:04d}_theta_{plate}_{np.degrees(channels[plate].angle[k]):06.2f}" for k in (7, 31)]
        assert [p.name for p in solids] == np.repeat(names, channels[plate].counts[[7, 31]]).tolist()


def test_channels_lie_in_the_land_and_are_not_mirrored():
    sheet = domains()
    for plate in PLATES:
        for solid in cell(chosen=(12,)).group(f"channels_{plate}"):
            along = solid.outline[1] - solid.outline[0]
            angle = sheet.theta[12] + SIDE[plate] * sheet.dtheta[12] / 2
            assert along[0] * np.sin(angle) - along[1] * np.cos(angle) == pytest.approx(0, abs=1e-12)
            near, far = sorted(np.abs([solid.z0, solid.z1]))
            assert np.sign(solid.z0) == SIDE[plate]
            assert (near, far) == pytest.approx((0.05, 0.0506), rel=1e-14)


def test_an_angle_that_rounds_to_180_degrees_is_named_0():
    sheet = domains()
    flat = type(sheet)(sheet.vertices, sheet.polygons, np.full(50, np.pi - 1e-6), np.zeros(50), np.ones((50, 2)))
    channels = hatched(flat, job())
    built = assemble(arrange(flat.vertices, job()), job(), flat, {"bottom": [], "top": []}, channels)
    assert {p.name[-6:] for p in built.channels} == {"000.00"}


def test_the_most_central_domain_is_the_default():
    (k,) = choose(domains(), hatched(domains(), job()), ())
    assert np.linalg.norm(domains().centroid, axis=1).argmin() == k


def test_a_domain_that_does_not_exist_is_refused():
    with pytest.raises(InputError, match=r"^output.step_domains: domain 50 does not exist; the sheet has 0 to 49$"):
        choose(domains(), hatched(domains(), job()), (3, 50))


def without(channels, domain):
    keep = channels.domain != domain
    return Channels(
        channels.plate,
        channels.centre[keep],
        channels.angle,
        channels.length[keep],
        channels.domain[keep],
        channels.width,
        channels.depth,
    )


def test_a_domain_without_channels_is_refused_and_never_the_default():
    channels = hatched(domains(), job())
    (central,) = choose(domains(), channels, ())
    channels["top"] = without(channels["top"], central)
    assert choose(domains(), channels, ()) != (central,)
    with pytest.raises(InputError, match=f"domain {central} is too small for a channel; choose another"):
        choose(domains(), channels, (central,))


def test_too_many_solids_are_refused_with_an_estimate():
    sheet = domains(n=32)
    channels = hatched(sheet, job())
    total = sum(len(channels[plate]) for plate in PLATES)
    assert total > MAX_SOLIDS
    sentence = rf"ask for {total} channel solids, about {total * 4e-3:.0f} s and {total * 8e-3:.0f} MB of STEP"
    with pytest.raises(InputError, match=sentence):
        choose(sheet, channels, range(len(sheet)))


def test_lands_are_cut_only_while_their_faces_stay_readable():
    built = cell(chosen=tuple(range(50)))
    (land,) = (p for p in built.parts if p.name == "bottom_land")
    assert MAX_CUT - 20 < len(land.holes) - 4 <= MAX_CUT < len(built.group("channels_bottom"))


# ---------------------------------------------------------------- merging of marks


def test_a_cross_of_three_rectangles_becomes_one_outline():
    (ring,) = merged(cross(1.5, -2.0))
    assert len(ring) == 12
    assert signed_area(ring[None])[0] == pytest.approx(0.0144, rel=1e-12)


def test_overlapping_rectangles_count_once():
    (ring,) = merged([square(2.0), square(2.0, 1.0, 1.0)])
    assert signed_area(ring[None])[0] == pytest.approx(7.0, rel=1e-12)
    assert len(ring) == 8


def test_a_rectangle_that_only_grows_another_leaves_no_needless_corner():
    (ring,) = merged([square(1.0), square(1.0, 1.0)])
    np.testing.assert_allclose(sorted(ring.tolist()), [[0, 0], [0, 1], [2, 0], [2, 1]], atol=1e-12)


def test_polygons_apart_stay_as_they_are():
    rings = [square(1.0), np.array([(3, 0), (4, 0.5), (3.2, 1)])]
    for before, after in zip(rings, merged(rings), strict=True):
        assert after is before
    assert merged([]) == []


@pytest.mark.parametrize(
    "rectangles",
    [
        [square(1.0), square(1.0, 1.0, 1.0)],
        [square(1.0, x, y) for x in range(3) for y in range(3) if (x, y) != (1, 1)],
    ],
    ids=["point", "island"],
)
def test_what_has_no_simple_outline_is_refused(rectangles):
    with pytest.raises(ValueError, match="touch in a point only, or enclose an island"):
        merged(rectangles)


def test_the_shipped_marks_are_as_many_recesses_as_they_show_and_keep_their_area():
    frame = arrange(domains(n=100).vertices, Job())
    for plate in PLATES:
        drawn = np.concatenate([*marks(frame, plate, Job().marks).values()])
        rings = merged(drawn)
        area = sum(signed_area(ring[None])[0] for ring in rings)
        assert area == pytest.approx(signed_area(drawn).sum(), rel=1e-12)
        low, high = (np.array([f(ring, axis=0) for ring in rings]) for f in (np.min, np.max))
        meets = np.all((low[:, None] <= high) & (low <= high[:, None]), axis=2)
        assert np.count_nonzero(meets) == len(rings) < len(drawn)
