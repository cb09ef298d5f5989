"""Pictures of the workbench at work, for docs/workbench.md: a session on a virtual screen.

.venv/bin/python resources/pictures/workbench.py MESH         # needs xvfb, openbox and imagemagick
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
COLOURS = 64

if __name__ == "__main__":
    PICTURES.mkdir(parents=True, exist_ok=True)
    with (
        display() as screen,
        tempfile.TemporaryDirectory() as folder,
        subprocess.Popen(["openbox"], env={"DISPLAY": screen, "HOME": folder}) as manager,
    ):
        try:
            freecad = FreeCAD(Path(folder) / "home")
            freecad.window(screen, gui_tour.shown, mesh=str(Path(sys.argv[1]).resolve()), pictures=str(PICTURES))
        finally:
            manager.terminate()
    for picture in sorted(PICTURES.glob("[0-9]_*.png")):
        subprocess.run(
            ["convert", picture, "-colors", str(COLOURS), "-define", "png:compression-level=9", picture], check=True
        )
