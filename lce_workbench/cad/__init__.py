"""Prisms become solids: build123d and cadquery headless, FreeCAD's Part in the document."""
