"""The prediction of a sheet that lies on the hot plate."""

import json

import numpy as np
import small

from lce_workbench.cli import main


def test_a_sheet_on_the_plate_lies_on_it_and_a_soft_one_is_flatter(tmp_path):
    lowest, height = [], []
    for plate, modulus in (("false", 1), ("true", 1), ("true", 0.003)):
        settings = [f"prediction.plate={plate}", f"prediction.modulus_MPa={modulus}"]
        out = small.designed(tmp_path, size=300, steps=5, settings=settings)
        assert main(["predict", str(out), "--quiet"]) == 0
        z = np.load(out / "prediction.npz")["vertices"][:, 2]
        lowest.append(z.min())
        height.append(np.ptp(z))
        loading = json.loads((out / "prediction.json").read_text())["heating"][-1]["loading"]
        assert (loading > 0) == (plate == "true")
    free, stiff, soft = height
    assert abs(lowest[1]) < 0.02 * stiff  # where z = 0 is, lies the plate
    assert abs(stiff / free - 1) < 0.1
    assert soft < 0.9 * stiff
