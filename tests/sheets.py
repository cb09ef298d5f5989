"""Sheets to test masks with: jittered triangulations of a rectangle with smooth angles."""

from __future__ import annotations

import numpy as np

from lce_solver.types import Design, Flattening, Material, Status, Surface
from lce_workbench.core.channels import ChannelField, hatch
from lce_workbench.core.domains import Domains, partition
from lce_workbench.core.frame import arrange
from lce_workbench.core.job import ChannelSpec, Job, Marks
from lce_workbench.core.mask import compose


def lattice(columns, rows, width, height, jitter=0.12, seed=1):
    """Points (n, 2) of a rectangle about the origin, staggered and jittered inside, and its triangles (m, 3)."""
    i, j = np.meshgrid(np.arange(columns + 1), np.arange(rows + 1))
    inside = (i > 0) & (i < columns) & (j > 0) & (j < rows)
    noise = np.random.default_rng(seed).uniform(-jitter, jitter, (2, *i.shape))
    x = i + inside * (np.where(j % 2, 0.25, -0.25) + noise[0])
    y = j + inside * noise[1]
    points = np.stack([(x / columns - 0.5) * width, (y / rows - 0.5) * height], axis=2).reshape(-1, 2)
    a = (np.arange(rows)[:, None] * (columns + 1) + np.arange(columns)).ravel()
    b, c, d = a + 1, a + columns + 2, a + columns + 1
    odd = (np.repeat(np.arange(rows), columns) % 2)[:, None].astype(bool)
    one = np.where(odd, np.stack([a, b, c], axis=1), np.stack([a, b, d], axis=1))
    two = np.where(odd, np.stack([a, c, d], axis=1), np.stack([b, c, d], axis=1))
    return points, np.concatenate([one, two])


def design(columns=6, rows=8, width=2.0, height=2.2, twist=0.05, **how):
    """A flat design with a director that turns smoothly and a twist of up to ``twist``."""
    uv, faces = lattice(columns, rows, width, height, **how)
    x, y = uv[faces].mean(axis=1).T
    theta = 0.7 + 1.6 * x / width + 0.9 * np.sin(2.5 * y / height)
    dtheta = twist * np.cos(3 * x / width + 2 * y / height)
    material = Material(0.6, 0.5)
    n = len(faces)
    return Design(
        surface=Surface(np.column_stack([uv, np.zeros(len(uv))]), faces),
        uv=uv,
        theta=np.mod(theta, np.pi),
        dtheta=dtheta,
        stretch=np.tile([material.along, material.across], (n, 1)),
        material=material,
        thickness=0.1,
        flattening=Flattening(uv, np.mod(theta, np.pi), Status.CONVERGED, [0.0], 1, [], np.empty((0, 2))),
        bending_left=1.0,
    )


def b20():
    """The bench sheet: 20 x 20 mm, 7590 domains of side 350 um, 1.24 million channels a plate."""
    return partition(design(columns=55, rows=69, width=20.0, height=20.0))


def wafer():
    """A wafer's sheet: 100 x 100 mm, 190 000 domains, 31 million channels a plate."""
    return partition(design(columns=275, rows=345, width=100.0, height=100.0))


def single(triangle, theta, dtheta=0.0):
    """One domain."""
    return Domains(np.asarray(triangle, float), [[0, 1, 2]], [theta], [dtheta], [[0.6, 1.29]])


PLAIN = Job(marks=Marks(grating=False, fields=("depth",)))
"""A job with few polygons outside the sheet, on every layer."""


SEAM = np.array([[[0.0, 0.0], [0.3, 0.4]]])
"""A line on the layer that only cut sheets have."""


def both_masks(domains, job=None, room=0.0):
    """Frame, channels and masks of both plates; the frame is laid out for a sheet of ``room`` mm at least."""
    job = job or Job()
    frame = arrange(np.concatenate([domains.vertices, np.array([[-room, -room], [room, room]]) / 2]), job)
    channels = {plate: hatch(domains, plate, job.channels) for plate in ("bottom", "top")}
    masks = {plate: compose(frame, ChannelField(domains, plate, job.channels), job, SEAM) for plate in channels}
    return frame, channels, masks


SPEC = ChannelSpec()
