"""A small built folder, and copies of it to tamper with."""

from __future__ import annotations

import json
import shutil
import sys

import pytest
from shared import built_once
from tampering import refresh

from lce_workbench import pipeline
from lce_workbench.core import jobfile

JOB = """
[target]
surface = "dome"
[sheet]
width_mm = 2.0
[domains]
size_um = 300.0
[marks]
grating = false
fields = []
[solver]
starts = 1
[prediction]
steps = 4
[output]
masks = ["gds", "oas", "dxf", "r12.dxf", "cif"]
pictures = false
freecad = false
drawings = false
"""


@pytest.fixture(scope="session")
def built(tmp_path_factory):
    """What the stages that are verified leave, but the FreeCAD document; all mask formats."""

    def build(folder):
        assert pipeline.build(jobfile.parse(JOB), folder.parent, folder, ["design", "predict", "mask", "cad"]) in {0, 1}

    return built_once(tmp_path_factory, "verify", build)


@pytest.fixture
def alone(monkeypatch):
    """As inside FreeCAD: readers work in this process, which has imported them once and where its faults are."""
    monkeypatch.setitem(sys.modules, "FreeCAD", None)


@pytest.fixture
def copy(built, tmp_path):
    """A copy of everything."""
    return shutil.copytree(built, tmp_path / "copy")


@pytest.fixture
def solid(built, tmp_path):
    """A copy with the CAD files and the masks as GDSII alone."""
    folder = shutil.copytree(
        built, tmp_path / "solid", ignore=shutil.ignore_patterns("*.oas", "*.r12.dxf", "bottom.dxf", "top.dxf", "*.cif")
    )
    _masks_alone(folder)
    return folder


def _masks_alone(folder):
    """Let the job ask for GDSII alone."""
    job = folder / "job.toml"
    job.write_text(job.read_text().replace('["gds", "oas", "dxf", "r12.dxf", "cif"]', '["gds"]'))


@pytest.fixture
def masked(built, tmp_path):
    """A copy without CAD files, with the masks as GDSII alone: quick to verify."""
    folder = shutil.copytree(
        built, tmp_path / "masked", ignore=shutil.ignore_patterns("cad", "*.oas", "*.dxf", "*.cif")
    )
    _masks_alone(folder)
    manifest = json.loads((folder / "manifest.json").read_text())
    manifest["stages"].remove("cad")
    (folder / "manifest.json").write_text(json.dumps(manifest))
    refresh(folder)
    return folder
