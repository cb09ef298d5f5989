"""Everything the review shows, read from the files of one output folder."""

from __future__ import annotations

import csv
import json
import zipfile
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from lce_solver.compare import align, vertex_areas
from lce_solver.errors import InputError
from lce_solver.judge import stretch_errors
from lce_solver.types import Design, Floats, Ints
from lce_workbench.core import jobfile
from lce_workbench.core.domains import Domains
from lce_workbench.core.frame import Frame, arrange
from lce_workbench.core.job import Job
from lce_workbench.core.marks import fingerprint
from lce_workbench.divided import read_domains
from lce_workbench.outputs import read_design, read_manifest

STAGE = "review"
OWN = "report."
"""The review's own files begin with it."""
PARTS_MM = 1000.0
"""glTF is in metres."""


@dataclass(frozen=True, eq=False)
class Predicted:
    """The simulated heating, laid onto the target."""

    record: Mapping[str, Any]
    """`prediction.json`."""
    frames: Floats
    """(k, n_v, 3) the flat sheet and the shape after each step, moved as lays the last best onto the target [mm]."""
    lambdas: Floats
    """(k,) stretch along the director in each frame, from 1."""
    deviation: Floats
    """(n_v,) distance of the last from the target [mm]."""


@dataclass(frozen=True, eq=False)
class Part:
    """One part of the cell as `cad/cell.glb` holds it."""

    name: str
    colour: tuple[float, float, float, float]
    """Red, green, blue, opacity in [0, 1]."""
    vertices: Floats
    """(n, 3), z up [mm]."""
    faces: Ints
    """(m, 3)"""


@dataclass(frozen=True, eq=False)
class Review:
    """One folder's review; what the folder lacks is None."""

    job: Job
    design: Design
    domains: Domains
    table: str
    """`domains.csv`, as it is."""
    findings: tuple[Mapping[str, Any], ...]
    """Of all stages and of the check of the written files."""
    versions: Mapping[str, str]
    inputs: tuple[Mapping[str, Any], ...]
    files: tuple[Mapping[str, Any], ...]
    """Path, size [bytes] and SHA-256 of every file."""
    studies: tuple[Mapping[str, Any], ...]
    """`studies/*.json`: how many of the samples arrive for each value of a fault."""
    prediction: Predicted | None
    cell: tuple[Part, ...] | None

    @cached_property
    def frame(self) -> Frame:
        """Where things lie on the plates."""
        return arrange(self.design.uv, self.job)

    @cached_property
    def columns(self) -> dict[str, Floats]:
        """The columns of `domains.csv`, each (n_d,)."""
        return _columns(self.table)

    @cached_property
    def errors(self) -> Floats:
        """(n_d, 2) relative errors of the stretches along and across the director."""
        return stretch_errors(self.domains.stretch, self.design.material)

    @property
    def code(self) -> str:
        """The design's code, as it stands on the plates."""
        return fingerprint(self.domains, self.job.channels)

    @property
    def title(self) -> str:
        """The target's name."""
        return self.job.target.surface or Path(self.job.target.mesh).name


def _columns(table: str) -> dict[str, Floats]:
    names, *rows = csv.reader(table.splitlines())
    if any(len(row) != len(names) for row in rows):
        msg = f"a row lacks some of the {len(names)} columns"
        raise ValueError(msg)
    return dict(zip(names, np.array(rows, dtype=np.float64).T, strict=True))


@contextmanager
def _read(path: Path, again: str) -> Iterator[None]:
    """Turn what happens with a damaged file into one sentence."""
    try:
        yield
    except (OSError, ValueError, LookupError, TypeError, EOFError, zipfile.BadZipFile) as fault:
        said = getattr(fault, "strerror", None) or " ".join(str(fault).split())[:120]
        msg = f"{path.name} is missing or damaged ({said}); run `./lce {again}` on the folder again"
        raise InputError(msg) from fault


def assemble(folder: Path, checked: Sequence[Mapping[str, Any]] = ()) -> Review:
    """Read a folder; ``checked`` are the records of what the check of the written files found.

    Raises
    ------
    InputError
        The folder is not ours, or a file of it cannot be read.
    """
    manifest = read_manifest(folder)
    design, domains = read_design(folder / "design.npz"), read_domains(folder / "design.npz")
    former = (record for record in manifest["findings"] if record["stage"] != STAGE)
    return Review(
        job=jobfile.load(folder / "job.toml"),
        design=design,
        domains=domains,
        table=_table(folder / "domains.csv", len(domains)),
        findings=(*former, *checked),
        versions=manifest["versions"],
        inputs=tuple(manifest["inputs"]),
        files=tuple(entry for entry in manifest["files"] if not entry["path"].startswith(OWN)),
        studies=tuple(_study(path) for path in sorted(folder.glob("studies/*.json"))),
        prediction=_prediction(folder, design),
        cell=_cell(folder / "cad" / "cell.glb"),
    )


def _table(path: Path, count: int) -> str:
    """`domains.csv`, as it is; a row of numbers for each domain."""
    with _read(path, "design"):
        text = path.read_text(encoding="ascii")
        columns = _columns(text)
        wrong = [name for name, column in columns.items() if len(column) != count or not np.all(np.isfinite(column))]
        if wrong:
            msg = f"{wrong[0]} holds no finite number for one of {count} domains"
            raise ValueError(msg)
    return text


def _study(path: Path) -> dict[str, Any]:
    with _read(path, f"study {path.stem}"):
        told: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
        _ = told["study"], told["question"], told["axis"], told["samples"], told["reached_below_rms_pct"], told["table"]
    return told


def _prediction(folder: Path, design: Design) -> Predicted | None:
    path, target = folder / "prediction.json", design.surface.vertices
    if not path.is_file():
        return None
    with _read(path, "predict"):
        record = json.loads(path.read_text(encoding="utf-8"))
        lambdas = np.array([1.0, *(step["lambda_"] for step in record["heating"])])
    with _read(folder / "prediction.npz", "predict"), np.load(folder / "prediction.npz", allow_pickle=False) as data:
        frames = data["frames"].reshape(len(lambdas) - 1, *target.shape)
    laid = align(frames[-1], target, vertex_areas(target, design.surface.faces))
    flat = np.column_stack([design.uv, np.zeros(len(design.uv))])
    frames = np.concatenate([flat[None], frames])
    return Predicted(record, frames @ laid.rotation.T + laid.shift, lambdas, laid.distance)


def _cell(path: Path) -> tuple[Part, ...] | None:
    if not path.is_file():
        return None
    import trimesh

    parts = []
    with _read(path, "cad"):
        scene = trimesh.load_scene(path)
        for node in sorted(scene.graph.nodes_geometry):
            motion, name = scene.graph[node]
            mesh = scene.geometry[name]
            x, y, z = (mesh.vertices @ motion[:3, :3].T + motion[:3, 3]).T * PARTS_MM
            colour = np.asarray(mesh.visual.material.baseColorFactor) / 255
            parts.append(Part(node, tuple(colour.tolist()), np.column_stack([x, -z, y]), np.asarray(mesh.faces)))
    return tuple(parts)
