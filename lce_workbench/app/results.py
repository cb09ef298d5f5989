"""What takes long to compute and is kept in the document: design, prediction, masks, review.

Each remembers the values it was made for. When one of them changes, it is not computed anew but says that it is stale,
in its property `Status`, its label and its icon.
"""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

from lce_solver.errors import InputError
from lce_workbench.app import cells
from lce_workbench.app.geometry import fields_of, is_rough, stored
from lce_workbench.app.objects import FILES, HIDDEN, READ_ONLY, Proxy, add, job_of
from lce_workbench.core import jobfile
from lce_workbench.core.domains import PLATES
from lce_workbench.core.marks import fingerprint
from lce_workbench.core.uses import USES, sections, values

MISSING, CURRENT, STALE = "not computed", "current", "stale"
"""How a state begins."""

ROUGH = f"{CURRENT}, but not corrected for this film yet; Predict, Mask or Export does it"
"""A design whose twist follows the film's thickness by the formula alone."""

LOST = f"{STALE}: its file is not in this document, which is damaged"
"""A design without its file."""

MARK = " (stale)"
"""What a stale result adds to its label."""

Values = dict[str, Any]


class Result(Proxy):
    """A result and the values it was made for."""

    VIEW = "lce_workbench.gui.views:ResultView"

    def setup(self, obj: Any) -> None:
        super().setup(obj)
        add(obj, "App::PropertyString", "Status", "Whether it is what the parameters say now", MISSING, mode=READ_ONLY)
        add(obj, "App::PropertyString", "MadeFor", "Values that it was made for", mode=HIDDEN)
        add(obj, "App::PropertyLinkListGlobal", "Parameters", "What it is made from")

    def onDocumentRestored(self, obj: Any) -> None:  # noqa: N802 - FreeCAD's name
        """Tell the status of a result from before there was one."""
        super().onDocumentRestored(obj)
        if obj.Status == MISSING or self.state(obj) == LOST:
            obj.Status = self.state(obj)

    def compute(self, obj: Any) -> None:
        """Compare with the parameters."""
        obj.Status = self.state(obj)
        stale, label = obj.Status.startswith(STALE), obj.Label.removesuffix(MARK)
        if obj.Label != label + MARK * stale:
            obj.Label = label + MARK * stale

    def state(self, obj: Any) -> str:
        """`MISSING`, `CURRENT`, or what makes it stale."""
        if not obj.MadeFor:
            return MISSING
        words = difference(self.values(obj), json.loads(obj.MadeFor))
        return f"{STALE}: {words}" if words else CURRENT

    def values(self, obj: Any) -> Values:
        """Name -> value of all that it would be made for now."""
        raise NotImplementedError

    def summary(self, obj: Any) -> str:
        """What came out, in one sentence."""
        raise NotImplementedError

    def remember(self, obj: Any) -> None:
        """Note that it is made for what the parameters are now."""
        obj.MadeFor = json.dumps(self.values(obj))


def difference(now: Values, then: Values) -> str:
    """The first value that changed, in words; "" when none did."""
    now, then = json.loads(json.dumps(now)), json.loads(json.dumps(then))  # tuples become lists, as in a document
    for name, value in then.items():
        if not _same(value, now.get(name)):
            told = f"{name} is now {now.get(name)!r}, this was made for {value!r}"
            return f"{name} changed since this was made" if name in FILES or name == "design" else told
    return ""


def _same(one: Any, other: Any) -> bool:
    if isinstance(one, float) and isinstance(other, float):
        return math.isclose(one, other, rel_tol=1e-9)  # FreeCAD keeps 16 decimals
    return bool(one == other)


class DesignData(Result):
    """The solved metric and the twist that follows from it, stored inside the document."""

    SECTIONS = (*jobfile.METRIC_SECTIONS, "prediction")

    def setup(self, obj: Any) -> None:
        super().setup(obj)
        add(obj, "App::PropertyFileIncluded", "File", "The design (design.npz), kept inside this document")
        add(obj, "App::PropertyString", "Job", "The job that it was solved for", mode=HIDDEN)
        add(obj, "App::PropertyString", "Manifest", "What was found when it was solved", mode=HIDDEN)
        add(obj, "App::PropertyInteger", "Domains", "Number of domains", mode=READ_ONLY)
        add(obj, "App::PropertyLength", "Width", "Width of the flat sheet (x)", mode=READ_ONLY)
        add(obj, "App::PropertyLength", "Height", "Height of the flat sheet (y)", mode=READ_ONLY)
        add(obj, "App::PropertyAngle", "LargestTwist", "Largest twist from bottom to top", mode=READ_ONLY)
        add(obj, "App::PropertyFloat", "Energy", "Final energy of the metric, per area of the target", mode=READ_ONLY)

    def values(self, obj: Any) -> Values:
        found = jobfile.metric_values(job_of(obj.Parameters))
        files = {p.Section: cells.digest(p.File) for p in obj.Parameters if p.Section in FILES and p.File}
        return {**found, **files}

    def summary(self, obj: Any) -> str:
        """Domains, size, twist."""
        size = f"{obj.Width.Value:.4g} x {obj.Height.Value:.4g} mm"
        return f"{obj.Domains} domains in a sheet of {size}, twisted by {obj.LargestTwist.Value:.3g} deg at most"

    def state(self, obj: Any) -> str:
        """As of every result; and whether its file is there, and its twist was corrected."""
        if obj.File and not Path(obj.File).is_file():
            return LOST
        found = super().state(obj)
        return ROUGH if found == CURRENT and is_rough(job_of(obj.Parameters), cells.made_for(obj)) else found

    def compute(self, obj: Any) -> None:
        """Tell the state, and the figures for the film as it is now."""
        super().compute(obj)
        if not obj.File or obj.Status == LOST:
            return
        design = stored(Path(obj.File), job_of(obj.Parameters), cells.made_for(obj))
        obj.Domains = len(design.theta)
        obj.Width, obj.Height = (design.uv.max(axis=0) - design.uv.min(axis=0)).tolist()
        obj.LargestTwist = math.degrees(abs(design.dtheta).max())
        obj.Energy = float(design.flattening.energy[-1])


class Outcome(Result):
    """What is made from a design."""

    USES: tuple[str, ...] = ()
    """Parameters that it is made from besides."""

    def setup(self, obj: Any) -> None:
        super().setup(obj)
        add(obj, "App::PropertyLinkGlobal", "Design", "The design that it is made for")

    def compute(self, obj: Any) -> None:
        """Compare with the parameters.

        Raises
        ------
        InputError
            The design was deleted.
        """
        if obj.Design is None:
            msg = f"{obj.Label} has lost its design; undo its deletion, or start a new cell"
            raise InputError(msg)
        super().compute(obj)

    def state(self, obj: Any) -> str:
        found = super().state(obj)
        stale = found == CURRENT and not obj.Design.Status.startswith(CURRENT)
        return f"{STALE}: the design is {obj.Design.Status}" if stale else found

    def values(self, obj: Any) -> Values:
        return {"design": cells.digest(obj.Design.File), **values(job_of(obj.Parameters), self.USES)}


class PredictionData(Outcome):
    """The shape that the heated sheet takes."""

    USES = USES["prediction"]
    SECTIONS = sections(USES)

    def setup(self, obj: Any) -> None:
        super().setup(obj)
        add(obj, "App::PropertyFileIncluded", "File", "The shapes (prediction.npz), kept inside this document")
        add(obj, "App::PropertyString", "Verdict", "What the heated sheet becomes", mode=READ_ONLY)
        add(obj, "App::PropertyFloat", "Rms", "Distance from the target, rms, in % of its diagonal", mode=READ_ONLY)
        add(obj, "App::PropertyFloat", "Max", "Largest distance from the target, in % of its diagonal", mode=READ_ONLY)
        add(obj, "App::PropertyBool", "Mirrored", "Whether it becomes the mirror image", mode=READ_ONLY)

    def summary(self, obj: Any) -> str:
        """The verdict of the judge."""
        from lce_solver.compare import Verdict  # needs SciPy, without which a document opens and follows its parameters

        verdict = Verdict[obj.Verdict.upper()].value
        return f"{verdict}, {obj.Rms:.2g} % of the target's diagonal away (rms), {obj.Max:.2g} % at most"


class MaskData(Outcome):
    """The masks of both plates: their channels now, and where they were written last."""

    USES = USES["mask"]
    SECTIONS = sections(USES)

    def setup(self, obj: Any) -> None:
        super().setup(obj)
        add(obj, "App::PropertyString", "Folder", "Where the masks were written last", mode=READ_ONLY)
        add(obj, "App::PropertyInteger", "ChannelsBottom", "Channels of the bottom plate", mode=READ_ONLY)
        add(obj, "App::PropertyInteger", "ChannelsTop", "Channels of the top plate", mode=READ_ONLY)
        add(obj, "App::PropertyString", "Code", "The design's code, as printed on the plates", mode=READ_ONLY)

    def compute(self, obj: Any) -> None:
        """Count the channels for the film as it is now."""
        super().compute(obj)
        if not obj.Design.File:
            return
        fields = fields_of(Path(obj.Design.File), job_of(obj.Parameters), cells.made_for(obj.Design))
        obj.ChannelsBottom, obj.ChannelsTop = (int(fields[plate].counts.sum()) for plate in PLATES)
        obj.Code = fingerprint(fields["bottom"].domains, fields["bottom"].spec)

    def summary(self, obj: Any) -> str:
        """Channels and place."""
        return f"{obj.ChannelsBottom} and {obj.ChannelsTop} channels; the files are in {obj.Folder}"


class ReviewData(Outcome):
    """What was found in the cell, and in the written files."""

    USES = USES["review"]
    SECTIONS = sections(USES)

    def setup(self, obj: Any) -> None:
        super().setup(obj)
        add(obj, "App::PropertyString", "Folder", "The output folder that was reviewed, if any was", mode=READ_ONLY)
        add(obj, "App::PropertyInteger", "Errors", "Findings that forbid fabrication", mode=READ_ONLY)
        add(obj, "App::PropertyInteger", "Warnings", "Findings to look at", mode=READ_ONLY)
        add(obj, "App::PropertyStringList", "Findings", "What the checks measured", mode=READ_ONLY)
        add(obj, "App::PropertyStringList", "Records", "The same with values, limits and places, as JSON", mode=HIDDEN)

    def summary(self, obj: Any) -> str:
        """How much was found."""
        place = f"; the files are in {obj.Folder}" if obj.Folder else ""
        return f"errors: {obj.Errors}, warnings: {obj.Warnings}{place}"


RESULTS: dict[str, tuple[type[Result], str]] = {
    "Design": (DesignData, "Design"),
    "Prediction": (PredictionData, "Prediction"),
    "Mask": (MaskData, "Mask"),
    "Review": (ReviewData, "Review"),
}
"""Name of an object -> its proxy and label, in the order of the work."""
