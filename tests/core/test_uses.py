"""What a result is made from: exactly the parameters whose change changes its files."""

from dataclasses import fields, replace

import pytest
import sheets
from small import digests

from lce_solver.errors import InputError
from lce_workbench.core.job import Job
from lce_workbench.core.jobfile import toml_name
from lce_workbench.core.uses import TWIST, USES, sections, values
from lce_workbench.outputs import write_design
from lce_workbench.stages import Run, run_mask

START = replace(Job(), output=replace(Job().output, masks=("gds",), pictures=False))

OTHER = {
    "sheet": {"width_mm": 2.5, "gap_um": 150.0, "twist_gain": 2.0, "twist_limit_deg": 3.0, "edge_overdrive": True},
    "channels": {"width_um": 1.5, "spacing_um": 1.5, "depth_um": 0.7, "guard_um": 0.9, "align_phase": True},
    "plates": {
        "carrier": "50x50", "width_mm": 60.0, "height_mm": 60.0, "glass_mm": 1.1, "replications": 3, "epoxy_um": 40.0,
        "chamfer_mm": 0.2, "release_deg": 3.0, "notch_mm": 1.0, "engraving_um": 20.0, "frame_mm": 4.0,
        "frame_clearance_um": 60.0,
    },
    "marks": {"clearance_mm": 2.5, "tolerance_um": 8.0, "grating": False, "fields": ("dose",), "label": "A1"},
    "spacer": {"strip_mm": 2.5, "clearance_mm": 1.2, "glue_mm": 9.0, "bead_mm": 0.5},
    "prediction": {
        "correct": "off", "seed": 2, "imperfection": 0.03, "steps": 4, "plate": True, "density_kg_m3": 1100.0,
        "modulus_MPa": 2.0, "film": True,
    },
    "output": {
        "masks": ("oas",), "pictures": True, "overlay_x_um": 1.0, "overlay_y_um": 1.0, "writer_um": 1.2,
        "freecad": False, "cad": (), "drawings": False, "author": "A", "date": "today", "step_domains": (3,),
        "step_window_um": (0, 0, 9, 9), "step": "all", "step_instances": "assembly", "relief": True,
        "relief_spot_um": 0.6, "relief_contrast": 2.0, "relief_pixel_nm": 60.0, "step_gzip": True,
    },
}  # fmt: skip
"""Another value of every parameter; those of the other sections change the design itself."""

DESIGNED = (*TWIST, "channels.align_phase")
"""What reaches the masks through the design and its domains."""
NAMES = [name for name in USES["mask"] if name not in DESIGNED]

USED, REST = [], []
for name in (f"{section}.{key}" for section, keys in OTHER.items() for key in keys):
    if name not in DESIGNED:
        (USED if {name, name.partition(".")[0]} & set(NAMES) else REST).append(name)


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    path = tmp_path_factory.mktemp("uses")
    write_design(sheets.design(columns=4, rows=4), path / "design.npz")
    return path


def written(folder, job):
    """Name and digest of every file of the masks, and what was found; or why there are none."""
    for path in (folder / "mask").glob("*"):
        path.unlink()
    if (folder / "mask").is_dir():
        (folder / "mask").rmdir()
    try:
        found = run_mask(Run(folder, job, folder))
    except InputError as fault:
        return {}, str(fault)
    return digests(folder / "mask"), repr(found)


def changed(names, job=START):
    """The job with other values of some parameters."""
    for name in names:
        section, _, key = name.partition(".")
        job = replace(job, **{section: replace(getattr(job, section), **{key: OTHER[section][key]})})
    return job


@pytest.fixture(scope="module")
def first(folder):
    return written(folder, START)


@pytest.fixture(scope="module")
def pictured(folder):
    return written(folder, changed(["output.pictures"]))


def test_every_parameter_has_another_value_here():
    rest = {part.name: part for part in fields(Job)}
    for section, keys in OTHER.items():
        part = getattr(Job(), rest.pop(section).name)
        assert {toml_name(f) for f in fields(part)} == keys.keys()
        assert all(getattr(START, section) != replace(part, **{key: value}) for key, value in keys.items())
    assert rest.keys() == {"target", "material", "domains", "solver"}


OVERLAY = ["output.overlay_x_um", "output.overlay_y_um"]
"""What only the pictures show."""


@pytest.mark.parametrize("name", [name for name in USED if name not in {*OVERLAY, "output.pictures"}])
def test_masks_change_with_each_of_their_parameters(folder, first, name):
    assert written(folder, changed([name])) != first


def test_masks_change_with_their_pictures(folder, first, pictured):
    assert pictured[0].keys() > first[0].keys()
    assert written(folder, changed(["output.pictures", *OVERLAY]))[0] != pictured[0]


def test_masks_change_with_nothing_else(folder, first):
    assert len(REST) > 25
    assert written(folder, changed(REST)) == first
    assert values(changed(REST), NAMES) == values(START, NAMES)


def test_names_are_parameters():
    for names in USES.values():
        found = values(Job(), names)
        assert all(any(name in {key, key.partition(".")[0]} for key in found) for name in names)
        assert sections(names) == tuple(dict.fromkeys(key.partition(".")[0] for key in found))
