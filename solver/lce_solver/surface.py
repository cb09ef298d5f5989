"""The target surface: from a mesh file to one oriented piece of triangles, or to a sentence that says what is wrong."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from lce_solver.errors import InputError
from lce_solver.geometry import edge_lengths, face_areas, frames, mean_edge, vertex_normals
from lce_solver.meshfile import RawMesh, read
from lce_solver.subdivision import subdivide
from lce_solver.topology import boundary_loops, edge_table, edges, fans, flips, half_edges, pieces
from lce_solver.types import Finding, Floats, Ints, Severity, Surface

__all__ = [
    "boundary_loops",
    "check",
    "edge_lengths",
    "edges",
    "face_areas",
    "frames",
    "load",
    "mean_edge",
    "subdivide",
    "vertex_normals",
]

TOLERANCE = 1e-6
"""Corners closer than this are one, and triangles thinner than this have no area; times the bounding-box diagonal."""

FARTHEST = 1e100
"""Coordinates from here on would overflow when squared and cubed."""


def load(path: str | Path, *, cuts: bool = False) -> tuple[Surface, tuple[Finding, ...]]:
    """Read a mesh file, weld what its format tore apart, orient its triangles and check that it can be laid flat.

    STL repeats every corner, so its corners are always welded. OBJ, PLY and OFF state which triangles share a vertex;
    that stands if it makes the mesh one piece with one boundary (vertices that coincide are then the two sides of a
    cut), and coinciding vertices are welded if it does not.

    Parameters
    ----------
    path : an ``.stl``, ``.obj``, ``.ply`` or ``.off`` file, in any unit of length.
    cuts : whether the surface may be closed or have handles, because it will be cut open.

    Returns
    -------
    The surface, in the file's unit and with unused vertices dropped, and what was done to the mesh.

    Raises
    ------
    InputError
        The file cannot be read, or `check` refuses the mesh.
    """
    path = Path(path)
    mesh = read(path)
    try:
        _check_elements(mesh.vertices, mesh.faces)
        torn = path.suffix.lower() == ".stl" or not _one_disk(mesh.faces)
        faces, findings = _welded(mesh) if torn else (mesh.faces, _cuts(mesh))
        surface = check(mesh.vertices, faces, cuts=cuts)
    except InputError as fault:
        msg = f"{path.name}: {fault}"
        raise InputError(msg) from fault
    return surface, (_summary(path, surface), *findings, *_repairs(mesh, faces, surface))


def check(vertices: Floats, faces: Ints, *, cuts: bool = False) -> Surface:
    """Return the mesh as one oriented disk, with or without holes, without its unused vertices.

    Triangles keep their order; the minority that faces the other way is turned over.

    Parameters
    ----------
    vertices : (n_v, 3) positions.
    faces : (n_f, 3) vertex indices.
    cuts : whether it may be closed or have handles, because it will be cut open.

    Raises
    ------
    InputError
        Names the first bad element by its index, counted from 0, and its position.
    """
    vertices, faces = np.asarray(vertices, dtype=np.float64), np.asarray(faces, dtype=np.int64)
    _check_elements(vertices, faces)
    for test in (_check_areas, _check_duplicates, _check_edges, _check_pieces):
        test(vertices, faces)
    faces = _oriented(vertices, faces)
    for test in (_check_fans,) if cuts else (_check_closed, _check_fans, _check_handles):
        test(vertices, faces)
    used, renumbered = np.unique(faces, return_inverse=True)
    return Surface(vertices[used], renumbered.reshape(-1, 3))


# --- what is wrong with a mesh, in the order in which it is looked for ---


def _check_elements(vertices: Floats, faces: Ints) -> None:
    if len(faces) == 0:
        msg = "the mesh has no triangles; export a surface, not points or curves"
        raise InputError(msg)
    bad = np.flatnonzero(((faces < 0) | (faces >= len(vertices))).any(axis=1))
    if len(bad):
        msg = (
            f"triangle {bad[0]} refers to the vertices {faces[bad[0]].tolist()}, but the mesh has {len(vertices)} "
            "(counted from 0); the file is damaged, export the mesh again"
        )
        raise InputError(msg)
    bad = np.flatnonzero(~(np.abs(vertices) < FARTHEST).all(axis=1))
    if len(bad):
        msg = (
            f"vertex {bad[0]} lies at {_at(vertices[bad[0]])}, which is not finite or absurdly far; "
            "remove it or export the mesh again"
        )
        raise InputError(msg)


def _check_areas(vertices: Floats, faces: Ints) -> None:
    corners = vertices[faces]
    longest = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max(axis=1)
    double = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    flat = np.flatnonzero(double <= TOLERANCE * _size(vertices, faces) * longest)
    if len(flat):
        msg = (
            f"{_triangle(vertices, faces, flat[0])} has no area{_more(len(flat), 'triangles')}; "
            "collapse or delete degenerate triangles in a mesh editor"
        )
        raise InputError(msg)


def _check_duplicates(vertices: Floats, faces: Ints) -> None:
    _, first, same = np.unique(np.sort(faces, axis=1), axis=0, return_index=True, return_inverse=True)
    original = first[same.reshape(-1)]
    twice = np.flatnonzero(original != np.arange(len(faces)))
    if len(twice):
        msg = (
            f"{_triangle(vertices, faces, twice[0])} repeats triangle {original[twice[0]]}"
            f"{_more(len(twice), 'triangles')}; delete the duplicates"
        )
        raise InputError(msg)


def _check_edges(vertices: Floats, faces: Ints) -> None:
    edge, which, count = edge_table(faces)
    bad = np.flatnonzero(count > 2)
    if len(bad):
        a, b = edge[bad[0]]
        at_edge = np.sort(np.flatnonzero(which == bad[0]) % len(faces)).tolist()
        msg = (
            f"the edge between vertices {a} and {b} at {_at(vertices[[a, b]].mean(axis=0))} belongs to {len(at_edge)} "
            f"triangles, {at_edge[:6]}{_more(len(bad), 'edges')}; a sheet has at most two there, delete the others"
        )
        raise InputError(msg)


def _check_pieces(vertices: Floats, faces: Ints) -> None:
    piece = pieces(faces)
    count = np.bincount(piece)
    if len(count) > 1:
        second = int(np.argmax(piece == 1))
        sizes = ", ".join(str(n) for n in np.sort(count)[::-1][:5]) + (", ..." if len(count) > 5 else "")
        msg = (
            f"the mesh falls into {len(count)} pieces that share no edge, of {sizes} triangles, the second begins with "
            f"{_triangle(vertices, faces, second)}; keep one piece, or merge the vertices between them"
        )
        raise InputError(msg)


def _oriented(vertices: Floats, faces: Ints) -> Ints:
    turned = flips(faces)
    if turned is None:
        msg = (
            f"the surface is one-sided like a Moebius strip: a way from {_triangle(vertices, faces, 0)} leads back to "
            "its other side; cut the mesh so that it has a top and a bottom"
        )
        raise InputError(msg)
    return np.where(turned[:, None], faces[:, [0, 2, 1]], faces)


def _check_closed(vertices: Floats, faces: Ints) -> None:
    _, _, count = edge_table(faces)
    if not (count == 1).any():
        msg = (
            f"the surface is closed: no edge is open, beginning with {_triangle(vertices, faces, 0)}; a flat sheet "
            "needs an outline, so delete the part that you do not need, cut the mesh open, or let target.cuts be true"
        )
        raise InputError(msg)


def _check_fans(vertices: Floats, faces: Ints) -> None:
    fan = fans(faces)
    _, corner = np.unique(fan, return_index=True)
    vertex, count = np.unique(half_edges(faces)[corner, 0], return_counts=True)
    bad = np.flatnonzero(count > 1)
    if len(bad):
        v = vertex[bad[0]]
        msg = (
            f"vertex {v} at {_at(vertices[v])} is the only link between {count[bad[0]]} groups of triangles (a bow "
            f"tie){_more(len(bad), 'vertices')}; split it, or fill the gap beside it"
        )
        raise InputError(msg)


def _check_handles(vertices: Floats, faces: Ints) -> None:
    euler = len(np.unique(faces)) - len(edges(faces)) + len(faces)
    whole = 2 - len(boundary_loops(faces))
    if euler != whole:
        msg = (
            f"the surface has {(whole - euler) // 2} handle(s) like a torus (Euler characteristic {euler}, without "
            f"them {whole}), beginning with {_triangle(vertices, faces, 0)}; cut the handles open, remove them, or "
            "let target.cuts be true"
        )
        raise InputError(msg)


def _size(vertices: Floats, faces: Ints) -> float:
    """Diagonal of the bounding box of the vertices in use."""
    return float(np.linalg.norm(np.ptp(vertices[faces.ravel()], axis=0)))


def _at(point: Floats) -> str:
    return "(" + ", ".join(f"{x:.6g}" for x in point) + ")"


def _triangle(vertices: Floats, faces: Ints, f: int) -> str:
    return f"triangle {f} at {_at(vertices[faces[f]].mean(axis=0))}"


def _more(total: int, things: str) -> str:
    return f" (the first of {total} such {things})" if total > 1 else ""


# --- mending what the format tore ---


def _one_disk(faces: Ints) -> bool:
    """Whether the topology stated by the file is one piece with one boundary and no handle."""
    edge, _, count = edge_table(faces)
    euler = len(np.unique(faces)) - len(edge) + len(faces)
    return bool(count.max() <= 2 and pieces(faces).max() == 0 and euler == 1)


def _coinciding(mesh: RawMesh) -> Ints:
    """(n_v,) the first vertex in use at the same place, itself if it is the only one or not in use."""
    used = np.unique(mesh.faces)
    points, place = np.unique(mesh.vertices[used], axis=0, return_inverse=True)
    close = cKDTree(points).query_pairs(TOLERANCE * _size(mesh.vertices, mesh.faces), output_type="ndarray")
    graph = coo_array((np.ones(len(close)), tuple(close.T)), shape=(len(points), len(points)))
    _, first, cluster = np.unique(
        connected_components(graph.tocsr(), directed=False)[1][place.reshape(-1)],
        return_index=True,
        return_inverse=True,
    )
    same = np.arange(len(mesh.vertices))
    same[used] = used[first[cluster.reshape(-1)]]
    return same


def _welded(mesh: RawMesh) -> tuple[Ints, list[Finding]]:
    same = _coinciding(mesh)
    faces = same[mesh.faces]
    before, after = len(np.unique(mesh.faces)), len(np.unique(faces))
    if before == after:
        return faces, []
    message = f"{before} corners lie at {after} places and were welded"
    return faces, [Finding("mesh_welded", Severity.INFO, message, value=float(before - after), unit="vertices")]


def _cuts(mesh: RawMesh) -> list[Finding]:
    same = _coinciding(mesh)
    twin: NDArray[np.int64] = np.flatnonzero(same != np.arange(len(same)))
    if len(twin) == 0:
        return []
    where = f"vertices {same[twin[0]]} and {twin[0]} at {_at(mesh.vertices[twin[0]])}"
    message = (
        f"{len(twin)} vertices coincide with others, first {where}; the file keeps them apart, so they are the sides "
        "of a cut: merge them in the mesh if that is not meant"
    )
    return [Finding("mesh_cut", Severity.WARNING, message, value=float(len(twin)), unit="vertices", where=where)]


def _summary(path: Path, surface: Surface) -> Finding:
    longest = float(np.ptp(surface.vertices, axis=0).max())
    message = (
        f"{path.name}: {len(surface.faces)} triangles, {len(surface.vertices)} vertices, {_rims(surface)}; the "
        f"longest side of {longest:g} may be in any unit, for the width of the sheet fixes the size"
    )
    return Finding("mesh_read", Severity.INFO, message, value=float(len(surface.faces)), unit="triangles")


def _rims(surface: Surface) -> str:
    holes = len(boundary_loops(surface.faces)) - 1
    return ("closed", "one outline")[holes + 1] if holes < 1 else f"one outline and {holes} hole(s)"


def _repairs(mesh: RawMesh, faces: Ints, surface: Surface) -> list[Finding]:
    """What else was done, as findings: polygons split, vertices dropped, triangles turned over."""
    split = len(mesh.faces) - mesh.polygons
    unused = len(mesh.vertices) - len(np.unique(mesh.faces))
    # the surface's triangles keep their order and first corner, so a turned one has another second corner
    used = np.unique(faces)
    turned = int((used[surface.faces[:, 1]] != faces[:, 1]).sum())
    done = (
        ("mesh_split", split, "triangles", f"polygons were split into triangles, {split} more than the file has faces"),
        ("mesh_unused", unused, "vertices", f"{unused} vertices that no triangle uses were dropped"),
        ("mesh_turned", turned, "triangles", f"{turned} triangles faced the other way and were turned over"),
    )
    return [Finding(name, Severity.INFO, text, value=float(n), unit=unit) for name, n, unit, text in done if n]
