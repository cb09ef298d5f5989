"""The angle table, domains.csv."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from lce_solver.types import Floats, Ints
from lce_workbench.core.domains import Domains

DECIMALS = 6
"""Angles to a micro-degree, lengths to a nanometre."""


def write_table(domains: Domains, counts: Sequence[Ints], path: Path) -> None:
    """Write one row per domain: place, angles [degrees, lines in [0, 180)], stretches and channel counts.

    Parameters
    ----------
    counts : (n_d,) channels in each domain, of the bottom and of the top plate.

    Raises
    ------
    OSError
        The file cannot be written.
    """
    table = columns(domains, counts)
    row = ",".join(FORMATS.get(name, f"%.{DECIMALS}f") for name in table) + "\n"
    values = zip(*(column.tolist() for column in table.values()), strict=True)
    with path.open("w", encoding="ascii", newline="\n") as file:
        file.write(",".join(table) + "\n")
        file.writelines(row % value for value in values)


def columns(domains: Domains, counts: Sequence[Ints]) -> dict[str, Floats | Ints]:
    """Name -> column (n_d,) of the table; arguments as for `write_table`."""
    x, y = domains.centroid.T
    return {
        "domain": np.arange(len(domains)),
        "x_mm": _rounded(x),
        "y_mm": _rounded(y),
        "area_mm2": domains.area,
        "theta_deg": _line(domains.theta),
        "dtheta_deg": _rounded(np.degrees(domains.dtheta)),
        "theta_top_deg": _line(domains.angle("top")),
        "theta_bottom_deg": _line(domains.angle("bottom")),
        "written_top_deg": _line(domains.written("top")),
        "written_bottom_deg": _line(domains.written("bottom")),
        "stretch_along": domains.stretch[:, 0],
        "stretch_across": domains.stretch[:, 1],
        "channels_top": counts[1],
        "channels_bottom": counts[0],
    }


FORMATS = {"domain": "%d", "channels_top": "%d", "channels_bottom": "%d", "area_mm2": "%.9f"}
"""Columns that are not written with `DECIMALS`."""


def _rounded(value: Floats) -> Floats:
    """Round before printing, so that no -0.000000 appears."""
    return np.round(value, DECIMALS) + 0.0


def _line(angle: Floats) -> Floats:
    """Line angles in degrees that stay below 180 when they are printed."""
    return np.mod(_rounded(np.degrees(angle)), 180.0)
