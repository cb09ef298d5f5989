"""Reading written STEP files back: what arrives must be what was sent, no solid merged and none dropped."""

from __future__ import annotations

import gzip
from collections import Counter
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from OCP.TopoDS import TopoDS_Shape

CHUNK = 1 << 24

OPENERS: dict[str, Any] = {".gz": gzip.open}

KEYWORDS = {
    "solids": b"=MANIFOLD_SOLID_BREP(",
    "faces": b"=OPEN_SHELL(",
    "mapped": b"=MAPPED_ITEM(",
    "placed": b"=NEXT_ASSEMBLY_USAGE_OCCURRENCE(",
    "products": b"=PRODUCT(",
}
"""What is counted -> how its statements begin."""


def tally(path: Path) -> Counter[str]:
    """Count the statements of `KEYWORDS` in a STEP file, as a stream: no kernel, little memory.

    Raises
    ------
    OSError
        The file cannot be read.
    """
    found: Counter[str] = Counter()
    rest = b""
    with OPENERS.get(path.suffix, open)(path, "rb") as file:
        while chunk := file.read(CHUNK):
            whole, _, rest = (rest + chunk).rpartition(b"\n")
            found.update({name: whole.count(word) for name, word in KEYWORDS.items()})
    return found


def channels_in(path: Path, way: str) -> int:
    """Number of channels in a file that `instances.write_channels` wrote, by counting statements."""
    found = tally(path)
    domains = found["products"] - 1 - (found["solids"] if way == "assembly" else 0)
    return found["mapped"] if way == "mapped" else found["placed"] - domains


def solids_in(path: Path) -> list[TopoDS_Shape]:
    """The solids that OpenCASCADE finds in a STEP file, each where it belongs.

    Raises
    ------
    OSError
        The file cannot be read.
    """
    from OCP.IFSelect import IFSelect_RetDone
    from OCP.STEPControl import STEPControl_Reader
    from OCP.TopAbs import TopAbs_SOLID
    from OCP.TopExp import TopExp_Explorer

    reader = STEPControl_Reader()
    if reader.ReadFile(str(path)) != IFSelect_RetDone:
        raise OSError(0, "OpenCASCADE cannot read it", str(path))
    reader.TransferRoots()
    explorer = TopExp_Explorer(reader.OneShape(), TopAbs_SOLID)
    found = []
    while explorer.More():
        found.append(explorer.Current())
        explorer.Next()
    return found


def volume_of(shape: TopoDS_Shape) -> float:
    """[mm3], by the kernel."""
    from OCP.BRepGProp import BRepGProp
    from OCP.GProp import GProp_GProps

    properties = GProp_GProps()
    BRepGProp.VolumeProperties_s(shape, properties)
    return float(properties.Mass())
