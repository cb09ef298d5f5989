"""Verification of an output folder from its files alone.

Readers that are not ours (gdstk, ezdxf, OpenCASCADE, FreeCAD) read what was written; the formulae that it is held
against stand here once more, so that a fault in a writer or in the drawing cannot hide itself.
"""

from lce_workbench.verify.run import verify

__all__ = ["verify"]
