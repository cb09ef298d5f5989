"""Random valid jobs: no invalid shape, no interference, the gap right, kernels and prisms agree. 40 in benchmarks."""

import pytest
from cad.cad_sample import CHECKS
from cad.sweep import swept


@pytest.mark.parametrize("seed", range(8))
def test_a_random_job_gives_a_sound_cell(seed, tmp_path):
    found = swept(seed, tmp_path)
    assert {f.check for f in found} == CHECKS
    assert [f.message for f in found if f.severity.value == "error"] == []
    assert all(f.value <= 1e-9 for f in found if f.check in {"cad_kernel", "cad_interference"})
    assert all(f.value <= 1e-3 for f in found if f.check in {"cad_gap", "cad_mates"})  # nm
