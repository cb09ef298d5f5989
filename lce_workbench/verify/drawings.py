"""DXF of any version: ezdxf opens the document with a few polylines of every layer; NumPy reads the corners of all."""

from __future__ import annotations

import io
from collections import Counter
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from lce_solver.types import Floats, Ints

POLYLINES = (b"LWPOLYLINE", b"POLYLINE")

CORNERED = (b"LWPOLYLINE", b"VERTEX")

STRUCTURE = (*POLYLINES, b"SECTION", b"ENDSEC", b"VERTEX", b"SEQEND", b"BLOCK", b"ENDBLK", b"EOF")

DIGIT, BLANK = (np.isin(np.arange(256), tuple(known)) for known in (b"0123456789", b" \t\r\n"))
"""(256,) whether a byte is one."""

LONGEST = 64
"""Bytes of a line that matters."""

SHOWN = 20
"""So many polylines of every layer ezdxf reads."""


@dataclass(frozen=True, eq=False)
class Drawing:
    """The polylines of a drawing."""

    points: Floats
    """(n, 2) corners of all polylines, laid end to end, in the file's unit."""
    counts: Ints
    """(m,) corners of each polyline."""
    layers: Any
    """(m,) name of each one's layer."""
    unit: str | None
    """$INSUNITS; None if the file has none."""
    others: Counter[str]
    """Everything that is no closed polyline, with how many."""


def read(data: bytes) -> Drawing:
    """What the text of a DXF file draws.

    Raises
    ------
    ValueError
        It is no whole DXF file, or ezdxf finds other polylines in it.
    """
    tags = Tags(data)
    if tags.kind[-1:].tolist() != [b"EOF"]:
        msg = "it ends before its end"
        raise ValueError(msg)
    drawn = np.isin(tags.section, (b"ENTITIES", b"BLOCKS"))
    heads = np.flatnonzero(drawn & np.isin(tags.kind, POLYLINES))
    corners = drawn & np.isin(tags.kind, CORNERED)
    x, y = (np.flatnonzero((tags.code == axis) & corners[tags.record]) for axis in (10, 20))
    owner = np.searchsorted(heads, tags.record[x], side="right") - 1
    if not np.array_equal(tags.record[x], tags.record[y]) or np.any(owner < 0):
        msg = "a corner lacks a coordinate, or belongs to no polyline"
        raise ValueError(msg)
    points = np.stack([tags.values(x).astype(np.float64), tags.values(y).astype(np.float64)], axis=1)
    layer = tags.of(heads, 8, b"")
    closed = tags.of(heads, 70, b"0").astype(np.int64) & 1
    others = Counter(kind.decode("ascii", "replace") for kind in tags.kind[drawn & ~np.isin(tags.kind, STRUCTURE)])
    others["open polylines"] = int(np.sum(closed == 0))
    counts = np.bincount(owner, minlength=len(heads))
    found = Drawing(points, counts, np.char.decode(layer, "utf-8"), None, others)
    return replace(found, unit=_opened(tags, heads, found))


@dataclass(frozen=True, eq=False)
class Tags:
    """The tags of a DXF file: two lines each, a group code and a value; code 0 begins a record."""

    data: bytes

    @cached_property
    def _bytes(self) -> Any:
        return np.frombuffer(self.data, dtype=np.uint8)

    @cached_property
    def _lines(self) -> tuple[Ints, Ints]:
        """Beginning and end of every line."""
        end = np.flatnonzero(self._bytes == ord("\n"))
        if len(end) % 2 or not len(end) or self.data[-1:] != b"\n":
            msg = "it is no DXF file, or ends before its end"
            raise ValueError(msg)
        return np.concatenate([[0], end[:-1] + 1]), end

    def _text(self, lines: Ints) -> Any:
        """(n,) lines as byte strings without white space around them."""
        start, end = (edge[lines] for edge in self._lines)
        width = int((end - start).max(initial=1))
        if width > LONGEST:
            msg = f"a line of {width} bytes stands where a number or a name should"
            raise ValueError(msg)
        place = start[:, None] + np.arange(width)
        held = np.where(place < end[:, None], self._bytes[np.minimum(place, len(self.data) - 1)], 0)
        return np.char.strip(np.ascontiguousarray(held, dtype=np.uint8).view(f"S{width}").ravel())

    @cached_property
    def code(self) -> Ints:
        """(n,) group code of every tag."""
        start, end = (edge[::2] for edge in self._lines)
        found = np.zeros(len(start), dtype=np.int64)
        if int((end - start).max()) > LONGEST:
            msg = "it is no DXF file"
            raise ValueError(msg)
        for k in range(int((end - start).max())):
            byte = self._bytes[np.minimum(start + k, end)]
            digit = DIGIT[byte]
            if not np.all(digit | BLANK[byte]):
                msg = "it is no DXF file: a group code is no number"
                raise ValueError(msg)
            found = np.where(digit, 10 * found + byte - ord("0"), found)
        return found

    def values(self, tags: Ints) -> Any:
        """(k,) values of some tags as byte strings."""
        return self._text(2 * tags + 1)

    @cached_property
    def begin(self) -> Ints:
        """(r,) first tag of every record."""
        return np.flatnonzero(self.code == 0)

    @cached_property
    def record(self) -> Ints:
        """(n,) record of every tag, -1 before the first."""
        return np.cumsum(self.code == 0) - 1

    @cached_property
    def kind(self) -> Any:
        """(r,) what every record is."""
        return self.values(self.begin)

    @cached_property
    def section(self) -> Any:
        """(r,) the section that every record lies in."""
        first = np.flatnonzero(self.kind == b"SECTION")
        names = np.concatenate([[b""], self.of(first, 2, b"")])
        return names[np.searchsorted(first, np.arange(len(self.kind)), side="right")]

    def of(self, records: Ints, code: int, default: bytes) -> Any:
        """(k,) value of the last tag of that code in some records (sorted)."""
        tags = np.flatnonzero((self.code == code) & np.isin(self.record, records))
        texts = self.values(tags)
        found = np.full(len(records), default, dtype=f"S{max(texts.dtype.itemsize, len(default), 1)}")
        found[np.searchsorted(records, self.record[tags])] = texts
        return found

    def cut(self, kept: Any) -> bytes:
        """The file with some of its records (r,) alone."""
        start = self._lines[0][2 * self.begin]
        edges = np.flatnonzero(np.diff(np.concatenate([[False], kept, [False]]).astype(np.int8)))
        place = np.concatenate([start, [len(self.data)]])[edges]
        return b"".join(self.data[low:high] for low, high in place.reshape(-1, 2).tolist())


def _opened(tags: Tags, heads: Ints, found: Drawing) -> str | None:
    """$INSUNITS as ezdxf has it, which opens the document with the first polylines of every layer and has to agree."""
    import ezdxf

    shown = np.array([k for name in np.unique(found.layers) for k in np.flatnonzero(found.layers == name)[:SHOWN]])
    shown = np.sort(shown.astype(np.int64))
    owner = np.searchsorted(heads, np.arange(len(tags.kind)), side="right") - 1
    part = np.isin(tags.kind, (*POLYLINES, b"VERTEX", b"SEQEND")) & (owner >= 0)
    text = tags.cut(~part | np.isin(owner, shown)).decode("utf-8")
    try:
        document = ezdxf.read(io.StringIO(text.replace("\r\n", "\n")))
    except ezdxf.DXFError as fault:
        raise ValueError(str(fault)) from None
    seen = [_corners(entity) for entity in document.modelspace() if entity.dxftype() in {"LWPOLYLINE", "POLYLINE"}]
    end = np.cumsum(found.counts)
    wanted = [(str(found.layers[k]), found.points[end[k] - found.counts[k] : end[k]].tolist()) for k in shown]
    if seen != wanted:
        msg = f"ezdxf finds {len(seen)} polylines where {len(wanted)} are written, or finds them elsewhere"
        raise ValueError(msg)
    unit = document.header.get("$INSUNITS")
    return None if unit is None else str(unit)


def _corners(entity: Any) -> tuple[str, list[list[float]]]:
    """Layer and corners of a polyline."""
    points = entity.get_points("xy") if entity.dxftype() == "LWPOLYLINE" else entity.points()
    return entity.dxf.layer, [[float(p[0]), float(p[1])] for p in points]
