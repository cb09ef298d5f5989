"""Draw the README's picture from an output folder: ``demo.py out/demo [picture.png]``."""

import sys
from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib import pyplot as plt
from matplotlib.collections import LineCollection, PolyCollection

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT), str(ROOT / "solver")]

from lce_workbench.core import jobfile  # noqa: E402
from lce_workbench.core.channels import corners, hatch  # noqa: E402
from lce_workbench.core.domains import PLATES, partition  # noqa: E402
from lce_workbench.outputs import read_design  # noqa: E402

LIGHT = np.array([-0.4, 0.5, 0.75]) / np.linalg.norm([0.4, 0.5, 0.75])
WINDOW = 0.03
"""Half side of the zoom [mm]."""


def show(axes, polygons, title, **style):
    """Fill an axes with polygons, equal scales, no frame."""
    shown = axes.add_collection(PolyCollection(polygons, linewidths=0.2, **style))
    axes.autoscale()
    axes.set_aspect("equal")
    axes.set_axis_off()
    axes.set_title(title, fontsize=10)
    return shown


def target(axes, surface):
    """The target, lit from the upper left."""
    x = surface.vertices[surface.faces]
    normal = np.cross(x[:, 1] - x[:, 0], x[:, 2] - x[:, 0])
    light = np.clip((normal / np.linalg.norm(normal, axis=1)[:, None]) @ LIGHT, 0.08, 1)
    order = np.argsort(x[:, :, 2].mean(axis=1))
    colours = mpl.colormaps["copper"](light[order])
    show(axes, x[order, :, :2], "target", facecolors=colours, edgecolors=colours)


def sheet(figure, axes, plan, degrees, title, colours):
    """The flat sheet coloured by an angle, the director as streaks."""
    polygons = plan.uv[plan.surface.faces]
    shown = show(axes, polygons, title, array=degrees, cmap=colours, edgecolors="face")
    centre, n = polygons.mean(axis=1), np.column_stack([np.cos(plan.theta), np.sin(plan.theta)])
    some = slice(None, None, 5)
    ends = np.stack([centre[some] - 0.25 * n[some], centre[some] + 0.25 * n[some]], axis=1)
    axes.add_collection(LineCollection(ends, colors="black", linewidths=0.4))
    figure.colorbar(shown, ax=axes, shrink=0.6, format="%g°")
    return shown


def zoom(axes, plan, job):
    """The channels of both plates around the vertex nearest the centre."""
    domains = partition(plan)
    spot = plan.uv[np.argmin(np.linalg.norm(plan.uv, axis=1))]
    for plate, colour in zip(PLATES, ("tab:blue", "tab:orange"), strict=True):
        boxes = corners(hatch(domains, plate, job.channels))
        near = (np.abs(boxes.mean(axis=1) - spot) < 0.3).all(axis=1)
        show(axes, boxes[near], "channels: bottom blue, top orange", facecolors=colour, alpha=0.5)
    axes.set_xlim(spot[0] - WINDOW, spot[0] + WINDOW)
    axes.set_ylim(spot[1] - WINDOW, spot[1] + WINDOW)
    axes.plot(spot[0] + WINDOW * np.array([0.2, 0.8667]), [spot[1] - 0.92 * WINDOW] * 2, "k", linewidth=3)
    axes.text(spot[0] + 0.53 * WINDOW, spot[1] - 0.86 * WINDOW, "20 µm", ha="center", fontsize=9)


def main(folder, picture):
    """Draw the four panels."""
    plan, job = read_design(folder / "design.npz"), jobfile.load(folder / "job.toml")
    figure, axes = plt.subplots(1, 4, figsize=(14, 4.6), layout="constrained")
    target(axes[0], plan.surface)
    sheet(figure, axes[1], plan, np.degrees(plan.theta), "director θ on the flat sheet", "viridis")
    limit = np.degrees(np.abs(plan.dtheta)).max()
    sheet(figure, axes[2], plan, np.degrees(plan.dtheta), "twist Δθ", "RdBu").set_clim(-limit, limit)
    zoom(axes[3], plan, job)
    figure.savefig(picture, dpi=90)


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]) if len(sys.argv) > 2 else Path(__file__).with_suffix(".png"))
