"""The output folder appears whole or not at all."""

import os
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from sheets import design

from lce_solver.errors import EnvironmentFault, InputError
from lce_solver.types import Start, Status
from lce_workbench.outputs import (
    MANIFEST,
    read_design,
    read_manifest,
    require_unchanged,
    staged,
    write_design,
    write_manifest,
)


def _poisoned(array):
    array = array.astype(float)
    array.flat[3] = np.nan
    return array


FOREIGN = {
    "cut short": lambda path: path.write_bytes(path.read_bytes()[:3000]),
    "empty": lambda path: path.write_bytes(b""),
    "another kind": lambda path: path.write_bytes(b"\x93NUMPY not an archive"),
    "theta is missing": lambda path: _changed(path, theta=None),
    "theta is not finite": lambda path: _changed(path, theta=_poisoned),
    "vertices are not finite": lambda path: _changed(path, vertices=_poisoned),
    "triangles name vertices": lambda path: _changed(path, faces=lambda a: a + 1000),
    "no triangles": lambda path: _changed(
        path, **dict.fromkeys(("faces", "theta", "dtheta", "stretch"), lambda a: a[:0])
    ),
}


def _changed(path, **changes):
    with np.load(path) as data:
        arrays = dict(data)
    for name, change in changes.items():
        former = arrays.pop(name)
        if change:
            arrays[name] = change(former)
    np.savez(path, **arrays)


OURS = {"versions": {"lce-molds": "0"}, "findings": []}


def make(out, text="one", replaced=None):
    with staged(out, replaced=replaced) as folder:
        (folder / "a.txt").write_text(text)
        write_manifest(folder, OURS)


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


def killed_run(out):
    child = os.fork()
    if child == 0:
        with staged(out) as folder:
            (folder / "a.txt").write_text("half")
            os._exit(9)
    assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 9


@pytest.mark.parametrize("exists", [False, True])
def test_the_next_run_clears_what_a_killed_one_left(tmp_path, exists):
    if exists:
        make(tmp_path / "out")
    killed_run(tmp_path / "out")
    assert len(list(tmp_path.iterdir())) == 1 + exists
    make(tmp_path / "out", "two")
    assert [p.name for p in tmp_path.iterdir()] == ["out"]
    assert (tmp_path / "out" / "a.txt").read_text() == "two"


def test_a_run_killed_between_its_two_renames_loses_nothing(tmp_path):
    make(tmp_path / "out")
    (tmp_path / "out").rename(tmp_path / ".out.abcdefgh.former")
    with pytest.raises(RuntimeError), staged(tmp_path / "out"):
        raise RuntimeError
    assert [p.name for p in tmp_path.iterdir()] == ["out"]
    assert (tmp_path / "out" / "a.txt").read_text() == "one"


def test_a_run_that_is_alive_keeps_its_folder(tmp_path):
    with staged(tmp_path / "out") as folder:
        (folder / "a.txt").write_text("slow")
        write_manifest(folder, OURS)
        make(tmp_path / "out", "quick")
        assert folder.is_dir()
    assert (tmp_path / "out" / "a.txt").read_text() == "slow"


def test_a_mount_point_is_refused_before_the_work():
    with pytest.raises(InputError, match="mount point"), staged(Path("/dev/shm")):
        pass


def test_a_folder_within_an_output_folder_is_refused_and_within_any_other_is_not(tmp_path):
    make(tmp_path / "out")
    with pytest.raises(InputError, match="lies in the output folder"), staged(tmp_path / "out" / "deep" / "inner"):
        pass
    assert [path.name for path in (tmp_path / "out").iterdir() if path.is_dir()] == []
    (tmp_path / "manifest.json").write_text('{"name": "somebody else\'s"}')
    make(tmp_path / "second")
    assert (tmp_path / "second" / "a.txt").is_file()


def test_kept_files_are_kept_and_the_former_folder_is_not_touched_through_them(tmp_path):
    make(tmp_path / "out")
    (tmp_path / "out" / "b.txt").write_text("kept")
    with pytest.raises(RuntimeError), staged(tmp_path / "out", replaced=["a.txt"]) as folder:
        (folder / "a.txt").write_text("new")
        write_manifest(folder, OURS)
        raise RuntimeError
    assert (tmp_path / "out" / "a.txt").read_text() == "one"
    make(tmp_path / "out", "two", replaced=["a.txt"])
    assert (tmp_path / "out" / "a.txt").read_text() == "two"
    assert (tmp_path / "out" / "b.txt").read_text() == "kept"


def test_what_was_added_or_changed_by_hand_is_never_lost(tmp_path):
    out = tmp_path / "out"
    make(out)
    (out / "notes.txt").write_text("mine")
    with pytest.raises(InputError, match=r"notes\.txt is not ours and would be lost"):
        make(out, "two")
    (out / "notes.txt").unlink()
    (out / "a.txt").write_text("edited")
    for replaced in (None, ["a.txt"]):
        with pytest.raises(InputError, match=r"a\.txt was changed since it was written and would be lost"):
            make(out, "two", replaced)
    assert (out / "a.txt").read_text() == "edited"


def test_a_manifest_of_somebody_else_does_not_make_the_folder_ours(tmp_path):
    (tmp_path / MANIFEST).write_text('{"name": "my web app"}')
    (tmp_path / "index.html").write_text("precious")
    with pytest.raises(InputError, match="not an output folder"):
        make(tmp_path)
    assert (tmp_path / "index.html").read_text() == "precious"


@pytest.mark.parametrize("exists", [False, True])
def test_a_link_stays_a_link(tmp_path, exists):
    if exists:
        make(tmp_path / "real")
    (tmp_path / "link").symlink_to(tmp_path / "real")
    make(tmp_path / "link", "two")
    assert (tmp_path / "link").is_symlink()
    assert (tmp_path / "real" / "a.txt").read_text() == "two"
    assert sorted(p.name for p in tmp_path.iterdir()) == ["link", "real"]


def test_a_file_that_the_manifest_does_not_know_is_refused(tmp_path):
    make(tmp_path / "out")
    require_unchanged(tmp_path / "out", "a.txt")
    (tmp_path / "out" / "a.txt").write_text("onf")
    for name in ("a.txt", "none.txt"):
        with pytest.raises(InputError, match="missing or not what"):
            require_unchanged(tmp_path / "out", name)


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
    for text in ("{", "[]", '{"findings": [1]}', '{"versions": {"lce-molds": "1"}, "files": [], "findings": [1]}'):
        (tmp_path / MANIFEST).write_text(text)
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
    with pytest.raises(EnvironmentFault, match="the disk is full") as fault, staged(out, replaced=[]) as folder:
        (folder / "big").symlink_to("/dev/full")
        (folder / "big").write_bytes(bytes(4_000_000))
    assert fault.value.exit_code == 4
    assert (out / "a.txt").read_text() == "one"
    assert [p.name for p in tmp_path.iterdir()] == ["out"]


def test_the_design_comes_back_with_the_starts_that_competed(tmp_path):
    starts = (
        Start(0.0, Status.CONVERGED, 0.01, 0.5, flipped=0, crossings=0, symmetric=True, triangles=96),
        Start(0.5, Status.OVERLAP, 0.2, 0.9, flipped=0, crossings=3, symmetric=False, triangles=24),
    )
    for competed in (starts, ()):
        write_design(replace(design(), starts=competed), tmp_path / "design.npz")
        assert read_design(tmp_path / "design.npz").starts == competed


def test_a_design_of_a_former_version_lacks_nothing_but_what_was_not_known_then(tmp_path):
    start = Start(0.5, Status.CONVERGED, 0.2, 0.9, flipped=0, crossings=0, winner=True, heated_pct=0.1)
    write_design(replace(design(), starts=(start,)), tmp_path / "design.npz")
    with np.load(tmp_path / "design.npz") as data:
        kept = {name: data[name] for name in data.files if name not in {"start_winner", "start_heated_pct"}}
    np.savez(tmp_path / "design.npz", **kept)
    assert read_design(tmp_path / "design.npz").starts == (replace(start, winner=False, heated_pct=np.inf),)


@pytest.mark.parametrize("fault", FOREIGN)
def test_what_is_no_design_is_told(tmp_path, fault):
    path = tmp_path / "design.npz"
    write_design(design(4, 4), path)
    FOREIGN[fault](path)
    with pytest.raises(InputError, match="is not a readable design"):
        read_design(path)
