"""KLayout reads what we write."""

import csv

import klayout.db as kdb
import numpy as np
import pytest
from sheets import both_masks, design

from lce_workbench.core.domains import partition
from lce_workbench.core.job import ChannelSpec, Job
from lce_workbench.core.mask import LAYERS, Mask
from lce_workbench.export import gdsii
from lce_workbench.export.table import write_table

PLATES = ("bottom", "top")


def read(path):
    layout = kdb.Layout()
    layout.read(str(path))
    return layout


def polygons(layout, layer):
    """Corners of each polygon (n, k, 2) [nm], in no particular order of polygons."""
    shapes = layout.top_cell().shapes(layout.layer(layer, 0))
    return np.array([[(p.x, p.y) for p in shape.polygon.each_point_hull()] for shape in shapes.each()])


def ordered(found):
    """Corners as complex numbers, sorted in each polygon, and the polygons sorted."""
    corners = np.sort(found[..., 0] + 1j * found[..., 1], axis=1)
    return corners[np.lexsort(corners.T)]


@pytest.fixture(scope="module")
def sheet(tmp_path_factory):
    """A sheet of 504 domains, its masks and table as files, and KLayout's reading."""
    folder = tmp_path_factory.mktemp("mask")
    domains = partition(design(14, 18, width=5.0, height=5.2))
    _, channels, masks = both_masks(domains)
    for plate in PLATES:
        gdsii.write(masks[plate], folder / f"{plate}.gds")
    write_table(domains, [channels[plate].counts for plate in PLATES], folder / "domains.csv")
    with (folder / "domains.csv").open() as file:
        table = list(csv.DictReader(file))
    return domains, channels, masks, table, {plate: read(folder / f"{plate}.gds") for plate in PLATES}


@pytest.mark.parametrize("plate", PLATES)
def test_one_flat_cell_of_polygons_on_a_nanometre_grid(sheet, plate):
    *_, layouts = sheet
    layout = layouts[plate]
    assert [cell.name for cell in layout.each_cell()] == [f"LCE_{plate.upper()}"]
    assert layout.dbu == 0.001
    found = {(info.layer, info.datatype) for info in layout.layer_infos()}
    assert found == {(1, 0), (2, 0), (3, 0), (4, 0), (10, 0), (11, 0), (12, 0), (13, 0)}
    cell = layout.top_cell()
    assert cell.child_instances() == 0
    for index in layout.layer_indexes():
        shapes = cell.shapes(index)
        assert shapes.size() == sum(1 for _ in shapes.each(kdb.Shapes.SPolygons | kdb.Shapes.SBoxes))


@pytest.mark.parametrize("plate", PLATES)
def test_every_layer_comes_back_to_the_nanometre(sheet, plate):
    _, _, masks, _, layouts = sheet
    for name, number in LAYERS.items():
        expected = np.concatenate([*masks[plate].layers[name]])
        assert np.array_equal(ordered(polygons(layouts[plate], number)), ordered(expected))


@pytest.mark.parametrize("plate", PLATES)
def test_angle_and_width_in_200_domains(sheet, plate):
    domains, _, _, table, layouts = sheet
    cell, layer = layouts[plate].top_cell(), layouts[plate].layer(1, 0)
    side = -1 if plate == "top" else 1
    picked = np.random.default_rng(7).choice(len(domains), 200, replace=False)
    for d in picked:
        x, y = side * float(table[d]["x_mm"]) * 1e3, float(table[d]["y_mm"]) * 1e3
        centre = kdb.DBox(x - 3, y - 3, x + 3, y + 3)
        near = (item.shape().polygon for item in cell.begin_shapes_rec_touching(layer, centre))
        found = [[(p.x, p.y) for p in q.each_point_hull()] for q in near if q.touches(centre.to_itype(0.001))]
        assert len(found) >= 2
        assert all(len(p) == 4 for p in found)
        p = np.array(found, dtype=float)
        long = np.linalg.norm(p[:, 1] - p[:, 0], axis=1) > np.linalg.norm(p[:, 2] - p[:, 1], axis=1)
        p[~long] = np.roll(p[~long], 1, axis=1)  # now the first and third edge are long
        u = p[:, 1] - p[:, 0]
        angle = np.degrees(np.arctan2(u[:, 1], u[:, 0]))
        error = (angle - float(table[d][f"written_{plate}_deg"]) + 90) % 180 - 90
        assert np.abs(error).max() < 0.02
        seen = (side * angle - float(table[d][f"theta_{plate}_deg"]) + 90) % 180 - 90
        assert np.abs(seen).max() < 0.02
        for end in (2, 3):
            v = p[:, end] - p[:, 0]
            width = np.abs(u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]) / np.linalg.norm(u, axis=1)
            assert np.abs(width - 1000).max() <= 2


@pytest.mark.parametrize("plate", PLATES)
def test_channel_area_is_duty_times_sheet_and_the_sum_of_channels(sheet, plate):
    domains, channels, _, table, layouts = sheet
    area = kdb.Region(layouts[plate].top_cell().begin_shapes_rec(layouts[plate].layer(1, 0)))
    area.merged_semantics = False
    assert np.isclose(area.area() * 1e-12, channels[plate].areas.sum(), rtol=1e-5)  # the grid rounds each width
    assert 0.96 < area.area() * 1e-12 / (domains.area.sum() * 0.5) < 1
    assert area.count() == sum(int(row[f"channels_{plate}"]) for row in table)


@pytest.mark.parametrize("guard", [0.4, 0.5, 1.5])
def test_nothing_comes_closer_than_the_lands(tmp_path, guard):
    """KLayout's own spacing check: lands inside domains are the spacing wide, between domains two guards."""
    job = Job(channels=ChannelSpec(spacing_um=1.0, guard_um=guard))
    _, _, masks = both_masks(partition(design(2, 3, width=0.12, height=0.15)), job)
    gdsii.write(masks["top"], tmp_path / "top.gds")
    layout = read(tmp_path / "top.gds")
    region = kdb.Region(layout.top_cell().begin_shapes_rec(layout.layer(1, 0)))
    assert region.area() == region.merged().area() == sum(p.area() for p in region.each())
    least = round(min(1000, 2000 * guard)) - 2
    assert region.space_check(least).count() == 0
    assert region.space_check(least + (5 if guard >= 0.5 else 150)).count() > 0


def test_polygons_of_any_number_of_corners(tmp_path):
    angle = np.arange(7) * 2 * np.pi / 7
    heptagon = np.rint(1e5 * np.stack([np.cos(angle), np.sin(angle)], axis=1)).astype(np.int32)[None]
    triangle = np.array([[[0, 0], [-99_999_999, 5], [7, -3]]], dtype=np.int32)[:, ::-1]
    gdsii.write(Mask("top", {"MARKS": (heptagon, triangle)}), tmp_path / "a.gds")
    layout = read(tmp_path / "a.gds")
    found = [list(s.polygon.each_point_hull()) for s in layout.top_cell().shapes(layout.layer(2, 0)).each()]
    expected = [p for group in (heptagon, triangle) for p in group.tolist()]
    assert sorted(sorted((p.x, p.y) for p in f) for f in found) == sorted(sorted(map(tuple, p)) for p in expected)
