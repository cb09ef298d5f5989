"""Several designs on one plate: every polygon of every mask, moved by whole nanometres, read back by KLayout."""

import csv

import klayout.db as kdb
import numpy as np
import pytest
from sheets import PLAIN, both_masks, design

from lce_workbench.cli import main
from lce_workbench.core.domains import partition
from lce_workbench.core.mask import LAYERS
from lce_workbench.export import gdsii
from lce_workbench.export.together import DICING, polygons
from lce_workbench.outputs import write_manifest
from lce_workbench.pipeline import versions


def finished(folder, width):
    """An output folder with masks."""
    (folder / "mask").mkdir(parents=True)
    _, _, masks = both_masks(partition(design(2, 3, width=width, height=width)), PLAIN, room=4.0)
    for plate, mask in masks.items():
        gdsii.write(mask, folder / "mask" / f"{plate}.gds")
    write_manifest(folder, {"versions": versions(), "stages": [], "inputs": [], "findings": [], "exit_code": 0})
    return folder


@pytest.fixture(scope="module")
def folders(tmp_path_factory):
    place = tmp_path_factory.mktemp("designs")
    return [finished(place / "one", 0.3), finished(place / "two", 0.5)]


def region(path, layer):
    layout = kdb.Layout()
    layout.read(str(path))
    assert layout.cells() == 1
    found = kdb.Region()
    found.insert(layout.top_cell().shapes(layout.layer(layer, 0)))
    return found


def test_our_reader_gives_what_was_written(tmp_path):
    _, _, masks = both_masks(partition(design(2, 3, width=0.3, height=0.3)), PLAIN, room=4.0)
    gdsii.write(masks["top"], tmp_path / "top.gds")
    found = {}
    for layer, group in polygons(tmp_path / "top.gds"):
        found.setdefault(layer, []).extend(group.tolist())
    for name, groups in masks["top"].layers.items():
        assert found.get(LAYERS[name], []) == [ring for group in groups for ring in group.tolist()]


def test_every_mask_stands_where_the_map_says(folders, tmp_path):
    out = tmp_path / "out"
    assert main(["plate", *map(str, folders), "--size", "5in", "--out", str(out), "--quiet"]) == 0
    rows = list(csv.DictReader((out / "plate.csv").read_text().splitlines()))
    stand = sorted((row["design"], row["plate"]) for row in rows)
    assert stand == [("one", "bottom"), ("one", "top"), ("two", "bottom"), ("two", "top")]
    assert {row["plate"] for row in rows if row["mirrored"] == "yes"} == {"top"}
    for layer in (LAYERS["CHANNELS"], LAYERS["MARKS"], LAYERS["LABELS"]):
        want = kdb.Region()
        for row in rows:
            x, y = (round(float(row[name]) * 1e6) for name in ("x_mm", "y_mm"))
            want += region(row["file"], layer).moved(x, y)
        found = region(out / "plate.gds", layer)
        assert found.count() == want.count() > 0
        assert (found ^ want).is_empty()
    saw, glass = region(out / "plate.gds", DICING), region(out / "plate.gds", LAYERS["PLATE"])
    assert saw.count() == 4 * len(rows)
    boxes = [p.bbox() for p in glass.each()]
    side = max(box.width() for box in boxes)
    assert side == 127_000_000
    assert (saw & kdb.Region([kdb.Polygon(box) for box in boxes if box.width() < side])).is_empty()
    exposed = sum((region(out / "plate.gds", LAYERS[n]) for n in ("CHANNELS", "MARKS", "LABELS", "TEST")), kdb.Region())
    assert (saw & exposed).is_empty()


def test_same_bytes_again(folders, tmp_path):
    for name in ("a", "b"):
        assert main(["plate", *map(str, folders), "--out", str(tmp_path / name), "--quiet"]) == 0
    for name in ("plate.gds", "plate.csv", "plate.png"):
        assert (tmp_path / "a" / name).read_bytes() == (tmp_path / "b" / name).read_bytes()


def test_what_does_not_fit_is_refused(folders, tmp_path, capsys):
    many = [finished(tmp_path / f"d{k}", 0.2) for k in range(9)]
    assert main(["plate", *map(str, many), "--size", "4in", "--out", str(tmp_path / "out")]) == 2
    assert "does not fit on the plate of 101.6 mm" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()
    assert main(["plate", str(folders[0]), str(folders[0]), "--out", str(tmp_path / "out")]) == 2
    assert "named twice" in capsys.readouterr().err


def test_a_design_is_never_replaced(tmp_path, capsys):
    folder = finished(tmp_path / "one", 0.2)
    before = {path.name: path.read_bytes() for path in folder.rglob("*.*")}
    assert main(["plate", str(folder), "--out", str(folder)]) == 2
    assert "is the output folder of a design and would be lost" in capsys.readouterr().err
    assert {path.name: path.read_bytes() for path in folder.rglob("*.*")} == before
    out = tmp_path / "plate"
    for _ in range(2):  # a plate is replaced by a plate
        assert main(["plate", str(folder), "--out", str(out), "--quiet"]) == 0


def test_designs_of_one_name_are_told_apart_and_names_may_hold_commas(tmp_path):
    same = [finished(tmp_path / place / "a, b", 0.2) for place in ("x", "y")]
    other = finished(tmp_path / 'c "d"', 0.2)
    assert main(["plate", *map(str, [*same, other]), "--out", str(tmp_path / "out"), "--quiet"]) == 0
    rows = list(csv.DictReader((tmp_path / "out" / "plate.csv").read_text().splitlines()))
    assert {row["design"] for row in rows} == {*map(str, same), 'c "d"'}
    assert all(row["file"].endswith(f"{row['plate']}.gds") for row in rows)


def test_a_folder_without_gdsii_is_refused(tmp_path, capsys):
    folder = finished(tmp_path / "one", 0.2)
    (folder / "mask" / "top.gds").unlink()
    write_manifest(folder, {"versions": versions(), "stages": [], "inputs": [], "findings": [], "exit_code": 0})
    assert main(["plate", str(folder), "--out", str(tmp_path / "out")]) == 2
    assert "has no masks as GDSII; let its output.masks name gds" in capsys.readouterr().err


def test_a_changed_mask_is_refused(tmp_path, capsys):
    folder = finished(tmp_path / "one", 0.2)
    path = folder / "mask" / "top.gds"
    path.write_bytes(path.read_bytes()[:-100])
    assert main(["plate", str(folder), "--out", str(tmp_path / "out")]) == 2
    assert "is missing or not what manifest.json says" in capsys.readouterr().err


def test_another_gdsii_is_refused(tmp_path):
    layout = kdb.Layout()
    layout.create_cell("X").shapes(layout.layer(1, 0)).insert(kdb.Path([kdb.Point(0, 0), kdb.Point(9, 9)], 2))
    layout.write(str(tmp_path / "x.gds"))
    assert np.sum([len(p) for _, p in polygons(tmp_path / "x.gds")]) == 0
