"""The command line answers at once: what needs no computation loads nothing that computes."""

import os
import signal
import subprocess
import sys

import pytest
from processes import ROOT

from lce_workbench.cli import guarded, main

HEAVY = {"numpy", "scipy", "igl", "mmgpy", "cadquery", "OCP", "matplotlib", "trimesh", "ezdxf", "dask"}


def loaded(*argv):
    """Exit code of the command and the packages that it imports, as the interpreter tells."""
    paths = os.pathsep.join([str(ROOT), str(ROOT / "solver")])
    words = [sys.executable, "-X", "importtime", "-m", "lce_workbench", *argv]
    done = subprocess.run(words, capture_output=True, text=True, check=False, env=os.environ | {"PYTHONPATH": paths})
    lines = [line.rpartition("|")[2].strip() for line in done.stderr.splitlines() if line.startswith("import time:")]
    return done.returncode, {name.partition(".")[0] for name in lines}


@pytest.mark.parametrize(
    ("argv", "code"), [(["--version"], 0), (["--help"], 0), (["build", "--help"], 0), (["biuld"], 2), (["plate"], 2)]
)
def test_words_alone_load_nothing(argv, code):
    ended, packages = loaded(*argv)
    assert ended == code
    assert "lce_workbench" in packages
    assert not packages & HEAVY


def test_an_alignment_loads_no_mesh_library_nor_cad_kernel(tmp_path):
    ended, packages = loaded("align", str(tmp_path / "none.csv"))
    assert ended == 2
    assert "numpy" in packages
    assert not packages & (HEAVY - {"numpy", "scipy"})


def test_a_study_s_questions_are_in_its_help(capsys):
    from lce_workbench.core.perturb import STUDIES

    with pytest.raises(SystemExit):
        main(["study", "--help"])
    said = capsys.readouterr().out
    assert all(name in said and one.question in said for name, one in STUDIES.items())


def test_an_interruption_is_one_whatever_a_library_makes_of_it_and_however_often_it_comes(capsys):
    def importing(_):
        try:
            signal.raise_signal(signal.SIGINT)
        except KeyboardInterrupt:
            signal.raise_signal(signal.SIGTERM)  # as `timeout` sends them, one right after the other
            raise ImportError("initialization failed") from None

    assert guarded(importing, []) == 130
    assert capsys.readouterr().err == "lce: interrupted; nothing was changed\n"


def test_a_folder_is_no_mesh_for_a_new_job(capsys):
    assert main(["new", "."]) == 2
    assert "internal" not in capsys.readouterr().err
