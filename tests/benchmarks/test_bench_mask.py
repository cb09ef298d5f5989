"""Masks of B20: 20 x 20 mm, 7590 domains of 350 um, 1.25 million channels a plate.

python -m pytest tests/benchmarks/test_bench_mask.py -o addopts=--import-mode=importlib --benchmark-only
"""

import os
import subprocess
import sys
import time
from pathlib import Path

import gdstk
import numpy as np
import pytest
from sheets import b20

from lce_workbench.core.channels import hatch
from lce_workbench.core.domains import Domains
from lce_workbench.core.frame import arrange
from lce_workbench.core.job import Job
from lce_workbench.core.mask import compose
from lce_workbench.core.mask_checks import check
from lce_workbench.export import EXPORTERS, gdsii

JOB = Job()
SAMPLE = 40


@pytest.fixture(scope="module")
def sheet():
    domains = b20()
    return domains, arrange(domains.vertices, JOB)


def rate(benchmark, channels):
    benchmark.extra_info["channels"] = channels
    benchmark.extra_info["channels_per_second"] = round(channels / benchmark.stats.stats.min)


def drawn(domains, frame, path, plate="top"):
    channels = hatch(domains, plate, JOB.channels)
    gdsii.write(compose(frame, domains, channels, JOB), path)
    return channels


def test_hatch(benchmark, sheet):
    channels = benchmark.pedantic(hatch, (sheet[0], "top", JOB.channels), rounds=5)
    rate(benchmark, len(channels))
    assert len(channels) > 1_240_000


def test_hatch_and_gdsii(benchmark, sheet, tmp_path):
    channels = benchmark.pedantic(drawn, (*sheet, tmp_path / "top.gds"), rounds=5)
    rate(benchmark, len(channels))


def test_dxf(benchmark, sheet, tmp_path):
    domains, frame = sheet
    channels = hatch(domains, "top", JOB.channels)
    mask = compose(frame, domains, channels, JOB)
    benchmark.pedantic(EXPORTERS["dxf"], (mask, tmp_path / "top.dxf"), rounds=1)
    rate(benchmark, len(channels))


def test_checks(benchmark, sheet):
    domains, frame = sheet
    channels = hatch(domains, "top", JOB.channels)
    mask = compose(frame, domains, channels, JOB)
    benchmark.pedantic(check, (mask, domains, channels, frame, JOB), rounds=3)
    rate(benchmark, len(channels))


def clipped(domains):
    """The common way, in um on a 1 nm grid: strips clipped to each inset domain by gdstk's boolean."""
    pitch, width, guard = JOB.channels.pitch * 1e3, JOB.channels.width * 1e3, JOB.channels.guard * 1e3
    count = 0
    for corner, angle in zip(domains.corners * 1e3, domains.angle("top"), strict=True):
        middle = corner.mean(axis=0)
        x, y = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]]) @ (corner - middle).T
        strips = [
            gdstk.rectangle((x.min(), low), (x.max(), low + width)).rotate(angle).translate(*middle)
            for low in np.arange(y.min(), y.max(), pitch)
        ]
        count += len(gdstk.boolean(strips, gdstk.offset(gdstk.Polygon(corner), -guard), "and", precision=1e-3))
    return count


def test_against_gdstk(benchmark, sheet, tmp_path):
    """Hatch and GDSII of everything, against the clipping alone of a sample, per channel and in the same run."""
    domains, frame = sheet
    picked = np.random.default_rng(5).choice(len(domains), SAMPLE, replace=False)
    sample = Domains(
        domains.vertices,
        domains.triangles[picked],
        domains.theta[picked],
        domains.dtheta[picked],
        domains.stretch[picked],
    )
    start = time.process_time()
    theirs = clipped(sample)
    theirs_each = (time.process_time() - start) / theirs
    assert 0.99 < theirs / len(hatch(sample, "top", JOB.channels)) < 1.03
    channels = benchmark.pedantic(drawn, (domains, frame, tmp_path / "top.gds"), rounds=1)
    start = time.process_time()
    drawn(domains, frame, tmp_path / "top.gds")
    ours_each = (time.process_time() - start) / len(channels)
    rate(benchmark, len(channels))
    benchmark.extra_info["times_faster_than_gdstk"] = round(theirs_each / ours_each, 1)
    assert theirs_each > 15 * ours_each


def test_memory(benchmark, tmp_path):
    """Hatch and GDSII in a process of their own stay under 200 MB."""
    program = "\n".join(
        (
            "import re",
            "from pathlib import Path",
            "from sheets import Job, arrange, b20, compose, hatch",
            "from lce_workbench.export import gdsii",
            "job, domains = Job(), b20()",
            "channels = hatch(domains, 'top', job.channels)",
            "mask = compose(arrange(domains.vertices, job), domains, channels, job)",
            f"gdsii.write(mask, Path({str(tmp_path / 'top.gds')!r}))",
            "print(re.search(r'VmHWM:\\s*(\\d+)', Path('/proc/self/status').read_text())[1])",
        )
    )
    root = Path(__file__).parents[2]
    call = [sys.executable, "-c", program]
    paths = {**os.environ, "PYTHONPATH": f"{root}:{root / 'solver'}:{root / 'tests'}"}
    run = benchmark.pedantic(subprocess.run, (call,), {"check": True, "capture_output": True, "env": paths}, rounds=1)
    benchmark.extra_info["megabytes"] = round(int(run.stdout) / 1024)
    assert int(run.stdout) < 200 * 1024
