"""A small output folder, and what is in one."""

from __future__ import annotations

import hashlib

from lce_workbench.cli import main

JOB = """
[target]
surface = "saddle"
[sheet]
width_mm = 3.0
gap_um = 20
[domains]
size_um = {size}.0
[prediction]
correct = "off"
steps = {steps}
"""


def designed(folder, *, size=400, steps=4, settings=()):
    """The output folder of a designed saddle of 3 mm; its job stands in ``folder``."""
    job, out = folder / "job.toml", folder / "out" / "saddle"
    job.write_text(JOB.format(size=size, steps=steps))
    more = ["--set", *settings] if settings else []
    assert main(["design", str(job), "--quiet", "--out", str(out), *more]) == 0
    return out


def digests(folder, besides=()):
    """Name and SHA-256 of every file of a folder."""
    files = (p for p in folder.rglob("*") if p.is_file() and p.name not in besides)
    return {p.relative_to(folder).as_posix(): hashlib.sha256(p.read_bytes()).hexdigest() for p in files}
