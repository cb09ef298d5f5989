import os
import re
import subprocess
import sys
import time
from collections import Counter
from pathlib import Path

import numpy as np
import pytest
from cad.cad_sample import job, solids
from cad.readers import centroid, valid, volume

from lce_solver.errors import EnvironmentFault
from lce_workbench.cad.step import CHANNEL_FILES, FILES, write_cad
from lce_workbench.core.cell import LOOKS

ROOT = Path(__file__).parents[2]
STEPS = [name for name in FILES if name.endswith(".step")]
PICK = FILES | {name: lambda cell, group=name[:-5]: cell.group(group) for name in CHANNEL_FILES}


def by_name(prisms):
    grouped = {}
    for prism in prisms:
        grouped.setdefault(prism.name, []).append(prism)
    return grouped


@pytest.mark.parametrize("name", STEPS)
def test_read_back_names_numbers_volumes_and_validity(read, sample, name):
    """A reader without cadquery finds every product with its solids, in order, valid, where it belongs."""
    want = by_name(FILES[name](sample))
    found = {product.path[-1]: product for product in read(name)}
    assert list(found) == list(want)
    for label, prisms in want.items():
        assert len(found[label].solids) == len(prisms)
        for shape, prism in zip(found[label].solids, prisms, strict=True):
            assert volume(shape) == pytest.approx(prism.volume, rel=1e-9)
            np.testing.assert_allclose(centroid(shape), prism.centroid, atol=1e-9)
            assert valid(shape)


def test_channel_solids_are_length_width_depth_to_a_millionth(read, sample):
    for plate in ("bottom", "top"):
        solids = [s for p in read(f"channels_{plate}.step") for s in p.solids]
        lengths = [np.linalg.norm(p.outline[1] - p.outline[0]) for p in sample.group(f"channels_{plate}")]
        np.testing.assert_allclose([volume(s) for s in solids], np.multiply(lengths, 1e-3 * 0.6e-3), rtol=1e-6)


@pytest.mark.parametrize("name", STEPS)
def test_colours_of_an_xcaf_reader_are_those_of_the_table(read, sample, name):
    want = {label: (*prisms[0].colour, prisms[0].opacity) for label, prisms in by_name(FILES[name](sample)).items()}
    for product in read(name):
        np.testing.assert_allclose(product.colour, want[product.path[-1]], atol=1e-6)


def test_all_colours_differ():
    assert len({colour for colour, _ in LOOKS.values()}) == len(LOOKS)


def test_the_cell_is_an_assembly_of_plates_spacer_and_sheet(read):
    paths = [product.path[:-1] for product in read("cell.step")]
    assert Counter(paths) == {
        ("cell", "bottom_plate"): 3,
        ("cell", "spacer"): 2,
        ("cell", "glue"): 2,
        ("cell",): 1,
        ("cell", "top_plate"): 3,
    }
    assert {product.path[:-1] for product in read("top_plate.step")} == {("top_plate",)}


def test_files_are_millimetres_and_ascii_and_name_no_machine(written):
    for name in STEPS:
        text = (written / name).read_bytes().decode("ascii")
        assert len(re.findall(r"SI_UNIT\(\.MILLI\.,\.METRE\.\)", text)) == text.count("LENGTH_UNIT()")
        assert "AUTOMOTIVE_DESIGN" in text[:600]
        header = text[: text.index("DATA;")]
        assert f"FILE_NAME('{name[:-5]}','1980-01-01T00:00:00'" in header
        assert os.uname().nodename not in header


def test_the_same_bytes_in_another_second_and_another_process(written, tmp_path):
    """Clock, addresses in memory and the number of files written before leave no trace."""
    time.sleep(max(0.0, (written / "channels_top.step").stat().st_mtime + 1.1 - time.time()))
    script = (
        "import sys, pathlib; from cad.cad_sample import cell, job, solids; "
        "from lce_workbench.cad.step import FILES, write_cad; "
        "FILES.pop('spacer.step'); write_cad(cell(), solids(), job(), pathlib.Path(sys.argv[1]))"
    )
    path = os.pathsep.join(str(ROOT / part) for part in ("", "solver", "tests"))
    subprocess.run([sys.executable, "-c", script, tmp_path], check=True, env={**os.environ, "PYTHONPATH": path})
    for name in (*FILES, *CHANNEL_FILES):
        if name != "spacer.step":
            assert (tmp_path / name).read_bytes() == (written / name).read_bytes(), name


def test_progress_names_every_file(sample, tmp_path, monkeypatch):
    chosen = {"spacer.step": FILES["spacer.step"], "cell.glb": list_spacer}
    monkeypatch.setattr("lce_workbench.cad.step.files", lambda job: chosen)
    told = []
    write_cad(sample, solids(), job(), tmp_path, lambda stage, fraction: told.append((stage, fraction)))
    assert told == [
        ("cad/spacer.step", 0.0),
        ("cad/cell.glb", 0.25),
        ("cad/channels_bottom.step", 0.5),
        ("cad/channels_top.step", 0.75),
    ]


def list_spacer(cell):
    return cell.group("spacer")


@pytest.mark.parametrize("name", ["x.step", "x.glb"])
@pytest.mark.parametrize("full", [True, False], ids=["full disk", "no folder"])
def test_what_cannot_be_written_is_an_environment_fault(sample, tmp_path, monkeypatch, name, full):
    monkeypatch.setattr("lce_workbench.cad.step.files", lambda job: {name: list_spacer})
    if full:
        (tmp_path / "out").mkdir()
        (tmp_path / "out" / name).symlink_to("/dev/full")
    with pytest.raises(EnvironmentFault, match=rf"{name} could not be written; see that the disk has room"):
        write_cad(sample, solids(), job(), tmp_path / "out")
