"""Folders that cannot be written."""

from __future__ import annotations

import os
from pathlib import Path


def read_only(folder: Path) -> list[str]:
    """Make a folder read-only; words that start a program which obeys that also as the superuser."""
    for path in (folder, *folder.rglob("*")):
        path.chmod(path.stat().st_mode & ~0o222)
    return ["setpriv", "--bounding-set=-dac_override"] if os.geteuid() == 0 else []
