import lce_workbench  # noqa: F401  FreeCAD 1.1.1 restores proxies of modules that are loaded
