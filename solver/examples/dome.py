"""Design the sheet that becomes a dome, or the surface of the mesh file given as first argument.

Usage: python dome.py [TARGET.stl] [--out design.npz]
"""

import argparse
from pathlib import Path

import numpy as np

from lce_solver.design import design
from lce_solver.geometry import mean_edge
from lce_solver.remesh import remesh
from lce_solver.surface import load
from lce_solver.surfaces import SURFACES
from lce_solver.types import Material


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("target", nargs="?", type=Path, help="mesh file; without it, the shipped dome")
    parser.add_argument("--out", type=Path, default=Path("design.npz"))
    options = parser.parse_args()

    # 1. The target, in any unit: an open surface, orientable, in one piece.
    target = load(options.target)[0] if options.target else SURFACES["dome"](0.1)

    # 2. Equal triangles: each becomes one domain of uniform director.
    size = np.ptp(target.vertices, axis=0).max()
    surface = remesh(target, 0.05 * size)

    # 3. The sheet: 20 mm wide, 0.1 mm thick, of a material that shrinks to 60 % along its director.
    sheet = design(surface, Material(lambda_=0.6, nu=0.5), width=20.0, thickness=0.1, starts=6)

    print(f"{len(sheet.theta)} domains of mean edge {mean_edge(sheet.surface):.2f} mm on the target")
    for finding in sheet.findings:
        print(f"{finding.severity.value:8}{finding.check}: {finding.message}")

    # 4. The flat sheet seen from above [mm], the director in mid-plane and its twist from bottom to top [rad].
    np.savez(options.out, uv=sheet.uv, faces=sheet.surface.faces, theta=sheet.theta, dtheta=sheet.dtheta)


if __name__ == "__main__":
    main()
