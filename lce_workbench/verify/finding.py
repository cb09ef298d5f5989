"""What a check of the verification says, and how a file that cannot be read is told."""

from __future__ import annotations

import csv
import math
import zipfile
import zlib
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from typing import Any

from lce_solver.errors import LceError
from lce_solver.types import Finding, Severity

LARGEST = 1e300
"""Stands for what is not a finite number, which JSON does not know."""

Findings = tuple[Finding, ...]


class Unreadable(LceError):
    """A file cannot be read by its reader; the sentence says why."""


DAMAGES = (OSError, EOFError, ValueError, RuntimeError, LookupError, TypeError, AttributeError, OverflowError,
           MemoryError, csv.Error, zlib.error, zipfile.BadZipFile)  # fmt: skip
"""What readers raise at a damaged file."""


@contextmanager
def reading(*more: type[Exception]) -> Iterator[None]:
    """Turn what a reader raises at a damaged file, also ``more``, into `Unreadable`. Nothing is checked within."""
    try:
        yield
    except (*DAMAGES, *more) as fault:
        said = getattr(fault, "strerror", None) or " ".join(str(fault).split())[:160] or type(fault).__name__
        msg = f"cannot be read ({said}); write it again"
        raise Unreadable(msg) from fault


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
    """What ``run`` finds, or that its file cannot be read; any other exception is a fault of ours and goes on."""
    try:
        return tuple(run(*given))
    except Unreadable as fault:
        return (error(check, where, str(fault)),)
