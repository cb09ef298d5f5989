"""Documents that a FreeCAD without this workbench saved: their objects lost their proxies there, and get them back."""

from __future__ import annotations

import importlib
from typing import Any

KINDS = {
    "Section": "objects:Parameters",
    "Prisms": "objects:Body",
    "Energy": "results:DesignData",
    "Verdict": "results:PredictionData",
    "ChannelsTop": "results:MaskData",
    "Records": "results:ReviewData",
    "Figure": "drawings:DrawnFigure",
    "Svg": "drawings:DrawnSymbol",
}
"""A property that objects of one kind have and no others -> their proxy."""


def is_lost(obj: Any) -> bool:
    """Whether an object is one of ours without its proxy."""
    return getattr(obj, "Proxy", obj) is None and "SchemaVersion" in obj.PropertiesList


def revive(doc: Any) -> None:
    """Give what is lost its proxy and its view; it is computed with the next recompute, having been edited perhaps."""
    lost = [obj for obj in doc.Objects if is_lost(obj)]
    for obj in lost:
        module, name = next(KINDS[name] for name in obj.PropertiesList if name in KINDS).split(":")
        proxy = getattr(importlib.import_module(f"lce_workbench.app.{module}"), name)
        obj.Proxy = proxy.__new__(proxy)
    for obj in lost:  # after all have one: they look for each other
        obj.Proxy.onDocumentRestored(obj)
        obj.touch()
