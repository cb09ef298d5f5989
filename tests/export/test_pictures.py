import numpy as np
from PIL import Image
from sheets import both_masks, design

from lce_workbench.core.align import PLACES
from lce_workbench.core.domains import partition
from lce_workbench.core.job import Job, Marks
from lce_workbench.export.pictures import write_pictures


def test_every_picture_is_drawn_and_the_overlay_shows_the_mismatch(tmp_path):
    domains = partition(design(3, 4, width=1.0, height=1.1))
    job = Job(marks=Marks(grating=False))
    frame, _, masks = both_masks(domains, job)
    pictures = {}
    for name, mismatch in (("a", (0.005, -0.003)), ("b", (0.0, 0.0))):
        (tmp_path / name).mkdir()
        write_pictures(frame, domains, masks, tmp_path / name, mismatch)
        pictures[name] = {p.name: np.asarray(Image.open(p).convert("RGB")) for p in (tmp_path / name).iterdir()}
    names = {"overview.png", "border.png", "domain.png", "overlay.png"}
    assert set(pictures["a"]) == names | {f"cluster_{place.replace(' ', '_')}.png" for place in PLACES}
    differ = {n for n in pictures["a"] if not np.array_equal(pictures["a"][n], pictures["b"][n])}
    assert differ == {"overlay.png"}
    for name, picture in pictures["a"].items():
        ink = np.ptp(picture.astype(int), axis=2) > 40  # coloured, not grey
        assert 0.01 < ink.mean() < 0.8, name
