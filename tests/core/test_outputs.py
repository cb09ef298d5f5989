"""The output folder appears whole or not at all."""

import pytest

from lce_solver.errors import EnvironmentFault, InputError
from lce_workbench.outputs import MANIFEST, read_manifest, staged, write_manifest


def make(out, text="one", keep=None):
    with staged(out, keep=keep) as folder:
        (folder / "a.txt").unlink(missing_ok=True)
        (folder / "a.txt").write_text(text)
        write_manifest(folder, {})


def test_a_finished_folder_replaces_the_former_one(tmp_path):
    make(tmp_path / "out")
    make(tmp_path / "out", "two")
    assert (tmp_path / "out" / "a.txt").read_text() == "two"
    assert [p.name for p in tmp_path.iterdir()] == ["out"]


@pytest.mark.parametrize("fault", [RuntimeError, KeyboardInterrupt])
@pytest.mark.parametrize("exists", [False, True])
def test_a_broken_run_leaves_what_was_there(tmp_path, fault, exists):
    if exists:
        make(tmp_path / "out")
    with pytest.raises(fault), staged(tmp_path / "out") as folder:
        (folder / "a.txt").write_text("half")
        raise fault
    assert [p.name for p in tmp_path.iterdir()] == (["out"] if exists else [])
    assert not exists or (tmp_path / "out" / "a.txt").read_text() == "one"


def test_kept_files_are_kept_and_the_former_folder_is_not_touched_through_them(tmp_path):
    make(tmp_path / "out")
    (tmp_path / "out" / "b.txt").write_text("kept")
    with pytest.raises(RuntimeError), staged(tmp_path / "out", keep=tmp_path / "out") as folder:
        (folder / "a.txt").unlink()
        (folder / "a.txt").write_text("new")
        write_manifest(folder, {})
        raise RuntimeError
    assert (tmp_path / "out" / "a.txt").read_text() == "one"
    make(tmp_path / "out", "two", keep=tmp_path / "out")
    assert (tmp_path / "out" / "b.txt").read_text() == "kept"


def test_files_of_others_are_never_replaced(tmp_path):
    (tmp_path / "thesis.tex").write_text("years of work")
    with pytest.raises(InputError, match="not ours"), staged(tmp_path):
        pass
    with pytest.raises(InputError, match="is a file"), staged(tmp_path / "thesis.tex"):
        pass
    assert (tmp_path / "thesis.tex").read_text() == "years of work"


def test_the_manifest_lists_every_file_with_its_digest(tmp_path):
    make(tmp_path / "out")
    (entry,) = read_manifest(tmp_path / "out")["files"]
    assert entry == {
        "path": "a.txt",
        "size": 3,
        "sha256": "7692c3ad3540bb803c020b3aee66cd8887123234ea0c6e7143c0add73ff431ed",  # sha256sum of "one"
    }


def test_a_folder_without_manifest_is_told(tmp_path):
    with pytest.raises(InputError, match="not an output folder"):
        read_manifest(tmp_path)
    (tmp_path / MANIFEST).write_text("{")
    with pytest.raises(InputError, match="not an output folder"):
        read_manifest(tmp_path)


def test_a_place_that_cannot_be_written_is_told(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(EnvironmentFault, match="cannot be written"), staged(tmp_path / "file" / "out"):
        pass


def test_a_full_disk_is_told_and_loses_nothing(tmp_path):
    """/dev/full gives the kernel's own answer to a write on a full disk, without a mount, which a chroot forbids."""
    out = tmp_path / "out"
    make(out)
    with pytest.raises(EnvironmentFault, match="the disk is full") as fault, staged(out, keep=out) as folder:
        (folder / "big").symlink_to("/dev/full")
        (folder / "big").write_bytes(bytes(4_000_000))
    assert fault.value.exit_code == 4
    assert (out / "a.txt").read_text() == "one"
    assert [p.name for p in tmp_path.iterdir()] == ["out"]
