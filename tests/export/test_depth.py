"""The solids of the channels in STEP are the rectangles of the masks on the grid: as many, same area, same corners."""

from collections.abc import Iterator

import gdstk
import klayout.db as kdb
import numpy as np
import pytest
from OCP.BRep import BRep_Tool
from OCP.TopAbs import TopAbs_VERTEX
from OCP.TopExp import TopExp_Explorer
from OCP.TopoDS import TopoDS
from sheets import PLAIN, both_masks, design

from lce_workbench.cad.instances import write_channels
from lce_workbench.cad.part21 import part21
from lce_workbench.cad.reread import solids_in, volume_of
from lce_workbench.core.domains import PLATES, partition
from lce_workbench.export import EXPORTERS

FINEST = 2e-3
"""STEP holds places to a thousandth of a nanometre; so a corner between two grid points may fall to either [nm]."""


@pytest.fixture(scope="module")
def written(tmp_path_factory):
    """Per plate: the mask as GDSII, its channels as STEP, as both programs read them, and the channels."""
    folder = tmp_path_factory.mktemp("depth")
    _, channels, masks = both_masks(partition(design(2, 3, width=0.5, height=0.6)), PLAIN, room=4.0)
    found = {}
    for plate, mask in masks.items():
        EXPORTERS["gds"](mask, folder / f"{plate}.gds")
        with part21(folder / f"channels_{plate}.step") as out:
            write_channels(out, [channels[plate]], PLAIN.sheet.thickness, "mapped")
        solids = solids_in(folder / f"channels_{plate}.step")
        found[plate] = folder / f"{plate}.gds", solids, channels[plate]
    return found


def corners(solid) -> Iterator[tuple[float, float]]:
    """Where the upright edges of a solid stand [mm]."""
    explorer = TopExp_Explorer(solid, TopAbs_VERTEX)
    while explorer.More():
        point = BRep_Tool.Pnt_s(TopoDS.Vertex_s(explorer.Current()))
        yield point.X(), point.Y()
        explorer.Next()


@pytest.mark.parametrize("plate", PLATES)
def test_as_many_solids_as_polygons_and_the_same_area(written, plate):
    path, solids, channels = written[plate]
    mask = kdb.Layout()
    mask.read(str(path))
    drawn = kdb.Region(mask.top_cell().begin_shapes_rec(mask.layer(1, 0)))
    drawn.merged_semantics = False
    assert drawn.count() == len(solids) == len(channels)
    area = sum(map(volume_of, solids)) / channels.depth
    assert area == pytest.approx((channels.length * channels.width).sum(), rel=1e-9)
    # The grid moves each corner by its own fraction of 1 nm: sqrt(1/12) nm along every axis.
    spread = np.sqrt((channels.length**2).sum() / 12) * 1e-6
    assert abs(drawn.area() * 1e-12 - area) < 4 * spread
    assert spread < 1e-5 * area


@pytest.mark.parametrize("plate", PLATES)
def test_every_corner_on_the_mask_is_the_solid_s_on_the_grid(written, plate):
    """The solids stand in the cell, where nothing is mirrored; the top plate's mask is."""
    path, solids, _ = written[plate]
    (cell,) = gdstk.read_gds(path).cells
    drawn = np.array([polygon.points for polygon in cell.get_polygons(layer=1, datatype=0)]) * 1000
    drawn[..., 0] *= {"bottom": 1, "top": -1}[plate]
    for solid, polygon in zip(solids, drawn, strict=True):
        exact = np.unique(np.round([*corners(solid)], 10), axis=0) * 1e6
        off = np.abs(exact[:, None] - polygon).max(axis=2)
        assert len(exact) == 4
        assert sorted(off.argmin(axis=1)) == [0, 1, 2, 3]
        assert off.min(axis=1).max() <= 0.5 + FINEST
