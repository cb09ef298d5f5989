import json
import os
import subprocess
from functools import cache
from pathlib import Path

import pytest
from cad.cad_sample import cell, domains, hatched, job, solids
from cad.readers import products

from lce_workbench.cad.instances import WAYS, write_channels
from lce_workbench.cad.part21 import part21
from lce_workbench.cad.step import write_cad

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="session")
def sample():
    return cell()


@pytest.fixture(scope="session")
def written(sample, tmp_path_factory):
    """The sample's files, written in this process, and all its channels in each way."""
    folder = tmp_path_factory.mktemp("cad")
    write_cad(sample, solids(), job(), folder)
    for plate, channels in hatched(domains(), job()).items():
        for way in WAYS:
            (folder / way).mkdir(exist_ok=True)
            with part21(folder / way / f"channels_{plate}.step") as out:
                write_channels(out, [channels], job().sheet.thickness, way)
    return folder


@pytest.fixture(scope="session")
def read(written):
    """File name -> its products, read once."""
    return cache(lambda name: products(written / name))


@pytest.fixture(scope="session")
def freecad(written):
    """What FreeCAD measured on its own solids and on the files; see `freecad_probe`."""
    paths = [str(ROOT), str(ROOT / "solver"), str(ROOT / "tests")]
    code = f"import sys; sys.path[:0] = {paths}; from cad.freecad_probe import main; main({str(written)!r})"
    done = subprocess.run(
        ["freecadcmd", "-c", code], env={**os.environ, "LC_ALL": "C.UTF-8"}, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return json.loads((written / "freecad.json").read_text())
