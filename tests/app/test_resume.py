"""A heating that is interrupted goes on where it stopped; and the film of it."""

import json
import struct
from pathlib import Path

import numpy as np
import pytest
import small
from small import digests

from lce_solver.errors import EnvironmentFault
from lce_workbench.checkpoint import place
from lce_workbench.cli import Bar, main
from lce_workbench.core import jobfile
from lce_workbench.outputs import read_design
from lce_workbench.pipeline import build


@pytest.fixture
def designed(tmp_path):
    return small.designed(tmp_path, settings=["prediction.film=true"])


def heated(folder, stop=2.0):
    """Run the prediction and return the fractions that it told; interrupt it at one."""
    told = []

    def progress(stage, fraction):
        told.append(fraction)
        if stage == "heating" and fraction >= stop:
            raise KeyboardInterrupt

    build(jobfile.load(folder / "job.toml"), folder, folder, ["predict"], progress)
    return told


def interrupted(folder):
    with pytest.raises(KeyboardInterrupt):
        heated(folder, stop=0.5)


def test_a_resumed_heating_equals_the_undisturbed_one(designed):
    assert heated(designed)[0] == 0.0
    undisturbed = digests(designed)
    interrupted(designed)
    assert digests(designed) == undisturbed
    assert place(designed).is_file()
    assert heated(designed)[0] == 0.5  # two of four steps were not done again
    assert digests(designed) == undisturbed
    assert [p.name for p in designed.parent.iterdir()] == [designed.name]


def test_a_heating_that_does_not_converge_is_an_error(designed, monkeypatch, capsys):
    monkeypatch.setattr("lce_solver.shell.LIMIT", 2)
    assert main(["predict", str(designed), "--quiet"]) == 3
    assert "error: the simulation did not converge, so it says nothing" in capsys.readouterr().err


def test_a_heating_of_another_sheet_is_not_gone_on_with(designed):
    interrupted(designed)
    path = designed / "job.toml"
    job = jobfile.load(path, ["prediction.seed=7"])
    told = []
    build(job, designed, designed, ["predict"], lambda _, fraction: told.append(fraction))
    assert told[0] == 0.0
    assert not place(designed).exists()


@pytest.mark.parametrize(
    "damage",
    [
        lambda whole: whole[: len(whole) // 2],
        lambda whole: whole.replace(whole[len(whole) // 2 :][:64], bytes(64)),
        lambda _: b"",
        lambda _: b"\x93NUMPY not an archive",
    ],
    ids=["cut short", "overwritten", "empty", "another kind"],
)
def test_a_damaged_file_is_no_harm(designed, damage):
    interrupted(designed)
    place(designed).write_bytes(damage(place(designed).read_bytes()))
    assert heated(designed)[0] == 0.0
    assert not place(designed).exists()


def test_a_full_disk_is_told_and_leaves_the_folder_as_it_was(designed):
    """/dev/full gives the kernel's own answer to a write on a full disk."""
    before = digests(designed.parent)
    place(designed).with_suffix(".part").symlink_to("/dev/full")
    with pytest.raises(EnvironmentFault, match="the disk is full"):
        heated(designed)
    assert digests(designed.parent) == before


def read_glb(path: Path):
    data = path.read_bytes()
    magic, version, length = struct.unpack("<4sII", data[:12])
    size, kind = struct.unpack("<I4s", data[12:20])
    assert (magic, version, length, kind) == (b"glTF", 2, len(data), b"JSON")
    tree, rest = json.loads(data[20 : 20 + size]), data[28 + size :]

    def array(k):
        accessor = tree["accessors"][k]
        view = tree["bufferViews"][accessor["bufferView"]]
        kind = {5126: "<f4", 5125: "<u4"}[accessor["componentType"]]
        raw = rest[view["byteOffset"] : view["byteOffset"] + view["byteLength"]]
        return np.frombuffer(raw, kind).reshape(accessor["count"], -1)

    return tree, array


def test_the_film_shows_every_step(designed):
    heated(designed)
    plan, shapes = read_design(designed / "design.npz"), np.load(designed / "prediction.npz")["frames"]
    tree, array = read_glb(designed / "prediction_film.glb")
    (primitive,) = tree["meshes"][0]["primitives"]
    flat = array(primitive["attributes"]["POSITION"])
    moves = np.array([array(target["POSITION"]) for target in primitive["targets"]])
    (sampler,) = tree["animations"][0]["samplers"]
    weights = array(sampler["output"]).reshape(len(array(sampler["input"])), len(moves))
    played = flat + np.einsum("tk,kvx->tvx", weights, moves)
    assert np.abs(played[0] - np.column_stack([plan.uv, np.zeros(len(plan.uv))])).max() < 1e-6
    assert np.abs(played[1:] - shapes).max() < 1e-6
    assert np.array_equal(array(primitive["indices"]).reshape(-1, 3), plan.surface.faces)


def test_another_reader_plays_the_film(designed):
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkFiltersGeometry import vtkCompositeDataGeometryFilter
    from vtkmodules.vtkIOGeometry import vtkGLTFReader

    heated(designed)
    shapes = np.load(designed / "prediction.npz")["frames"]
    reader = vtkGLTFReader()
    reader.SetFileName(str(designed / "prediction_film.glb"))
    reader.ApplyDeformationsToGeometryOn()
    reader.UpdateInformation()
    assert reader.GetNumberOfAnimations() == 1
    assert reader.GetAnimationDuration(0) == pytest.approx(0.4 * len(shapes))
    reader.EnableAnimation(0)
    reader.SetFrameRate(10)
    reader.UpdateInformation()
    for step in (2, len(shapes)):
        reader.UpdateTimeStep(0.4 * step)
        merged = vtkCompositeDataGeometryFilter()
        merged.SetInputConnection(reader.GetOutputPort())
        merged.Update()
        points = vtk_to_numpy(merged.GetOutput().GetPoints().GetData())
        upright = 1e-3 * shapes[step - 1] @ np.array([[1, 0, 0], [0, 0, 1], [0, -1, 0]]).T
        assert np.abs(points - upright).max() < 1e-7


def test_the_bar_tells_what_is_left(monkeypatch, capsys):
    clock = iter([0.0, 10.0, 20.0, 21.0])
    monkeypatch.setattr("lce_workbench.cli.time.monotonic", lambda: next(clock))
    monkeypatch.setattr("sys.stderr.isatty", lambda: True)
    bar = Bar()
    bar("heating", 0.0)
    bar("heating", 0.25)
    assert capsys.readouterr().err.endswith("heating 20 s, about 30 s left")
    bar("mask", 0.0)
    assert capsys.readouterr().err.endswith("mask 21 s")
