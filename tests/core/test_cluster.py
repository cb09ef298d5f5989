"""Masks by the workers of a Dask cluster: the same bytes as by this process."""

import hashlib
import warnings

import pytest
from distributed import LocalCluster
from sheets import design

from lce_solver.errors import EnvironmentFault, InputError
from lce_workbench.cli import main
from lce_workbench.cluster import client, each
from lce_workbench.core import jobfile
from lce_workbench.core.job import Job, Marks, Output, Target
from lce_workbench.outputs import write_design, write_manifest
from lce_workbench.pipeline import versions


@pytest.fixture(scope="module")
def address():
    with LocalCluster(n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None) as cluster:
        yield cluster.scheduler_address


def folder(path):
    """A designed folder, with the least that `./lce mask` needs."""
    path.mkdir()
    job = Job(
        target=Target(surface="face"),
        marks=Marks(grating=False),
        output=Output(masks=("gds", "oas", "dxf", "r12.dxf", "cif"), pictures=False),
    )
    (path / "job.toml").write_text(jobfile.dump(job))
    write_design(design(6, 7, width=2.0, height=2.2), path / "design.npz")
    write_manifest(path, {"versions": versions(), "stages": ["design"], "inputs": [], "findings": [], "exit_code": 0})
    return path


def digests(path):
    return {p.name: hashlib.sha256(p.read_bytes()).hexdigest() for p in sorted((path / "mask").iterdir())}


def test_the_same_bytes(address, tmp_path, capsys):
    alone, shared = folder(tmp_path / "alone"), folder(tmp_path / "shared")
    assert main(["mask", str(alone), "--quiet"]) == 0
    assert main(["mask", str(shared), "--quiet", "--scheduler", address]) == 0
    assert digests(alone) == digests(shared)
    assert len(digests(alone)) == 12
    assert capsys.readouterr().err == ""


def doubled(x):
    if x > 2:
        msg = f"{x} is too large; take less"
        raise InputError(msg)
    return 2 * x


def test_results_come_in_order_and_faults_as_they_are(address):
    for where in (None, address):
        with client(where) as workers:
            assert list(each(workers, doubled, [2, 0, 1])) == [4, 0, 2]
            with pytest.raises(InputError, match="3 is too large; take less"):
                list(each(workers, doubled, [1, 3]))


def test_no_scheduler_is_one_sentence(tmp_path, capsys):
    path = folder(tmp_path / "alone")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        assert main(["mask", str(path), "--scheduler", "tcp://127.0.0.1:9"]) == EnvironmentFault.exit_code
    said = capsys.readouterr().err
    assert "lce: --scheduler tcp://127.0.0.1:9: no Dask scheduler answers there" in said
    assert not (path / "mask").exists()
