"""Outlines of the parts, read back by programs of their own."""

import re
from xml.etree import ElementTree

import ezdxf
import numpy as np
import pytest
from cad.cad_sample import WORKSHOP, cell

from lce_workbench.core.prism import bodies
from lce_workbench.export.outlines import OUTLINES, rings


@pytest.fixture(scope="module")
def worked():
    return cell(plates=WORKSHOP)


@pytest.fixture(scope="module")
def folder(worked, tmp_path_factory):
    made = tmp_path_factory.mktemp("outlines")
    for name, write in OUTLINES.items():
        write(worked, made / f"outlines.{name}")
    return made


def test_every_edge_of_every_part_is_drawn_once(worked):
    found = rings(worked)
    assert set(found) == set(bodies(worked.parts))
    assert len(found["top_glass"]) == 3 + 2 - 2 + len(worked.group("top_plate")[-1].holes)  # square, two chamfer edges
    assert len(found["spacer_left"]) == 1
    assert len(found["alignment_frame"]) == 2


def test_dxf_is_in_millimetres_with_a_layer_for_each_part(worked, folder):
    document = ezdxf.readfile(folder / "outlines.dxf")
    assert document.units == ezdxf.units.MM
    assert not document.audit().errors
    for name, want in rings(worked).items():
        lines = document.modelspace().query(f'LWPOLYLINE[layer=="{name.upper()}"]')
        assert all(line.closed for line in lines)
        for line, ring in zip(lines, want, strict=True):
            np.testing.assert_allclose([p[:2] for p in line], ring, atol=1e-12)


def test_svg_is_drawn_at_true_size(worked, folder):
    root = ElementTree.parse(folder / "outlines.svg").getroot()
    box = [float(v) for v in root.get("viewBox").split()]
    assert (float(root.get("width")[:-2]), float(root.get("height")[:-2])) == (box[2], box[3])
    assert root.get("width").endswith("mm")
    assert box[2] == pytest.approx(25 + 2 * (4 + 0.05) + 2, abs=1e-6)  # plate, frame with clearance, margin
    paths = {g.get("id"): g[0].get("d") for g in root[0]}
    for name, want in rings(worked).items():
        drawn = [
            np.array([[float(v) for v in p.split(",")] for p in path.split("L")])
            for path in re.findall(r"M([^Z]*)Z", paths[name])
        ]
        for one, ring in zip(drawn, want, strict=True):
            np.testing.assert_allclose(one, ring, atol=1e-6)


def test_the_same_bytes_again(worked, folder, tmp_path):
    for name, write in OUTLINES.items():
        write(worked, tmp_path / name)
        assert (tmp_path / name).read_bytes() == (folder / f"outlines.{name}").read_bytes()
