"""Inverse design of thin nematic elastomer sheets (Aharoni et al., "Making Faces"), without FreeCAD and without CAD."""

__version__ = "0.1.0"
