"""The finishing of an FCStd file that was saved without a window: it opens visible and coloured, and holds the same
bytes for the same content.

FreeCAD keeps colours and visibility in ``GuiDocument.xml``, which only its GUI writes; without it every shape opens
hidden. And it writes clock, random identifiers and random object numbers into ``Document.xml``.
"""

from __future__ import annotations

import base64
import hashlib
import re
import uuid
import zipfile
from collections.abc import Mapping
from dataclasses import dataclass
from itertools import count
from pathlib import Path
from xml.sax.saxutils import quoteattr

EPOCH = (1980, 1, 1, 0, 0, 0)
"""The date of everything: the first one that a zip file can hold."""

DISPLAY_MODES = ("Flat Lines", "Shaded")
"""The first display modes of a Part view provider, in FreeCAD's order."""

AMBIENT = 0x33333300
"""What a body returns of the light from all sides, packed as red, green, blue, nothing."""


@dataclass(frozen=True)
class Look:
    """How an object opens in the GUI."""

    view: str
    """View provider, ``module:class``; "" for FreeCAD's own."""
    colour: tuple[float, float, float] | None = None
    """Red, green, blue in [0, 1]; `None` for what has no shape."""
    transparency: int = 0
    """Per cent."""
    edges: bool = True
    """Draw the edges (a field of fine channels would turn black)."""


def finish(saved: Path, looks: Mapping[str, Look], camera: str, target: Path) -> None:
    """Write ``target`` from the file that FreeCAD saved: with looks, and without clock or chance.

    Parameters
    ----------
    looks : name of an object -> its look.
    camera : Open Inventor text of the camera, see `isometric`.
    """
    with zipfile.ZipFile(saved) as archive:
        members = {name: archive.read(name) for name in archive.namelist()}
    members["Document.xml"] = _without_chance(members)
    members["GuiDocument.xml"] = _gui(looks, camera).encode()  # last: FreeCAD reads in the order of registration
    with zipfile.ZipFile(target, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, data in members.items():
            info = zipfile.ZipInfo(name, EPOCH)
            info.compress_type = zipfile.ZIP_DEFLATED
            archive.writestr(info, data)


def _without_chance(members: Mapping[str, bytes]) -> bytes:
    """``Document.xml`` with dates, object numbers and UUIDs that depend on the content alone."""
    text = members["Document.xml"].decode()
    dates = r'(name="(?:CreationDate|LastModifiedDate)"[^>]*>\s*<String value=")[^"]*'
    text = re.sub(dates, r"\g<1>1980-01-01T00:00:00Z", text)
    numbers = count(1)
    text = re.sub(r'(<Object type="[^"]*" name="[^"]*" id=")\d+', lambda hit: f"{hit[1]}{next(numbers)}", text)
    digest = hashlib.sha256(re.sub(r'<Uuid value="[^"]*"', "", text).encode())
    for name in sorted(members.keys() - {"Document.xml"}):
        digest.update(name.encode() + b"\0" + members[name])
    own = uuid.uuid5(uuid.NAMESPACE_OID, digest.hexdigest())
    order = count()
    text = re.sub(r'(<Uuid value=")[^"]*', lambda hit: f"{hit[1]}{uuid.uuid5(own, str(next(order)))}", text)
    return text.encode()


def _gui(looks: Mapping[str, Look], camera: str) -> str:
    """``GuiDocument.xml`` for objects that are all visible."""
    providers = "".join(_provider(name, look) for name, look in looks.items())
    return (
        '<?xml version="1.0" encoding="utf-8"?>\n<Document SchemaVersion="1">\n'
        f'<ViewProviderData Count="{len(looks)}">\n{providers}</ViewProviderData>\n'
        f"<Camera settings={quoteattr(camera)}/>\n</Document>\n"
    )


def _provider(name: str, look: Look) -> str:
    properties = [_property("Visibility", "App::PropertyBool", '<Bool value="true"/>')]
    if look.colour:
        properties += _surface(look)
    if look.view:
        module, _, cls = look.view.partition(":")
        none = base64.b64encode(b"null").decode()
        python = f'<Python value="{none}" encoded="yes" module="{module}" class="{cls}"/>'
        properties.append(_property("Proxy", "App::PropertyPythonObject", python))
    return (
        f'<ViewProvider name={quoteattr(name)} expanded="0"><Properties Count="{len(properties)}" TransientCount="0">\n'
        f"{''.join(properties)}</Properties></ViewProvider>\n"
    )


def _surface(look: Look) -> list[str]:
    """The properties of a view provider that draws a shape."""
    red, green, blue = (round(255 * part) for part in look.colour or (0, 0, 0))
    mode = DISPLAY_MODES.index("Flat Lines" if look.edges else "Shaded")
    rgba = red << 24 | green << 16 | blue << 8
    # The whole material and not its colour alone: FreeCAD 1.0's own shines, and what faces the eye is white.
    material = (
        f'<PropertyMaterial ambientColor="{AMBIENT}" diffuseColor="{rgba}" specularColor="0" emissiveColor="0" '
        f'shininess="0.2" transparency="{look.transparency / 100}"/>'
    )
    return [
        _property("ShapeMaterial", "App::PropertyMaterial", material),
        _property("Transparency", "App::PropertyPercent", f'<Integer value="{look.transparency}"/>'),
        _property("DisplayMode", "App::PropertyEnumeration", f'<Integer value="{mode}"/>'),
    ]


def _property(name: str, kind: str, value: str) -> str:
    return f'<Property name="{name}" type="{kind}">{value}</Property>\n'


def isometric(centre: tuple[float, float, float], diagonal: float) -> str:
    """The camera that sees a box of this centre and diagonal [mm] from the front, right and above."""
    x, y, z = (at + step * diagonal for at, step in zip(centre, (0.577350, -0.577350, 0.577350), strict=True))
    return (
        "OrthographicCamera { viewportMapping ADJUST_CAMERA "
        f"position {x:.6g} {y:.6g} {z:.6g} orientation 0.742906 0.307722 0.594473 1.217126 "
        f"nearDistance 0 farDistance {2 * diagonal:.6g} aspectRatio 1 "
        f"focalDistance {diagonal:.6g} height {diagonal:.6g} }}"
    )
