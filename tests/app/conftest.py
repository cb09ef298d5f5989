"""What the tests of the application share."""

from __future__ import annotations

from pathlib import Path

import pytest
from processes import make_project


@pytest.fixture
def project(tmp_path: Path) -> Path:
    """A small checkout without .venv."""
    return make_project(tmp_path)
