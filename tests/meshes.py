"""Small meshes with known properties, and writers of mesh files by hand (so that readers meet another's output)."""

import struct
from pathlib import Path

import numpy as np


def grid(n=4, m=3):
    """A bumpy rectangle of n x m squares, two triangles each, counter-clockwise seen from +z: a disk."""
    x, y = np.meshgrid(np.arange(n + 1.0), np.arange(m + 1.0), indexing="ij")
    vertices = np.column_stack([x.ravel(), y.ravel(), 0.2 * np.sin(x.ravel() + 0.5 * y.ravel())])
    i, j = (a.ravel() for a in np.meshgrid(np.arange(n), np.arange(m), indexing="ij"))
    a, b, c, d = i * (m + 1) + j, (i + 1) * (m + 1) + j, (i + 1) * (m + 1) + j + 1, i * (m + 1) + j + 1
    return vertices, np.concatenate([np.column_stack([a, b, c]), np.column_stack([a, c, d])])


def band(n=8, twist=0):
    """A closed strip of n squares: an annulus, or a Moebius strip with one half ``twist``."""
    angle = np.arange(n) * 2 * np.pi / n
    tilt = twist * angle / 2
    ring = np.column_stack([np.cos(angle), np.sin(angle), 0 * angle])
    across = 0.3 * np.column_stack([np.cos(tilt) * np.cos(angle), np.cos(tilt) * np.sin(angle), np.sin(tilt)])
    vertices = np.stack([ring - across, ring + across], axis=1).reshape(-1, 3)
    a, b = np.arange(n) * 2, np.arange(n) * 2 + 1
    c, d = np.roll(a, -1), np.roll(b, -1)
    if twist % 2:
        c[-1], d[-1] = b[0], a[0]
    return vertices, np.concatenate([np.column_stack([a, b, d]), np.column_stack([a, d, c])])


def octahedron():
    vertices = np.array([(1, 0, 0), (0, 1, 0), (-1, 0, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)], float)
    sides = [(i, (i + 1) % 4, 4) for i in range(4)] + [((i + 1) % 4, i, 5) for i in range(4)]
    return vertices, np.array(sides)


def torus_with_hole(n=5):
    """A torus without one triangle: one boundary, but a handle."""
    i, j = (a.ravel() for a in np.meshgrid(np.arange(n), np.arange(n), indexing="ij"))
    u, v = 2 * np.pi * i / n, 2 * np.pi * j / n
    vertices = np.column_stack([(2 + np.cos(v)) * np.cos(u), (2 + np.cos(v)) * np.sin(u), np.sin(v)])
    a, b, c, d = i * n + j, (i + 1) % n * n + j, (i + 1) % n * n + (j + 1) % n, i * n + (j + 1) % n
    return vertices, np.concatenate([np.column_stack([a, b, c]), np.column_stack([a, c, d])])[1:]


def write_stl_ascii(path: Path, vertices, faces):
    lines = ["solid hand"]
    for corners in vertices[faces]:
        lines += ["facet normal 0 0 0", "outer loop", *(f"vertex {x!r} {y!r} {z!r}" for x, y, z in corners.tolist())]
        lines += ["endloop", "endfacet"]
    path.write_text("\n".join([*lines, "endsolid hand", ""]))


def write_stl_binary(path: Path, vertices, faces):
    records = [struct.pack("<12fH", 0, 0, 0, *corners.ravel(), 0) for corners in vertices[faces]]
    path.write_bytes(b"binary".ljust(80) + struct.pack("<I", len(faces)) + b"".join(records))


def write_obj(path: Path, vertices, faces, header=""):
    lines = [f"v {x!r} {y!r} {z!r}" for x, y, z in np.asarray(vertices, float).tolist()]
    lines += ["f " + " ".join(str(i + 1) for i in face) for face in faces]
    path.write_text("\n".join([header, *lines, ""]))


def write_obj_with_seams(path: Path, vertices, faces):
    """Every corner has its own texture coordinate and normal, and materials and groups change all the time."""
    lines = ["mtllib missing.mtl", *(f"v {x!r} {y!r} {z!r}" for x, y, z in vertices.tolist())]
    lines += [f"vt {k / 1000} {k % 7}" for k in range(3 * len(faces))]
    lines += [f"vn 0 {k % 2} 1" for k in range(3 * len(faces))]
    for f, face in enumerate(faces.tolist()):
        lines += [f"o part{f % 3}", f"usemtl paint{f % 2}", f"s {f % 2}"]
        lines += ["f " + " ".join(f"{v + 1}/{3 * f + i + 1}/{3 * f + i + 1}" for i, v in enumerate(face))]
    path.write_text("\n".join([*lines, ""]))


def write_ply(path: Path, vertices, faces):
    header = ["ply", "format ascii 1.0", f"element vertex {len(vertices)}", *(f"property double {a}" for a in "xyz")]
    header += [f"element face {len(faces)}", "property list uchar int vertex_indices", "end_header"]
    lines = [f"{x!r} {y!r} {z!r}" for x, y, z in vertices.tolist()]
    lines += [" ".join(map(str, (len(face), *face))) for face in faces]
    path.write_text("\n".join([*header, *lines, ""]))


def write_off(path: Path, vertices, faces):
    lines = [f"{x!r} {y!r} {z!r}" for x, y, z in vertices.tolist()]
    lines += [" ".join(map(str, (len(face), *face))) for face in faces]
    path.write_text("\n".join(["OFF", f"{len(vertices)} {len(faces)} 0", *lines, ""]))


WRITERS = {
    "ascii.stl": write_stl_ascii,
    "binary.stl": write_stl_binary,
    "plain.obj": write_obj,
    "seams.obj": write_obj_with_seams,
    "plain.ply": write_ply,
    "plain.off": write_off,
}


def soup(vertices, faces):
    """Every triangle with corners of its own, as a careless exporter writes them."""
    return vertices[faces.ravel()], np.arange(faces.size).reshape(-1, 3)
