"""The project's own packages (`.venv`), for the Python inside FreeCAD."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from lce_solver.errors import EnvironmentFault
from lce_workbench import ROOT


def folder() -> Path:
    """The packages that `./lce` installed for the Python that runs."""
    return ROOT / ".venv" / "lib" / f"python{sys.version_info.major}.{sys.version_info.minor}" / "site-packages"


def append() -> None:
    """Make ours importable behind everybody else's: for FreeCAD with a window, which other addons share."""
    path = str(folder())
    if path not in sys.path:
        sys.path.append(path)


@contextmanager
def needed() -> Iterator[None]:
    """Turn the lack of a package into one sentence that says how to get it.

    Raises
    ------
    EnvironmentFault
        A package is missing.
    """
    try:
        yield
    except ModuleNotFoundError as fault:
        msg = (
            f"the Python package {fault.name} is missing in {sys.prefix}; run {ROOT / 'lce'} demo once, which "
            "installs all that is needed, and start again"
        )
        raise EnvironmentFault(msg) from fault


def prefer() -> None:
    """Put ours in front: for a process of our own, so that it computes to the last bit what `./lce` computes."""
    if not folder().is_dir():
        msg = f"The packages of the workbench are missing ({folder()}): run {ROOT / 'lce'} once, which installs them."
        raise EnvironmentFault(msg)
    numpy = sys.modules.get("numpy")
    if numpy is not None and not Path(str(numpy.__file__)).is_relative_to(folder()):
        msg = (
            f"Another addon has loaded {numpy.__file__} before us, so results could differ from those of ./lce: "
            "start with FREECAD_USER_HOME set to an empty folder, where no addon is found."
        )
        raise EnvironmentFault(msg)
    sys.path.insert(0, str(folder()))
