"""Pictures of the 3D view, for docs/workbench.md: its states, for the design of an output folder, on a virtual screen.

.venv/bin/python resources/pictures/view.py out/demo         # needs xvfb, openbox and imagemagick
"""

import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT), str(ROOT / "solver"), str(ROOT / "tests")]

import gui_tour  # noqa: E402
from freecad_call import FreeCAD  # noqa: E402
from processes import display  # noqa: E402

PICTURES = ROOT / "docs" / "workbench"
COLOURS = 256

if __name__ == "__main__":
    with (
        display() as screen,
        tempfile.TemporaryDirectory() as folder,
        subprocess.Popen(["openbox"], env={"DISPLAY": screen, "HOME": folder}) as manager,
    ):
        freecad, results = FreeCAD(Path(folder) / "home"), Path(sys.argv[1]).resolve()
        try:
            freecad.window(screen, gui_tour.viewed, folder=str(results), pictures=str(PICTURES))
        finally:
            manager.terminate()
    for picture in sorted(PICTURES.glob("view_*.png")):
        size = ["+dither", "-colors", str(COLOURS), "-define", "png:compression-level=9"]
        subprocess.run(["convert", picture, *size, picture], check=True)
