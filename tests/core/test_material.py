"""Materials: presets say that they are estimates, curves are interpolated and never extrapolated."""

import numpy as np
import pytest

from lce_solver.errors import InputError
from lce_solver.types import Severity
from lce_workbench.core import material
from lce_workbench.core.job import MaterialSpec

CURVE = "T_C, lambda_parallel, lambda_perpendicular\n20, 1.0, 1.0\n100, 0.9, 1.05\n180, 0.6, 1.3\n"


@pytest.fixture
def curve(tmp_path):
    (tmp_path / "curve.csv").write_text(CURVE)
    return tmp_path / "curve.csv"


@pytest.mark.parametrize("name", material.presets())
def test_presets_state_their_source_and_that_they_are_estimates(name):
    matter, findings = material.from_preset(name)
    assert "Aharoni" in matter.source
    assert findings[0].severity is Severity.WARNING
    assert "estimate" in findings[0].message


def test_a_curve_gives_the_measured_stretches_at_its_points_and_the_mean_between(curve):
    assert material.from_curve(curve, 180).along == pytest.approx(0.6, abs=1e-15)
    assert material.from_curve(curve, 180).across == pytest.approx(1.3, abs=1e-14)
    halfway = material.from_curve(curve, 140)
    assert (halfway.along, halfway.across) == pytest.approx((0.75, 1.175), abs=1e-14)


@pytest.mark.parametrize("temperature", [19.9, 181, 453])
def test_a_curve_is_never_extrapolated(curve, temperature):
    with pytest.raises(InputError, match="outside the curve"):
        material.from_curve(curve, temperature)


def test_a_temperature_without_strain_has_no_director(curve):
    with pytest.raises(InputError, match="no director"):
        material.from_curve(curve, 20)


BAD = {
    "column": ("T,lambda_parallel,lambda_perpendicular\n1,2,3\n", "no column T_C"),
    "percent": ("T_C,lambda_parallel,lambda_perpendicular\n180,60,130\n", "line 2: stretches must be ratios"),
    "text": ("T_C,lambda_parallel,lambda_perpendicular\n180,a,1.3\n", "line 2"),
    "short": ("T_C,lambda_parallel,lambda_perpendicular\n180,0.6\n", "line 2"),
    "empty": ("", "no column"),
    "no rows": ("T_C,lambda_parallel,lambda_perpendicular\n", "has no rows"),
    "twice": ("T_C,lambda_parallel,lambda_perpendicular\n180,0.6,1.3\n180,0.5,1.4\n", "stands twice"),
}


@pytest.mark.parametrize("case", BAD)
def test_a_bad_curve_is_told(tmp_path, case):
    text, words = BAD[case]
    (tmp_path / "c.csv").write_text(text)
    with pytest.raises(InputError, match=words):
        material.resolve(MaterialSpec(curve="c.csv", temperature_C=180.0), tmp_path)


def test_a_missing_curve_and_an_unknown_preset_are_told(tmp_path):
    with pytest.raises(InputError, match="cannot be read"):
        material.resolve(MaterialSpec(curve="none.csv", temperature_C=180.0), tmp_path)
    with pytest.raises(InputError, match="shipped are"):
        material.resolve(MaterialSpec(preset="rubber"), tmp_path)


def test_rows_may_stand_in_any_order(tmp_path, curve):
    lines = CURVE.splitlines()
    (tmp_path / "other.csv").write_text("\n".join([lines[0], *reversed(lines[1:])]))
    same = [material.from_curve(p, 133.0) for p in (curve, tmp_path / "other.csv")]
    assert np.isclose(same[0].along, same[1].along, atol=0)
