"""The cell as files: STEP AP214 with names, colours, assemblies and validation properties, and binary glTF."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path

import numpy as np

from lce_solver.errors import EnvironmentFault
from lce_solver.types import Progress, silent
from lce_workbench.cad.brep import write_solids
from lce_workbench.cad.glb import write_glb
from lce_workbench.cad.instances import write_channels, write_exact
from lce_workbench.cad.meshes import printed, write_3mf, write_stl
from lce_workbench.cad.part21 import Part21, Product, part21
from lce_workbench.cad.sheet import write_domains
from lce_workbench.core.cell import Cell
from lce_workbench.core.channels import Channels
from lce_workbench.core.domains import PLATES, Plate
from lce_workbench.core.job import Job
from lce_workbench.core.polyhedron import polyhedron
from lce_workbench.core.prism import Prism, bodies, together

FILES: dict[str, Callable[[Cell], Sequence[Prism]]] = {
    "cell.step": lambda cell: cell.parts,
    "cell.glb": lambda cell: cell.parts,
    "bottom_plate.step": lambda cell: cell.group("bottom_plate"),
    "top_plate.step": lambda cell: cell.group("top_plate"),
    "spacer.step": lambda cell: cell.group("spacer"),
    "combs_bottom.step": lambda cell: cell.group("combs_bottom"),
    "combs_top.step": lambda cell: cell.group("combs_top"),
}
"""File -> the prisms in it, all in the cell's coordinates."""

EXTRAS: dict[str, dict[str, Callable[[Cell], Sequence[Prism]]]] = {
    "sheet": {"sheet.step": lambda cell: [part for part in cell.parts if part.name == "sheet"]},
    "stl": {f"{plate}_plate.stl": FILES[f"{plate}_plate.step"] for plate in PLATES},
    "3mf": {f"{plate}_plate.3mf": FILES[f"{plate}_plate.step"] for plate in PLATES},
}
"""Name in `output.cad` -> file -> the prisms in it."""


def files(job: Job) -> dict[str, Callable[[Cell], Sequence[Prism]]]:
    """`FILES` and the `EXTRAS` that the job asks for."""
    return FILES | {file: pick for name in job.output.cad for file, pick in EXTRAS.get(name, {}).items()}


CHANNEL_FILES: dict[str, Plate] = {f"channels_{plate}.step": plate for plate in PLATES}
"""File -> the plate whose channels are the solids in it."""


def write_cad(
    cell: Cell,
    channels: Mapping[Plate, Iterable[Channels]],
    job: Job,
    folder: Path,
    progress: Progress = silent,
) -> None:
    """Write every entry of `files` and `CHANNEL_FILES` into ``folder``, the same bytes for the same cell.

    Parameters
    ----------
    channels : the channels that become solids, in parts that never split a domain.

    Raises
    ------
    EnvironmentFault
        A file cannot be written.
    """
    wanted = files(job)
    n = len(wanted) + len(CHANNEL_FILES)
    for i, (name, pick) in enumerate(wanted.items()):
        progress(f"cad/{name}", i / n)
        path = folder / name
        with told(path):
            WRITERS[path.suffix](pick(cell), path)
    for i, (name, plate) in enumerate(CHANNEL_FILES.items(), len(wanted)):
        path = folder / stored_as(name, job)
        progress(f"cad/{path.name}", i / n)
        with told(path):
            if job.output.step == "exact":
                write_exact(channels[plate], cell.domains.corners, job, path)
            else:
                with part21(path) as out:
                    write_channels(out, channels[plate], job.sheet.thickness, job.output.step_instances)
    if "domains" in job.output.cad:
        path = folder / "domains.step"
        with told(path):
            write_domains(cell.domains, path)


def stored_as(name: str, job: Job) -> str:
    """Name of a file of `CHANNEL_FILES`, compressed if the job asks for it."""
    return name + ".gz" if job.output.step_gzip else name


def write_step(prisms: Sequence[Prism], path: Path) -> None:
    """Write bodies as STEP: a product each; those of a group in an assembly, unless the whole file is that group."""
    with part21(path) as out:
        root = out.product(out.name)
        parents = {"": root, out.name: root}
        for stack in bodies(prisms).values():
            group = stack[0].group
            if group not in parents:
                parents[group] = out.product(group)
                out.place([parents[group]], root)
            out.place([_product(out, stack)], parents[group])


def _product(out: Part21, stack: Sequence[Prism]) -> Product:
    """One body: prisms that stand on each other."""
    name, outside = stack[0].name, polyhedron(stack)
    body = write_solids(out, [name], [outside])
    (product,) = out.products([name], [body], "ADVANCED_BREP_SHAPE_REPRESENTATION")
    out.paint(body, stack[0].colour, stack[0].opacity)
    volume, centroid = together(stack)
    out.validate([product], *(np.array([value]) for value in (volume, outside.surface, centroid)))
    return product


WRITERS: dict[str, Callable[[Sequence[Prism], Path], None]] = {
    ".step": write_step,
    ".glb": write_glb,
    ".stl": lambda prisms, path: write_stl(*printed(prisms), path),
    ".3mf": lambda prisms, path: write_3mf(*printed(prisms), path),
}
"""Suffix -> writer."""


@contextmanager
def told(path: Path) -> Iterator[None]:
    """Turn a fault of the file system into one sentence."""
    try:
        yield
    except OSError as fault:
        msg = f"{path} could not be written; see that the disk has room and the folder may be written"
        raise EnvironmentFault(msg) from fault
