import json

import numpy as np
import pytest

from lce_solver.errors import InputError
from lce_workbench.cli import main
from lce_workbench.core.align import COLUMNS, PLACES, Readings, fit, form, read, told
from lce_workbench.core.frame import arrange
from lce_workbench.core.job import Job, Marks

UM = 1e-3
FRAME = arrange(np.array([[-10.0, -10.0], [10.0, 10.0]]), Job())


def displaced(at, tx, ty, phi, s):
    """Exact displacement of points: turned, stretched, shifted."""
    turn = np.array([[np.cos(phi), -np.sin(phi)], [np.sin(phi), np.cos(phi)]])
    return (1 + s) * at @ turn.T + [tx, ty] - at


def readings(at, shift, step=UM, tolerance=10 * UM):
    return Readings(at, np.round(shift / step) * step, np.full(len(at), step), FRAME.sheet, tolerance)


def drawn(rng):
    return (*rng.uniform(-3, 3, 2) * UM, rng.uniform(-3e-4, 3e-4), rng.uniform(-2e-4, 2e-4))


@pytest.mark.parametrize("count", [4, 8])
def test_a_thousand_draws_lie_in_their_intervals(count):
    rng = np.random.default_rng(11)
    at, corners = FRAME.marks[:count], FRAME.sheet.ring
    hits, corner_errors = np.zeros(5), []
    for _ in range(1000):
        truth = drawn(rng)
        found = fit(readings(at, displaced(at, *truth)))
        estimate = np.array([*found.shift, found.rotation, found.scale])
        worst = np.linalg.norm(displaced(corners, *truth), axis=1).max()
        errors = np.abs([*(estimate - truth), found.worst - worst])
        hits += errors <= found.halves
        off = displaced(corners, *estimate) - displaced(corners, *truth)
        corner_errors.append(np.linalg.norm(off, axis=1).max())
        assert not found.unlikely
    assert np.abs(hits / 10 - 95).max() <= 2
    limit = {4: 0.40, 8: 0.30}[count]  # rms of the worst corner; four corners are the classic set
    assert np.sqrt(np.mean(np.square(corner_errors))) < limit * UM
    if count == len(FRAME.marks):  # the set that is drawn
        assert np.percentile(corner_errors, 95) <= 0.4 * UM


def test_exact_readings_are_recovered():
    truth = (3 * UM, -2 * UM, 1e-4, -5e-5)
    found = fit(readings(FRAME.marks, displaced(FRAME.marks, *truth), step=1e-9))
    assert np.allclose([*found.shift, found.rotation, found.scale], truth, atol=1e-6)


def test_one_reading_that_contradicts_the_others_is_seen():
    shift = displaced(FRAME.marks, 1 * UM, 0, 0, 0)
    shift[3, 0] += 4 * UM
    found = fit(readings(FRAME.marks, shift))
    assert found.unlikely
    assert not found.passed


@pytest.mark.parametrize(("shift", "passed"), [(0.0, True), (9.0, True), (9.9, False), (12.15, False)])
def test_the_interval_has_to_lie_within_the_tolerance(shift, passed):
    found = fit(readings(FRAME.marks, displaced(FRAME.marks, shift * UM, 0, 0, 0), step=0.45 * UM))
    assert found.passed == passed
    assert np.isclose(found.worst, shift * UM, atol=1e-4 * shift + 1e-9)


def test_the_rotation_is_the_error_of_the_twist():
    found = told(fit(readings(FRAME.marks, displaced(FRAME.marks, 0, 0, 4e-4, 0))))
    assert np.isclose(found["dtheta_error_deg"], np.degrees(4e-4), atol=1e-3)
    assert found["dtheta_error_deg_95"] < 0.001


def filled(path, shift):
    lines = form(FRAME, Job(marks=Marks(tolerance_um=8.0)), "0123ABCD").splitlines()
    for i, (dx, dy) in enumerate(shift):
        lines[5 + i] = lines[5 + i].replace(",,,", f",{dx:.0f},{dy:.0f},")
    path.write_text("\n".join(lines))
    return path


def test_the_form_comes_back(tmp_path):
    found = read(filled(tmp_path / "r.csv", [(k, -k) for k in range(6)]))
    assert np.allclose(found.at, FRAME.marks[:6])
    assert np.allclose(found.shift, np.array([(k, -k) for k in range(6)]) * UM)
    assert found.tolerance == pytest.approx(8 * UM)
    assert (found.sheet.x0, found.sheet.y1) == (-10, 10)
    assert len(PLACES) == len(FRAME.marks)


def test_command(tmp_path, capsys):
    good = filled(tmp_path / "good.csv", [(2, -1)] * 8)
    assert main(["align", str(good)]) == 0
    assert "pass" in capsys.readouterr().out
    bad = filled(tmp_path / "bad.csv", [(7, -7)] * 8)
    assert main(["align", str(bad), "--json"]) == 1
    said = json.loads(capsys.readouterr().out)
    assert said["passed"] is False
    assert said["worst_mismatch_um"] == pytest.approx(7 * np.sqrt(2), abs=0.01)


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        (lambda t: t.replace(",3,-1,", ",three,-1,", 1), "dx_um = 'three' is not a number"),
        (lambda t: t.replace(",3,-1,", ",nan,-1,", 1), "dx_um = 'nan' is not a number"),
        (lambda t: t.replace(",3,-1,", ",3,-1000,", 1), "dy_um = '-1000' is not a number from -150 to 150"),
        (lambda t: t.replace(",3,-1,1", ",3,-1,0", 1), "resolution_um = '0'"),
        (lambda t: t.replace(",3,-1,1", ",3,-1,1e308"), "resolution_um = '1e308'"),
        (lambda t: t.replace(",3,-1,1", ",3,-1", 1), "resolution_um = ''"),
        (lambda t: t.replace(",3,-1,", ',"3,5",-1,', 1), "dx_um = '3,5'"),
        (lambda t: t.replace(",3,-1,", ",3,5,-1,5,", 1), "has more columns than the head; write decimals with a point"),
        (lambda t: t.replace(",3,-1,", ",0.003,-0.001,"), "write dx_um and dy_um in um"),
        (lambda t: t.replace("tolerance_um 8", "tolerance_um -8"), "tolerance_um = '-8'"),
        (lambda t: t.replace("lower left", "l" * 200_000), "field larger than"),
        (lambda _: "", "lacks the column mark"),
        (lambda t: t.replace("dx_um,", "dx,"), "lacks the column dx_um"),
        (lambda t: t.replace("# sheet_mm", "# sheet"), "lacks the line"),
        (lambda t: t.replace("# sheet_mm", "# sheet_mm 1"), "needs four numbers"),
        (lambda t: t.replace(",3,-1,", ",,,"), "two marks at least"),
        (lambda t: t + "\n" + t.splitlines()[-1], "has two lines for 'left middle'"),
    ],
)
def test_bad_forms_are_one_sentence_and_2(tmp_path, capsys, change, sentence):
    path = filled(tmp_path / "r.csv", [(3, -1)] * 8)
    path.write_text(change(path.read_text()))
    assert main(["align", str(path)]) == 2
    said = capsys.readouterr().err
    assert sentence in said
    assert said.count("\n") == 1


def test_a_form_that_a_spreadsheet_saved_with_decimal_commas_is_the_same(tmp_path):
    path = filled(tmp_path / "r.csv", [(3, -1)] * 8)
    plain = path.read_text().replace(",3,-1,", ",2.5,-1.5,")
    path.write_text(plain)
    want = read(path)
    for delimiter, tail in ((";", ";;;;;"), ("\t", "")):
        quoted = [f'"{line}"' if line.startswith("#") and delimiter in line else line for line in plain.splitlines()]
        lines = [line + tail if "#" in line else line.replace(",", delimiter) for line in quoted]
        path.write_text("\r\n".join(line if "#" in line else line.replace(".", ",") for line in lines))
        found = read(path)
        assert all(np.array_equal(getattr(found, name), getattr(want, name)) for name in ("at", "shift", "resolution"))
        assert (found.sheet, found.tolerance) == (want.sheet, want.tolerance)


def test_a_missing_form_is_2(tmp_path, capsys):
    assert main(["align", str(tmp_path / "none.csv")]) == 2
    assert "cannot be read" in capsys.readouterr().err
    assert COLUMNS[0] == "mark"
    with pytest.raises(InputError):
        read(tmp_path / "none.csv")
