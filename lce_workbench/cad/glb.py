"""The cell as binary glTF for the web, through cadquery's assembly."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from lce_workbench.cad.solids import solid
from lce_workbench.core.prism import Prism, bodies

if TYPE_CHECKING:
    import cadquery as cq


def write_glb(prisms: Sequence[Prism], path: Path) -> None:
    """Write binary glTF as its standard asks: metres, y up, a mesh per part.

    Raises
    ------
    OSError
        The file cannot be written.
    LceError
        A solid is not what its prism says.
    """
    from cadquery.occ_impl.assembly import toCAF
    from OCP.Message import Message_ProgressRange
    from OCP.RWGltf import RWGltf_CafWriter
    from OCP.RWMesh import RWMesh_CoordinateSystem
    from OCP.TCollection import TCollection_AsciiString
    from OCP.TColStd import TColStd_IndexedDataMapOfStringString

    _, document = toCAF(assembly(path.stem, prisms), coloredSTEP=True, mesh=True)
    writer = RWGltf_CafWriter(TCollection_AsciiString(str(path)), True)
    writer.SetMergeFaces(True)
    converter = writer.ChangeCoordinateSystemConverter()
    converter.SetInputLengthUnit(1e-3)
    converter.SetInputCoordinateSystem(RWMesh_CoordinateSystem.RWMesh_CoordinateSystem_Zup)
    if not writer.Perform(document, TColStd_IndexedDataMapOfStringString(), Message_ProgressRange()):
        raise OSError(str(path))


def assembly(name: str, prisms: Sequence[Prism]) -> cq.Assembly:
    """Bodies of one group become a sub-assembly."""
    import cadquery as cq

    root = cq.Assembly(name=name)
    parents = {"": root}
    for label, stack in bodies(prisms).items():
        parent = parents.setdefault(stack[0].group, cq.Assembly(name=stack[0].group))
        parent.add(solid(stack), name=label, color=cq.Color(*stack[0].colour, stack[0].opacity))
    for group in (parent for parent in parents.values() if parent is not root):
        root.add(group)  # filled, for a copy is taken, whose parts become the root's by their paths
    return root
