"""What there is: the job, the domains, channels, marks, mask and cell. Pure: no FreeCAD, no CAD kernel, no files."""
