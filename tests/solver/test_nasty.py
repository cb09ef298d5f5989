"""Broken and nasty meshes, the first of the 200 that the benchmark runs."""

import pytest
from nasty import check_ends


@pytest.mark.filterwarnings("error")
def test_nasty_meshes_end_in_a_design_or_a_sentence(tmp_path):
    counts = check_ends(range(24), tmp_path / "nasty.obj")
    assert counts["design"] > 8
    assert counts["refused"] > 8
