import numpy as np
import pytest
from sheets import both_masks, design

from lce_workbench.core.domains import partition, signed_area
from lce_workbench.core.mask import LAYERS, flipped, nanometres, written


def test_nanometres_round_to_the_nearest():
    assert nanometres(np.array([1.2345674, -1.2345676, 1e-6, 0.4e-6, -99.9999999])).tolist() == [
        1234567, -1234568, 1, 0, -100000000
    ]  # fmt: skip


def test_the_top_is_mirrored_and_the_bottom_is_not():
    triangle = np.array([[[0.001, 0.002], [0.005, 0.002], [0.001, 0.009]]])
    assert written(triangle, "bottom").tolist() == [[[1000, 2000], [5000, 2000], [1000, 9000]]]
    assert written(triangle, "top").tolist() == [[[-1000, 9000], [-5000, 2000], [-1000, 2000]]]


@pytest.mark.parametrize("plate", ["bottom", "top"])
def test_a_mask_holds_every_layer_in_order_counter_clockwise(plate):
    domains = partition(design())
    _, channels, masks = both_masks(domains)
    mask = masks[plate]
    assert mask.name == {"bottom": "LCE_BOTTOM", "top": "LCE_TOP"}[plate]
    assert list(mask.layers) == list(LAYERS)
    for groups in mask.layers.values():
        for polygons in groups:
            assert polygons.dtype == np.int32
            assert (signed_area(polygons.astype(float)) > 0).all()
            assert np.array_equal(flipped(flipped(polygons)), polygons)
    assert len(mask.channels) == len(channels[plate])
    side = mask.channels[:, 1] - mask.channels[:, 0]
    assert np.allclose(np.hypot(*side.T), channels[plate].length * 1e6, atol=1.5)
    assert sum(map(len, mask.layers["DOMAINS"])) == len(domains)


def test_without_twist_the_masters_are_mirror_images():
    """Both plates get the same channels in sheet coordinates, and mirroring comes after rounding: equal to the bit."""
    _, _, masks = both_masks(partition(design(twist=0.0)))
    for layer in ("CHANNELS", "DOMAINS", "PLATE"):
        for bottom, top in zip(masks["bottom"].layers[layer], masks["top"].layers[layer], strict=True):
            assert np.array_equal(top, flipped(bottom))


def test_with_twist_they_are_not():
    _, _, masks = both_masks(partition(design(twist=0.05)))
    assert not np.array_equal(masks["top"].channels[:50], flipped(masks["bottom"].channels[:50]))


def test_the_pattern_is_exposed_inside_the_sheet_only():
    frame, _, masks = both_masks(partition(design()))
    for mask in masks.values():
        low, high = mask.channels.min(axis=(0, 1)) * 1e-6, mask.channels.max(axis=(0, 1)) * 1e-6
        assert (low >= [frame.sheet.x0, frame.sheet.y0]).all()
        assert (high <= [frame.sheet.x1, frame.sheet.y1]).all()
