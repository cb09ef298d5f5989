"""Masks compared with committed ones by KLayout's XOR. `tests/golden/renew.py` writes them anew."""

from dataclasses import replace
from pathlib import Path

import klayout.db as kdb
import numpy as np
import pytest
from golden.renew import FOLDER, small_masks

from lce_workbench.core.mask import LAYERS
from lce_workbench.export import gdsii

PLATES = ("bottom", "top")


def read(path: Path):
    layout = kdb.Layout()
    layout.read(str(path))
    return layout


def differing(path: Path, golden: Path):
    """Layers whose regions differ anywhere, by a nanometre or more."""
    layouts = [read(path), read(golden)]
    regions = (
        (name, *(kdb.Region(x.top_cell().begin_shapes_rec(x.layer(number, 0))) for x in layouts))
        for name, number in LAYERS.items()
    )
    return [name for name, a, b in regions if not (a ^ b).is_empty() or a.count() != b.count()]


@pytest.mark.parametrize("plate", PLATES)
def test_masks_are_the_golden_ones(tmp_path, plate):
    path = tmp_path / "mask.gds"
    gdsii.write(small_masks()[plate], path)
    assert differing(path, FOLDER / f"{plate}.gds.gz") == []
    assert read(path).top_cell().name == read(FOLDER / f"{plate}.gds.gz").top_cell().name


@pytest.mark.parametrize("layer", LAYERS)
def test_a_nanometre_more_is_seen(tmp_path, layer):
    mask = small_masks()["top"]
    polygons = np.concatenate([*mask.layers[layer]])
    polygons[-1, 0, 0] -= 1
    gdsii.write(replace(mask, layers={**mask.layers, layer: (polygons,)}), tmp_path / "mask.gds")
    assert differing(tmp_path / "mask.gds", FOLDER / "top.gds.gz") == [layer]


def test_the_other_plate_is_seen():
    assert {"CHANNELS", "MARKS", "LABELS"} <= set(differing(FOLDER / "bottom.gds.gz", FOLDER / "top.gds.gz"))
