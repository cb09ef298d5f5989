"""Arrays as nodes of the 3D view's scene graph."""

from __future__ import annotations

import ctypes
from collections.abc import Sequence
from typing import Any

import numpy as np
from pivy import coin

from lce_workbench.app.colours import packed
from lce_workbench.app.pictures import Picture, Strokes
from lce_workbench.app.skins import Skin

BORDER = np.array([[0.20, 0.23, 0.27]])
"""Of the pieces of a section."""


CORNER = (0.48, -0.40, 0.98)
"""Where an image stands in the box that its camera sees: right, below, before everything."""


def fill(field: Any, values: Any, dtype: str) -> None:
    """Copy an array into a field. Pivy's own way asks Python for every number: 1.4 s for 1.5 million lines."""
    array = np.ascontiguousarray(values, dtype=dtype)
    field.setNum(len(array))
    if len(array):
        first = field.startEditing()
        ctypes.memmove(int(getattr(first, "this", first)), array.ctypes.data, array.nbytes)
        field.finishEditing()


def group(*children: Any) -> Any:
    """Nodes whose settings stay among them; they are culled together."""
    node = coin.SoSeparator()
    node.renderCulling = coin.SoSeparator.ON
    node.renderCaching = coin.SoSeparator.OFF
    for child in children:
        node.addChild(child)
    return node


def flat_light() -> Any:
    """Colours as they are, whatever way they face."""
    node = coin.SoLightModel()
    node.model = coin.SoLightModel.BASE_COLOR
    return node


def picture(shown: Picture) -> Any:
    """All of a picture but its legend; what is drawn behind the lines is moved back a little."""
    back = coin.SoPolygonOffset()
    above = coin.SoDirectionalLight()
    above.direction, above.intensity = (0.3, 0.3, -1.0), 0.3
    skins = group(back, above, *(skin(one) for one in shown.skins))
    return group(skins, *(strokes(one) for one in shown.strokes))


def skin(shown: Skin) -> Any:
    """A sheet, lit from both sides; one that is flat shows its colours as they are."""
    hints, coordinates, faces = coin.SoShapeHints(), coin.SoCoordinate3(), coin.SoIndexedFaceSet()
    hints.vertexOrdering = coin.SoShapeHints.COUNTERCLOCKWISE
    hints.creaseAngle = 0.6
    fill(coordinates.point, shown.points, "f4")
    fill(faces.coordIndex, np.insert(shown.faces, 3, -1, axis=1).ravel(), "i4")
    colours, binding = coin.SoPackedColor(), coin.SoMaterialBinding()
    fill(colours.orderedRGBA, packed(shown.colours), "u4")
    binding.value = _binding(shown)
    light = [flat_light()] if not np.ptp(shown.points[:, 2]) else []
    return group(*light, hints, coordinates, colours, binding, faces)


def _binding(shown: Skin) -> Any:
    """Whether colours are those of the whole, of faces or of vertices."""
    binding = coin.SoMaterialBinding
    found = {len(shown.points): binding.PER_VERTEX_INDEXED, len(shown.faces): binding.PER_FACE, 1: binding.OVERALL}
    return found[len(shown.colours)]


def strokes(shown: Strokes) -> Any:
    """Lines of a width in pixels."""
    style, lines, points = coin.SoDrawStyle(), coin.SoLineSet(), coin.SoVertexProperty()
    style.lineWidth = shown.width
    fill(points.vertex, shown.ends, "f4")
    fill(points.orderedRGBA, packed(shown.colours), "u4")
    one = len(shown.colours) == 1
    points.materialBinding = coin.SoVertexProperty.OVERALL if one else coin.SoVertexProperty.PER_PART
    fill(lines.numVertices, np.full(len(shown), 2), "i4")
    lines.vertexProperty = points
    return group(flat_light(), style, lines)


def polylines(lines: Sequence[Any], colour: tuple[float, float, float], width: float) -> Any:
    """Lines through points (k, 3), seen through everything."""
    style, front, node, points = coin.SoDrawStyle(), coin.SoDepthBuffer(), coin.SoLineSet(), coin.SoVertexProperty()
    style.lineWidth = width
    front.test = False
    fill(points.vertex, np.concatenate(lines), "f4")
    fill(points.orderedRGBA, packed([colour]), "u4")
    fill(node.numVertices, [len(line) for line in lines], "i4")
    node.vertexProperty = points
    return group(flat_light(), front, style, node)


def quads(pieces: Any, colours: Any) -> Any:
    """Filled quadrilaterals (n, 4, 3) with their borders, in the colours (n, 3)."""
    faces, points = coin.SoFaceSet(), coin.SoVertexProperty()
    fill(points.vertex, pieces.reshape(-1, 3), "f4")
    fill(points.orderedRGBA, packed(colours), "u4")
    points.materialBinding = coin.SoVertexProperty.PER_PART
    fill(faces.numVertices, np.full(len(pieces), 4), "i4")
    faces.vertexProperty = points
    sides = np.stack([pieces, np.roll(pieces, -1, axis=1)], axis=2).reshape(-1, 3)
    return group(flat_light(), group(coin.SoPolygonOffset(), faces), strokes(Strokes(sides, BORDER)))


def image(pixels: bytes, size: tuple[int, int], middle: Any, reach: float) -> Any:
    """An image in the lower right corner, whatever the camera does.

    It has a camera of its own, which sees a box of size ``reach`` [mm] about ``middle`` (3,) only: small, and in the
    middle of what is shown, so that nothing changes for "fit all".
    """
    camera, place, node = coin.SoOrthographicCamera(), coin.SoTranslation(), coin.SoImage()
    camera.viewportMapping = coin.SoCamera.LEAVE_ALONE
    camera.aspectRatio, camera.height = 1.0, reach
    camera.position = (middle + np.multiply(reach, (0, 0, 1))).tolist()
    camera.nearDistance, camera.farDistance = 0.0, 2 * reach
    place.translation = (middle + np.multiply(reach, CORNER)).tolist()
    node.image.setValue(coin.SbVec2s(*size), 4, pixels)
    node.horAlignment, node.vertAlignment = coin.SoImage.RIGHT, coin.SoImage.BOTTOM
    return group(flat_light(), camera, place, node)
