"""The outlines of all domains as faces in one STEP file, each a product named with its angles and coloured by them."""

from __future__ import annotations

import colorsys
from pathlib import Path

import numpy as np

from lce_workbench.cad.brep import write_faces
from lce_workbench.cad.part21 import part21
from lce_workbench.core.domains import PLATES, Domains
from lce_workbench.core.polyhedron import Polyhedron
from lce_workbench.core.prism import Colour

HUES = 36
"""Colours of the circle of directions."""

SURFACE = "@0=OPEN_SHELL('',(#{face:d}));\n@1=SHELL_BASED_SURFACE_MODEL('{name}',(@0));\n"


def write_domains(domains: Domains, path: Path) -> None:
    """Write every domain as a face in the film's mid-plane.

    Raises
    ------
    OSError
        The file cannot be written.
    """
    n = len(domains)
    surface = Polyhedron(
        np.insert(domains.vertices, 2, 0.0, axis=1), tuple((ring[ring >= 0],) for ring in domains.polygons)
    )
    names = domain_names(domains)
    with part21(path) as out:
        root = out.product(out.name)
        faces = out.rows(SURFACE, n, {"face": write_faces(out, [surface], names), "name": names}) + 1
        products = out.products(names, list(faces[:, None]), "MANIFOLD_SURFACE_SHAPE_REPRESENTATION")
        out.place(products, root)
        hue = np.floor(domains.theta / np.pi * HUES).astype(int) % HUES
        for k in np.unique(hue).tolist():
            out.paint(faces[hue == k], _hue(k / HUES), 1.0)


def domain_names(domains: Domains) -> list[str]:
    """Number, director and both plates' channel directions of each domain, seen from above, in degrees."""
    angles = np.degrees([domains.theta, *(domains.angle(plate) for plate in PLATES)]).round(2) % 180
    return [
        f"domain_{k:04d}_theta_{theta:06.2f}_bottom_{bottom:06.2f}_top_{top:06.2f}"
        for k, (theta, bottom, top) in enumerate(angles.T.tolist())
    ]


def _hue(turn: float) -> Colour:
    return colorsys.hsv_to_rgb(turn, 0.6, 0.9)
