"""The pins are a closure without clashes: installing them needs no resolving, and each file has one owner."""

from __future__ import annotations

import re
from collections import Counter
from importlib.metadata import distribution

import pytest
from packaging.requirements import Requirement
from processes import ROOT

SETS = ("requirements.txt", "requirements-test.txt")

LEFT_OUT = {
    # For cadquery's browser viewer, and for its NURBS fitting, which nothing of ours imports.
    "cadquery": {"trame", "trame-vtk", "trame-components", "trame-vuetify", "numba"},
}


def canonical(name: str) -> str:
    return re.sub(r"[-_.]+", "-", name).lower()


def pins(name: str) -> dict[str, str]:
    """The versions of a set; each line is one pin and nothing else."""
    found = [
        re.fullmatch(r"([A-Za-z0-9._-]+)==([0-9][0-9a-z.]*)", line) for line in (ROOT / name).read_text().splitlines()
    ]
    assert all(found)
    return {canonical(match[1]): match[2] for match in found if match}


ALL = pins(SETS[0]) | pins(SETS[1])


def test_sets_are_apart() -> None:
    assert not set(pins(SETS[0])) & set(pins(SETS[1]))


@pytest.mark.parametrize("name", sorted(ALL))
def test_installed_and_complete(name: str) -> None:
    assert distribution(name).version == ALL[name]
    wanted = [Requirement(text) for text in distribution(name).requires or []]
    here = [need for need in wanted if need.marker is None or need.marker.evaluate({"extra": ""})]
    missing = {canonical(need.name) for need in here} - set(ALL)
    assert missing == LEFT_OUT.get(name, set())
    for need in here:
        if canonical(need.name) in ALL:
            assert need.specifier.contains(ALL[canonical(need.name)])


def test_no_file_has_two_owners() -> None:
    owned = Counter(str(file) for name in ALL for file in {*(distribution(name).files or [])})
    assert [file for file, owners in owned.items() if owners > 1 and "__pycache__" not in file] == []
