"""Decimal text of integers in bulk: a few lookups a number instead of a call of a formatter.

A number is cut into groups of three digits; each group is four bytes from a table. Bytes that a shorter number leaves
over are NUL, and go when the rows become text.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

Texts = NDArray[np.bytes_]

PLAIN, MINUS, PADDED, POINT, EMPTY = 0, 1000, 2000, 3000, 4000

GROUPS = np.array(
    [pattern % i for pattern in ("%d", "-%d", "%03d", ".%03d") for i in range(1000)] + [""], dtype="S4"
).view(np.uint32)
"""Texts of 0 to 999 as they stand first, first after a minus, further on, and after the decimal point."""

HEX = np.frombuffer(b"0123456789ABCDEF", dtype=np.uint8)


def thousandths(values: NDArray[np.int32]) -> Texts:
    """``%.3f`` of values / 1000, |values| < 1e9: nanometres in um."""
    high, middle, low, sign = _groups(values)
    return _texts(
        np.where(high > 0, high + sign, EMPTY), middle + np.where(high > 0, PADDED, sign), low + np.int32(POINT)
    )


def integers(values: NDArray[np.int32]) -> Texts:
    """``%d`` of values, |values| < 1e9."""
    high, middle, low, sign = _groups(values)
    some = high + middle > 0
    return _texts(
        np.where(high > 0, high + sign, EMPTY),
        np.where(some, middle + np.where(high > 0, PADDED, sign), EMPTY),
        low + np.where(some, PADDED, sign),
    )


def billionths(values: NDArray[np.int64]) -> Texts:
    """``%.9f`` of values / 1e9, |values| < 1e12: picometres in mm."""
    whole, rest = (part.astype(np.int32) for part in np.divmod(np.abs(values), 1_000_000_000))
    high, middle, low, _ = _groups(rest)
    sign = (values < 0) * np.int32(MINUS)
    return _texts(whole + sign, high + np.int32(POINT), middle + np.int32(PADDED), low + np.int32(PADDED))


def hexadecimals(values: NDArray[np.int64]) -> Texts:
    """``%X`` of values (n,) from 1 to 2^32 - 1."""
    shifts = np.arange(28, -4, -4)
    digits = HEX[(values[:, None] >> shifts) & 15]
    digits[values[:, None] >> shifts == 0] = 0
    found: Texts = digits.view("S8")[:, 0]
    return found


def lines(pieces: Sequence[bytes | Texts]) -> bytes:
    """Rows that are alike: constant texts and columns (n,) of changing ones, joined row by row."""
    n = max(len(piece) for piece in pieces if isinstance(piece, np.ndarray))
    kinds = [piece.dtype if isinstance(piece, np.ndarray) else np.dtype(f"S{len(piece)}") for piece in pieces]
    rows = np.empty(n, dtype=[(f"f{i}", kind) for i, kind in enumerate(kinds)])
    for name, piece in zip(rows.dtype.names or (), pieces, strict=True):
        rows[name] = piece
    return rows.tobytes().translate(None, b"\0")


def _groups(values: NDArray[np.int32]) -> tuple[NDArray[np.int32], ...]:
    """Millions, thousands and ones of the absolute values, and which table holds the first group."""
    thousands, ones = np.divmod(np.abs(values), np.int32(1000))
    millions, thousands = np.divmod(thousands, np.int32(1000))
    return millions, thousands, ones, (values < 0) * np.int32(MINUS)


def _texts(*groups: NDArray[np.int32]) -> Texts:
    """Texts of four bytes a group, from indices into `GROUPS`."""
    found: Texts = np.stack([GROUPS[group] for group in groups], axis=-1).view(f"S{4 * len(groups)}")[..., 0]
    return found
