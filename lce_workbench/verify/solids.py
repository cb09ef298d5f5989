"""STEP files as OpenCASCADE's document reader finds them: names, places, volumes, validity of every part."""

from __future__ import annotations

import gzip
import re
import shutil
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from lce_solver.types import Floats
from lce_workbench.verify.finding import Unreadable, reading

READABLE = 2000
"""Channels that the kernel reads in some seconds; of larger files the statements are counted."""

REPAIRS = ("FixFreeShellMode", "FixFreeFaceMode", "FixFreeWireMode", "FixSolidMode", "FixShellMode", "FixFaceMode",
           "FixWireMode", "FixSameParameterMode")  # fmt: skip
"""What the kernel's reader does to the shapes that it reads unless it is told not to; most of its time goes there."""


@dataclass(frozen=True, eq=False)
class Part:
    """One product."""

    name: str
    count: int
    """Solids in it."""
    volume: float
    """[mm3]"""
    low: Floats
    """(3,) corner of its box [mm]."""
    high: Floats
    """(3,) [mm]."""
    valid: bool
    """By the kernel's own check; true when it was not asked."""
    levels: Floats
    """(k,) heights of its corners, ascending [mm]."""

    def like(self, other: Part) -> bool:
        """Whether both have the same box and volume, to 1 nm and a millionth."""
        near = np.abs(np.concatenate([self.low - other.low, self.high - other.high])).max() < 1e-6
        return bool(near) and abs(self.volume - other.volume) <= 1e-6 * abs(other.volume)


def parts(path: Path, *, validate: bool = True) -> list[Part]:
    """Every product with solids, in the file's order.

    Raises
    ------
    Unreadable
        OpenCASCADE cannot read the file, or finds no part in it.
    """
    from OCP.Standard import Standard_Failure

    with reading(Standard_Failure), tempfile.TemporaryDirectory() as folder:
        plain = path
        if path.suffix == ".gz":
            plain = Path(folder) / "channels.step"
            with gzip.open(path) as packed, plain.open("wb") as out:
                shutil.copyfileobj(packed, out)
        return _transferred(plain, validate=validate)


def _transferred(path: Path, *, validate: bool) -> list[Part]:
    from OCP.IFSelect import IFSelect_RetDone
    from OCP.STEPCAFControl import STEPCAFControl_Reader
    from OCP.TCollection import TCollection_ExtendedString
    from OCP.TDF import TDF_LabelSequence
    from OCP.TDocStd import TDocStd_Document
    from OCP.XCAFDoc import XCAFDoc_DocumentTool

    document = TDocStd_Document(TCollection_ExtendedString("verify"))
    reader = STEPCAFControl_Reader()
    reader.SetNameMode(True)
    roots = TDF_LabelSequence()
    if path.is_file() and reader.ReadFile(str(path)) == IFSelect_RetDone and _as_written(reader).Transfer(document):
        XCAFDoc_DocumentTool.ShapeTool_s(document.Main()).GetFreeShapes(roots)
    found = [_part(name, shape, validate) for root in roots for name, shape in _leaves(root, None)]
    if not found:
        msg = "OpenCASCADE finds no part in it; write it again"
        raise Unreadable(msg)
    return found


def _as_written(reader: Any) -> Any:
    """A reader that has read a file, and will not repair what is in it."""
    from OCP.Resource import Resource_DataMapOfAsciiStringAsciiString
    from OCP.TCollection import TCollection_AsciiString

    modes = Resource_DataMapOfAsciiStringAsciiString()
    for mode in REPAIRS:
        modes.Bind(TCollection_AsciiString(f"FixShape.{mode}"), TCollection_AsciiString("0"))
    reader.SetShapeFixParameters(modes)
    return reader


def _leaves(label: Any, place: Any) -> Iterator[tuple[str, Any]]:
    """Name and shape of every product without components, where it belongs."""
    from OCP.TDF import TDF_Label, TDF_LabelSequence
    from OCP.XCAFDoc import XCAFDoc_ShapeTool

    own = XCAFDoc_ShapeTool.GetLocation_s(label)
    place = own if place is None else place.Multiplied(own)
    if XCAFDoc_ShapeTool.IsReference_s(label):
        target = TDF_Label()
        XCAFDoc_ShapeTool.GetReferredShape_s(label, target)
        label = target
    below = TDF_LabelSequence()
    XCAFDoc_ShapeTool.GetComponents_s(label, below)
    # below a domain are its channels: nameless ones that a mapped item places, or components named by their length
    if not XCAFDoc_ShapeTool.IsAssembly_s(label) or _name(label).startswith("domain_"):
        yield _name(label), XCAFDoc_ShapeTool.GetShape_s(label).Moved(place)
        return
    for child in below:
        yield from _leaves(child, place)


def _name(label: Any) -> str:
    """The label's name, "" if it has none."""
    from OCP.TDataStd import TDataStd_Name
    from OCP.TDF import TDF_AttributeIterator

    attributes = TDF_AttributeIterator(label)
    while attributes.More():
        if isinstance(attributes.Value(), TDataStd_Name):
            return str(attributes.Value().Get().ToExtString())
        attributes.Next()
    return ""


def _part(name: str, shape: Any, validate: bool) -> Part:
    from OCP.BRep import BRep_Tool
    from OCP.BRepCheck import BRepCheck_Analyzer
    from OCP.BRepGProp import BRepGProp
    from OCP.GProp import GProp_GProps
    from OCP.TopAbs import TopAbs_SOLID, TopAbs_VERTEX
    from OCP.TopoDS import TopoDS

    properties = GProp_GProps()
    BRepGProp.VolumeProperties_s(shape, properties)
    corners = [BRep_Tool.Pnt_s(TopoDS.Vertex_s(v)) for v in _inside(shape, TopAbs_VERTEX)]
    points = np.array([(p.X(), p.Y(), p.Z()) for p in corners]).reshape(-1, 3)
    low, high = (points.min(axis=0), points.max(axis=0)) if len(points) else (np.full(3, np.nan),) * 2
    valid = BRepCheck_Analyzer(shape).IsValid() if validate else True
    count = sum(1 for _ in _inside(shape, TopAbs_SOLID))
    return Part(name, count, properties.Mass(), low, high, valid, np.unique(points[:, 2].round(8)))


def _inside(shape: Any, kind: Any) -> Iterator[Any]:
    from OCP.TopExp import TopExp_Explorer

    explorer = TopExp_Explorer(shape, kind)
    while explorer.More():
        yield explorer.Current()
        explorer.Next()


STATEMENT = re.compile(rb"=(MAPPED_ITEM|NEXT_ASSEMBLY_USAGE_OCCURRENCE|PRODUCT)\((?:'([^']*)')?")


def counted(path: Path) -> tuple[int, list[str]]:
    """Placements of channels and names of domains in a file of channels, by its text.

    Raises
    ------
    Unreadable
        It is missing or damaged.
    """
    names, placed, mapped, line = [], 0, 0, b""
    with reading(), gzip.open(path) if path.suffix == ".gz" else path.open("rb") as file:
        for line in file:
            hit = STATEMENT.search(line)
            if hit and hit[1] == b"PRODUCT":
                names.append((hit[2] or b"").decode("ascii", "replace"))
            elif hit:
                mapped, placed = mapped + (hit[1] == b"MAPPED_ITEM"), placed + (hit[1] != b"MAPPED_ITEM")
    if line.strip() != b"END-ISO-10303-21;":
        msg = "it breaks off before its end; write it again"
        raise Unreadable(msg)
    domains = [name for name in names if name.startswith("domain_")]
    return mapped or placed - len(domains), domains
