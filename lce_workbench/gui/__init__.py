"""FreeCAD with a window."""
