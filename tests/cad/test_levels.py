"""Levels of detail: outlines of all domains by their angles, a window's domains, channels with exact ends."""

import re
from dataclasses import replace

import numpy as np
import pytest
from cad.cad_sample import PITCH, cell, domains, hatched, job
from cad.readers import products
from OCP.BRepGProp import BRepGProp
from OCP.GProp import GProp_GProps
from OCP.IFSelect import IFSelect_RetDone
from OCP.STEPControl import STEPControl_Reader
from OCP.TopAbs import TopAbs_FACE
from OCP.TopExp import TopExp_Explorer

from lce_solver.errors import InputError
from lce_solver.types import Severity
from lce_workbench.cad.checks import check
from lce_workbench.cad.instances import estimate, write_exact
from lce_workbench.cad.reread import solids_in, volume_of
from lce_workbench.cad.sheet import domain_names, write_domains
from lce_workbench.cad.step import write_cad
from lce_workbench.core.cell import wanted
from lce_workbench.core.channels import corners, slanted
from lce_workbench.core.domains import signed_area
from lce_workbench.core.frame import arrange
from lce_workbench.core.job import Output


def test_every_domain_is_a_face_of_its_area_under_its_name(tmp_path):
    sheet = domains()
    write_domains(sheet, tmp_path / "domains.step")
    reader = STEPControl_Reader()
    assert reader.ReadFile(str(tmp_path / "domains.step")) == IFSelect_RetDone
    reader.TransferRoots()
    explorer, found = TopExp_Explorer(reader.OneShape(), TopAbs_FACE), []
    while explorer.More():
        properties = GProp_GProps()
        BRepGProp.SurfaceProperties_s(explorer.Current(), properties)
        at = properties.CentreOfMass()
        found.append((at.X(), at.Y(), properties.Mass()))
        explorer.Next()
    np.testing.assert_allclose(found, np.column_stack([sheet.centroid, sheet.area]), atol=1e-12)
    text = (tmp_path / "domains.step").read_text("ascii")
    assert re.findall(r"=PRODUCT\('(domain_[^']*)'", text) == domain_names(sheet)
    assert re.findall(r"=ADVANCED_FACE\('(domain_[^']*)'", text) == domain_names(sheet)


def test_a_name_holds_the_angles_of_the_table():
    sheet = domains()
    number, theta, bottom, top = re.fullmatch(
        r"domain_(\d+)_theta_([\d.]+)_bottom_([\d.]+)_top_([\d.]+)", domain_names(sheet)[7]
    ).groups()
    assert int(number) == 7
    want = np.degrees([sheet.theta[7], sheet.angle("bottom")[7], sheet.angle("top")[7]])
    np.testing.assert_allclose([float(theta), float(bottom), float(top)], want, atol=0.005001)


def test_a_window_chooses_the_domains_that_it_touches():
    sheet = domains()  # squares of 30 um, each of two triangles, cut from lower left to upper right
    um = PITCH * 1000
    inside = round(-2.5 * um + 2), round(-2.5 * um + 1), round(-2.5 * um + 3), round(-2.5 * um + 2)
    assert wanted(sheet, Output(step_window_um=inside)) == (0, 25)  # across the diagonal
    assert wanted(sheet, Output(step_window_um=(-68, -74, -65, -72))) == (0,)  # below it
    assert wanted(sheet, Output(step_window_um=(-68, -74, -65, -72), step_domains=(9,))) == (0, 9)
    assert wanted(sheet, Output(step_window_um=(-100, -100, 100, 100))) == tuple(range(50))
    with pytest.raises(InputError, match="outside the sheet"):
        wanted(sheet, Output(step_window_um=(100, 100, 120, 120)))
    with pytest.raises(InputError, match="has 3 numbers; give x0, y0, x1, y1"):
        wanted(sheet, Output(step_window_um=(1, 2, 3)))


@pytest.mark.parametrize("plate", ["bottom", "top"])
def test_exact_ends_lie_on_the_border_s_inset(plate):
    """Each side of a channel reaches from inset border to inset border, and holds the square-ended channel."""
    sheet, channels = domains(), hatched(domains(), job())[plate]
    guard = job().channels.guard
    rings, square = slanted(channels, sheet.corners, guard), corners(channels)
    edges = np.roll(sheet.corners, -1, axis=1) - sheet.corners
    inward = np.stack([-edges[..., 1], edges[..., 0]], axis=2) / np.linalg.norm(edges, axis=2)[..., None]
    inside = np.einsum(
        "nejk,nek->nje", rings[:, None] - sheet.corners[channels.domain][:, :, None], inward[channels.domain]
    )
    assert inside.min() > guard - 1e-12
    np.testing.assert_allclose(inside.min(axis=2), guard, atol=1e-12)  # every corner is on a border
    area, least = signed_area(rings), signed_area(square)
    assert np.all(area >= least - 1e-15)
    assert area.sum() > least.sum() * 1.005


def test_exact_channels_are_solids_of_their_own_split_by_64_domains(tmp_path):
    sheet, channels = domains(8), hatched(domains(8), job())["top"]
    write_exact([channels], sheet.corners, job(), tmp_path / "channels_top.step")
    names = sorted(path.name for path in tmp_path.iterdir())
    assert names == ["channels_top_0000.step", "channels_top_0001.step"]
    volumes = [volume_of(solid) for name in names for solid in solids_in(tmp_path / name)]
    want = signed_area(slanted(channels, sheet.corners, job().channels.guard)) * channels.depth
    np.testing.assert_allclose(volumes, want, rtol=1e-9)
    assert len({p.path[-1] for p in products(tmp_path / names[1])}) == np.count_nonzero(channels.counts[64:])


def test_the_exact_level_is_counted_and_a_lost_file_is_seen(tmp_path):
    sheet, wish = domains(), replace(job((24,)), output=Output(step="exact", step_domains=(24,), cad=("domains",)))
    built, solids = cell((24,)), {plate: [part] for plate, part in hatched(sheet, wish).items()}
    write_cad(built, solids, wish, tmp_path)

    def errors():
        found = check(built, solids, arrange(sheet.vertices, wish), wish, tmp_path)
        return {f.where for f in found if f.severity is Severity.ERROR and f.check == "cad_step"}

    assert errors() == set()
    (tmp_path / "channels_top_0000.step").unlink()
    (tmp_path / "domains.step").write_text((tmp_path / "domains.step").read_text().replace("OPEN_SHELL", "SHELL", 1))
    assert errors() == {"channels_top.step", "domains.step"}


def test_the_estimate_of_exact_channels_and_outlines_is_about_their_size(tmp_path):
    sheet, channels = domains(), hatched(domains(), job())["top"]
    write_exact([channels], sheet.corners, job(), tmp_path / "x.step")
    write_domains(sheet, tmp_path / "domains.step")
    for kind, count, name in (("exact", len(channels), "x_0000.step"), ("domain", len(sheet), "domains.step")):
        assert estimate(kind, count).value == pytest.approx((tmp_path / name).stat().st_size / 1e6, rel=0.3)
