"""Pictures of the examples for the workbench's menu: target and flat sheet with its director.

.venv/bin/python resources/pictures/examples.py
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
from PIL import Image, ImageDraw

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT), str(ROOT / "solver")]

from lce_solver.surfaces import SURFACES  # noqa: E402

HERE = Path(__file__).resolve().parent / "examples"
EXAMPLES = {"face": (-25.0, 0.0), "dome": (-60.0, 25.0), "saddle": (-60.0, 25.0), "leaf": (-45.0, -60.0)}
"""Name -> turns about the x axis after the z axis [degrees]."""
SIZE, OVER = 128, 4
LIGHT = np.array([0.4, -0.5, 0.77])


def view(degrees: tuple[float, float]) -> np.ndarray:
    """(3, 3) rotation of the eye."""
    (cx, cz), (sx, sz) = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    return np.array([[1, 0, 0], [0, cx, -sx], [0, sx, cx]]) @ np.array([[cz, -sz, 0], [sz, cz, 0], [0, 0, 1]])


def draw(name: str) -> None:
    """Write one picture with a transparent background."""
    surface = SURFACES[name](0.06)
    points = (surface.vertices - surface.vertices.mean(axis=0)) @ view(EXAMPLES[name]).T
    points *= 0.88 * SIZE * OVER / np.ptp(points[:, :2], axis=0).max()
    corner = points[surface.faces]
    normal = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    shade = 0.35 + 0.65 * np.abs(normal @ (LIGHT / np.linalg.norm(LIGHT)))
    middle = (points[:, :2].min(axis=0) + points[:, :2].max(axis=0)) / 2
    flat = (corner[..., :2] - middle) * [1, -1] + SIZE * OVER / 2
    image = Image.new("RGBA", (SIZE * OVER, SIZE * OVER))
    pen = ImageDraw.Draw(image)
    for k in np.argsort(corner[..., 2].mean(axis=1)):
        colour = (*(np.array([74, 160, 230]) * shade[k]).astype(int).tolist(), 255)
        pen.polygon([tuple(p) for p in flat[k]], fill=colour, outline=(255, 255, 255, 90))
    image.resize((SIZE, SIZE), Image.Resampling.LANCZOS).save(HERE / f"{name}.png", optimize=True)


if __name__ == "__main__":
    HERE.mkdir(exist_ok=True)
    for one in EXAMPLES:
        draw(one)
