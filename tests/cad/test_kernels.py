"""Two CAD kernels agree with the prisms and with each other, and the parts fit together."""

from itertools import combinations

import numpy as np
import pytest
from cad.cad_sample import cell, stacks
from cad.readers import centroid, valid, volume
from OCP.BRepAlgoAPI import BRepAlgoAPI_Common
from OCP.TopTools import TopTools_ListOfShape

from lce_solver.errors import LceError
from lce_workbench.cad.solids import VOLUME_TOLERANCE, require_volume, solid
from lce_workbench.cad.step import CHANNEL_FILES, EXTRAS, FILES
from lce_workbench.core.prism import Prism, together


def test_both_kernels_agree_on_every_body(freecad):
    """Also on tapered and chamfered ones, which are one solid of several layers."""
    built = stacks()
    assert len(built) == len(freecad["bodies"])
    assert max(map(len, built)) == 3
    for stack, there in zip(built, freecad["bodies"], strict=True):
        here, (wanted, centre) = solid(stack).wrapped, together(stack)
        assert volume(here) == pytest.approx(wanted, rel=1e-9)
        assert there["volume"] == pytest.approx(volume(here), rel=1e-9)
        reach = {"rtol": 0, "atol": 1e-9 * np.ptp(stack[0].outline, axis=0).max()}
        np.testing.assert_allclose(centroid(here), centre, **reach)
        np.testing.assert_allclose(there["centroid"], centroid(here), **reach)
        assert valid(here)
        assert there["valid"]
        assert there["type"] == "Solid"


def test_freecad_reads_the_step_files(sample, freecad):
    for name, found in freecad["files"].items():
        if "/" in name or name == "domains.step":  # all channels: see test_instances; outlines: see test_levels
            continue
        parts = {**FILES, **EXTRAS["sheet"]}
        prisms = parts[name](sample) if name in parts else sample.group(f"channels_{CHANNEL_FILES[name]}")
        assert len(found) == len(prisms)
        assert all(s["valid"] for s in found)
        for s, prism in zip(found, prisms, strict=True):
            assert s["volume"] == pytest.approx(prism.volume, rel=1e-9)
            assert (s["box"][2], s["box"][5]) == pytest.approx((prism.z0, prism.z1), abs=1e-12)


def test_no_two_parts_share_volume(sample):
    """All pairs: apart by their heights or outlines' boxes, or by the kernel's common volume."""
    shapes = {part.name: solid([part]).wrapped for part in sample.parts}
    touching = 0
    for a, b in combinations(sample.parts, 2):
        if a.z1 < b.z0 or b.z1 < a.z0:
            continue
        touching += 1
        assert common(shapes[a.name], [shapes[b.name]]) == pytest.approx(0, abs=1e-15), (a.name, b.name)
    assert touching >= 8 + 3


def test_common_volume_is_seen():
    """The measure of the test above, on parts that do overlap."""
    (sheet,) = (p for p in cell().parts if p.name == "sheet")
    raised = Prism("raised", sheet.outline, (), sheet.z0 + 0.01, sheet.z1 + 0.01, sheet.colour)
    assert common(solid([sheet]).wrapped, [solid([raised]).wrapped]) == pytest.approx(sheet.area * 0.09, rel=1e-9)


def test_channel_solids_fill_the_holes_of_their_land(sample):
    """No channel solid shares volume with its land; in a land without holes each would lie wholly inside."""
    for plate in ("bottom", "top"):
        (land,) = (p for p in sample.parts if p.name == f"{plate}_land")
        channels = [solid([p]).wrapped for p in sample.group(f"channels_{plate}")]
        assert common(solid([land]).wrapped, channels) == pytest.approx(0, abs=1e-15)
        slab = Prism("slab", land.outline, (), land.z0, land.z1, land.colour)
        assert common(solid([slab]).wrapped, channels) == pytest.approx(sum(map(volume, channels)), rel=1e-9)


@pytest.mark.parametrize("gap_um", [100.0, 150.0])
def test_the_gap_between_the_epoxy_faces_is_the_spacer(gap_um):
    parts = {p.name: solid([p]) for p in cell(gap_um=gap_um).parts if "land" in p.name or "spacer" in p.name}
    height = {name: [vertex.Z for vertex in part.Vertices()] for name, part in parts.items()}
    gap = min(height["top_land"]) - max(height["bottom_land"])
    assert gap == pytest.approx(gap_um / 1000, abs=1e-15)
    for side in ("left", "right"):
        strip = height[f"spacer_{side}"]
        assert max(strip) - min(strip) == pytest.approx(gap, abs=1e-15)


def test_the_number_of_recesses_is_seen_in_the_solid(sample):
    """A face per ring and side: 4 walls a channel, 12 a cross, 4 outside, and the two holed faces."""
    for plate, crosses in (("bottom", 4), ("top", 5)):
        (land,) = (p for p in sample.parts if p.name == f"{plate}_land")
        channels = len(sample.group(f"channels_{plate}"))
        assert len(solid([land]).Faces()) == 4 * channels + 12 * crosses + 4 + 2


def test_a_volume_that_is_off_is_refused(sample):
    (land,) = (p for p in sample.parts if p.name == "top_land")
    require_volume(land.name, land.volume, land.volume * (1 + 0.9 * VOLUME_TOLERANCE))
    with pytest.raises(LceError, match=r"^top_land: the CAD kernel finds \S+ mm3 instead of \S+; this is a fault of"):
        require_volume(land.name, land.volume, land.volume * (1 + 1.1 * VOLUME_TOLERANCE))


@pytest.mark.parametrize(("shift", "clockwise", "fine"), [(2.0, True, True), (2.0, False, False), (0.5, True, False)])
def test_validity_sees_holes_that_overlap_or_run_the_wrong_way(shift, clockwise, fine):
    square = np.array([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)])
    prism = Prism("p", 5 * square, (square + 1, square + 1 + shift), 0.0, 1.0, (1.0, 1.0, 1.0))
    if not clockwise:
        object.__setattr__(prism, "holes", tuple(hole[::-1] for hole in prism.holes))
    assert valid(solid([prism]).wrapped) is fine


def common(shape, others):
    """Common volume [mm3]."""
    operation = BRepAlgoAPI_Common()
    for setter, shapes in ((operation.SetArguments, [shape]), (operation.SetTools, others)):
        several = TopTools_ListOfShape()
        for each in shapes:
            several.Append(each)
        setter(several)
    operation.Build()
    assert operation.IsDone()
    return volume(operation.Shape())
