"""From the written files through resist, PDMS and epoxy to the closed cell: where do the channels lie, which way?"""

import klayout.db as kdb
import numpy as np
import pytest
from sheets import both_masks, design

from lce_solver.types import Severity
from lce_workbench.core.domains import partition
from lce_workbench.core.replication import advice, replicated, settings
from lce_workbench.export import gdsii

DEPTH = 600.0


def exposed(path):
    """The patterned face of a developed master, up: trenches (n, 4, 3) where positive resist was exposed [nm]."""
    layout = kdb.Layout()
    layout.read(str(path))
    shapes = layout.top_cell().shapes(layout.layer(1, 0))
    flat = np.array([[(p.x, p.y) for p in s.polygon.each_point_hull()] for s in shapes.each()], dtype=float)
    return np.concatenate([flat, np.full((*flat.shape[:2], 1), -DEPTH)], axis=2)


def turned_over(points):
    """Turn a body over about the y axis."""
    return points * [-1, 1, -1]


def cast(points):
    """A cast copies every point of the face in place; it is turned over to look at its own patterned face."""
    return turned_over(points)


def domain_of(points, domains):
    """Domain of each channel by its middle (n, 2) [mm]."""
    middle = points[..., :2].mean(axis=1) * 1e-6
    corner = domains.corners
    edge = np.roll(corner, -1, axis=1) - corner
    found = np.full(len(middle), -1)
    for d in range(len(domains)):
        r = middle[:, None] - corner[d]
        inside = (edge[d, :, 0] * r[..., 1] - edge[d, :, 1] * r[..., 0] > 0).all(axis=1)
        assert (found[inside] == -1).all()
        found[inside] = d
    return found, middle


def directions(points, domain, count):
    """Length-weighted direction in each domain [rad]."""
    a, b = points[:, 1, :2] - points[:, 0, :2], points[:, 2, :2] - points[:, 1, :2]
    u = np.where(np.linalg.norm(a, axis=1)[:, None] > np.linalg.norm(b, axis=1)[:, None], a, b)
    line = (u[:, 0] + 1j * u[:, 1]) ** 2 / np.linalg.norm(u, axis=1)
    total = np.bincount(domain, line.real, count) + 1j * np.bincount(domain, line.imag, count)
    return np.angle(total) / 2


def line_error(a, b):
    return np.degrees(np.abs((a - b + np.pi / 2) % np.pi - np.pi / 2)).max()


@pytest.fixture(scope="module")
def chain(tmp_path_factory):
    folder = tmp_path_factory.mktemp("chain")
    domains = partition(design(5, 6, width=1.5, height=1.6, twist=0.08))
    _, channels, masks = both_masks(domains)
    for plate, mask in masks.items():
        gdsii.write(mask, folder / f"{plate}.gds")
    return domains, channels, {plate: exposed(folder / f"{plate}.gds") for plate in masks}


@pytest.mark.parametrize(("plate", "side"), [("bottom", -1), ("top", 1)])
def test_both_plates_face_the_film_with_theta_minus_and_plus_half_the_twist(chain, plate, side):
    domains, channels, masters = chain
    epoxy = cast(cast(masters[plate]))
    mounted = epoxy if plate == "bottom" else turned_over(epoxy)
    # trenches lie inside their plate: below the film's lower face, above its upper face
    assert np.all(np.sign(mounted[..., 2]) == side)
    domain, middle = domain_of(mounted, domains)
    assert np.array_equal(np.bincount(domain, minlength=len(domains)), channels[plate].counts)
    expected = domains.theta + side * domains.dtheta / 2
    assert line_error(directions(mounted, domain, len(domains)), expected) < 1e-3
    length = np.linalg.norm(mounted[:, 2] - mounted[:, 0], axis=1)
    centroid = np.stack([np.bincount(domain, m * length) / np.bincount(domain, length) for m in middle.T], axis=1)
    assert np.abs(centroid - domains.centroid).max() < 2e-3


def test_a_cast_less_mirrors_the_pattern_and_turns_trenches_into_ridges(chain):
    domains, _, masters = chain
    pdms = cast(masters["bottom"])
    assert (pdms[..., 2] > 0).all()
    domain, _ = domain_of(pdms * [-1, 1, 1], domains)
    assert line_error(directions(pdms, domain, len(domains)), -domains.angle("bottom")) < 1e-3


def test_an_unmirrored_top_would_be_wrong(chain):
    domains, _, masters = chain
    unmirrored = masters["top"] * [-1, 1, 1]
    mounted = turned_over(cast(cast(unmirrored)))
    domain, _ = domain_of(mounted * [-1, 1, 1], domains)
    expected = domains.theta + domains.dtheta / 2
    assert line_error(directions(mounted, domain, len(domains)), expected) > 10


@pytest.mark.parametrize("casts", range(5))
@pytest.mark.parametrize(("plate", "side"), [("bottom", -1), ("top", 1)])
def test_with_the_stated_settings_any_number_of_casts_gives_the_same_plates(chain, casts, plate, side):
    """Files -> converter -> resist -> casts -> mounted plate, with what `settings` says for this number of casts."""
    domains, _, masters = chain
    said = settings(casts)
    points = masters[plate] * [-1 if said.mirror else 1, 1, 1]
    for _ in range(casts):
        points = cast(points)
    mounted = points if plate == "bottom" else turned_over(points)
    # a trench lies beyond the face, inside its plate; a ridge stands into the film
    assert np.all(np.sign(mounted[..., 2]) == (side if said.trenches else -side))
    ordered = mounted[:, ::-1] if said.mirror else mounted
    domain, _ = domain_of(ordered, domains)
    assert (domain >= 0).all()
    expected = domains.theta + side * domains.dtheta / 2
    assert line_error(directions(ordered, domain, len(domains)), expected) < 1e-3
    assert said.mirrored[plate] == (said.mirror != (plate == "top"))


def test_one_cast_more_or_less_says_which_flags_change():
    assert advice(2) == advice(4) == advice(0) == ()
    for casts in (1, 3):
        said = " ".join(advice(casts))
        assert "mirror x ON for both plates" in said
        assert "bottom mirrored, top not mirrored" in said
        assert "ridges" in said
        (finding,) = replicated(casts)
        assert finding.severity is Severity.WARNING
    assert replicated(2) == ()
