"""The design review of the document: faults that are made are found, where they are; the bill of materials is exact."""

import inspection_steps as steps
import numpy as np
import pytest
import sheets
from freecad_call import FreeCAD
from processes import ROOT

from lce_workbench.core.closed import closed
from lce_workbench.core.domains import partition
from lce_workbench.core.frame import MARK_BOX, arrange
from lce_workbench.core.job import Job, Sheet
from lce_workbench.outputs import write_design


@pytest.fixture(scope="module")
def design(tmp_path_factory):
    path = tmp_path_factory.mktemp("a design") / "design.npz"
    write_design(sheets.design(), path)
    return path


@pytest.fixture
def freecad(tmp_path):
    return FreeCAD(tmp_path / "home")


def test_faults_are_found_where_they_are(design, freecad):
    found = freecad.console(steps.sound_and_faulty, design_npz=design)
    assert "Traceback" not in freecad.said
    checks = {"body_state", "body_volume", "body_gap", "plates_aligned", "interference", "marks_seen"}
    assert checks <= found["sound"].keys()
    assert found["errors"] == 0
    assert found["status"] == "current"
    assert found["the whole cell elsewhere"] == found["sound"]

    def errors(case):
        return {check: told[1:] for check, told in found[case].items() if told[0] == "error"}

    assert errors("strip in the film").keys() == {"interference"}
    assert errors("strip in the film")["interference"][1] == "spacer_left and sheet"
    assert errors("strip under a mark")["marks_seen"][1].endswith("spacer_right")
    volume, where = errors("top plate too low")["interference"]
    assert "top_" in where
    assert volume > 0
    assert errors("top plate too low")["body_gap"][0] == pytest.approx(10_000, rel=1e-6)  # nm
    assert errors("top plate aside").keys() == {"plates_aligned"}
    apart, where = errors("top plate aside")["plates_aligned"]
    assert (apart, where) == (pytest.approx(50, rel=1e-6), "corner 0, top_land and bottom_land")
    assert errors("another shape")["body_volume"][1] == "bottom_epoxy"
    assert found["changed"].startswith("stale: plates.epoxy_um is now 30.0")


def test_the_bill_of_materials_follows_the_bodies(design, freecad):
    found = freecad.console(steps.bill, design_npz=design)
    assert "Traceback" not in freecad.said
    job = Job(sheet=Sheet(width_mm=2.2))
    parts = closed(sheets.design(), partition(sheets.design()), job).parts
    prisms = {prism.name: prism.volume for prism in parts}
    first, second = found["first"], found["second"]
    assert first["total_volume"] == pytest.approx(sum(prisms.values()), rel=1e-9)
    assert first["bottom_layer_volume"] == pytest.approx(prisms["bottom_land"] + prisms["bottom_epoxy"], rel=1e-9)
    assert first["spacer_volume"] == pytest.approx(prisms["spacer_left"] + prisms["spacer_right"], rel=1e-9)
    for name in ("bottom_carrier", "bottom_layer", "spacer", "film", "top_layer", "top_carrier"):
        assert first[f"{name}_mass"] == pytest.approx(first[f"{name}_volume"] * first[f"{name}_density"] * 1e-6), name
    assert first["total_mass"] == pytest.approx(sum(v for k, v in first.items() if k.endswith("_mass")) / 2)
    assert first["bottom_carrier_density"] == 2500
    area = prisms["bottom_epoxy"] / (job.plates.epoxy_um * 1e-3)
    assert second["bottom_layer_volume"] - first["bottom_layer_volume"] == pytest.approx(0.4e-3 * area, rel=0.05)
    assert second["film_mass"] / first["film_mass"] == pytest.approx(1100 / 1200)
    assert found["again"] == ["BillOfMaterials", True, False]
    assert [row[:2] for row in found["rows"]] == [
        ["Carrier, bottom", 1], ["Channel layer, bottom", 1], ["Spacer strip", 2], ["Film", 1],
        ["Channel layer, top", 1], ["Carrier, top", 1],
    ]  # fmt: skip
    assert all(source for *_, source in found["rows"])


def test_every_place_leads_to_objects_or_outlines(design, freecad):
    found = freecad.console(steps.places, design_npz=design)
    domains, frame = partition(sheets.design()), arrange(sheets.design().uv, Job(sheet=Sheet(width_mm=2.2)))

    def ring(where, k=0):
        return np.array(found[where][1][k])

    np.testing.assert_allclose(ring("bottom plate, domain 3"), np.column_stack([domains.ring(3), [-0.05] * 3]))
    np.testing.assert_allclose(ring("top plate, domain 3"), np.column_stack([domains.ring(3), [0.05] * 3]))
    np.testing.assert_allclose(ring("domains 4, 5", 1)[:, :2], domains.ring(5))
    middle = ring("triangle 7 at (0.20, 0.30) mm")[:, :2].mean(axis=0)
    assert np.linalg.norm(middle - (0.2, 0.3)) == pytest.approx(
        np.linalg.norm(domains.centroid - (0.2, 0.3), axis=1).min()
    )
    corner = ring("corner 2, spacer_left")[:, :2]
    np.testing.assert_allclose(corner.mean(axis=0), frame.marks[2])
    np.testing.assert_allclose(np.ptp(corner, axis=0), MARK_BOX)
    assert set(found["spacer_left and sheet"][0]) == {"SpacerLeft", "Sheet"}
    assert found["top plate"][0] == ["TopPlate"]
    assert found["cell.step"] == found[""] == [[], []]


@pytest.mark.parametrize("name", ["schema1", "schema2", "schema3"])
def test_older_documents_are_inspected(name, freecad):
    found = freecad.console(steps.older, path=ROOT / "tests" / "documents" / f"{name}.FCStd")
    assert "Traceback" not in freecad.said
    assert found["versions"] == [4]
    # Channels are rounded otherwise than they were then; FreeCAD 1.0 recomputes what has got a new property.
    assert found["errors"] == (name == "schema1" and not found["new"])
    assert found["total_volume"] == pytest.approx(sum(found["shapes"].values()), rel=1e-9)
