"""All formats hold the same polygons: read back by KLayout and gdstk, compared as integers."""

from dataclasses import replace
from itertools import combinations
from pathlib import Path

import ezdxf
import gdstk
import klayout.db as kdb
import numpy as np
import pytest
from sheets import PLAIN, both_masks, design

from lce_workbench.core.digits import billionths, hexadecimals, integers, thousandths
from lce_workbench.core.domains import PLATES, partition
from lce_workbench.core.mask import LAYERS, Mask
from lce_workbench.export import EXPORTERS, cif, dxf, oasis

POLYLINES = 2
"""KLayout's way of reading DXF where closed polylines are polygons and nothing is merged."""


def layout(path):
    """A file as KLayout reads it, 1 nm grid."""
    options = kdb.LoadLayoutOptions()
    options.dxf_unit, options.dxf_dbu, options.dxf_polyline_mode = 1.0, 0.001, POLYLINES
    options.dxf_keep_layer_names = True
    options.cif_dbu = 0.001
    found = kdb.Layout()
    found.read(str(path), options)
    return found


def region(found, name):
    """One layer, by number or by the name that the format has for it."""
    names = {name, cif.LAYERS[name]}
    for index in found.layer_indexes():
        info = found.get_info(index)
        if info.layer == LAYERS[name] or info.name in names:
            polygons = kdb.Region()  # a copy, which outlives the layout
            polygons.insert(found.top_cell().begin_shapes_rec(index))
            polygons.merged_semantics = False
            return polygons
    return kdb.Region()


def regions(path):
    """All layers of a file."""
    found = layout(path)
    return {name: region(found, name) for name in LAYERS}


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    """A sheet with channels at all distances from the origin that occur, in every format."""
    folder = tmp_path_factory.mktemp("formats")
    domains = partition(design(2, 3, width=0.5, height=0.6))
    _, _, masks = both_masks(domains, PLAIN, room=4.0)
    for plate, mask in masks.items():
        for name, write in EXPORTERS.items():
            write(mask, folder / f"{plate}.{name}")
    return folder, masks


@pytest.fixture(scope="module")
def read(files):
    """Every file as KLayout reads it."""
    return {(plate, name): regions(files[0] / f"{plate}.{name}") for plate in files[1] for name in EXPORTERS}


@pytest.mark.parametrize("plate", PLATES)
@pytest.mark.parametrize("pair", [*combinations(EXPORTERS, 2)], ids="-".join)
def test_no_nanometre_differs_between_two_formats(read, plate, pair):
    one, other = (read[plate, name] for name in pair)
    for layer in LAYERS:
        a, b = one[layer], other[layer]
        assert a.count() > 0
        assert (a.count(), a.area()) == (b.count(), b.area())
        assert (a ^ b).is_empty()


@pytest.mark.parametrize("layer", LAYERS)
def test_a_corner_that_is_off_by_a_nanometre_is_seen(files, read, tmp_path, layer):
    mask = files[1]["top"]
    moved = np.concatenate([*mask.layers[layer]])
    moved[-1, 0] += (0, 1)
    EXPORTERS["oas"](replace(mask, layers={**mask.layers, layer: (moved,)}), tmp_path / "moved.oas")
    found = regions(tmp_path / "moved.oas")
    assert [name for name in LAYERS if not (found[name] ^ read["top", "gds"][name]).is_empty()] == [layer]


def test_gdstk_reads_the_oasis(files):
    folder, masks = files
    (cell,) = gdstk.read_oas(folder / "top.oas").cells
    assert cell.name == "LCE_TOP"
    for name, number in LAYERS.items():
        found = cell.get_polygons(layer=number, datatype=0)
        expected = np.concatenate([*masks["top"].layers[name]])
        assert np.abs(np.array([p.points for p in found]) * 1000 - expected).max() < 1e-6


def test_r12_audits_clean(files):
    document = ezdxf.readfile(files[0] / "top.r12.dxf")
    audit = document.audit()
    assert not audit.errors
    assert document.dxfversion == "AC1009"
    assert {layer.dxf.name for layer in document.layers} >= set(LAYERS)
    assert all(e.dxftype() == "POLYLINE" and e.is_closed for e in document.modelspace())
    points = np.array([v.dxf.location.vec2 for e in document.modelspace() for v in e.vertices])
    assert np.abs(document.header["$EXTMAX"][0] - points[:, 0].max()) < 1e-9


@pytest.mark.parametrize("name", EXPORTERS)
def test_two_runs_are_the_same_to_the_byte(files, tmp_path, name):
    folder, masks = files
    EXPORTERS[name](masks["top"], tmp_path / f"again.{name}")
    assert (tmp_path / f"again.{name}").read_bytes() == (folder / f"top.{name}").read_bytes()


@pytest.mark.parametrize("name", EXPORTERS)
def test_a_full_disk_is_an_os_error(files, name):
    with pytest.raises(OSError, match="No space left"):
        EXPORTERS[name](files[1]["top"], Path("/dev/full"))


@pytest.mark.parametrize("write", [oasis.write, dxf.write_r12, cif.write])
def test_polygons_of_any_number_of_corners_far_from_the_origin(tmp_path, write):
    angle = np.arange(7) * 2 * np.pi / 7
    heptagon = np.rint(1e3 * np.stack([np.cos(angle), np.sin(angle)], axis=1)).astype(np.int32)[None]
    triangle = np.array([[[0, 0], [7, -3], [-99_999_999, 5]]], dtype=np.int32)
    path = tmp_path / {oasis.write: "a.oas", dxf.write_r12: "a.dxf", cif.write: "a.cif"}[write]
    write(Mask("top", {"MARKS": (heptagon + 99_000_000, triangle)}), path)
    read_back = layout(path)
    found = region(read_back, "MARKS")
    expected = [p for group in (heptagon + 99_000_000, triangle) for p in group.tolist()]
    read = sorted(sorted((p.x, p.y) for p in polygon.each_point_hull()) for polygon in found.each())
    assert read == sorted(sorted(map(tuple, p)) for p in expected)


def test_digits_are_those_of_the_formatter():
    edges = [0, 1, 9, 10, 99, 999, 1000, 1001, 10_000, 999_999, 10**6, 10**6 + 1, 1_001_000, 10**8, 10**9 - 1]
    values = np.array([*edges, *np.random.default_rng(2).integers(0, 10**9, 2000)], dtype=np.int32)
    for v in (values, -values):
        assert [t.replace(b"\0", b"").decode() for t in thousandths(v).tolist()] == [f"{x / 1000:.3f}" for x in v + 0]
        assert [t.replace(b"\0", b"").decode() for t in integers(v).tolist()] == [f"{x}" for x in v]
    for v in (far := np.concatenate([values.astype(np.int64) * 997, edges])), -far:
        assert [t.replace(b"\0", b"").decode() for t in billionths(v).tolist()] == [f"{x / 1e9:.9f}" for x in v + 0]
    many = np.array([1, 15, 16, 255, 0x1F2E3D, 2**32 - 1])
    assert [t.replace(b"\0", b"").decode() for t in hexadecimals(many).tolist()] == [f"{x:X}" for x in many]
