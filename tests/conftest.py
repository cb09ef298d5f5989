"""What tests that open a window share."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
from processes import display


@pytest.fixture(scope="module")
def screen() -> Iterator[str]:
    """A virtual screen: what DISPLAY has to be."""
    with display() as name:
        yield name
