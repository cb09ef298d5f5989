"""Targets from files: what is welded, what is turned, and which sentence a broken mesh gets."""

import re
import struct
import warnings

import meshes
import numpy as np
import pytest
from faults import BAD_MESHES

from lce_solver.errors import InputError
from lce_solver.surface import boundary_loops, check, edges, face_areas, load
from lce_solver.types import Severity, Surface


def found(findings):
    return {finding.check: finding for finding in findings}


def corners(surface: Surface):
    return surface.vertices[surface.faces]


def is_disk(surface: Surface):
    euler = len(surface.vertices) - len(edges(surface.faces)) + len(surface.faces)
    return euler == 1 and len(boundary_loops(surface.faces)) == 1


@pytest.mark.parametrize("scale", [1e-9, 1.0, 1e9])
@pytest.mark.parametrize("name", meshes.WRITERS)
def test_every_format_gives_the_same_topology(tmp_path, name, scale):
    vertices, faces = meshes.grid()
    meshes.WRITERS[name](tmp_path / name, scale * vertices, faces)
    surface, findings = load(tmp_path / name)
    assert len(surface.vertices) == len(vertices)
    np.testing.assert_allclose(corners(surface), scale * vertices[faces], rtol=1e-6, atol=1e-7 * scale)
    assert is_disk(surface)
    assert ("mesh_welded" in found(findings)) == name.endswith(".stl")
    assert found(findings)["mesh_read"].value == len(faces)


def test_units_do_not_matter_and_the_user_is_told(tmp_path):
    meshes.write_obj(tmp_path / "a.obj", *meshes.grid())
    message = found(load(tmp_path / "a.obj")[1])["mesh_read"].message
    assert "any unit" in message
    assert "width of the sheet" in message


def test_stl_corners_weld_within_rounding_but_fine_details_stay(tmp_path):
    vertices, faces = meshes.grid()
    torn, own = meshes.soup(vertices, faces)
    noise = np.random.default_rng(1).uniform(-1e-7, 1e-7, torn.shape)
    meshes.write_stl_ascii(tmp_path / "a.stl", torn + noise, own)
    assert len(load(tmp_path / "a.stl")[0].vertices) == len(vertices)
    vertices[:, 0] *= 1e-3  # columns of vertices are 1e-3 apart, the diagonal is 3
    meshes.write_stl_ascii(tmp_path / "b.stl", vertices, faces)
    assert len(load(tmp_path / "b.stl")[0].vertices) == len(vertices)


@pytest.mark.parametrize("name", ["plain.obj", "plain.ply", "plain.off"])
def test_triangle_soup_is_welded_in_formats_with_topology(tmp_path, name):
    vertices, faces = meshes.grid()
    meshes.WRITERS[name](tmp_path / name, *meshes.soup(vertices, faces))
    surface, findings = load(tmp_path / name)
    assert len(surface.vertices) == len(vertices)
    assert found(findings)["mesh_welded"].value == faces.size - len(vertices)


@pytest.mark.parametrize(("name", "open_"), [("plain.obj", True), ("plain.ply", True), ("ascii.stl", False)])
def test_a_cut_that_the_file_states_stays_open(tmp_path, name, open_):
    """A band cut along one line is a disk in OBJ and PLY; STL cannot state the cut, so there it is an annulus."""
    vertices, faces = meshes.band()
    last = np.isin(np.arange(len(faces)), [7, 15])
    copies = len(vertices) + (faces == 1)
    faces = np.where(last[:, None] & (faces < 2), copies, faces)
    vertices = np.vstack([vertices, vertices[:2]])
    meshes.WRITERS[name](tmp_path / name, vertices, faces)
    if open_:
        surface, findings = load(tmp_path / name)
        assert is_disk(surface)
        assert found(findings)["mesh_cut"].severity is Severity.WARNING
        assert found(findings)["mesh_cut"].value == 2
    else:
        assert len(boundary_loops(load(tmp_path / name)[0].faces)) == 2


def test_relative_indices_and_comments_of_obj(tmp_path):
    text = "# a comment\nv 0 0 0\nv 1 0 0 # end\nv 1 1 0\nf -3 -2 \\\n-1\nv 0 1 0\nf -4 -2 -1\n"
    (tmp_path / "a.obj").write_text(text)
    assert load(tmp_path / "a.obj")[0].faces.tolist() == [[0, 1, 2], [0, 2, 3]]


@pytest.mark.parametrize("name", ["plain.obj", "plain.ply", "plain.off"])
def test_quads_are_split_and_the_user_is_told(tmp_path, name):
    vertices = np.array([(0, 0, 0), (1, 0, 0), (2, 0, 0), (0, 1, 0), (1, 1, 0), (2, 1, 0)], float)
    meshes.WRITERS[name](tmp_path / name, vertices, [[0, 1, 4, 3], [1, 2, 5, 4]])
    surface, findings = load(tmp_path / name)
    assert len(surface.faces) == 4
    assert is_disk(surface)
    assert found(findings)["mesh_split"].value == 2


def test_unused_vertices_are_dropped(tmp_path):
    vertices, faces = meshes.grid()
    meshes.write_obj(tmp_path / "a.obj", np.vstack([[[9, 9, 9]], vertices, [[1e6, 0, 0]]]), faces + 1)
    surface, findings = load(tmp_path / "a.obj")
    np.testing.assert_array_equal(surface.vertices, vertices)
    np.testing.assert_array_equal(surface.faces, faces)
    assert found(findings)["mesh_unused"].value == 2


@pytest.mark.parametrize("seed", range(5))
def test_the_minority_is_turned_over(tmp_path, seed):
    vertices, faces = meshes.grid()
    turned = np.random.default_rng(seed).permutation(len(faces))[:9]
    mixed = faces.copy()
    mixed[turned] = mixed[turned][:, [0, 2, 1]]
    meshes.write_obj(tmp_path / "a.obj", vertices, mixed)
    surface, findings = load(tmp_path / "a.obj")
    np.testing.assert_array_equal(surface.faces, faces)
    assert found(findings)["mesh_turned"].value == 9


def test_the_direction_of_an_oriented_mesh_is_kept():
    vertices, faces = meshes.grid()
    np.testing.assert_array_equal(check(vertices, faces[:, ::-1]).faces, faces[:, ::-1])


@pytest.mark.parametrize("scale", [1e-9, 1.0, 1e9])
@pytest.mark.parametrize("name", BAD_MESHES)
def test_a_bad_mesh_is_named_with_a_remedy(name, scale):
    make, element, remedy = BAD_MESHES[name]
    vertices, faces = make()
    with pytest.raises(InputError) as fault:
        check(scale * vertices, faces)
    sentence = str(fault.value)
    assert re.search(element if scale == 1.0 else re.split(r" at | lies|, of length", element)[0], sentence), sentence
    assert remedy in sentence
    assert "\n" not in sentence
    assert fault.value.exit_code == 2


@pytest.mark.parametrize("name", ["plain.obj", "plain.ply"])
@pytest.mark.parametrize("fault", ["not finite", "index", "no area", "three at an edge", "handle"])
def test_a_bad_file_is_named_too(tmp_path, name, fault):
    make, element, remedy = BAD_MESHES[fault]
    vertices, faces = make()
    meshes.WRITERS[name](tmp_path / name, vertices, faces)
    with pytest.raises(InputError, match=f"^{name}: .*{element}") as broken:
        load(tmp_path / name)
    assert remedy in str(broken.value)


BAD_FILES = {
    # name of the file: content, what the sentence says
    "empty.stl": (b"", "empty.stl: the file is empty; export"),
    "blank.obj": (b" \n\n", "blank.obj: the file is empty; export"),
    "points.obj": (b"v 0 0 0\nv 1 0 0\nv 0 1 0\n", "points.obj: the mesh has no triangles; export a surface"),
    "zero.obj": (b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 0 1 2\n", "triangle 0 refers to the vertices .*-1"),
    "word.obj": (b"v 0 0 0\nv 1 zero 0\n", "word.obj is no readable OBJ file .line 2: .*zero.*; export"),
    "short.obj": (b"v 0 0\n", "no readable OBJ file .line 1"),
    "noise.ply": (b"\x00\xff\x13 noise", "noise.ply is no readable PLY file .*; export"),
    "noise.off": (b"noise", "noise.off is no readable OFF file .*; export"),
    "noise.stl": (b"noise", "noise.stl is no readable STL file .5 bytes.*truncated or no STL.; export"),
    "cut.stl": (b"solid a\nfacet normal 0 0 0\nouter loop\nvertex 0 0 0\n", "announces 1 faces and 0 could be read"),
    "bow.obj": (
        b"v 0 0 0\nv 1 1 0\nv 1 0 0\nv 0 1 0\nf 1 2 3 4\n",
        "bow.obj: polygon 0 of 4 corners .* crosses itself; triangulate it",
    ),
    "index.off": (b"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 7\n", "index.off is no readable OFF file .*index"),
    "short.off": (b"OFF\n3 2 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n", "announces 2 faces and 1 could be read"),
    "mesh.step": (b"ISO-10303-21;", "format '.step' is unknown; export the surface as .stl, .obj, .ply, .off"),
    "mesh": (b"v 0 0 0", "format '' is unknown"),
}


@pytest.mark.parametrize("name", BAD_FILES)
def test_an_unreadable_file_is_one_sentence(tmp_path, name):
    content, sentence = BAD_FILES[name]
    (tmp_path / name).write_bytes(content)
    with pytest.raises(InputError, match=sentence) as fault:
        load(tmp_path / name)
    assert "\n" not in str(fault.value)


def test_a_missing_file_and_a_folder(tmp_path):
    with pytest.raises(InputError, match=r"gone\.stl: the mesh file cannot be read \(No such file.*check the path"):
        load(tmp_path / "gone.stl")
    (tmp_path / "folder.stl").mkdir()
    with pytest.raises(InputError, match=r"cannot be read \(Is a directory"):
        load(tmp_path / "folder.stl")


def test_a_truncated_stl_is_refused(tmp_path):
    meshes.write_stl_binary(tmp_path / "a.stl", *meshes.grid())
    (tmp_path / "b.stl").write_bytes((tmp_path / "a.stl").read_bytes()[:-30])
    with pytest.raises(InputError, match=r"b\.stl is no readable STL file \(1254 bytes.* 24 .*1284: truncated"):
        load(tmp_path / "b.stl")


def test_a_text_stl_may_have_a_name_in_latin_1(tmp_path):
    vertices, faces = meshes.grid()
    meshes.write_stl_ascii(tmp_path / "a.stl", vertices, faces)
    (tmp_path / "b.stl").write_bytes((tmp_path / "a.stl").read_bytes().replace(b"hand", b"Fl\xe4che"))
    np.testing.assert_array_equal(corners(load(tmp_path / "b.stl")[0]), corners(load(tmp_path / "a.stl")[0]))


CONCAVE = {
    "quad": [(0, 0, 0), (2, 0, 0), (2, 2, 0), (1, 0.3, 0)],
    "chevron": [(0, 0, 0), (3, 0, 0), (3, 3, 0), (2.5, 1, 0), (2, 0.5, 0)],
}


@pytest.mark.parametrize("name", ["plain.obj", "plain.ply", "plain.off"])
@pytest.mark.parametrize("shape", CONCAVE)
def test_a_concave_polygon_is_split_inside_itself(tmp_path, name, shape):
    points = CONCAVE[shape]
    x, y = np.array(points)[:, :2].T
    area = (x * np.roll(y, -1) - y * np.roll(x, -1)).sum() / 2
    for turn in range(len(points)):
        ring = [*range(turn, len(points)), *range(turn)]
        meshes.WRITERS[name](tmp_path / name, np.array(points, float), [ring])
        assert face_areas(load(tmp_path / name)[0]).sum() == pytest.approx(area, rel=1e-12)


def test_a_binary_ply_with_quads_is_split_inside_them(tmp_path):
    header = "ply\nformat binary_little_endian 1.0\ncomment Fl\xe4che\nelement vertex 4\n"
    header += "".join(f"property double {a}\n" for a in "xyz")
    header += "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
    points = struct.pack("<12d", *np.ravel(CONCAVE["quad"]))
    (tmp_path / "a.ply").write_bytes(header.encode("latin-1") + points + struct.pack("<B4i", 4, 0, 1, 2, 3))
    assert face_areas(load(tmp_path / "a.ply")[0]).sum() == pytest.approx(1.3, rel=1e-12)


@pytest.mark.parametrize("scale", [1e-307, 1e-200, 1e200, 1e307])
@pytest.mark.parametrize("name", ["plain.obj", "plain.ply", "plain.off", "ascii.stl"])
def test_absurd_units_are_told(tmp_path, name, scale):
    vertices, faces = meshes.grid()
    meshes.WRITERS[name](tmp_path / name, vertices * scale, faces)
    with warnings.catch_warnings(), pytest.raises(InputError, match=r"absurdly far|no area"):
        warnings.simplefilter("error")
        load(tmp_path / name)


def test_a_null_byte_in_the_path_is_told():
    with pytest.raises(InputError, match=r"cannot be read .*null"):
        load("a\0.stl")
