"""A small cell for the tests here, for a second process and for FreeCAD's Python."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from lce_solver.types import Floats
from lce_workbench.core import marks
from lce_workbench.core.cell import Cell, assemble, select
from lce_workbench.core.channels import Channels, hatch
from lce_workbench.core.domains import PLATES, Domains, Plate
from lce_workbench.core.frame import Frame, arrange
from lce_workbench.core.job import Job, Output, Plates, Sheet
from lce_workbench.core.marks import MARKS, Wanted
from lce_workbench.core.prism import Prism, bodies
from lce_workbench.core.shapes import moved

CHECKS = {"cad_kernel", "cad_interference", "cad_gap", "cad_marks", "cad_mates", "cad_step"}
"""Of `cad.checks`, for a cell without channel files."""

PITCH = 0.03
"""Side of the square that two domains share [mm]."""


def domains(n: int = 5, seed: int = 3) -> Domains:
    """A square sheet of 2 n^2 triangles, directors at random, twist of some degrees."""
    line = (np.arange(n + 1) - n / 2) * PITCH
    x, y = np.meshgrid(line, line)
    index = np.arange((n + 1) ** 2).reshape(n + 1, n + 1)
    a, b, c, d = (index[i : n + i, j : n + j].ravel() for i, j in ((0, 0), (0, 1), (1, 1), (1, 0)))
    triangles = np.concatenate([np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)])
    rng = np.random.default_rng(seed)
    theta, dtheta = rng.uniform(0, np.pi, len(triangles)), rng.normal(0, 0.05, len(triangles))
    return Domains(np.stack([x.ravel(), y.ravel()], axis=1), triangles, theta, dtheta, np.ones((len(triangles), 2)))


def hatched(sheet: Domains, job: Job) -> dict[Plate, Channels]:
    return {plate: hatch(sheet, plate, job.channels) for plate in PLATES}


def cross(x: float, y: float) -> Floats:
    """(3, 4, 2) a cross of three touching rectangles [mm]."""
    boxes = np.array([(-0.1, -0.02, 0.1, 0.02), (-0.02, 0.02, 0.02, 0.1), (-0.02, -0.1, 0.02, -0.02)])
    return boxes[:, [[0, 1], [2, 1], [2, 3], [0, 3]]] + np.array([x, y])


def job(chosen: tuple[int, ...] = (), gap_um: float = 100.0) -> Job:
    return replace(Job(), sheet=Sheet(width_mm=0.15, gap_um=gap_um), output=Output(step_domains=chosen))


WORKSHOP = Plates(chamfer_mm=0.3, release_deg=10.0, notch_mm=2.0, engraving_um=100.0, frame_mm=4.0)
"""Every option at once."""


def cell(chosen: tuple[int, ...] = (24, 25), gap_um: float = 100.0, plates: Plates | None = None) -> Cell:
    """The sheet of `domains` with a cross at each corner of both plates, and one more on the top plate."""
    sheet, wanted = domains(), replace(job(chosen, gap_um), plates=plates or Plates())
    frame = arrange(sheet.vertices, wanted)
    bottom = np.concatenate([cross(*centre) for centre in frame.marks[:4]])
    top = np.concatenate([bottom, cross(frame.marks[0, 0], 0.0)])
    return assemble(frame, wanted, sheet, {"bottom": bottom, "top": top}, hatched(sheet, wanted))


def stacks() -> list[list[Prism]]:
    """Every body of `cell`, each channel alone, and the bodies of the cell that has every option."""
    plain, worked = cell(), cell(plates=WORKSHOP)
    return [*bodies(plain.parts).values(), *([p] for p in plain.channels), *bodies(worked.parts).values()]


def gauged(plates: Plates | None = None) -> tuple[Cell, dict[Plate, list[Channels]], Frame, Job]:
    """A cell that `check` passes, with the gauge of every cluster: cell, channel solids, frame and job."""
    sheet, wanted = domains(), replace(job((24, 25)), plates=plates or Plates())
    frame, channels, at = arrange(sheet.vertices, wanted), hatched(sheet, wanted), MARKS["gauge"].at
    drawn = {
        plate: np.concatenate([moved(draw(Wanted(wanted.marks)), *at) + corner for corner in frame.marks])
        for plate, draw in (("bottom", marks.windows), ("top", marks.cross))
    }
    built = assemble(frame, wanted, sheet, drawn, channels)
    return built, {plate: [select(part, built.chosen)] for plate, part in channels.items()}, frame, wanted


def solids(chosen: tuple[int, ...] = (24, 25)) -> dict[Plate, list[Channels]]:
    """What `write_cad` takes for the channels of `cell`."""
    return {plate: [select(channels, chosen)] for plate, channels in hatched(domains(), job()).items()}
