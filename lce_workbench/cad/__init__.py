"""Prisms become solids: cadquery headless, FreeCAD's Part in the document."""
