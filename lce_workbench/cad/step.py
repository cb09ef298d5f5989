"""The cell as files: STEP AP214 and binary glTF, with names, colours and assemblies."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from lce_solver.errors import EnvironmentFault
from lce_solver.types import Progress, silent
from lce_workbench.cad.canonical import canonical
from lce_workbench.cad.solids import solid
from lce_workbench.core.cell import Cell, Prism

if TYPE_CHECKING:
    import cadquery as cq

FILES: dict[str, Callable[[Cell], Sequence[Prism]]] = {
    "cell.step": lambda cell: cell.parts,
    "cell.glb": lambda cell: cell.parts,
    "bottom_plate.step": lambda cell: cell.group("bottom_plate"),
    "top_plate.step": lambda cell: cell.group("top_plate"),
    "spacer.step": lambda cell: cell.group("spacer"),
    "channels_bottom.step": lambda cell: cell.group("channels_bottom"),
    "channels_top.step": lambda cell: cell.group("channels_top"),
}
"""File -> the prisms in it, all in the cell's coordinates."""


def write_cad(cell: Cell, folder: Path, progress: Progress = silent) -> None:
    """Write every entry of `FILES` into ``folder``, the same bytes for the same cell.

    Raises
    ------
    LceError
        A solid is not what its prism says.
    EnvironmentFault
        A file cannot be written.
    """
    solids: dict[Prism, cq.Solid] = {}
    for i, (name, pick) in enumerate(FILES.items()):
        progress(f"cad/{name}", i / len(FILES))
        path = folder / name
        prisms = pick(cell)
        solids |= {prism: solid(prism) for prism in prisms if prism not in solids}
        WRITERS[path.suffix](assembly(path.stem, prisms, solids), path)


def assembly(name: str, prisms: Sequence[Prism], solids: dict[Prism, cq.Solid]) -> cq.Assembly:
    """Prisms of one group become a sub-assembly, unless the whole file is that group; those of one name one product."""
    import cadquery as cq

    root = cq.Assembly(name=name)
    parents = {"": root, name: root}
    products: dict[str, list[Prism]] = {}
    for prism in prisms:
        products.setdefault(prism.name, []).append(prism)
    for label, members in products.items():
        first = members[0]
        if first.group not in parents:
            root.add(cq.Assembly(name=first.group))
            parents[first.group] = root.children[-1]
        shape = cq.Compound.makeCompound([solids[prism] for prism in members])
        parents[first.group].add(shape, name=label, color=cq.Color(*first.colour, first.opacity))
    return root


def write_step(tree: cq.Assembly, path: Path) -> None:
    """Write STEP AP214 in mm. Planes need no curves in parameter space; without them the file is half as large."""
    from cadquery.occ_impl.exporters.assembly import exportAssembly

    if not exportAssembly(tree, str(path), write_pcurves=False):
        raise EnvironmentFault(_unwritten(path))
    path.write_text(canonical(path.read_text("ascii"), path.stem), "ascii", newline="\n")


def write_glb(tree: cq.Assembly, path: Path) -> None:
    """Write binary glTF as its standard asks: metres, y up, a mesh per part."""
    from cadquery.occ_impl.assembly import toCAF
    from OCP.Message import Message_ProgressRange
    from OCP.RWGltf import RWGltf_CafWriter
    from OCP.RWMesh import RWMesh_CoordinateSystem
    from OCP.TCollection import TCollection_AsciiString
    from OCP.TColStd import TColStd_IndexedDataMapOfStringString

    _, document = toCAF(tree, coloredSTEP=True, mesh=True)
    writer = RWGltf_CafWriter(TCollection_AsciiString(str(path)), True)
    writer.SetMergeFaces(True)
    converter = writer.ChangeCoordinateSystemConverter()
    converter.SetInputLengthUnit(1e-3)
    converter.SetInputCoordinateSystem(RWMesh_CoordinateSystem.RWMesh_CoordinateSystem_Zup)
    if not writer.Perform(document, TColStd_IndexedDataMapOfStringString(), Message_ProgressRange()):
        raise EnvironmentFault(_unwritten(path))


WRITERS: dict[str, Callable[[cq.Assembly, Path], None]] = {".step": write_step, ".glb": write_glb}
"""Suffix -> writer."""


def _unwritten(path: Path) -> str:
    return f"{path} could not be written; see that the disk has room and the folder may be written"
