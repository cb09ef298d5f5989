"""From the master to the plate: what each cast does to handedness and relief, and what the operator has to set for it.

Looking at its patterned face, a cast is the mirror image of what it was taken from, trenches become ridges. A master
shows its file unmirrored, exposed positive resist is a trench. The bottom plate is laid face up; the top plate is
turned over about the y axis, which mirrors it once more.
"""

from __future__ import annotations

from dataclasses import dataclass

from lce_solver.types import Finding, Severity
from lce_workbench.core.domains import PLATES, Plate

USUAL = 2
"""Casts that the files are written for: PDMS, then epoxy."""


@dataclass(frozen=True)
class Settings:
    """What follows from the number of casts."""

    mirrored: dict[Plate, bool]
    """Whether a plate's pattern has to be mirrored on the master, x -> -x, against the sheet seen from above."""
    mirror: bool
    """Whether the converter has to mirror both files, x -> -x; they are written for `USUAL` casts."""
    trenches: bool
    """Whether what is exposed becomes channels; else it becomes ridges, with positive resist."""


def settings(casts: int) -> Settings:
    """Settings for a number of casts between the master and the plate."""
    odd = casts % 2 == 1
    return Settings({plate: (plate == "top") != odd for plate in PLATES}, odd != (USUAL % 2 == 1), not odd)


def advice(casts: int) -> tuple[str, ...]:
    """What the operator changes against the files and settings for `USUAL` casts; nothing for an even number."""
    found = settings(casts)
    if not found.mirror:
        return ()
    flags = ", ".join(f"{plate} {'mirrored' if found.mirrored[plate] else 'not mirrored'}" for plate in PLATES)
    return (
        f"mirror x ON for both plates in the converter (on the masters: {flags})",
        "what is exposed becomes ridges: take negative resist, or a converter that inverts the exposed layers",
        "labels on the masters read mirrored; on the plates they read right",
    )


def replicated(casts: int) -> tuple[Finding, ...]:
    """A warning for a number of casts that the files are not written for."""
    changes = advice(casts)
    if not changes:
        return ()
    text = f"plates.replications = {casts}: the files are for an even number of casts; {'; '.join(changes)}"
    return (Finding("replications", Severity.WARNING, text, float(casts), float(USUAL)),)
