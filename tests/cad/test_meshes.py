"""Triangle meshes of the plates and of the heated sheet, read back by trimesh."""

import zipfile
from xml.etree import ElementTree

import numpy as np
import pytest
import trimesh
from cad.cad_sample import WORKSHOP, cell, job
from scipy.spatial import Delaunay

from lce_workbench.cad.meshes import printed, thickened, write_3mf, write_stl
from lce_workbench.cad.step import EXTRAS, files
from lce_workbench.core.prism import together

CORE = "{http://schemas.microsoft.com/3dmanufacturing/core/2015/02}"


@pytest.fixture(scope="module")
def worked():
    return cell(plates=WORKSHOP)


@pytest.mark.parametrize("plate", ["bottom_plate", "top_plate"])
def test_a_plate_is_one_closed_mesh_of_its_volume_with_the_pattern_up(worked, tmp_path, plate):
    stack = worked.group(plate)
    points, triangles = printed(stack)
    mesh = trimesh.Trimesh(points, triangles, process=False)
    assert mesh.is_watertight
    assert mesh.body_count == 1
    assert mesh.volume == pytest.approx(together(stack)[0], rel=1e-12)
    write_stl(points, triangles, tmp_path / "plate.stl")
    read = trimesh.load(tmp_path / "plate.stl")
    assert read.is_watertight
    assert read.volume == pytest.approx(mesh.volume, rel=1e-5)
    (land,) = (p for p in stack if p.name.endswith("land"))
    assert points[:, 2].min() == 0
    top = points[points[:, 2] > points[:, 2].max() - 1e-9]
    assert len(top) == sum(map(len, land.rings))
    x = {tuple(p) for p in np.round(np.concatenate(land.rings) * ((1, 1) if "bottom" in plate else (-1, 1)), 9)}
    assert {tuple(p) for p in np.round(top[:, :2], 9)} == x


def test_a_3mf_is_the_same_mesh_in_millimetres(worked, tmp_path):
    points, triangles = printed(worked.group("top_plate"))
    write_3mf(points, triangles, tmp_path / "top_plate.3mf")
    with zipfile.ZipFile(tmp_path / "top_plate.3mf") as archive:
        assert {"[Content_Types].xml", "_rels/.rels", "3D/3dmodel.model"} == set(archive.namelist())
        root = ElementTree.fromstring(archive.read("3D/3dmodel.model"))
    assert root.get("unit") == "millimeter"
    vertices = np.array([[float(v.get(k)) for k in "xyz"] for v in root.iter(f"{CORE}vertex")])
    faces = np.array([[int(t.get(k)) for k in ("v1", "v2", "v3")] for t in root.iter(f"{CORE}triangle")])
    np.testing.assert_allclose(vertices, points, atol=1e-7)
    assert np.array_equal(faces, triangles)


def test_the_job_chooses_what_is_written():
    assert {name for extra in EXTRAS.values() for name in extra} <= set(files(job()))


def disc(rings, radius):
    """Points (n, 2) of a disc and its triangles, counter-clockwise."""
    xy = np.concatenate(
        [[(0.0, 0.0)]]
        + [
            radius * r / rings * np.column_stack([np.cos(t), np.sin(t)])
            for r in range(1, rings + 1)
            for t in [np.arange(6 * r) * np.pi / (3 * r)]
        ]
    )
    faces = Delaunay(xy).simplices
    a, b, c = xy[faces].transpose(1, 0, 2)
    left = np.cross(b - a, c - a) > 0
    return xy, np.where(left[:, None], faces, faces[:, ::-1])


@pytest.mark.filterwarnings("ignore:Arrays of 2-dimensional vectors:DeprecationWarning")
def test_a_heated_sheet_has_its_thickness_on_a_sphere():
    """Between two spheres of radius 3 -+ 0.1: the mid-surface lies on r = 3."""
    xy, faces = disc(30, 2.0)
    points = np.column_stack([xy, np.sqrt(9 - (xy**2).sum(axis=1))])
    moved, triangles = thickened(points, faces, 0.2)
    mesh = trimesh.Trimesh(moved, triangles, process=False)
    assert mesh.is_watertight
    area = trimesh.Trimesh(points, faces, process=False).area
    assert mesh.volume == pytest.approx(area * 0.2 * (1 + 0.2**2 / 12 / 9), rel=2e-3)
    r = np.linalg.norm(moved, axis=1).reshape(2, -1)
    np.testing.assert_allclose(r, [[3.1], [2.9]] * np.ones(r.shape), atol=1e-3)
