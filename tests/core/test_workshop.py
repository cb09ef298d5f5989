"""What a workshop asks for, by exact volumes of the parts and of what is taken from them."""

import math
from dataclasses import replace

import numpy as np
import pytest
from cad.cad_sample import domains, hatched
from cad.cad_sample import job as sample_job

from lce_solver.errors import InputError
from lce_workbench.core.cell import assemble
from lce_workbench.core.domains import signed_area
from lce_workbench.core.frame import arrange
from lce_workbench.core.job import Plates, Spacer
from lce_workbench.core.polyhedron import polyhedron
from lce_workbench.core.prism import Prism, bodies, together
from lce_workbench.core.workshop import PIXEL, inset

EVERYTHING = Plates(chamfer_mm=0.3, release_deg=10.0, notch_mm=2.0, engraving_um=100.0, frame_mm=4.0)


def closed(plates=None, spacer=None):
    sheet = domains()
    job = replace(sample_job((24,)), plates=plates or Plates(), spacer=spacer or Spacer())
    frame = arrange(sheet.vertices, job)
    cell = assemble(frame, job, sheet, {"bottom": [], "top": []}, hatched(sheet, job))
    return frame, cell, bodies(cell.parts)


def volume(stack):
    return together(stack)[0]


def test_a_chamfer_takes_a_frustum_s_share_of_the_glass():
    """Prismatoid: glass of 25 x 25 x 1, 0.3 of it tapered to 24.4 x 24.4."""
    _, _, parts = closed(Plates(chamfer_mm=0.3))
    want = 25**2 * 0.7 + 0.3 * (25**2 + 25 * 24.4 + 24.4**2) / 3
    for plate, outer in (("bottom", 0), ("top", -1)):
        stack = parts[f"{plate}_glass"]
        assert volume(stack) == pytest.approx(want, rel=1e-13)
        tip = stack[outer]
        assert np.ptp((tip.outline, tip.top)[outer], axis=0) == pytest.approx([24.4, 24.4], abs=1e-12)


def test_release_taper_narrows_the_epoxy_towards_the_film():
    _, _, parts = closed(Plates(release_deg=10.0))
    narrow = 25 - 2 * 0.05 * math.tan(math.radians(10))
    for plate in ("bottom", "top"):
        (land,), (epoxy,) = parts[f"{plate}_land"], parts[f"{plate}_epoxy"]
        assert np.ptp(land.outline, axis=0) == pytest.approx([narrow, narrow], abs=1e-12)
        assert epoxy.volume == pytest.approx(0.05 * (25**2 + 25 * narrow + narrow**2) / 3, rel=1e-13)
        near = epoxy.top if plate == "bottom" else epoxy.outline
        assert np.array_equal(near, land.outline)


def test_the_notches_of_the_closed_cell_lie_at_different_corners():
    _, _, parts = closed(Plates(notch_mm=2.0))
    for plate, corner in (("bottom", (-12.5, -12.5)), ("top", (12.5, -12.5))):
        for kind in ("land", "epoxy", "glass"):
            (part,) = parts[f"{plate}_{kind}"]
            assert signed_area(part.outline[None])[0] == pytest.approx(25**2 - 2.0)
            far = np.abs(part.outline - corner).sum(axis=1)
            assert np.sort(far)[:2] == pytest.approx([2.0, 2.0])


def test_letters_are_engraved_in_the_outer_face_and_read_from_outside():
    frame, _, parts = closed(Plates(engraving_um=100.0))
    for plate, outer in (("bottom", 0), ("top", -1)):
        stack = parts[f"{plate}_glass"]
        holes = stack[outer].holes
        assert [len(layer.holes) for layer in stack[:: 1 if outer else -1]] == [0, len(holes)]
        assert stack[outer].z1 - stack[outer].z0 == pytest.approx(0.1, rel=1e-12)
        assert 25**2 - volume(stack) == pytest.approx(0.1 * sum(abs(signed_area(h[None])[0]) for h in holes), rel=1e-9)
        x = np.concatenate(holes)[:, 0]
        assert np.ptp(x) == pytest.approx(7 * PIXEL / 1000 - 0.01, abs=1e-9)
        assert x.max() < frame.marks[0, 0] - 0.75  # on the left glue edge
    top, bottom = (parts[f"{plate}_glass"][outer].holes for plate, outer in (("top", -1), ("bottom", 0)))
    bar = min(top, key=lambda h: h[:, 1].min() + 10 * h[:, 0].min())  # of the T, whose head is on the left, turned
    assert np.ptp(bar, axis=0) == pytest.approx([0.09, 0.49])
    assert code(top, 1) == code(bottom, -1)


def code(holes, side):
    """Middles of the runs of the last eight letters, from the line's end; seen from below for ``side`` -1."""
    middles = np.array([hole.mean(axis=0) for hole in holes])
    end = max(hole[:, 1].max() for hole in holes)
    x = np.concatenate([hole[:, 0] for hole in holes])
    last = middles[middles[:, 1] > end - 47 * PIXEL / 1000] - ((x.min() + x.max()) / 2, end)
    return sorted(map(tuple, np.round(last * (side, 1), 6) + 0.0))


def test_every_option_together_gives_closed_bodies():
    for name, stack in closed(EVERYTHING)[2].items():
        loops = [loop for face in polyhedron(stack).faces for loop in face]
        half = [(a, b) for loop in loops for a, b in zip(loop.tolist(), np.roll(loop, -1).tolist(), strict=True)]
        assert len(set(half)) == len(half), name
        assert {(b, a) for a, b in half} == set(half), name


def test_stacked_prisms_are_one_body_without_inner_faces():
    _, _, parts = closed(EVERYTHING)
    stack = parts["top_glass"]
    body = polyhedron(stack)
    loops = sum(len(face) for face in body.faces)
    edges = sum(len(loop) for face in body.faces for loop in face) // 2
    assert len(stack) == 3  # straight, chamfered, chamfered and engraved
    assert len(body.points) - edges + 2 * len(body.faces) - loops == 2  # Euler: no handle, so no letter goes through
    inner = [p for p in body.points if stack[0].z0 < p[2] < stack[-1].z1]
    assert len(inner) > 10


def test_layers_that_do_not_stand_on_each_other_are_refused():
    square = np.array([(0.0, 0), (1, 0), (1, 1), (0, 1)])
    low, high = (Prism(name, square * k, (), z, z + 1.0, (1.0, 1.0, 1.0)) for name, k, z in (("a", 1, 0), ("b", 2, 1)))
    with pytest.raises(ValueError, match="b does not stand on a"):
        polyhedron([low, high])


def test_glue_lies_outside_the_marks_and_leaves_the_filling_edges_open():
    frame, _, parts = closed()
    (left,), (right,) = parts["glue_left"], parts["glue_right"]
    assert left.z1 - left.z0 == pytest.approx(0.1)
    assert np.ptp(left.outline[:, 0]) == pytest.approx(1.0)
    assert left.outline[:, 0].max() < frame.marks[0, 0] - 0.75 < frame.marks[2, 0] + 0.75 < right.outline[:, 0].min()
    assert left.outline[:, 0].min() > frame.plate.x0
    assert not any(name.startswith("glue") for name in closed(spacer=Spacer(bead_mm=0.0))[2])


def test_the_frame_goes_around_both_plates_with_its_clearance():
    _, _, parts = closed(Plates(frame_mm=4.0, frame_clearance_um=80.0))
    (jig,) = parts["alignment_frame"]
    assert np.ptp(jig.holes[0], axis=0) == pytest.approx([25.16, 25.16])
    assert np.ptp(jig.outline, axis=0) == pytest.approx([33.16, 33.16])
    assert jig.z0 == parts["bottom_glass"][0].z0
    assert 0 < jig.z1 < parts["top_glass"][-1].z1


def test_an_inset_triangle_keeps_its_incircle_s_centre():
    triangle = np.array([(0.0, 0.0), (4.0, 0.0), (0.0, 3.0)])  # incircle of radius 1 about (1, 1)
    np.testing.assert_allclose(inset(triangle, 1.0), [(1, 1)] * 3, atol=1e-12)
    np.testing.assert_allclose(inset(triangle, 0.5), (triangle + 1) / 2, atol=1e-12)


@pytest.mark.parametrize(
    ("plates", "spacer", "sentence"),
    [
        (Plates(notch_mm=9.0), None, r"plates.notch_mm = 9 would cut into marks, glue or spacer; at most \d"),
        (Plates(chamfer_mm=1.0), None, r"plates.chamfer_mm is not less than the glass, plates.glass_mm = 1"),
        (Plates(engraving_um=1000.0), None, r"plates.engraving_um is not less than the glass"),
        (Plates(engraving_um=50.0, width_mm=15.0), Spacer(glue_mm=0.1), r"make spacer.glue_mm larger"),
        (Plates(release_deg=45.0, epoxy_um=2000.0, width_mm=19.0), None, r"patterned face by 2 mm, into the marks; \d"),
        (Plates(carrier="25x25", width_mm=30.0), None, r"plates.carrier = 25x25 fixes the glass; leave out"),
    ],
)
def test_what_does_not_fit_is_refused(plates, spacer, sentence):
    with pytest.raises(InputError, match=sentence):
        closed(plates, spacer)


@pytest.mark.parametrize(("carrier", "size"), [("25x75", (25, 75)), ("75x25", (75, 25)), ("50x50", (50, 50))])
def test_a_carrier_is_chosen_by_its_name(carrier, size):
    assert closed(Plates(carrier=carrier))[0].plate.size == size
