"""Prisms become solids (cadquery headless, FreeCAD's Part in the document) and STEP files (without a kernel)."""
