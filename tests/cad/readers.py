"""Independent reading of a STEP file: OpenCASCADE's XCAF reader, without cadquery."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from OCP.BRepCheck import BRepCheck_Analyzer
from OCP.BRepGProp import BRepGProp
from OCP.GProp import GProp_GProps
from OCP.IFSelect import IFSelect_RetDone
from OCP.Quantity import Quantity_ColorRGBA, Quantity_TOC_sRGB
from OCP.STEPCAFControl import STEPCAFControl_Reader
from OCP.TCollection import TCollection_ExtendedString
from OCP.TDataStd import TDataStd_Name
from OCP.TDF import TDF_AttributeIterator, TDF_Label, TDF_LabelSequence
from OCP.TDocStd import TDocStd_Document
from OCP.TopAbs import TopAbs_SOLID
from OCP.TopExp import TopExp_Explorer
from OCP.TopoDS import TopoDS_Shape
from OCP.XCAFDoc import XCAFDoc_ColorSurf, XCAFDoc_DocumentTool, XCAFDoc_ShapeTool


@dataclass
class Product:
    path: tuple[str, ...]
    """Names from the root down to the product."""
    solids: list[TopoDS_Shape]
    colour: tuple[float, ...]
    """sRGB and opacity of the first solid."""


def products(path: Path) -> list[Product]:
    """The leaves of the assembly."""
    document = TDocStd_Document(TCollection_ExtendedString("test"))
    reader = STEPCAFControl_Reader()
    reader.SetColorMode(True)
    reader.SetNameMode(True)
    assert reader.ReadFile(str(path)) == IFSelect_RetDone
    assert reader.Transfer(document)
    tool = XCAFDoc_DocumentTool.ShapeTool_s(document.Main())
    colours = XCAFDoc_DocumentTool.ColorTool_s(document.Main())
    roots = TDF_LabelSequence()
    tool.GetFreeShapes(roots)
    found = []
    for label, names in (leaf for root in roots for leaf in _leaves(root, ())):
        solids = list(_solids(XCAFDoc_ShapeTool.GetShape_s(label)))
        colour = Quantity_ColorRGBA()
        assert colours.GetColor(solids[0], XCAFDoc_ColorSurf, colour)
        found.append(Product(names, solids, (*colour.GetRGB().Values(Quantity_TOC_sRGB), colour.Alpha())))
    return found


def _leaves(label: TDF_Label, above: tuple[str, ...]) -> Iterator[tuple[TDF_Label, tuple[str, ...]]]:
    if XCAFDoc_ShapeTool.IsReference_s(label):
        target = TDF_Label()
        XCAFDoc_ShapeTool.GetReferredShape_s(label, target)
        label = target
    names = (*above, *_name(label))
    parts = TDF_LabelSequence()
    XCAFDoc_ShapeTool.GetComponents_s(label, parts)
    if not XCAFDoc_ShapeTool.IsAssembly_s(label):
        yield label, names
    for part in parts:
        yield from _leaves(part, names)


def _name(label: TDF_Label) -> tuple[str, ...]:
    """The label's name, if it has one: the solids that a mapped item places have none."""
    iterator = TDF_AttributeIterator(label)
    while iterator.More():
        if isinstance(iterator.Value(), TDataStd_Name):
            return (iterator.Value().Get().ToExtString(),)
        iterator.Next()
    return ()


def _solids(shape: TopoDS_Shape) -> Iterator[TopoDS_Shape]:
    explorer = TopExp_Explorer(shape, TopAbs_SOLID)
    while explorer.More():
        yield explorer.Current()
        explorer.Next()


def volume(shape: TopoDS_Shape) -> float:
    return _properties(shape).Mass()


def centroid(shape: TopoDS_Shape) -> np.ndarray:
    point = _properties(shape).CentreOfMass()
    return np.array([point.X(), point.Y(), point.Z()])


def _properties(shape: TopoDS_Shape) -> GProp_GProps:
    properties = GProp_GProps()
    BRepGProp.VolumeProperties_s(shape, properties)
    return properties


def valid(shape: TopoDS_Shape) -> bool:
    return BRepCheck_Analyzer(shape).IsValid()
