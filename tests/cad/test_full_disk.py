"""A disk that fills in the middle of an export; /dev/full gives the kernel's own answer to a write on a full disk."""

import pytest
from cad.cad_sample import domains, hatched, job

from lce_solver.errors import EnvironmentFault
from lce_workbench.cad import step
from lce_workbench.outputs import staged, write_manifest


def test_a_disk_that_fills_in_the_middle_of_the_channels_leaves_the_former_files(tmp_path, monkeypatch):
    monkeypatch.setattr(step, "files", lambda job: {})
    out, name = tmp_path / "out", "channels_bottom.step"
    with staged(out) as folder:
        (folder / name).write_text("former")
        write_manifest(folder, {"versions": {"lce-molds": "0"}, "findings": []})
    parts = {plate: [part] for plate, part in hatched(domains(), job()).items()}
    with pytest.raises(EnvironmentFault, match=f"{name} could not be written; see that the disk has room"):  # noqa: SIM117
        with staged(out) as folder:
            (folder / name).symlink_to("/dev/full")
            step.write_cad(None, parts, job(), folder)
    assert (out / name).read_text() == "former"
    assert [path.name for path in tmp_path.iterdir()] == ["out"]
