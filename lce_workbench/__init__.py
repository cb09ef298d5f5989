"""Fabrication-ready molds for liquid-crystal-elastomer sheets: the workbench and the engine that works without it."""

import importlib.util
import sys
from pathlib import Path

__version__ = "0.1.0"

ROOT = Path(__file__).resolve().parent.parent
"""The addon's folder: resources/, templates/ and solver/ stand beside this package."""

# Appended, never in front, so that no other addon sees our packages instead of its own.
if importlib.util.find_spec("lce_solver") is None:
    sys.path.append(str(ROOT / "solver"))
