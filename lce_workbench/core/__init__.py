"""What there is: the job, the domains, channels, marks, mask and cell. No FreeCAD, no CAD kernel, no layout library."""
