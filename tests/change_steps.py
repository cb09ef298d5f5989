"""What the benchmark of changes does inside FreeCAD's window."""

import time

CHANGES = {
    "depth": {"channels.depth_um": 0.7},
    "gap": {"sheet.gap_um": 150.0},
    "domains": {"output.step_domains": (3, 5)},
    "glass": {"plates.glass_mm": 1.1},
}


HIDDEN = {"depth, hidden": {"channels.depth_um": 0.65}, "gap, hidden": {"sheet.gap_um": 140.0}}
"""With the bodies hidden: what is left is computing, without FreeCAD's meshing and drawing."""


def changed(folder):
    """Change -> seconds of the clock, of this thread and of all threads, and what was recomputed."""
    from gui_hands import activate, pump, run
    from session_steps import watch
    from view_steps import opened

    from lce_workbench.app import session, works

    activate()
    cell = opened(folder)
    found = {}
    run("Domains")
    pump(1.0)
    recomputed = watch(cell.Document)
    for name, settings in {**CHANGES, **HIDDEN}.items():
        for body in works.bodies(cell):
            body.ViewObject.Visibility = name in CHANGES
        clock, own, whole = time.monotonic(), time.thread_time(), time.process_time()
        session.set_parameters(cell, settings)
        spent = time.monotonic() - clock, time.thread_time() - own, time.process_time() - whole
        pump(0.5)
        found[name] = [*(round(seconds, 2) for seconds in spent), recomputed()]
    return found
