"""The film on the hot plate, when the job asks for it."""

from __future__ import annotations

from dataclasses import replace

from lce_solver.load import on_plate, specific_weight
from lce_solver.shell import Film
from lce_workbench.core.job import PredictionSpec


def loaded(film: Film, spec: PredictionSpec) -> Film:
    """``film`` with its weight on the hot plate, if that is asked for."""
    if not spec.plate:
        return film
    pull = specific_weight(spec.density_kg_m3, spec.modulus_MPa)
    return replace(film, load=on_plate(film.sheet, film.thickness, pull))
