from dataclasses import replace

import numpy as np
import pytest
from sheets import both_masks, design

from lce_solver.types import Severity
from lce_workbench.core.channel_checks import CHANNEL_CHECKS
from lce_workbench.core.channels import ChannelField
from lce_workbench.core.domains import partition
from lce_workbench.core.job import Job
from lce_workbench.core.mask import flipped
from lce_workbench.core.mask_checks import check

DOMAINS = partition(design(3, 4, width=1.0, height=1.1))
JOB = Job()
FRAME, CHANNELS, MASKS = both_masks(DOMAINS, JOB)


def many_corners(_):
    angle = 2 * np.pi * np.arange(5000) / 5000
    return np.rint(2e7 * np.stack([np.cos(angle), np.sin(angle)], axis=1)).astype(np.int32)[None]


def found(mask, domains=DOMAINS):
    return {f.check: f for f in check(mask, ChannelField(domains, mask.plate, JOB.channels), FRAME, JOB)}


def changed(mask, layer, change):
    """The mask with a changed copy of one layer."""
    copy = np.concatenate([*mask.layers[layer]])
    result = change(copy)
    return replace(mask, layers={**mask.layers, layer: (copy if result is None else result,)})


@pytest.mark.parametrize("plate", ["bottom", "top"])
def test_a_good_mask_passes_and_says_what_was_measured(plate):
    findings = found(MASKS[plate])
    assert set(findings) == {*FAULTS}
    for finding in findings.values():
        assert finding.severity is Severity.INFO, finding.message
        assert finding.value is not None
        assert plate in finding.where
    assert 0 < findings["channel_width"].value <= 2
    assert 998 <= findings["channel_spacing"].value <= 1000
    assert 499 <= findings["channel_inset"].value < 502
    assert findings["channel_length"].value >= 1998
    assert findings["channel_angle"].value < 1.5
    assert 0.96 < findings["channel_area"].value < 1


def wider(p):
    p[100, 2] += 3 * np.sign(p[100, 2] - p[100, 1])


def shorter(p):
    p[7, 1:3] = p[7, [0, 3]] + np.rint((p[7, 1:3] - p[7, [0, 3]]) * 1500 / np.hypot(*(p[7, 1] - p[7, 0]))).astype(int)


def across(p, i, by):
    """Move channel ``i`` along its width [nm]."""
    side = (p[i, 3] - p[i, 0]) / np.hypot(*(p[i, 3] - p[i, 0]))
    p[i] += np.rint(by * side).astype(np.int32)


def along(p, i, by):
    side = (p[i, 1] - p[i, 0]) / np.hypot(*(p[i, 1] - p[i, 0]))
    p[i] += np.rint(by * side).astype(np.int32)


def turn_domain(p, degrees=0.002):
    rows = CHANNELS["bottom"].domain == 5
    centre = p[rows].mean(axis=(0, 1))
    angle = np.radians(degrees)
    rotation = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
    p[rows] = np.rint((p[rows] - centre) @ rotation + centre)


def merge_corners(p):
    p[30, 2] = p[30, 1]


def bow_tie(p):
    p[30, [2, 3]] = p[30, [3, 2]]


def shift_first(by):
    def change(p):
        p[0] += np.array(by, dtype=np.int32)

    return change


def half_of_them(p):
    p[::2, 2:] = p[::2, 1::-1] + (p[::2, 2:] - p[::2, 1::-1]) // 2


def onto_the_sheet(p):
    p[0] -= np.rint(p[0].mean(axis=0)).astype(np.int32)


def onto_the_spacer(p):
    p[0, :, 0] += round(FRAME.strips[0].x0 / 1e-6) - p[0, :, 0].max()


def into_the_fill(p):
    p[0] += np.rint(np.array([0.0, FRAME.fill.y0 / 1e-6]) - p[0].mean(axis=0)).astype(np.int32)


def onto_the_next(p):
    p[0] += p[1].min(axis=0) - p[0].min(axis=0) + 1


FAULTS = {
    "channel_width": ("CHANNELS", wider),
    "channel_length": ("CHANNELS", shorter),
    "channel_spacing": ("CHANNELS", lambda p: across(p, 200, 5)),
    "channel_inset": ("CHANNELS", lambda p: along(p, 50, 100)),
    "channel_angle": ("CHANNELS", turn_domain),
    "domain_angle": ("CHANNELS", turn_domain),
    "channel_area": ("CHANNELS", half_of_them),
    "polygon_convex": ("CHANNELS", bow_tie),
    "polygon_edge": ("LABELS", merge_corners),
    "polygon_corners": ("PLATE", many_corners),
    "domain_border": ("DOMAINS", shift_first((2, 0))),
    "marks_sheet": ("MARKS", onto_the_sheet),
    "marks_fill": ("MARKS", into_the_fill),
    "marks_spacer": ("MARKS", onto_the_spacer),
    "marks_disjoint": ("MARKS", onto_the_next),
    "extent": ("PLATE", lambda p: p * 9),
    "plate_margin": ("LABELS", shift_first((-20_000_000, 0))),
}
"""A fault that each check must see."""


@pytest.mark.parametrize("name", FAULTS)
def test_each_check_sees_its_fault(name):
    layer, change = FAULTS[name]
    finding = found(changed(MASKS["bottom"], layer, change))[name]
    expected = Severity.WARNING if name in {"channel_area", "domain_angle"} else Severity.ERROR
    assert finding.severity is expected, finding.message
    assert (finding.value > finding.limit) != (finding.value < finding.limit)


def test_every_channel_check_has_a_fault():
    assert set(CHANNEL_CHECKS) < set(FAULTS)


def test_a_fault_names_its_domain():
    mask = changed(MASKS["bottom"], "CHANNELS", lambda p: along(p, 50, 5000))
    assert found(mask)["channel_inset"].where == f"bottom plate, domain {CHANNELS['bottom'].domain[50]}"


@pytest.mark.parametrize("degrees", [-0.01, 0.01])
def test_a_turn_of_a_hundredth_of_a_degree_is_far_beyond_rounding(degrees):
    finding = found(changed(MASKS["bottom"], "CHANNELS", lambda p: turn_domain(p, degrees)))["channel_angle"]
    assert finding.value > 5 * finding.limit
    assert finding.where == "bottom plate, domain 5"


@pytest.mark.parametrize("size", [0.03, 0.1, 0.3])
@pytest.mark.parametrize("plate", ["bottom", "top"])
def test_rounding_alone_passes_whatever_the_size_of_the_domains(plate, size):
    """The limit scales with what 1 nm can do to channels of that length: small domains turn more, and rightly so."""
    plan = design(16, 16, width=16 * size, height=16 * size)
    domains = partition(plan)
    frame, _, masks = both_masks(domains, JOB)
    findings = check(masks[plate], ChannelField(domains, plate, JOB.channels), frame, JOB)
    value = next(f for f in findings if f.check == "channel_angle").value
    assert 0.05 < value < np.sqrt(2)


def test_an_overlap_is_a_negative_spacing():
    mask = changed(MASKS["top"], "CHANNELS", lambda p: across(p, 200, 1500))
    assert found(mask)["channel_spacing"].value < 0


def test_a_forgotten_mirror_is_seen():
    top = MASKS["top"]
    layers = {name: tuple(flipped(group) for group in groups) for name, groups in top.layers.items()}
    findings = found(replace(top, layers=layers))
    wrong = {name for name, f in findings.items() if f.severity is Severity.ERROR}
    assert {"channel_inset", "channel_angle", "domain_border"} <= wrong


def test_the_angle_check_knows_the_sign_of_the_twist():
    def turn(p):
        """Each channel about its middle, from -(theta + dtheta / 2) to -(theta - dtheta / 2)."""
        middle = p.mean(axis=1, keepdims=True)
        points = (p - middle) @ [1, 1j] * np.exp(1j * DOMAINS.dtheta[CHANNELS["top"].domain])[:, None]
        return np.rint(middle + np.stack([points.real, points.imag], axis=2)).astype(np.int32)

    assert found(changed(MASKS["top"], "CHANNELS", turn))["channel_angle"].value > 0.1
