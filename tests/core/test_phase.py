"""Do channels of neighbours meet, measured on the channels themselves?"""

from dataclasses import replace

import numpy as np
import pytest
from sheets import design

from lce_workbench.core.borders import borders
from lce_workbench.core.channels import hatch
from lce_workbench.core.domains import partition
from lce_workbench.core.job import ChannelSpec
from lce_workbench.core.phase import PROBES, aligned, meeting, offsets

SPEC = ChannelSpec(align_phase=True)
DOMAINS = partition(design(4, 5, width=1.2, height=1.5, twist=0.0))


def with_phase(domains, angle):
    domains = replace(domains, theta=np.mod(angle, np.pi))
    return replace(domains, phase=aligned(domains, borders(domains), SPEC))


def lines(domains, channels, domain):
    """Distance of each channel of a domain from the origin, across its direction [mm]."""
    angle = domains.angle(channels.plate)[domain]
    return channels.centre[channels.domain == domain] @ [-np.sin(angle), np.cos(angle)]


@pytest.mark.parametrize("angle", [0.4, 0.0, 3.0])
def test_with_one_direction_all_channels_lie_on_common_lines(angle):
    domains = with_phase(DOMAINS, np.full(len(DOMAINS), angle))
    channels = hatch(domains, "bottom", SPEC)
    place = np.concatenate([lines(domains, channels, k) for k in range(len(domains))])
    turns = np.exp(2j * np.pi * place / SPEC.pitch)
    assert np.abs(turns - turns[0]).max() < 1e-6
    centred = np.concatenate([lines(domains, hatch(domains, "bottom", ChannelSpec()), k) for k in range(len(domains))])
    assert np.abs(np.mean(np.exp(2j * np.pi * centred / SPEC.pitch))) < 0.5


def test_lines_either_side_of_zero_degrees_meet_too():
    """Directions of 0.02 and 179.98 degrees: the normals point to opposite sides."""
    near = np.where(np.arange(len(DOMAINS)) % 2, 1, -1) * np.radians(0.02)
    domains = with_phase(DOMAINS, near)
    off, _ = offsets(domains, "bottom", borders(domains), SPEC)
    middle = off[:, PROBES // 2]
    assert np.median(middle) < 0.05e-3
    assert np.sqrt(np.mean(middle**2)) < 0.25e-3


def test_the_reported_offset_is_that_of_the_channels():
    domains = with_phase(DOMAINS, DOMAINS.theta)
    found = borders(domains)
    off, _ = offsets(domains, "top", found, SPEC)
    channels = hatch(domains, "top", SPEC)
    angle = domains.angle("top")
    near = np.abs((angle[found.pair[:, 0]] - angle[found.pair[:, 1]] + np.pi / 2) % np.pi - np.pi / 2) < np.radians(5)
    pairs, middles = found.pair[near], ((found.start + found.end) / 2)[near]
    measured = []
    for pair, middle in zip(pairs, middles, strict=True):
        place = []
        for k in pair:
            across = np.array([-np.sin(angle[k]), np.cos(angle[k])])
            here = middle @ across - lines(domains, channels, k)
            place.append((here[np.argmin(np.abs(here))], across))
        (a, n), (b, m) = place
        apart = (a - np.sign(n @ m) * b + SPEC.pitch / 2) % SPEC.pitch - SPEC.pitch / 2
        measured.append(abs(apart))
    np.testing.assert_allclose(off[:, PROBES // 2], measured, atol=1e-9)


def test_it_is_better_than_chance_and_says_so():
    domains = with_phase(DOMAINS, DOMAINS.theta)
    chance = SPEC.pitch * 1e3 / np.sqrt(12)
    for finding in meeting(domains, borders(domains), SPEC):
        assert finding.value < 0.8 * chance
        assert f"{finding.value:.2f} um rms" in finding.message
    scattered = replace(domains, phase=np.random.default_rng(1).uniform(0, SPEC.pitch, (len(domains), 2)))
    value = meeting(scattered, borders(domains), SPEC)[0].value
    assert value == pytest.approx(chance, rel=0.3)


def test_channels_stay_inside_whatever_the_phase():
    free, bound = hatch(DOMAINS, "top", ChannelSpec()), hatch(with_phase(DOMAINS, DOMAINS.theta), "top", SPEC)
    assert np.abs(free.counts - bound.counts).max() <= 1
    assert bound.areas.sum() == pytest.approx(free.areas.sum(), rel=2e-3)
