"""Draws the cell closed, exploded and cut open, and 30 um of a comb: .venv/bin/python resources/pictures/cell.py OUT"""

import sys
from dataclasses import replace
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT), str(ROOT / "solver")]

import vtkmodules.vtkRenderingOpenGL2  # noqa: E402, F401
from vtkmodules.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray  # noqa: E402
from vtkmodules.vtkCommonCore import vtkPoints  # noqa: E402
from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkPlane, vtkPlaneCollection, vtkPolyData  # noqa: E402
from vtkmodules.vtkFiltersCore import vtkFeatureEdges  # noqa: E402
from vtkmodules.vtkFiltersGeneral import vtkClipClosedSurface  # noqa: E402
from vtkmodules.vtkIOImage import vtkPNGWriter  # noqa: E402
from vtkmodules.vtkRenderingCore import (  # noqa: E402
    vtkActor,
    vtkPolyDataMapper,
    vtkRenderer,
    vtkRenderWindow,
    vtkWindowToImageFilter,
)

from lce_workbench.cad.meshes import triangulated  # noqa: E402
from lce_workbench.core import jobfile  # noqa: E402
from lce_workbench.core.closed import closed  # noqa: E402
from lce_workbench.core.prism import bodies  # noqa: E402
from lce_workbench.divided import read_domains  # noqa: E402
from lce_workbench.outputs import read_design  # noqa: E402

APART = {"bottom": -8.0, "spacer": -2.5, "glue": -2.5, "sheet": 0.0, "top": 8.0, "alignment": -12.0}
"""How far parts move in the exploded view [mm]."""


HALF = 0.015
"""Half the side of the window [mm]."""

SECTION = (0.0, -1.0, 0.1)
"""Whence the section is seen."""


def surface(stack, lift=0.0):
    points, triangles = triangulated(stack)
    points = points + np.array([0.0, 0.0, lift])
    data, at, cells = vtkPolyData(), vtkPoints(), vtkCellArray()
    at.SetData(numpy_to_vtk(points, deep=True))
    rows = np.insert(triangles, 0, 3, axis=1).ravel().astype(np.int64)
    cells.ImportLegacyFormat(numpy_to_vtkIdTypeArray(rows, deep=True))
    data.SetPoints(at)
    data.SetPolys(cells)
    return data


def halved(data, y):
    """What lies behind a plane, with the faces where it cuts."""
    return cut(data, [((0, y, 0), (0, 1, 0))])


def windowed(data, x, y):
    """What lies in the square about a point."""
    return cut(data, [((x - HALF * a, y - HALF * b, 0), (a, b, 0)) for a, b in ((1, 0), (-1, 0), (0, 1), (0, -1))])


def cut(data, sides):
    """What lies on the inner side of planes: a point of each and its normal."""
    planes, clip = vtkPlaneCollection(), vtkClipClosedSurface()
    for origin, normal in sides:
        plane = vtkPlane()
        plane.SetOrigin(*origin)
        plane.SetNormal(*normal)
        planes.AddItem(plane)
    clip.SetInputData(data)
    clip.SetClippingPlanes(planes)
    clip.SetTolerance(1e-9)
    clip.Update()
    return clip.GetOutput()


def actor(data, colour, opacity, edges=True):
    found = []
    for feature in (False, True)[: 1 + edges]:
        mapper, shown = vtkPolyDataMapper(), vtkActor()
        if feature:
            lines = vtkFeatureEdges()
            lines.SetInputData(data)
            lines.SetFeatureAngle(20)
            lines.ColoringOff()
            mapper.SetInputConnection(lines.GetOutputPort())
            mapper.ScalarVisibilityOff()
            shown.GetProperty().SetColor(0.15, 0.15, 0.18)
            shown.GetProperty().SetOpacity(0.6)
        else:
            mapper.SetInputData(data)
            shown.GetProperty().SetColor(*colour)
            shown.GetProperty().SetOpacity(opacity)
            shown.GetProperty().SetAmbient(0.45)
            shown.GetProperty().SetDiffuse(0.6)
        shown.SetMapper(mapper)
        found.append(shown)
    return found


def draw(actors, path, centre, height=0.0, towards=(0.6, -1.0, 0.75)):
    scene, window = vtkRenderer(), vtkRenderWindow()
    scene.SetBackground(1, 1, 1)
    for each in actors:
        scene.AddActor(each)
    window.SetOffScreenRendering(1)
    window.SetSize(900, 640)
    window.SetMultiSamples(0)
    window.SetAlphaBitPlanes(1)
    window.AddRenderer(scene)
    scene.SetUseDepthPeeling(1)
    scene.SetMaximumNumberOfPeels(30)
    scene.SetOcclusionRatio(0.0)
    camera = scene.GetActiveCamera()
    camera.ParallelProjectionOn()
    camera.SetFocalPoint(*centre)
    camera.SetPosition(*(np.array(centre) + 100 * (height or 50.0) * np.array(towards)))
    camera.SetViewUp(0, 0, 1)
    if height:
        camera.SetParallelScale(height / 2)
    else:
        scene.ResetCamera()
        camera.Zoom(1.25)
    scene.ResetCameraClippingRange()
    window.Render()
    picture, file = vtkWindowToImageFilter(), vtkPNGWriter()
    picture.SetInput(window)
    file.SetInputConnection(picture.GetOutputPort())
    file.SetFileName(str(path))
    file.Write()


def main(out):
    job = jobfile.load(out / "job.toml")
    cell = closed(read_design(out / "design.npz"), read_domains(out / "design.npz"), job)
    parts = bodies(cell.parts)
    folder = Path(__file__).parent
    looks = {name: (stack[0].colour, stack[0].opacity) for name, stack in parts.items()}
    shown = [a for n, stack in parts.items() for a in actor(surface(stack), *looks[n])]
    draw(shown, folder / "cell_closed.png", (0, 0, 0))
    lifted = [a for n, stack in parts.items() for a in actor(surface(stack, lift=APART[n.split("_")[0]]), *looks[n])]
    draw(lifted, folder / "cell_exploded.png", (0, 0, -3))
    rim = parts["spacer_left"][0].outline[:, 0].max()
    opened = [a for n, stack in parts.items() for a in actor(halved(surface(stack), 0.0), looks[n][0], 1.0)]
    draw(opened, folder / "cell_section.png", (rim + 0.3, 0, 0), 2.4, SECTION)
    comb = bodies(cell.combs)[f"comb_{cell.chosen[0]:04d}_bottom"]
    (x, y), z = cell.domains.centroid[cell.chosen[0]], comb[0].z1
    square = np.array([(x - HALF, y - HALF), (x + HALF, y - HALF), (x + HALF, y + HALF), (x - HALF, y + HALF)])
    below = replace(parts["bottom_epoxy"][0], outline=square, z0=comb[0].z0 - 2e-3, z1=comb[0].z0)
    shown = actor(windowed(surface(comb), x, y), comb[0].colour, 1.0) + actor(surface([below]), below.colour, 1.0)
    draw(shown, folder / "window_30um.png", (x, y, z - 1e-3), 0.036)


if __name__ == "__main__":
    main(Path(sys.argv[1]))
