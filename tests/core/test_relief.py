"""The rounded relief against what blurring may not change, and the files against the arrays."""

import json

import numpy as np
import pytest
from PIL import Image
from scipy.ndimage import gaussian_filter

from lce_workbench.cad.meshes import FINE, surface
from lce_workbench.core.channels import Channels
from lce_workbench.core.frame import Rect
from lce_workbench.core.job import Output
from lce_workbench.core.relief import cleared, dose, near, relief, window_of
from lce_workbench.export.relief import write_relief

UM = 1e-3


def channels(centres, length, width=1.0, angle=0.0):
    """Channels of one domain, in um."""
    n = len(centres)
    places = np.asarray(centres, float) * UM
    return Channels(
        "bottom", places, np.array([angle]), np.full(n, length * UM), np.zeros(n, int), width * UM, 0.6 * UM
    )


def grid(reach, pixel):
    """Middles of pixels from -reach to reach, um."""
    n = round(2 * reach / pixel)
    return (np.arange(n) + 0.5 - n / 2) * pixel * UM


@pytest.mark.parametrize("angle", [0.0, 0.6, 2.0])
def test_the_blur_conserves_volume(angle):
    found = channels([(0, 0), (1, 2.5)], 6.0, angle=angle)
    at = grid(8, 0.05)
    total = dose(found, at, at, 0.2 * UM).sum() * (0.05 * UM) ** 2
    assert total == pytest.approx(2 * 6e-3 * 1e-3, rel=1e-9)
    assert cleared(dose(found, at, at, 0.2 * UM), 1.0).sum() * (0.05 * UM) ** 2 == pytest.approx(total, rel=1e-9)


def test_the_middle_of_a_wide_pad_is_cleared_to_the_full_depth():
    pad = channels([(0, 0)], 20.0, width=20.0)
    made = relief(pad, Rect(-1e-3, -1e-3, 1e-3, 1e-3), Output())
    np.testing.assert_allclose(made.height, -0.6e-3, rtol=1e-12)
    far = relief(pad, Rect(0.02, 0.02, 0.021, 0.021), Output())
    assert np.abs(far.height).max() == 0


def test_an_edge_is_half_exposed_and_the_resist_answers_symmetrically():
    pad = channels([(0, 0)], 20.0, width=20.0)
    assert dose(pad, np.array([10.0 * UM]), np.array([0.0]), 0.2 * UM) == pytest.approx(0.5)
    shares = np.linspace(0, 1, 41)
    for contrast in (1.0, 2.0, 8.0):
        np.testing.assert_allclose(cleared(shares, contrast) + cleared(1 - shares, contrast), 1, rtol=1e-12)
        assert np.all(np.diff(cleared(shares, contrast)) > 0)
    np.testing.assert_allclose(cleared(shares, 1.0), shares, atol=1e-15)
    assert cleared(np.array([0.6]), 60.0) > 1 - 1e-9


def test_a_grating_is_periodic_and_symmetric_about_its_lines():
    lines = channels([(0, 2.0 * k) for k in range(-10, 11)], 60.0)
    y = grid(3, 0.05)
    found = dose(lines, np.array([0.0]), y, 0.2 * UM)[:, 0]
    period = round(2.0 / 0.05)
    np.testing.assert_allclose(found[period:], found[:-period], atol=1e-12)
    np.testing.assert_allclose(found, found[::-1], atol=1e-12)
    half = period // 2  # lines are as wide as lands: half a period on, what was cleared is kept
    np.testing.assert_allclose(found[half:] + found[:-half], 1, atol=1e-9)


def test_the_closed_form_is_the_convolution():
    """A fine binary picture, convolved by a program that knows nothing of error functions."""
    at = grid(5, 0.02)
    binary = (np.abs(at)[None] < 1.5 * UM) & (np.abs(at)[:, None] < 0.5 * UM)
    want = gaussian_filter(binary.astype(float), 0.2 / 0.02, truncate=7)
    np.testing.assert_allclose(dose(channels([(0, 0)], 3.0), at, at, 0.2 * UM), want, atol=3e-4)


def test_only_channels_near_the_window_count_and_none_is_missed():
    many = channels([(x, y) for x in range(-40, 41, 8) for y in range(-40, 41, 2)], 6.0, angle=0.7)
    window = Rect(-3e-3, -3e-3, 3e-3, 3e-3)
    some = near(many, window, 0.2 * UM)
    assert 0 < len(some) < len(many) / 4
    at = grid(3, 0.1)
    np.testing.assert_allclose(dose(some, at, at, 0.2 * UM), dose(many, at, at, 0.2 * UM), atol=1e-9)


def test_the_png_with_its_json_gives_the_heights_back(tmp_path):
    output = Output(relief_pixel_nm=100.0)
    made = relief(channels([(0, 0), (0.5, 2.0)], 4.0, angle=0.3), Rect(-3e-3, -2e-3, 3e-3, 4e-3), output)
    write_relief(made, output, tmp_path / "relief_bottom.png")
    scale = json.loads((tmp_path / "relief_bottom.json").read_text())
    with Image.open(tmp_path / "relief_bottom.png") as picture:
        assert picture.mode == "I;16"
        grey = np.array(picture)
        assert json.loads(picture.text["Comment"]) == scale
        assert picture.info["dpi"] == pytest.approx((254000, 254000), rel=1e-6)
    low, high = scale["height_nm_at_0"], scale["height_nm_at_65535"]
    np.testing.assert_allclose((low + grey / 65535 * (high - low))[::-1] * 1e-6, made.height, atol=0.6e-3 / 65535)
    x = (scale["left_um"] + (np.arange(grey.shape[1]) + 0.5) * scale["pixel_um"]) * UM
    np.testing.assert_allclose(x, made.x, atol=1e-9)
    assert "approximate" in scale["note"]


def test_the_mesh_lies_on_the_heights_and_stays_small():
    made = relief(channels([(0, 0)], 10.0), Rect(-15e-3, -15e-3, 15e-3, 15e-3), Output())
    points, triangles = surface(made)
    assert len(triangles) <= FINE
    assert {tuple(p) for p in points} <= {
        (x, y, z) for y, row in zip(made.y, made.height, strict=True) for x, z in zip(made.x, row, strict=True)
    }
    a, b, c = points[triangles].transpose(1, 0, 2)
    assert np.all(np.cross(b - a, c - a)[:, 2] > 0)


def test_the_window_is_the_job_s_or_30_um_about_the_middle():
    assert window_of(Output(), np.array([1.0, 2.0])) == Rect(0.985, 1.985, 1.015, 2.015)
    window = window_of(Output(step_window_um=(5, 9, 1, 3)), np.zeros(2))
    np.testing.assert_allclose(window.ring[[0, 2]], [(1e-3, 3e-3), (5e-3, 9e-3)], rtol=1e-12)
