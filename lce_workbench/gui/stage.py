"""The nodes in the 3D view that show the state of a cell's view."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from pivy import coin

from lce_solver.errors import InputError, LceError
from lce_solver.types import Floats
from lce_workbench.app import cells, works
from lce_workbench.app.cuts import apart, cut
from lce_workbench.app.geometry import domains_of, fields_of, stored
from lce_workbench.app.objects import job_of, prisms_around
from lce_workbench.app.pictures import PICTURES, Picture, Shown, flat_skin
from lce_workbench.app.results import STALE
from lce_workbench.app.skins import Skin, domain_at, first_hit
from lce_workbench.core.channels import ChannelField
from lce_workbench.core.domains import Plate
from lce_workbench.gui import nodes
from lce_workbench.gui.camera import look_at, view_of
from lce_workbench.gui.legend import Legend, legend

MARKED = (0.90, 0.00, 0.45)
"""Colour of marked domains."""

REACH = 1e-3
"""Size of the legend's own world relative to what is shown."""

CLOSE = 6.0
"""Height of the view over the size of the domains that it goes to."""

STILL = 3
"""A mouse that moved less between press and release has clicked [pixels]."""


class Scene:
    """The state of a cell's view, and the nodes that show it."""

    def __init__(self, cell: Any) -> None:
        self.cell = cell
        self.id = cell.Document.Name, cell.Name
        self.name = ""
        """Of the picture; "" for the cell itself."""
        self.picture: Picture | None = None
        self.legend: Legend | None = None
        self.exploded = False
        self.cut_at: float | None = None
        """y of the section [mm]."""
        self.marked: tuple[int, ...] = ()
        self.domains = self.shown().domains
        """Those that are marked: with others nothing is."""
        self.document = cell.Document
        self.aside: dict[str, int] = {}
        """Name of an object that a picture puts aside -> what its switch showed."""
        self.lifts: dict[str, Any] = {}
        """Name of a body -> the node that moves it when the cell is taken apart."""
        self.key: Any = None
        """What the nodes were made for."""
        self.gone = False
        """Whether the cell does not exist any more."""
        self.picking = False
        """Whether a click marks a domain."""
        self.pressed = (0, 0)
        self.camera = ""
        """As it was before the first picture."""
        self.view = view_of(cell.Document)
        self.graph = self.view.getSceneGraph()
        self.front, self.clip, self.back, self.marks = (coin.SoGroup() for _ in range(4))
        for place, node in enumerate((self.front, self.clip)):
            self.graph.insertChild(node, place)
        for node in (self.back, self.marks):
            self.graph.addChild(node)
        self.listening = self.view.addEventCallback("SoMouseButtonEvent", self.clicked)

    def shown(self) -> Shown:
        """What there is to be shown, for the parameters as they are.

        Raises
        ------
        InputError
            There is no design.
        """
        works.require_design(self.cell)
        job, design = job_of(cells.sections(self.cell).values()), cells.design_of(self.cell)
        path, made_for = Path(design.File), cells.made_for(design)
        plan = stored(path, job, made_for)
        heating, hot = cells.result(self.cell, "PredictionData"), None
        if heating is not None and heating.File:
            with np.load(heating.File, allow_pickle=False) as data:
                hot = data["vertices"] if len(data["vertices"]) == len(plan.uv) else None
        sources = {"deviation": (heating,)}.get(self.name, (design,))
        stale = any(source is not None and source.Status.startswith(STALE) for source in sources)
        return Shown(plan, domains_of(path, job, made_for), job, hot, stale)

    def fields(self) -> Mapping[Plate, ChannelField]:
        """The channels of both plates."""
        job, design = job_of(cells.sections(self.cell).values()), cells.design_of(self.cell)
        return fields_of(Path(design.File), job, cells.made_for(design))

    def draw(self) -> None:
        """Make all nodes anew from the state.

        Raises
        ------
        LceError
            What is missing; then the cell itself is shown.
        """
        for node in (self.front, self.clip, self.back):
            node.removeAllChildren()
        self.picture, self.legend = None, None
        self.key = self.made_for()
        try:
            if self.name:
                self.picture = PICTURES[self.name](self.shown())
                self.legend = legend(self.picture)
        except LceError:
            self.name = ""
            raise
        finally:
            self.put_aside(bool(self.name))
            self.take_apart(0.0 if self.name or not self.exploded else self.width())
        if self.picture and self.legend:
            low, high = self.box()
            reach = REACH * float(np.linalg.norm(high - low))
            self.front.addChild(nodes.image(self.legend.pixels, self.legend.size, (low + high) / 2, reach))
            self.back.addChild(nodes.picture(self.picture))
        elif self.cut_at is not None:
            self.cut_open(self.cut_at)
        self.outline()

    def made_for(self) -> Any:
        """What the picture depends on: when it changes, it is drawn anew."""
        design, heating = cells.design_of(self.cell), cells.result(self.cell, "PredictionData")
        job = job_of(cells.sections(self.cell).values())
        files = [cells.digest(obj.File) for obj in (design, heating) if obj is not None]
        bodies = tuple(obj.Name for obj in works.bodies(self.cell))
        return self.name, files, job, bodies

    def box(self) -> tuple[Floats, Floats]:
        """Corners of the box around a picture [mm]."""
        points = np.concatenate([skin.points for skin in self.skins()])
        return points.min(axis=0), points.max(axis=0)

    def skins(self) -> tuple[Skin, ...]:
        """Where domains are seen and picked: in the picture, or on the film in the cell."""
        return self.picture.skins if self.picture else (flat_skin(self.shown().design),)

    def put_aside(self, away: bool) -> None:
        """Hide the document's objects behind a picture, or show again what it hid."""
        if away:
            for obj in self.document.Objects:
                if obj.getParentGeoFeatureGroup() is not None:
                    continue  # what holds it is hidden; the mesh that a target is taken from is linked, not held
                switch = getattr(obj.ViewObject, "SwitchNode", None)
                if switch is not None and switch.whichChild.getValue() != coin.SO_SWITCH_NONE:
                    self.aside[obj.Name] = switch.whichChild.getValue()
                    switch.whichChild = coin.SO_SWITCH_NONE
            return
        for name, child in self.aside.items():
            obj = self.document.getObject(name)
            if obj is not None and obj.ViewObject.Visibility:
                obj.ViewObject.SwitchNode.whichChild = child
        self.aside = {}

    def width(self) -> float:
        """Of the plates [mm]."""
        return float(max(np.ptp(part.outline, axis=0).min() for part in prisms_around(self.cell).parts))

    def take_apart(self, width: float) -> None:
        """Move the bodies along z, as far as parts of plates of this ``width`` [mm] go; 0 puts them together."""
        for body in works.bodies(self.cell):
            lift, root = self.lifts.setdefault(body.Name, coin.SoTranslation()), body.ViewObject.RootNode
            if root.findChild(lift) < 0:  # a new body, or one that an undo brought back
                root.insertChild(lift, 0)
            lift.translation = (0.0, 0.0, apart(body.Prisms, width))

    def cut_open(self, y: float) -> None:
        """Hide what is before the plane at ``y`` [mm], and fill the solids that it goes through."""
        around = prisms_around(self.cell)
        width = self.width() if self.exploded else 0.0
        names = {body.Prisms for body in works.bodies(self.cell)}
        pieces, colours = [], []
        for found in cut([p for p in (*around.parts, *around.channels) if names & {p.name, p.group}], y):
            at = np.full((*found.quads.shape[:2], 3), y)
            at[..., 0], at[..., 2] = found.quads[..., 0], found.quads[..., 1] + apart(found.name, width)
            pieces.append(at)
            colours += [found.colour] * len(at)
        if pieces:
            self.front.addChild(nodes.quads(np.concatenate(pieces), colours))
        plane = coin.SoClipPlane()
        plane.plane = coin.SbPlane(coin.SbVec3f(0.0, 1.0, 0.0), y)
        self.clip.addChild(plane)

    def outline(self) -> None:
        """Draw the marked domains."""
        self.marks.removeAllChildren()
        domains, former = self.shown().domains, self.domains
        self.domains = domains
        if not all(np.array_equal(getattr(domains, n), getattr(former, n)) for n in ("polygons", "vertices")):
            self.marked = ()
        if not self.marked:
            return
        lines = []
        for skin in self.skins():
            for domain in self.marked:
                ring = domains.ring(domain)
                lines.append(skin.lift(np.concatenate([ring, ring[:1]])))
        self.marks.addChild(nodes.polylines(lines, MARKED, 3.0))

    def mark(self, domains: tuple[int, ...], *, go: bool = False) -> None:
        """Mark domains, and tell those who want to know; ``go`` turns the camera to them.

        Raises
        ------
        InputError
            There is no such domain, or no design.
        """
        count = len(self.shown().domains)
        for domain in domains:
            if not 0 <= domain < count:
                msg = f"there is no domain {domain}; the design has 0 to {count - 1}"
                raise InputError(msg)
        self.marked = domains
        self.outline()
        if go and domains:
            self.go_to()
        for watcher in WATCHERS:
            watcher(self)

    def go_to(self) -> None:
        """Turn the camera to the marked domains."""
        domains = self.shown().domains
        rings = np.concatenate([domains.ring(domain) for domain in self.marked])
        points = self.skins()[0].lift(rings)
        size = float(np.linalg.norm(np.ptp(points, axis=0)))
        look_at(self.view, (points.min(axis=0) + points.max(axis=0)) / 2, CLOSE * size)

    def pick(self, pixel: tuple[int, int]) -> int | None:
        """The domain that is seen at a pixel, from the lower left corner of the view; `None` beside the sheet."""
        start, end = (np.array(point) for point in self.view.projectPointToLine(*pixel))
        flat = first_hit(self.skins(), start, end - start)
        return None if flat is None else domain_at(self.shown().domains, flat)

    def clicked(self, event: dict[str, Any]) -> None:
        """Mark the domain that was clicked, while domains are picked; with Ctrl, besides the others or no more."""
        if not self.picking or event["Button"] != "BUTTON1":
            return
        place, down, more = event["Position"], event["State"] == "DOWN", event["CtrlDown"]
        if down:
            self.pressed = place
        still = np.abs(np.subtract(place, self.pressed)).max() <= STILL
        if still and down == more:  # a press with Ctrl turns nothing, and FreeCAD 1.0 keeps its release for itself
            domain = self.pick(place)
            if domain is not None:
                self.mark(tuple(sorted({*self.marked} ^ {domain})) if more else (domain,))

    def leave(self) -> None:
        """Let the solids be as if there were no scene."""
        for lift in self.lifts.values():
            lift.translation = (0.0, 0.0, 0.0)
        self.put_aside(False)

    def close(self) -> None:
        """Leave the view of a cell that is gone."""
        self.view.removeEventCallback("SoMouseButtonEvent", self.listening)
        for node in (self.front, self.clip, self.back, self.marks):
            self.graph.removeChild(node)
        self.leave()


WATCHERS: list[Callable[[Scene], None]] = []
"""Who wants to know that domains were marked, or that a scene was drawn anew."""
