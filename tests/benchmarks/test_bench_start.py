"""How long the command line takes to answer when there is nothing to compute."""

import os
import subprocess
import sys

import pytest
from processes import ROOT


@pytest.mark.parametrize("word", ["--version", "--help"])
def test_words_alone_are_answered_at_once(benchmark, word):
    """Under 0.4 s; the interpreter alone takes most of it."""
    env = os.environ | {"PYTHONPATH": os.pathsep.join([str(ROOT), str(ROOT / "solver")])}
    words = [sys.executable, "-m", "lce_workbench", word]
    benchmark.pedantic(subprocess.run, (words,), {"check": True, "capture_output": True, "env": env}, rounds=10)
    assert benchmark.stats.stats.median < 0.4
