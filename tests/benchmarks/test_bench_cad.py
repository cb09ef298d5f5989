"""Channel solids of B20: 20 x 20 mm, 7590 domains of 350 um, 1.25 million channels a plate.

python -m pytest tests/benchmarks/test_bench_cad.py -o addopts=--import-mode=importlib --benchmark-only
"""

import os
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
from cad.readers import valid, volume
from cad.sweep import swept
from OCP.TopLoc import TopLoc_Location
from sheets import SPEC, b20

from lce_workbench.cad.brep import write_solids
from lce_workbench.cad.instances import estimate, write_channels
from lce_workbench.cad.part21 import part21
from lce_workbench.cad.reread import channels_in, solids_in
from lce_workbench.cad.solids import solid
from lce_workbench.core.cell import select
from lce_workbench.core.channels import corners, hatch
from lce_workbench.core.polyhedron import polyhedron
from lce_workbench.core.prism import Prism

GAP = 0.1


@pytest.fixture(scope="module")
def channels():
    return hatch(b20(), "bottom", SPEC)


def write(channels, path):
    with part21(path) as out:
        write_channels(out, [channels], GAP, "mapped")


def test_all_channels(benchmark, channels, tmp_path):
    """Size, count and time against the ordinary way, OpenCASCADE's writer on 1000 prisms, in the same run."""
    path = tmp_path / "channels_bottom.step"
    benchmark.pedantic(write, (channels, path), rounds=1)
    start = time.process_time()
    write(channels, path)
    ours = (time.process_time() - start) / len(channels)
    theirs = ordinary(channels, tmp_path / "ordinary.step", 1000)
    size = path.stat().st_size / 1e6
    benchmark.extra_info.update(channels=len(channels), megabytes=round(size), times_faster=round(theirs / ours))
    assert size < 250
    assert estimate("mapped", len(channels)).value == pytest.approx(size, rel=0.1)
    assert channels_in(path, "mapped") == len(channels)
    assert theirs > 500 * ours


def ordinary(channels, path, n):
    """Seconds a prism to build and write solids with OpenCASCADE."""
    from OCP.BRep import BRep_Builder
    from OCP.STEPControl import STEPControl_AsIs, STEPControl_Writer
    from OCP.TopoDS import TopoDS_Compound

    start = time.process_time()
    builder, compound = BRep_Builder(), TopoDS_Compound()
    builder.MakeCompound(compound)
    for i, ring in enumerate(corners(channels, slice(0, n))):
        builder.Add(compound, solid([Prism(f"p{i}", ring, (), 0.0, 6e-4, (0.0, 0.0, 0.0))]).wrapped)
    writer = STEPControl_Writer()
    writer.Transfer(compound, STEPControl_AsIs)
    writer.Write(str(path))
    return (time.process_time() - start) / n


def test_read_back(benchmark, channels, tmp_path):
    """A tenth of the domains, by OpenCASCADE: every solid, every box valid, the design's volume."""
    some = select(channels, range(759))
    write(some, tmp_path / "some.step")
    found = benchmark.pedantic(solids_in, (tmp_path / "some.step",), rounds=1)
    assert len(found) == len(some)
    boxes = {hash(box): box for box in (shape.Located(TopLoc_Location()) for shape in found)}
    each = {key: volume(box) for key, box in boxes.items()}
    total = sum(each[hash(shape.Located(TopLoc_Location()))] for shape in found)
    assert total == pytest.approx(some.areas.sum() * some.depth, rel=1e-9)
    assert all(map(valid, boxes.values()))


def test_comb(benchmark, channels):
    """The land of one domain with its channels, some 200, as a solid of OpenCASCADE."""
    domain = int(np.argmax(channels.counts))
    rings = corners(select(channels, [domain]))
    comb = Prism("comb", b20().corners[domain], tuple(rings), 0.0, 6e-4, (0.0, 0.0, 0.0))
    shape = benchmark.pedantic(solid, ([comb],), rounds=3)
    benchmark.extra_info["holes"] = len(rings)
    assert valid(shape.wrapped)
    assert shape.Volume() == pytest.approx(comb.volume, rel=1e-12)


@pytest.mark.parametrize("seed", range(8, 48))
def test_a_random_job(benchmark, seed, tmp_path):
    """Forty more cells of random jobs; see tests/cad/test_sweep.py for eight."""
    found = benchmark.pedantic(swept, (seed, tmp_path), rounds=1)
    assert [f.message for f in found if f.severity.value == "error"] == []


def test_holes_cost_in_proportion(benchmark, channels, tmp_path):
    """Ten times the holes take about ten times as long to write, not a hundred times."""

    def seconds(n):
        rings = tuple(corners(channels, slice(0, n)))
        prism = Prism("land", 20 * np.array([(-1.0, -1), (1, -1), (1, 1), (-1, 1)]), rings, 0.0, 6e-4, (0.0, 0.0, 0.0))
        start = time.process_time()
        with part21(tmp_path / "land.step") as out:
            write_solids(out, ["land"], [polyhedron([prism])])
        return time.process_time() - start

    seconds(100)
    few, many = seconds(1000), benchmark.pedantic(seconds, (10_000,), rounds=1)
    assert many < 20 * few


def test_memory(benchmark, tmp_path):
    """Hatch and STEP in a process of its own stay under 300 MB."""
    program = "\n".join(
        (
            "import re",
            "from pathlib import Path",
            "from sheets import SPEC, b20, hatch",
            "from lce_workbench.cad.instances import write_channels",
            "from lce_workbench.cad.part21 import part21",
            f"with part21(Path({str(tmp_path / 'channels_top.step')!r})) as out:",
            "    write_channels(out, [hatch(b20(), 'top', SPEC)], 0.1, 'mapped')",
            "print(re.search(r'VmHWM:\\s*(\\d+)', Path('/proc/self/status').read_text())[1])",
        )
    )
    root = Path(__file__).parents[2]
    paths = {**os.environ, "PYTHONPATH": f"{root}:{root / 'solver'}:{root / 'tests'}"}
    call = [sys.executable, "-c", program]
    run = benchmark.pedantic(subprocess.run, (call,), {"check": True, "capture_output": True, "env": paths}, rounds=1)
    benchmark.extra_info["megabytes"] = round(int(run.stdout) / 1024)
    assert int(run.stdout) < 300 * 1024
