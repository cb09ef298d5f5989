"""Write the golden masks anew, after a wanted change: PYTHONPATH=.:solver:tests python tests/golden/renew.py."""

import gzip
import tempfile
from pathlib import Path

from sheets import PLAIN, both_masks, design

from lce_workbench.core.domains import partition
from lce_workbench.export import gdsii

FOLDER = Path(__file__).parent


def small_masks():
    """Both plates of a sheet of four small domains; marks without grating, to keep the files small."""
    return both_masks(partition(design(1, 2, width=0.08, height=0.14)), PLAIN, room=4.0)[2]


if __name__ == "__main__":
    for plate, mask in small_masks().items():
        with tempfile.TemporaryDirectory() as folder:
            gdsii.write(mask, Path(folder) / "mask.gds")
            data = (Path(folder) / "mask.gds").read_bytes()
        (FOLDER / f"{plate}.gds.gz").write_bytes(gzip.compress(data, mtime=0))
