"""Folders of other kinds: domains that are no triangles, cuts, workshop options, every level of detail."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh
from tampering import errors, grouped, redraw

from lce_workbench import pipeline
from lce_workbench.core import jobfile
from lce_workbench.verify import verify

JOB = """
{more}
[marks]
grating = false
fields = []
[solver]
starts = 1
[prediction]
correct = "off"
[output]
masks = ["gds"]
pictures = false
freecad = false
drawings = false
{output}
"""


def made(folder, stages, more, output=""):
    """A folder, verified: its findings by check without those that are well."""
    out = folder / "out"
    pipeline.build(jobfile.parse(JOB.format(more=more, output=output)), folder, out, stages)
    assert grouped(verify(out)) == {}
    return out


def dome(size=300):
    return f'[target]\nsurface = "dome"\n[sheet]\nwidth_mm = 1.5\n[domains]\nsize_um = {size}.0\n'


@pytest.mark.parametrize("kind", ["hexagons", "voronoi"])
def test_domains_of_another_kind_whose_channels_meet(tmp_path, kind):
    out = made(tmp_path, ["design", "mask"], f'{dome()}kind = "{kind}"\n[channels]\nalign_phase = true\n')
    with np.load(out / "design.npz") as data:
        arrays = {name: data[name] for name in data.files}
    phase, theta = arrays["domain_phase"].copy(), arrays["domain_theta"].copy()
    phase[3, 1] += 4e-4
    np.savez(out / "design.npz", **{**arrays, "domain_phase": phase})
    found = errors(out)
    assert list(found) == ["verify_phase"]
    assert "top.gds, domain 3 at" in found["verify_phase"][0].where
    assert found["verify_phase"][0].value == pytest.approx(400, abs=2)
    theta[5] += np.radians(0.5)
    np.savez(out / "design.npz", **{**arrays, "domain_theta": theta})
    found = errors(out)
    assert [f.value for f in found["verify_angle"]] == pytest.approx([0.5, 0.5], abs=1e-3)
    assert all("domain 5 at" in f.where for f in (*found["verify_angle"], *found["verify_table"]))


def test_the_lines_on_a_cut(tmp_path):
    trimesh.creation.icosphere(subdivisions=2).export(tmp_path / "ball.stl")
    more = '[target]\nmesh = "ball.stl"\ncuts = true\n[sheet]\nwidth_mm = 3.0\n[domains]\nsize_um = 300.0\n'
    out = made(tmp_path, ["design", "mask"], more)
    path, aside = out / "mask" / "top.gds", np.array([0.0, 0.005])
    redraw(path, lambda shapes: [(layer, points + aside * (layer == 13)) for layer, points in shapes])
    found = errors(out)
    assert found["verify_seams"][0].value == pytest.approx(5, abs=1)
    redraw(path, lambda shapes: [(layer, points) for layer, points in shapes if layer != 13])
    assert "SEAM" in errors(out)["verify_layers"][0].message
