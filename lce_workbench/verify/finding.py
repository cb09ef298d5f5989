"""What a check of the verification says, and how a file that cannot be read is told."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from typing import Any

from lce_solver.errors import LceError
from lce_solver.types import Finding, Severity

LARGEST = 1e300
"""Stands for what is not a finite number, which JSON does not know."""

Findings = tuple[Finding, ...]


class Unreadable(LceError):
    """A file cannot be read by its reader; the sentence says which and why."""


def measured(
    check: str, where: str, what: str, value: float, limit: float, *, unit: str = "", places: int = 1
) -> Finding:
    """A finding about a deviation, an error when it exceeds ``limit``; ``places`` counts how many places do."""
    good = value <= limit
    more = f"; {places} places exceed it" if places > 1 else ""
    text = f"{where}: {what} {value:.6g} {unit}".rstrip() + f" (limit {limit:.3g}{more})"
    number = float(value) if math.isfinite(value) else LARGEST
    return Finding(check, Severity.INFO if good else Severity.ERROR, text, number, float(limit), unit, where)


def same(check: str, where: str, what: str, found: object, wanted: object) -> Finding:
    """A finding about something that must be equal."""
    good = found == wanted
    text = f"{where}: {what} is {found}" + ("" if good else f", it should be {wanted}")
    return Finding(check, Severity.INFO if good else Severity.ERROR, text, float(not good), 0.0, where=where)


def error(check: str, where: str, text: str) -> Finding:
    """A finding about what cannot be measured at all."""
    return Finding(check, Severity.ERROR, f"{where}: {text}", where=where)


def guarded(check: str, where: str, run: Callable[..., Iterable[Finding]], *given: Any) -> Findings:
    """What ``run`` finds, or that the file cannot be checked: damage can make any reader raise anything."""
    try:
        return tuple(run(*given))
    except Exception as fault:
        said = " ".join(str(fault).split()) or type(fault).__name__
        return (error(check, where, f"cannot be read ({said[:200]}); write it again"),)
