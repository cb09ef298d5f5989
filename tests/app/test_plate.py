"""The prediction of a sheet that lies on the hot plate."""

import json

import numpy as np

from lce_workbench.cli import main

JOB = """
[target]
surface = "saddle"
[sheet]
width_mm = 3.0
gap_um = 20
[domains]
size_um = 300.0
[prediction]
correct = "off"
steps = 5
"""


def test_a_sheet_on_the_plate_lies_on_it_and_a_soft_one_is_flatter(tmp_path):
    (tmp_path / "job.toml").write_text(JOB)
    lowest, height = [], []
    for plate, modulus in (("false", 1), ("true", 1), ("true", 0.003)):
        out = tmp_path / f"{plate} {modulus}"
        settings = [f"prediction.plate={plate}", f"prediction.modulus_MPa={modulus}"]
        assert main(["design", str(tmp_path / "job.toml"), "--quiet", "--out", str(out), "--set", *settings]) == 0
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
