"""ezdxf and KLayout read what we write."""

import time

import ezdxf
import klayout.db as kdb
import numpy as np
import pytest
from sheets import PLAIN, both_masks, design

from lce_workbench.core.domains import partition
from lce_workbench.core.mask import LAYERS
from lce_workbench.export import dxf, gdsii

PLATES = ("bottom", "top")


def ordered(polygons):
    """Corners as complex numbers, sorted in each polygon, and the polygons sorted."""
    corners = np.sort(polygons[..., 0] + 1j * polygons[..., 1], axis=1)
    return corners[np.lexsort(corners.T)]


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    folder = tmp_path_factory.mktemp("dxf")
    _, _, masks = both_masks(partition(design(2, 3, width=0.5, height=0.6)), PLAIN, room=4.0)
    for plate in PLATES:
        dxf.write(masks[plate], folder / f"{plate}.dxf")
        gdsii.write(masks[plate], folder / f"{plate}.gds")
    return folder, masks


@pytest.mark.parametrize("plate", PLATES)
def test_it_audits_clean(files, plate):
    document = ezdxf.readfile(files[0] / f"{plate}.dxf")
    audit = document.audit()
    assert not audit.errors
    assert not audit.fixes
    assert document.dxfversion == "AC1015"
    assert document.header["$INSUNITS"] == 13
    assert {layer.dxf.name for layer in document.layers} >= set(LAYERS)
    assert {entity.dxf.layer for entity in document.modelspace()} == set(LAYERS)
    assert all(e.dxftype() == "LWPOLYLINE" and e.closed for e in document.modelspace())
    new = document.modelspace().add_lwpolyline([(0, 0), (1, 1)])  # $HANDSEED lies beyond all handles
    assert not document.audit().errors
    assert int(new.dxf.handle, 16) > max(int(e.dxf.handle, 16) for e in document.modelspace() if e is not new)


@pytest.mark.parametrize("plate", PLATES)
def test_its_coordinates_are_those_of_the_gds(files, plate):
    folder, _ = files
    layout = kdb.Layout()
    layout.read(str(folder / f"{plate}.gds"))
    document = ezdxf.readfile(folder / f"{plate}.dxf")
    for name, number in LAYERS.items():
        drawn = document.modelspace().query(f'*[layer=="{name}"]')
        found = np.array([e.get_points("xy") for e in drawn]) * 1000
        assert np.abs(found - np.rint(found)).max() < 1e-4
        shapes = layout.top_cell().shapes(layout.layer(number, 0))
        expected = np.array([[(p.x, p.y) for p in s.polygon.each_point_hull()] for s in shapes.each()])
        assert np.array_equal(ordered(np.rint(found)), ordered(expected))


def test_a_second_reader_sees_the_same_area(files):
    folder, masks = files
    options = kdb.LoadLayoutOptions()
    options.dxf_unit, options.dxf_dbu, options.dxf_polyline_mode = 1.0, 0.001, 2
    options.dxf_keep_layer_names = True
    layout = kdb.Layout()
    layout.read(str(folder / "top.dxf"), options)
    index = next(i for i in layout.layer_indexes() if layout.get_info(i).name == "CHANNELS")
    region = kdb.Region(layout.top_cell().begin_shapes_rec(index))
    assert region.count() == len(masks["top"].channels)
    p = masks["top"].channels.astype(np.int64)
    d, e = p[:, 2] - p[:, 0], p[:, 3] - p[:, 1]
    assert sum(polygon.area2() for polygon in region.each()) == np.sum(d[:, 0] * e[:, 1] - d[:, 1] * e[:, 0])


def test_two_runs_are_the_same_to_the_byte(files, tmp_path):
    folder, masks = files
    time.sleep(1.1)  # ezdxf's stamps count seconds
    dxf.write(masks["top"], tmp_path / "again.dxf")
    assert (tmp_path / "again.dxf").read_bytes() == (folder / "top.dxf").read_bytes()
    assert not ezdxf.options.write_fixed_meta_data_for_testing
