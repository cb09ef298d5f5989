"""What the benchmark of changes does inside FreeCAD's window."""

import time

CHANGES = {
    "depth": {"channels.depth_um": 0.7},
    "gap": {"sheet.gap_um": 150.0},
    "domains": {"output.step_domains": (3, 5)},
    "glass": {"plates.glass_mm": 1.1},
}


def changed(folder, profile=""):
    """Parameters changed while the domain table is open: seconds of the clock and of the processor, what recomputed."""
    import cProfile

    from gui_hands import activate, pump, run
    from session_steps import watch
    from view_steps import opened

    from lce_workbench.app import session

    activate()
    cell = opened(folder)
    doc, found = cell.Document, {}
    run("Domains")
    pump(1.0)
    recomputed = watch(doc)
    for name, settings in CHANGES.items():
        profiler, clock, began = cProfile.Profile(), time.monotonic(), time.process_time()
        if name == profile:
            profiler.enable()
        session.set_parameters(cell, settings)
        spent = time.process_time() - began
        if name == profile:
            profiler.dump_stats(f"{folder}/profile")
        pump(0.5)
        found[name] = [round(time.monotonic() - clock - 0.5, 2), round(spent, 2), recomputed()]
    found["domains_"] = doc.Design.Domains
    return found
