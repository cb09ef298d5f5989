"""The command line inside FreeCAD: ``freecadcmd lce_workbench/batch.py -- build JOB.toml --out DIR``.

FreeCAD 0.20 ends with 0 when a script raises, and then runs it a second time; so whatever happens, this ends with
`sys.exit`, which FreeCAD obeys.
"""

from __future__ import annotations

import os
import sys
import traceback
from pathlib import Path

HERE = Path(__file__).resolve().parent
ROOT = HERE.parent


def arguments(argv: list[str]) -> list[str]:
    """What is ours in FreeCAD's argv, after `--`: 0.20 has [script, ...], 1.0 ['freecadcmd', script, ...]."""
    marks = [place for place, word in enumerate(argv) if word in ("--", "--pass")]
    return argv[marks[0] + 1 :] if marks else []


def run(argv: list[str]) -> int:
    """Run ``argv`` with the numeric packages of `./lce`, whose masks these must equal, and return the exit code."""
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # as ./lce does, before NumPy reads it
    # FreeCAD puts the script's own folder on the path, where `core`, `export` and `app` would pass for packages.
    others = [path for path in sys.path if Path(path).resolve() != HERE]
    sys.path[:] = [str(ROOT), str(ROOT / "solver"), *others]
    from lce_solver.errors import EnvironmentFault
    from lce_workbench import packages

    try:
        packages.prefer()
    except EnvironmentFault as fault:
        print(f"lce: {fault}", file=sys.stderr)
        return fault.exit_code
    from lce_workbench import cli

    return cli.guarded(OWN[argv[0]], argv[1:]) if argv and argv[0] in OWN else cli.main(argv)


def _document(argv: list[str]) -> int:
    """Write the FreeCAD document of the output folder ``argv[0]``."""
    from lce_workbench.app.document import run_document

    run_document(Path(argv[0]))
    return 0


def _drawings(argv: list[str]) -> int:
    """Write the drawings of the output folder ``argv[0]``."""
    from lce_workbench.app.drawings import run_drawings

    run_drawings(Path(argv[0]))
    return 0


OWN = {"document": _document, "drawings": _drawings}
"""The pipeline's own calls."""


def end() -> None:
    """Run FreeCAD's argv and leave with its exit code; a defect of ours leaves a traceback and 1."""
    try:
        code = run(arguments(sys.argv))
    except KeyboardInterrupt:
        code = 130
    except Exception:
        traceback.print_exc()
        code = 1
    finally:
        sys.stdout.flush()  # FreeCAD 1.0 drops what is still buffered
    sys.exit(code)


if __name__ != "lce_workbench.batch":  # FreeCAD imports it as `batch`
    end()
