"""Masks that were tampered with, manifest and all; each is found, at its place, and nothing in an untouched folder."""

from __future__ import annotations

import shutil

import gdstk
import numpy as np
import pytest
from tampering import channels_of, errors, redraw, turned

DOMAIN = 17

RIGHT = np.array([1.0, 0.0])


def each(held, change):
    """Change the channels of a domain."""
    return lambda shapes: [
        (layer, change(points) if held(layer, points) else points)  # one at a time
        for layer, points in shapes
    ]


def test_an_untouched_mask_is_well(masked):
    assert errors(masked) == {}


@pytest.mark.parametrize("plate", ["bottom", "top"])
def test_a_domain_rotated_by_half_a_degree(masked, plate):
    held = channels_of(masked, plate, DOMAIN)
    with np.load(masked / "design.npz") as data:
        middle = data["uv"][data["faces"][DOMAIN]].mean(axis=0) * 1e3 * ([-1, 1] if plate == "top" else [1, 1])
    redraw(masked / "mask" / f"{plate}.gds", each(held, lambda points: turned(points, 0.5, middle)))
    (finding,) = errors(masked)["verify_angle"]
    assert f"{plate}.gds, domain {DOMAIN} at" in finding.where
    assert finding.value == pytest.approx(0.5, abs=1e-3)


def test_a_mask_that_is_not_mirrored(masked):
    redraw(masked / "mask" / "top.gds", lambda shapes: [(layer, points * [-1, 1]) for layer, points in shapes])
    found = errors(masked)
    assert "as seen from above" in found["verify_plate"][0].message or "verify_outline" in found
    assert len(found["verify_chirality"]) >= 8
    assert all("top" in finding.where for finding in found["verify_chirality"])


def test_plates_that_were_exchanged(masked):
    one, other = (masked / "mask" / f"{plate}.gds" for plate in ("bottom", "top"))
    one.rename(masked / "aside")
    other.rename(one)
    (masked / "aside").rename(other)
    found = errors(masked)
    assert [finding.where for finding in found["verify_cell"]] == ["mask/bottom.gds", "mask/top.gds"]
    assert found["verify_chirality"]


def test_channels_wider_by_20_nm(masked):
    held = channels_of(masked, "bottom", DOMAIN)

    def widened(points):
        edge = np.roll(points, -1, axis=0) - points
        long = edge[np.argmax(np.linalg.norm(edge, axis=1))]
        across = np.array([-long[1], long[0]]) / np.linalg.norm(long)
        return points + 0.01 * np.sign((points - points.mean(axis=0)) @ across)[:, None] * across

    redraw(masked / "mask" / "bottom.gds", each(held, widened))
    (finding,) = errors(masked)["verify_width"]
    assert f"bottom.gds, domain {DOMAIN} at" in finding.where
    assert finding.value == pytest.approx(20, abs=2)


def test_a_missing_channel(masked):
    held = channels_of(masked, "top", DOMAIN)

    def change(shapes):
        rows = [i for i, (layer, points) in enumerate(shapes) if held(layer, points)]
        return [shape for i, shape in enumerate(shapes) if i != rows[len(rows) // 2]]

    redraw(masked / "mask" / "top.gds", change)
    found = errors(masked)
    assert f"top.gds, domain {DOMAIN} at" in found["verify_count"][0].where
    assert found["verify_count"][0].value == 1
    assert found["verify_spacing"][0].value == pytest.approx(2000, abs=2)
    assert f"domain {DOMAIN} at" in found["verify_spacing"][0].where
    assert found["verify_job_sheet"]


@pytest.mark.parametrize("shift", [(1.0, 0.0), (0.0, 1.0)])
def test_a_domain_shifted_by_1_um(masked, shift):
    held = channels_of(masked, "bottom", DOMAIN)
    redraw(masked / "mask" / "bottom.gds", each(held, lambda points: points + shift))
    found = errors(masked)
    assert f"bottom.gds, domain {DOMAIN} at" in found["verify_border"][0].where


def test_channels_that_are_too_short(masked):
    held = channels_of(masked, "bottom", DOMAIN)

    def shortened(points):
        edge = np.roll(points, -1, axis=0) - points
        long = edge[np.argmax(np.linalg.norm(edge, axis=1))]
        unit = long / np.linalg.norm(long)
        return points - 0.5 * np.sign((points - points.mean(axis=0)) @ unit)[:, None] * unit

    redraw(masked / "mask" / "bottom.gds", each(held, shortened))
    found = errors(masked)
    assert set(found) == {"verify_reach", "verify_job_sheet"}
    assert f"domain {DOMAIN} at" in found["verify_reach"][0].where


def test_a_mark_moved_by_1_um(masked):
    def change(shapes):
        x, y = _cluster(masked, "upper right")
        near = lambda points: np.all(np.abs(points.mean(axis=0) - (-x + 180, y - 30)) < 210)
        return [(layer, points + RIGHT if layer == 2 and near(points) else points) for layer, points in shapes]

    redraw(masked / "mask" / "top.gds", change)
    found = errors(masked)
    for check in ("verify_marks", "verify_mark_place", "verify_overlay"):
        assert all("upper right" in finding.where for finding in found[check]), found[check]
    assert found["verify_overlay"][0].value == pytest.approx(1000, abs=2)
    assert "box in box" in found["verify_overlay"][0].message


def _cluster(folder, name):
    """Middle of a cluster [um]."""
    row = next(r for r in (folder / "mask" / "readings.csv").read_text().splitlines() if r.startswith(name))
    return [float(word) * 1e3 for word in row.split(",")[1:3]]


def test_records_that_do_not_belong_there(masked):
    path = masked / "mask" / "bottom.gds"
    library = gdstk.read_gds(path)
    library.cells[0].add(gdstk.Label("top secret", (0, 0), layer=3), gdstk.Polygon([(0, 0), (1, 0), (1, 1)], layer=77))
    library.write_gds(path)
    found = errors(masked)
    assert "1 labels" in found["verify_records"][0].message
    assert "77/0" in found["verify_layers"][0].message


def test_a_coarser_grid(masked):
    path = masked / "mask" / "top.gds"
    library = gdstk.read_gds(path)
    library.precision = 5e-9
    library.write_gds(path)
    assert "5 nm" in errors(masked)["verify_grid"][0].message


def test_a_file_cut_short(masked):
    path = masked / "mask" / "top.gds"
    path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])
    (finding,) = errors(masked)["verify_mask"]
    assert "top.gds" in finding.message
    assert "cannot be read" in finding.message


def test_a_domain_outline_that_was_moved(masked):
    seen = iter(range(10**9))

    def change(shapes):
        return [(la, p + RIGHT if la == 11 and next(seen) == DOMAIN else p) for la, p in shapes]

    redraw(masked / "mask" / "bottom.gds", change)
    found = errors(masked)
    assert f"domain {DOMAIN} at" in found["verify_outline"][0].where
    assert "DOMAINS" in found["verify_overlay"][0].where


def test_formats_that_contradict_each_other(copy, masked):
    """DXF scaled by 1.001, another channel in OASIS, a polygon of CIF moved."""
    for name in ("bottom.oas", "bottom.dxf", "bottom.cif"):
        shutil.copy(copy / "mask" / name, masked / "mask" / name)
    job = masked / "job.toml"
    job.write_text(job.read_text().replace('["gds"]', '["gds", "oas", "dxf", "cif"]'))
    library = gdstk.read_oas(masked / "mask" / "bottom.oas")
    library.cells[0].remove(library.cells[0].polygons[5])
    library.write_oas(masked / "mask" / "bottom.oas")
    lines = (masked / "mask" / "bottom.dxf").read_text().splitlines()
    for i in range(0, len(lines) - 1, 2):
        if lines[i].strip() in {"10", "20"} and i > lines.index("ENTITIES"):
            lines[i + 1] = f"{float(lines[i + 1]) * 1.001:.3f}"
    (masked / "mask" / "bottom.dxf").write_text("\n".join(lines) + "\n")
    found = errors(masked)
    told = " ".join(finding.message for finding in found["verify_formats"])
    assert "bottom.oas, CHANNELS" in told
    assert "1.001000 of the other's" in told
    assert "bottom.cif" not in told
    assert any("bottom.dxf" in finding.where for finding in found["verify_outline"])
    assert any("mask/top.oas" in finding.message for finding in found["verify_mask"])  # it is missing
