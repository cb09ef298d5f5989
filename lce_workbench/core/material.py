"""The material of the job: a preset, numbers, or a measured curve read at one temperature."""

from __future__ import annotations

import csv
import math
import tomllib
from pathlib import Path
from typing import Any

import numpy as np

from lce_solver.errors import InputError
from lce_solver.types import Finding, Material, Severity
from lce_workbench import ROOT
from lce_workbench.core.job import MaterialSpec

COLUMNS = ("T_C", "lambda_parallel", "lambda_perpendicular")


def resolve(spec: MaterialSpec, base: Path) -> tuple[Material, tuple[Finding, ...]]:
    """The material that the job names; files are relative to ``base``.

    Raises
    ------
    InputError
        Unknown preset, unreadable curve, or a temperature outside the curve.
    """
    if spec.curve and spec.temperature_C is not None:
        return from_curve(base / spec.curve, spec.temperature_C), ()
    if spec.lambda_ is not None and spec.nu is not None:
        return Material(spec.lambda_, spec.nu, "given in the job"), ()
    return from_preset(spec.preset)


def presets() -> dict[str, dict[str, Any]]:
    """The shipped presets by name."""
    return tomllib.loads((ROOT / "resources" / "materials.toml").read_text(encoding="utf-8"))


def from_preset(name: str) -> tuple[Material, tuple[Finding, ...]]:
    """A shipped preset; an estimate says so in a finding."""
    table = presets()
    if name not in table:
        msg = f"material.preset {name!r} is unknown; shipped are {', '.join(table)}"
        raise InputError(msg)
    entry = table[name]
    material = Material(entry["lambda"], entry["nu"], entry["source"])
    if not entry["estimate"]:
        return material, ()
    text = (
        f"material preset {name}: lambda = {material.lambda_:g}, nu = {material.nu:g} is an estimate; "
        "measure your film and give material.curve or lambda and nu"
    )
    return material, (Finding("material_estimate", Severity.WARNING, text, material.lambda_),)


def from_curve(path: Path, temperature: float) -> Material:
    """Interpolate a measured curve (columns T_C, lambda_parallel, lambda_perpendicular) at ``temperature`` [degC].

    nu = -ln(lambda_perpendicular) / ln(lambda_parallel), so that lambda^-nu is the measured stretch across.
    """
    along, across = measured(path, temperature)
    nu = -math.log(across) / math.log(along) if along != 1.0 else 0.0
    return Material(along, nu, f"{path.name} at {temperature:g} C")


def measured(path: Path, temperature: float) -> tuple[float, float]:
    """Both stretches of a measured curve at ``temperature`` [degC], along and across the director.

    Raises
    ------
    InputError
        The curve cannot be read, or ends before the temperature.
    """
    rows = np.array(_rows(path))
    order = np.argsort(rows[:, 0])
    degrees, along, across = rows[order].T
    if len(degrees) > 1 and np.any(np.diff(degrees) == 0):
        msg = f"curve {path}: the temperature {degrees[:-1][np.diff(degrees) == 0][0]:g} C stands twice; keep one row"
        raise InputError(msg)
    if not degrees[0] <= temperature <= degrees[-1]:
        msg = (
            f"material.temperature_C = {temperature:g} is outside the curve {path} "
            f"({degrees[0]:g} to {degrees[-1]:g} C); measure further or choose a temperature inside"
        )
        raise InputError(msg)
    return float(np.interp(temperature, degrees, along)), float(np.interp(temperature, degrees, across))


def temperatures(path: Path) -> list[float]:
    """The temperatures of a measured curve, in rising order [degC].

    Raises
    ------
    InputError
        The curve cannot be read.
    """
    return sorted({row[0] for row in _rows(path)})


def _rows(path: Path) -> list[tuple[float, float, float]]:
    try:
        with path.open(newline="", encoding="utf-8-sig") as file:
            reader = csv.DictReader((line for line in file if not line.startswith("#")), skipinitialspace=True)
            names = [name.strip() for name in reader.fieldnames or ()]
            reader.fieldnames = names
            missing = [column for column in COLUMNS if column not in names]
            if missing:
                msg = f"curve {path} has no column {missing[0]}; the first line must name {', '.join(COLUMNS)}"
                raise InputError(msg)
            rows = [_row(record, path, reader.line_num) for record in reader]
    except (OSError, UnicodeDecodeError) as fault:
        reason = fault.strerror if isinstance(fault, OSError) else "not UTF-8 text"
        msg = f"curve {path} cannot be read ({reason}); give a CSV file with {', '.join(COLUMNS)}"
        raise InputError(msg) from None
    if not rows:
        msg = f"curve {path} has no rows; give at least one measured temperature"
        raise InputError(msg)
    return rows


def _row(record: dict[str, str], path: Path, line: int) -> tuple[float, float, float]:
    try:
        t, along, across = (float(record[column]) for column in COLUMNS)
    except (TypeError, ValueError):
        msg = f"curve {path}, line {line}: {', '.join(COLUMNS)} must be three numbers"
        raise InputError(msg) from None
    if not (math.isfinite(t) and 0.05 < along < 20 and 0.05 < across < 20):
        msg = f"curve {path}, line {line}: stretches must be ratios such as 0.6 and 1.29 (not percent)"
        raise InputError(msg)
    return t, along, across
