"""Test fields stand clear of everything, measure what they say, and can be switched off one by one."""

import klayout.db as kdb
import numpy as np
import pytest
from sheets import both_masks, design

from lce_solver.errors import InputError
from lce_workbench.core.domains import partition
from lce_workbench.core.fields import (
    DIRECTIONS,
    FIELDS,
    LADDER_UM,
    directors,
    dose,
    fields,
    left_out,
    places,
    resolution,
)
from lce_workbench.core.frame import arrange
from lce_workbench.core.job import ChannelSpec, Job, Marks
from lce_workbench.core.job_sheet import job_sheet, minutes, totals

SPEC = ChannelSpec()
FRAME = arrange(np.array([[-10.0, -10.0], [10.0, 10.0]]), Job())


@pytest.mark.parametrize("name", FIELDS)
def test_each_field_keeps_to_its_place_and_can_be_switched_off(name):
    shape = FIELDS[name].draw(SPEC)
    low, high = shape.min(axis=(0, 1)), shape.max(axis=(0, 1))
    assert max(-low[0], high[0]) <= FIELDS[name].width / 2
    assert max(-low[1], high[1]) <= 0.75
    rest = tuple(other for other in FIELDS if other != name)
    assert len(fields(FRAME, Job())) - len(fields(FRAME, Job(marks=Marks(fields=rest)))) == len(shape)


def test_all_have_room_beside_a_sheet_of_20_mm_and_apart():
    found = places(FRAME, list(FIELDS))
    assert left_out(FRAME, Job()) == ()
    boxes = []
    for name, at in found.items():
        shape = FIELDS[name].draw(SPEC) + at
        boxes.append((*shape.min(axis=(0, 1)), *shape.max(axis=(0, 1))))
    for i, a in enumerate(boxes):
        for b in boxes[:i]:
            assert a[0] > b[2] or b[0] > a[2] or a[1] > b[3] or b[1] > a[3]


def test_fields_without_room_are_told():
    frame = arrange(np.array([[-2.0, -2.0], [2.0, 2.0]]), Job())
    (finding,) = left_out(frame, Job())
    assert "directors" in finding.message
    assert fields(frame, Job(marks=Marks(fields=()))).shape == (0, 4, 2)


def test_an_unknown_field_is_refused():
    with pytest.raises(InputError, match=r"marks\.fields: 'moon' is unknown"):
        places(FRAME, ["moon"])


def test_uniform_films_have_their_director_at_half_the_duty():
    shape = directors(SPEC)
    along = shape[:, 1] - shape[:, 0]
    angle = np.degrees(np.arctan2(along[:, 1], along[:, 0])) % 180
    for k, direction in enumerate(DIRECTIONS):
        pad = np.abs(shape.mean(axis=1)[:, 0] - 1.4 * (k - 1)) < 0.65
        assert np.allclose(angle[pad], direction)
        area = np.sum(np.linalg.norm(along[pad], axis=1)) * 1e-3
        assert np.isclose(area, 1.2**2 / 2, rtol=0.01)


def test_forty_patches_and_ladders():
    region = kdb.Region()
    for p in dose(SPEC):
        region.insert(kdb.Polygon([kdb.Point(*map(round, q * 1e6)) for q in p]))
    patches = [p for p in region.sized(1000).merged().each() if p.bbox().width() > 190_000]
    assert len(patches) == 40
    widths = np.unique(np.round(np.ptp(resolution(SPEC), axis=1).min(axis=1) * 1e3, 3))
    assert np.allclose(widths, LADDER_UM)


def test_the_job_sheet_says_what_the_files_hold():
    domains = partition(design(3, 4, width=1.0, height=1.1))
    frame, channels, masks = both_masks(domains)
    found = {plate: totals(mask) for plate, mask in masks.items()}
    for plate in masks:
        assert found[plate]["CHANNELS"].count == len(channels[plate])
        assert np.isclose(found[plate]["CHANNELS"].area, channels[plate].areas.sum(), rtol=1e-4)
        assert np.isclose(found[plate]["PLATE"].area, np.prod(frame.plate.size))
    sheet = job_sheet(frame, Job(), found, "0123ABCD")
    assert sheet.isascii()
    assert "OFF for both plates" in sheet
    row = next(line.split() for line in sheet.splitlines() if line.startswith("CHANNELS"))
    assert row[:3] == ["CHANNELS", "1/0", str(len(channels["bottom"]))]
    assert minutes(400.0, 1.0) == pytest.approx(150)
    assert minutes(400.0, 0.8) == pytest.approx(450)


@pytest.mark.parametrize(
    ("spec", "sentence"),
    [
        (
            ChannelSpec(width_um=0.7),
            r"channels\.width_um = 0\.7 is finer than output\.writer_um = 0\.8 um.* cannot be written",
        ),
        (ChannelSpec(spacing_um=0.5), r"channels\.spacing_um = 0\.5 is finer .* would merge with its neighbours"),
        (ChannelSpec(guard_um=0.3), r"channels\.guard_um = 0\.3 is finer .* even doubled, so channels would merge"),
    ],
)
def test_what_the_writer_cannot_resolve_is_refused(spec, sentence):
    with pytest.raises(InputError, match=sentence):
        both_masks(partition(design(2, 2)), Job(channels=spec))


def test_a_plate_larger_than_the_writer_is_refused():
    with pytest.raises(InputError, match=r"larger than the writer's 200 x 200 mm"):
        arrange(np.array([[-95.0, -95.0], [95.0, 95.0]]), Job())
