"""Lengths are mm and angles radians inside; these are the named edges to other units."""

from __future__ import annotations

UM = 1e-3
"""One micrometre in mm."""
NM = 1e-6
"""One nanometre in mm."""
