import csv

import numpy as np
import pytest
from sheets import design

from lce_workbench.core.domains import Domains, partition
from lce_workbench.export.table import write_table

HEADER = (
    "domain,x_mm,y_mm,area_mm2,theta_deg,dtheta_deg,theta_top_deg,theta_bottom_deg,written_top_deg,"
    "written_bottom_deg,stretch_along,stretch_across,channels_top,channels_bottom"
)


def table(domains, path, counts=None):
    n = len(domains)
    write_table(domains, counts or [np.zeros(n, int), np.zeros(n, int)], path)
    with path.open() as file:
        return list(csv.DictReader(file))


@pytest.fixture
def awkward():
    """Directors whose printed angle would be 180 or -0 if they were only formatted."""
    theta = [0.0, np.nextafter(np.pi, 0), 1e-12, np.pi / 2, 3.0]
    dtheta = [0.0, 0.0, 4e-12, -1e-12, 0.4]
    n = len(theta)
    corner = np.tile([[-1.0, 0.0], [1.0, -0.5], [0.0, 0.5]], (n, 1)) - [1e-9, 1e-9]
    return Domains(corner, np.arange(3 * n).reshape(n, 3), theta, dtheta, np.ones((n, 2)))


def test_the_columns_are_the_contract(tmp_path):
    domains = partition(design())
    n = len(domains)
    rows = table(domains, tmp_path / "d.csv", [np.arange(n), np.arange(n) + 1000])
    assert (tmp_path / "d.csv").read_text().splitlines()[0] == HEADER
    assert [int(r["domain"]) for r in rows] == list(range(n))
    assert [int(r["channels_bottom"]) for r in rows] == list(range(n))
    assert [int(r["channels_top"]) for r in rows] == list(range(1000, n + 1000))
    for name, expected in (
        ("x_mm", domains.centroid[:, 0]),
        ("y_mm", domains.centroid[:, 1]),
        ("area_mm2", domains.area),
        ("theta_deg", np.degrees(domains.theta)),
        ("dtheta_deg", np.degrees(domains.dtheta)),
        ("stretch_along", domains.stretch[:, 0]),
        ("stretch_across", domains.stretch[:, 1]),
    ):
        assert np.allclose([float(r[name]) for r in rows], expected, rtol=0, atol=5.1e-7)


def test_the_angles_obey_their_laws_as_printed(tmp_path):
    for row in table(partition(design(twist=0.2)), tmp_path / "d.csv"):
        value = {name: float(text) for name, text in row.items()}
        for sign, plate in ((1, "top"), (-1, "bottom")):
            left = value["theta_deg"] + sign * value["dtheta_deg"] / 2 - value[f"theta_{plate}_deg"]
            assert abs((left + 90) % 180 - 90) < 2e-6
        assert value["written_bottom_deg"] == value["theta_bottom_deg"]
        assert abs(value["written_top_deg"] - (180 - value["theta_top_deg"]) % 180) < 1e-6


def test_printed_angles_stay_below_180_and_nothing_is_minus_zero(awkward, tmp_path):
    rows = table(awkward, tmp_path / "d.csv")
    for row in rows:
        for name, text in row.items():
            assert not (text.startswith("-") and float(text) == 0), name
            if name.endswith("_deg") and name != "dtheta_deg":
                assert 0 <= float(text) < 180, name


def test_two_runs_are_the_same_to_the_byte(tmp_path):
    table(partition(design()), tmp_path / "a.csv")
    table(partition(design()), tmp_path / "b.csv")
    assert (tmp_path / "a.csv").read_bytes() == (tmp_path / "b.csv").read_bytes()
    assert b"\r" not in (tmp_path / "a.csv").read_bytes()
