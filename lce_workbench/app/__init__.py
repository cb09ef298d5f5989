"""FreeCAD without a window."""
