"""Channel solids of B20: 20 x 20 mm, 7590 domains of 350 um, 1.25 million channels a plate.

python -m pytest tests/benchmarks/test_bench_cad.py -o addopts=--import-mode=importlib --benchmark-only
"""

import json
import math
import os
import subprocess
import sys
import time
from collections import Counter
from pathlib import Path

import numpy as np
import pytest
from cad.readers import valid, volume
from cad.sweep import swept
from OCP.TopLoc import TopLoc_Location
from sheets import SPEC, b20, design

from lce_workbench.cad.brep import write_solids
from lce_workbench.cad.instances import estimate, write_channels
from lce_workbench.cad.part21 import part21
from lce_workbench.cad.reread import channels_in, solids_in, tally
from lce_workbench.cad.sheet import write_domains
from lce_workbench.cad.solids import solid
from lce_workbench.cad.step import write_step
from lce_workbench.core.cell import select
from lce_workbench.core.channels import STEPS_PER_MM, corners, hatch
from lce_workbench.core.closed import closed
from lce_workbench.core.domains import partition
from lce_workbench.core.job import Job
from lce_workbench.core.polyhedron import polyhedron
from lce_workbench.core.prism import Prism

GAP = 0.1

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def channels():
    return hatch(b20(), "bottom", SPEC)


def write(channels, path):
    with part21(path) as out:
        write_channels(out, [channels], GAP, "mapped")


@pytest.fixture(scope="module")
def whole(channels, tmp_path_factory):
    """All channels of a plate, and the processor seconds that one took to write."""
    path = tmp_path_factory.mktemp("b20") / "channels_bottom.step"
    start = time.process_time()
    write(channels, path)
    return path, (time.process_time() - start) / len(channels)


@pytest.mark.parametrize("prisms", [1000, 10_000])
def test_all_channels(benchmark, channels, whole, tmp_path, prisms):
    """Size, count and time against the ordinary way, OpenCASCADE's writer on some prisms, in the same run."""
    path, ours = whole
    theirs = benchmark.pedantic(ordinary, (channels, tmp_path / "ordinary.step", prisms), rounds=1)
    size = path.stat().st_size / 1e6
    told = {"seconds": round(ours * len(channels), 1), "times_faster": round(theirs / ours)}
    benchmark.extra_info.update(channels=len(channels), megabytes=round(size), **told)
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


def test_read_back(benchmark, channels, whole):
    """All of them by OpenCASCADE, three minutes: every solid, every box valid, the design's volume."""
    found = benchmark.pedantic(solids_in, (whole[0],), rounds=1)
    boxes, count = {}, Counter()
    for shape in found:
        box = shape.Located(TopLoc_Location())
        boxes.setdefault(hash(box), box)
        count[hash(box)] += 1
    total = math.fsum(n * volume(boxes[key]) for key, n in count.items())
    benchmark.extra_info.update(solids=len(found), boxes=len(boxes))
    assert len(found) == len(channels)
    assert len(boxes) == len(np.unique(np.rint(channels.length * STEPS_PER_MM)))
    assert total == pytest.approx(channels.areas.sum() * channels.depth, rel=1e-9)
    assert all(map(valid, boxes.values()))


def test_read_back_by_freecad(benchmark, channels, whole, tmp_path):
    """The same by the FreeCAD of this machine, three minutes and 3 GB."""
    np.save(tmp_path / "steps.npy", np.rint(channels.length * STEPS_PER_MM).astype(np.int64))
    paths = [str(path) for path in (whole[0], tmp_path / "steps.npy", tmp_path / "answer.json")]
    code = f"import sys; sys.path.append({str(ROOT / 'tests')!r}); from cad.whole import main; main(*{paths})"
    call = ["freecadcmd", "-c", code]
    benchmark.pedantic(subprocess.run, (call,), {"check": True, "capture_output": True}, rounds=1)
    found = json.loads((tmp_path / "answer.json").read_text())
    benchmark.extra_info.update(found)
    assert found["solids"] == len(channels)
    assert found["valid"] == found["boxes"] == len(np.unique(np.rint(channels.length * STEPS_PER_MM)))
    assert found["volume"] == pytest.approx(channels.areas.sum() * channels.depth, rel=1e-9)


def test_the_cell_with_all_outlines(benchmark, tmp_path):
    """Level 0: plates with their marks, spacer, film, and the outlines of 7590 domains, each under its name."""
    plan = design(columns=55, rows=69, width=20.0, height=20.0)
    start = time.process_time()
    made = closed(plan, partition(plan), Job())
    benchmark.pedantic(write_step, (made.parts, tmp_path / "cell.step"), rounds=1)
    write_domains(made.domains, tmp_path / "domains.step")
    seconds = time.process_time() - start
    size = sum(path.stat().st_size for path in tmp_path.iterdir()) / 1e6
    benchmark.extra_info.update(seconds=round(seconds, 2), megabytes=round(size, 1))
    assert tally(tmp_path / "domains.step")["faces"] == len(made.domains) == 7590
    assert seconds < 10


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
    paths = {**os.environ, "PYTHONPATH": f"{ROOT}:{ROOT / 'solver'}:{ROOT / 'tests'}"}
    call = [sys.executable, "-c", program]
    run = benchmark.pedantic(subprocess.run, (call,), {"check": True, "capture_output": True, "env": paths}, rounds=1)
    benchmark.extra_info["megabytes"] = round(int(run.stdout) / 1024)
    assert int(run.stdout) < 300 * 1024
