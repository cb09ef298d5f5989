import numpy as np
import pytest
import trimesh


@pytest.fixture(scope="module")
def scene(written):
    return trimesh.load(written / "cell.glb")


def test_every_part_is_a_closed_mesh_of_its_volume_in_metres(scene, sample):
    assert set(scene.geometry) == {part.name for part in sample.parts}
    for part in sample.parts:
        mesh = scene.geometry[part.name].copy()
        mesh.apply_scale(1e3)
        mesh.merge_vertices(digits_vertex=6, merge_norm=True, merge_tex=True)
        assert mesh.is_watertight, part.name
        assert mesh.volume == pytest.approx(part.volume, rel=1e-4)


def test_y_is_up(scene, sample):
    top = scene.geometry["top_glass"].bounds * 1e3
    (part,) = (p for p in sample.parts if p.name == "top_glass")
    np.testing.assert_allclose(top[:, 1], [part.z0, part.z1], rtol=1e-5)


def test_colours_are_linear_light(scene, sample):
    for part in sample.parts:
        srgb = np.array(part.colour)
        linear = np.where(srgb <= 0.04045, srgb / 12.92, ((srgb + 0.055) / 1.055) ** 2.4)
        shown = scene.geometry[part.name].visual.material.baseColorFactor / 255
        np.testing.assert_allclose(shown, [*linear, part.opacity], atol=1 / 255)


def test_the_file_is_small(written):
    assert (written / "cell.glb").stat().st_size < 1_000_000
