import FreeCADGui

from lce_workbench.gui.workbench import LceWorkbench

FreeCADGui.addWorkbench(LceWorkbench())
