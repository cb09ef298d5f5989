"""What of the job makes the film heavy."""

import pytest
from flatsheets import disk, uniform

from lce_solver.types import Material
from lce_workbench.core.job import PredictionSpec
from lce_workbench.core.weight import loaded

FILM = uniform(disk(3, radius=10.0), Material(0.6, 0.5), 0.1)


def test_weight_on_a_plate_is_an_option():
    assert loaded(FILM, PredictionSpec()) is FILM
    heavy = loaded(FILM, PredictionSpec(plate=True, density_kg_m3=1000, modulus_MPa=2)).load
    assert heavy.weight.sum() == pytest.approx(9.80665e-6 / 2 * 0.1 * FILM.sheet.area.sum())
