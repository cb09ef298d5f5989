"""Each check of the cad stage holds for a sound cell, and each fires."""

from dataclasses import replace

import numpy as np
import pytest
from cad.cad_sample import CHECKS, PITCH, gauged

from lce_solver.types import Severity
from lce_workbench.cad.checks import check
from lce_workbench.cad.step import write_cad
from lce_workbench.core.cell import select


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """Cell, channels, frame, job and folder with the files: a sheet with the gauges at its corners."""
    cell, solids, frame, wanted = gauged()
    folder = tmp_path_factory.mktemp("checked")
    write_cad(cell, solids, wanted, folder)
    return cell, solids, frame, wanted, folder


@pytest.fixture
def unread(monkeypatch):
    """Leave the files of parts unread, which takes a kernel seconds."""
    monkeypatch.setattr("lce_workbench.cad.checks.files", lambda job: {})


def errors(made, **changes):
    """Names of the checks that fire when some of the arguments of `check` are replaced."""
    arguments = dict(zip(("cell", "channels", "frame", "job", "folder"), made, strict=True)) | changes
    return {f"{f.check} {f.where}".strip() for f in check(**arguments) if f.severity is Severity.ERROR}


def test_a_sound_cell_has_no_error_and_is_measured(made):
    found = check(*made)
    assert all(f.severity is Severity.INFO for f in found)
    assert {f.check for f in found} == CHECKS
    assert len([f for f in found if f.check == "cad_step"]) == 10


def moved(cell, name, shift=(0.0, 0.0), dz=0.0):
    """The cell with the parts whose names begin like this elsewhere."""

    def there(part):
        if not part.name.startswith(name):
            return part
        holes = tuple(hole + np.array(shift) for hole in part.holes)
        return replace(part, outline=part.outline + np.array(shift), holes=holes, z0=part.z0 + dz, z1=part.z1 + dz)

    return replace(cell, parts=tuple(map(there, cell.parts)))


def test_a_plate_two_nanometres_too_high_is_seen(made, unread):
    assert errors(made, cell=moved(made[0], "top_", dz=2e-6)) == {"cad_gap", "cad_mates top_plate"}
    assert errors(made, cell=moved(made[0], "top_", dz=0.5e-6)) == set()


def test_marks_two_nanometres_apart_are_seen(made, unread):
    assert errors(made, cell=moved(made[0], "top_land", (2e-6, 0.0))) == {
        "cad_marks corner 0",
        "cad_mates top_plate",
    }


def test_parts_that_share_volume_are_seen(made, unread):
    part = {p.name: p.outline[:, 0] for p in made[0].parts}
    cell = moved(made[0], "spacer_left", (part["sheet"].min() - part["spacer_left"].max() + 0.05, 0.0))
    assert errors(made, cell=cell) == {"cad_interference spacer_left and sheet", "cad_mates spacer_left"}


def test_a_file_that_lacks_a_part_is_seen(made, tmp_path):
    folder = made[4]
    for path in folder.iterdir():
        (tmp_path / path.name).write_bytes(path.read_bytes())
    (tmp_path / "spacer.step").write_bytes((folder / "top_plate.step").read_bytes())
    (tmp_path / "channels_top.step").write_bytes((folder / "channels_bottom.step").read_bytes())
    assert errors(made, folder=tmp_path) == {"cad_step spacer.step", "cad_step channels_top.step"}


def test_a_large_file_is_counted(made, monkeypatch):
    monkeypatch.setattr("lce_workbench.cad.checks.READABLE", 3)
    monkeypatch.setattr("lce_workbench.cad.checks.HOLES", 3)
    assert errors(made) == set()
    half = {plate: [select(part, [24]) for part in parts] for plate, parts in made[1].items()}
    assert errors(made, channels=half) == {"cad_step channels_bottom.step", "cad_step channels_top.step"}


def test_a_hole_that_crosses_another_is_not_valid(made, unread):
    cell = made[0]
    comb = cell.combs[0]
    bad = replace(comb, holes=(*comb.holes, comb.holes[0] + PITCH / 100))
    assert errors(made, cell=replace(cell, combs=(bad, *cell.combs[1:]))) >= {f"cad_kernel {comb.name}"}
