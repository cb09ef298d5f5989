"""Domains in `design.npz`: stored beside the design, unless they are its triangles."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields, replace
from pathlib import Path
from typing import Any

from lce_workbench.core.domains import Domains, partition
from lce_workbench.outputs import read_arrays, read_design

PREFIX = "domain_"
"""Before the names of the arrays."""
STORED = tuple(field.name for field in fields(Domains) if field.name != "holes")
"""The rims of holes are those of the design's triangles."""


def arrays(domains: Domains) -> dict[str, Any]:
    """What `outputs.write_design` stores of domains that are not the design's triangles."""
    return {PREFIX + name: getattr(domains, name) for name in STORED}


def read_domains(path: Path) -> Domains:
    """The domains of a `design.npz`: those that it stores, else its triangles.

    Raises
    ------
    InputError
        The file is missing, damaged or of another kind.
    """
    stored, triangles = read_arrays(path, _stored), partition(read_design(path))
    return triangles if stored is None else replace(stored, holes=triangles.holes)


def _stored(data: Mapping[str, Any]) -> Domains | None:
    if PREFIX + "polygons" not in data:
        return None
    return Domains(**{name: data[PREFIX + name] for name in STORED})
