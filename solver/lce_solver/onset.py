"""Where a flat sheet first leaves its plane: there, and not at the end, it takes the target's side or the other."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from lce_solver.shell import Film
from lce_solver.shell_energy import bent_form, bias
from lce_solver.twist import twist
from lce_solver.types import Floats, Prediction


@dataclass(frozen=True, eq=False)
class Onset:
    """A film as it buckles."""

    film: Film
    buckled: bool
    """Whether it does: a sheet that stays flat has no side to take."""
    lambda_: float
    """Stretch along the director after the first step that leaves the sheet out of its plane."""
    shape: Floats
    """(n_v, 3) the sheet then [mm]."""
    lever: Floats
    """(n_f,) by how much a twist favours the target over its mirror image [bending energies of a sheet without twist,
    per radian]."""

    @property
    def favour(self) -> float:
        """By how much the film's twist does."""
        return float(self.lever @ self.film.dtheta)

    def lacking(self, wanted: float) -> Floats:
        """(n_f,) twist to add [rad], so that it favours the target by ``wanted``.

        A dome has no bending that twist could carry, but it has some along its edge while it rises: the shape at that
        moment says which twist helps it most.
        """
        if not self.buckled or self.favour >= wanted:
            return np.zeros_like(self.film.dtheta)
        hot = replace(self.film.material, lambda_=self.lambda_)
        best = np.abs(twist(bent_form(self.film.sheet, self.shape), self.film.theta, hot, self.film.thickness))
        best *= np.sign(self.lever)
        added: Floats = min(1.0, (wanted - self.favour) / float(self.lever @ best)) * best
        return added


def onset(film: Film, heated: Prediction, *, mirrored: bool) -> Onset:
    """Find where a heating from flat left the plane; ``mirrored`` says that it ended in the target's mirror image."""
    off = [np.linalg.svd(x - x.mean(axis=0), compute_uv=False)[-1] / np.sqrt(len(x)) for x in heated.frames]
    buckled = np.array(off) > film.thickness
    step = int(np.argmax(buckled)) if buckled.any() else -1
    lambda_, shape = heated.history[step].lambda_, heated.frames[step]
    plain, unit = (replace(film, dtheta=np.full_like(film.dtheta, twisted)).at(lambda_) for twisted in (0, 1))
    lever = bias(film.sheet, plain, unit, shape)
    return Onset(film, bool(buckled.any()), lambda_, shape, -lever if mirrored else lever)
