"""What the tests of the document do inside FreeCAD."""

from dataclasses import fields

from lce_workbench.core.job import Job


def round_trip(toml: str, path: str) -> list[str]:
    """Write every section of a job to properties, save, open, read; return the jobs before and after as text."""
    import FreeCAD
    from lce_workbench.app.properties import declare, read, write
    from lce_workbench.core import jobfile

    job = jobfile.parse(toml)
    doc = FreeCAD.newDocument("Properties")
    for section in fields(Job):
        obj = doc.addObject("App::FeaturePython", section.name)
        declare(obj, type(getattr(job, section.name)), section.name)
        write(obj, getattr(job, section.name))
        declare(obj, type(getattr(job, section.name)), section.name)
    doc.saveAs(path)
    FreeCAD.closeDocument(doc.Name)
    doc = FreeCAD.openDocument(path)
    parts = {f.name: read(doc.getObject(f.name), type(getattr(job, f.name))) for f in fields(Job)}
    return [repr(job), repr(Job(**parts))]
