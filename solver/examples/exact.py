"""Compare exact solutions with their closed form: the curvature that the director encodes, and the target's."""

import numpy as np

from lce_solver.field import sample, sheet
from lce_solver.fields import FIELDS
from lce_solver.types import Material


def main() -> None:
    material = Material(lambda_=0.6, nu=0.5)
    for name, make in FIELDS.items():
        field = make(material)
        uv, faces = sheet(field, edge=0.1 * field.limits[1])
        exact = sample(field, uv, faces)
        inner = uv[faces].mean(axis=1)
        error = np.abs(field.curvature(inner) - field.gaussian(field.radial(inner))).max()
        print(f"{name:17} {len(exact.theta):5} triangles, {field.bound}; curvature to {error:.0e}")


if __name__ == "__main__":
    main()
