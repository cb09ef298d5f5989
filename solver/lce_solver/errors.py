"""What can go wrong for a reason the user can mend: each error is one sentence with a remedy and an exit code."""

from __future__ import annotations


class LceError(Exception):
    """A fault told in one sentence: what is wrong, where, and what to do."""

    exit_code = 1


class InputError(LceError):
    """The input is wrong: a broken mesh, an impossible parameter, a missing file."""

    exit_code = 2


class SolverError(LceError):
    """The solver did not reach its tolerance, or its result is not usable."""

    exit_code = 3


class EnvironmentFault(LceError):
    """The machine is at fault: a missing program, a full disk, no right to write."""

    exit_code = 4


class Cancelled(LceError):
    """The user stopped the run."""

    exit_code = 130
