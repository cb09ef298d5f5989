"""Bad meshes and bad jobs, with what the sentence must say: for the loaders and for the command line."""

import meshes
import numpy as np

FACE = '[target]\nsurface = "face"\n'

BAD_JOBS = {
    "unknown section": (FACE + "[chanels]\n", "[chanels]; did you mean channels?"),
    "unknown key": (FACE + "[sheet]\nwitdh_mm = 20\n", "sheet.witdh_mm; did you mean width_mm?"),
    "wrong type": (FACE + '[sheet]\nwidth_mm = "wide"\n', "sheet.width_mm must be a number, not 'wide'"),
    "boolean as a number": (FACE + "[sheet]\nwidth_mm = true\n", "sheet.width_mm must be a number"),
    "fraction as a count": (FACE + "[solver]\nstarts = 1.5\n", "solver.starts must be a whole number"),
    "section as a value": (FACE + "sheet = 3\n", "target.sheet"),
    "lambda 0": (FACE + "[material]\nlambda = 0\nnu = 0.5\n", "material.lambda is 0; it must be greater than 0"),
    "lambda negative": (FACE + "[material]\nlambda = -0.6\nnu = 0.5\n", "material.lambda is -0.6"),
    "lambda without nu": (FACE + "[material]\nlambda = 0.6\n", "material.lambda and material.nu belong together"),
    "material twice": (FACE + '[material]\npreset = "x"\nlambda = 0.6\nnu = 0.5\n', "the material is given twice"),
    "curve alone": (FACE + '[material]\ncurve = "c.csv"\n', "material.temperature_C belong together"),
    "gap 0": (FACE + "[sheet]\ngap_um = 0\n", "sheet.gap_um is 0 um; it must be greater than 0 um"),
    "spacing 0": (FACE + "[channels]\nspacing_um = 0\n", "channels.spacing_um is 0 um"),
    "not finite": (FACE + "[sheet]\nwidth_mm = nan\n", "sheet.width_mm is nan; give a finite number"),
    "infinite": (FACE + "[sheet]\nwidth_mm = inf\n", "sheet.width_mm is inf"),
    "domain larger than the sheet": (
        FACE + "[domains]\nsize_um = 9000\n[sheet]\nwidth_mm = 5\n",
        "is not smaller than",
    ),
    "domain smaller than a channel": (FACE + "[domains]\nsize_um = 3\n", "holds hardly a channel"),
    "channel deeper than its epoxy": (
        FACE + "[channels]\ndepth_um = 50\n",
        "job.toml: channels.depth_um = 50 is not smaller than the epoxy layer that holds them (plates.epoxy_um = 50)",
    ),
    "channel deeper than the film": (
        FACE + "[channels]\ndepth_um = 6\n[sheet]\ngap_um = 5\n",
        "raise sheet.gap_um",
    ),
    "400 digits": (FACE + f"[sheet]\nwidth_mm = {'9' * 400}\n", "sheet.width_mm is inf; give a finite number"),
    "400 digits of a count": (FACE + f"[solver]\nstarts = {'9' * 400}\n", "solver.starts is inf; give a finite number"),
    "5000 digits": (FACE + f"[sheet]\nwidth_mm = {'9' * 5000}\n", "is not valid TOML"),
    "format twice": (FACE + '[output]\nmasks = ["gds", "dxf", "gds"]\n', "output.masks lists 'gds' twice"),
    "no target": ("[sheet]\nwidth_mm = 20\n", "there is no target"),
    "two targets": ('[target]\nsurface = "face"\nmesh = "a.stl"\n', "are both given"),
    "unknown choice": ('[target]\nmesh = "a.stl"\nsubdivision = "cubic"\n', "choose one of loop, midpoint"),
    "list of other things": (FACE + "[output]\nstep_domains = [1.5]\n", "each item is a whole number"),
    "nested deeply": (FACE + f"[sheet]\nwidth_mm = {'[' * 3000}{']' * 3000}\n", "is not valid TOML"),
    "a relief of many pixels": (FACE + "[output]\nrelief = true\nrelief_pixel_nm = 1\n", "9e+08 pixels"),
    "not TOML": ("[target\n", "is not valid TOML"),
}


def degenerate():
    vertices, faces = meshes.grid()
    vertices[faces[5]] = [(0, 0, 0), (1, 1, 1), (3, 3, 3)]
    return vertices, faces


def collapsed():
    vertices, faces = meshes.grid()
    return vertices, np.vstack([faces, [[2, 2, 3]]])


def duplicated():
    vertices, faces = meshes.grid()
    return vertices, np.vstack([faces, faces[[4]][:, [1, 2, 0]]])


def with_fin():
    vertices, faces = meshes.grid()
    a, b = faces[0, [0, 2]]  # the diagonal of the first square, an inner edge
    return np.vstack([vertices, [[0.5, 0.5, 2.0]]]), np.vstack([faces, [[a, b, len(vertices)]]])


def two_pieces():
    vertices, faces = meshes.grid()
    return np.vstack([vertices, vertices[:3] + np.array([0, 0, 5])]), np.vstack(
        [faces, np.array([[0, 1, 2]]) + len(vertices)]
    )


def bow_tie():
    """Two squares of a chequerboard touch at vertex 4; a bridge far from it makes them one piece."""
    vertices, faces = meshes.grid(2, 2)
    keep = [f for f, face in enumerate(faces.tolist()) if f not in (0, 4, 3, 7)]
    outer = np.array([(3, 0, 0), (0, 3, 0), (3, 3, 0)], float)
    n = len(vertices)
    bridge = [[7, 6, n], [7, n, 8], [8, n, n + 2], [8, n + 2, n + 1], [8, n + 1, 5], [5, n + 1, 2]]
    return np.vstack([vertices, outer]), np.vstack([faces[keep], bridge])


def not_finite():
    vertices, faces = meshes.grid()
    vertices[7, 1] = np.nan
    return vertices, faces


def out_of_range():
    vertices, faces = meshes.grid()
    faces[3, 1] = 99
    return vertices, faces


BAD_MESHES = {
    # name: mesh, the element that the sentence must name, the remedy it must offer
    "no triangles": (lambda: (meshes.grid()[0], np.empty((0, 3), int)), "no triangles", "export"),
    "not finite": (not_finite, r"vertex 7 lies at \(1, nan, ", "export the mesh again"),
    "index": (out_of_range, r"triangle 3 refers .*99", "export the mesh again"),
    "no area": (degenerate, r"triangle 5 at \(1\.33333, 1\.33333, 1\.33333\) has no area", "delete degenerate"),
    "corner twice": (collapsed, r"triangle 24 at \(.*\) has no area", "delete degenerate"),
    "duplicate": (duplicated, r"triangle 24 at \(.*\) repeats triangle 4", "delete the duplicates"),
    "three at an edge": (with_fin, r"edge between vertices 0 and 5 at \(.*\) .*3 triangles, \[0, 12, 24\]", "delete"),
    "pieces": (two_pieces, r"2 pieces .* of 24, 1 triangles.* triangle 24 at \(0, 1, 5", "keep one piece"),
    "one-sided": (lambda: meshes.band(8, 1), r"Moebius strip.* triangle 0 at \(", "cut the mesh"),
    "closed": (meshes.octahedron, r"closed.* triangle 0 at \(0.333", "cut the mesh open"),
    "bow tie": (bow_tie, r"vertex 4 at \(1, 1, .* 2 groups", "split it"),
    "handle": (meshes.torus_with_hole, r"1 handle.* triangle 0 at", "cut the handles open"),
}
