"""Sections of the job as FreeCAD properties and back, from their one declaration in `lce_workbench.core.job`."""

from __future__ import annotations

import re
import types
import typing
from dataclasses import Field, dataclass, fields
from decimal import Decimal
from functools import cache
from typing import Any

UNITS = {"um": ("App::PropertyDistance", -3), "mm": ("App::PropertyDistance", 0), "deg": ("App::PropertyAngle", 0)}
"""Unit of a parameter -> type of its property, and the places its decimal point moves on the way to FreeCAD's unit.

Not `App::PropertyLength`, which makes 0 of what is negative: an overlay may be, and what may not be is told so.
"""

TYPES: dict[Any, str] = {
    bool: "App::PropertyBool",
    int: "App::PropertyInteger",
    float: "App::PropertyFloat",
    str: "App::PropertyString",
    tuple[str, ...]: "App::PropertyStringList",
    tuple[int, ...]: "App::PropertyIntegerList",
}
"""Type of a parameter without such a unit -> type of its property."""


TAKEN = {"Label": "PrintedLabel"}
"""Names that every object of FreeCAD has already -> what we use instead."""


@dataclass(frozen=True)
class Property:
    """One parameter of a section and its property."""

    field: str
    name: str
    """Name of the property: the field's in CamelCase without the unit, which FreeCAD shows itself."""
    type: str
    kind: Any
    """Python type of the value, without `None`."""
    places: int
    """The decimal point moves by this many places from the parameter to the property."""
    choices: tuple[str, ...]
    doc: str
    given: str
    """Name of the tick beside an optional parameter (FreeCAD has no empty value); "" for the others."""

    def write(self, obj: Any, value: Any) -> None:
        """Set the property to the parameter's value."""
        if self.given:
            setattr(obj, self.given, value is not None)
        if value is not None:
            setattr(obj, self.name, list(value) if isinstance(value, tuple) else self.shifted(value, self.places))

    def read(self, obj: Any) -> Any:
        """Return the parameter's value."""
        if self.given and not getattr(obj, self.given):
            return None
        value = getattr(obj, self.name)
        plain = getattr(value, "Value", value)  # a quantity, in mm or degrees
        if typing.get_origin(self.kind) is tuple:
            return tuple(plain)
        return self.shifted(self.kind(plain), -self.places)

    @staticmethod
    def shifted(value: Any, places: int) -> Any:
        """The number with its decimal point moved."""
        # Moving the decimal point is exact where a product with 1e-3 is not: 0.7 um is 0.0007 mm and 0.7 um again.
        return float(Decimal(repr(float(value))).scaleb(places)) if places else value


@cache
def properties(section: type) -> tuple[Property, ...]:
    """The properties that stand for the fields of a section."""
    hints = typing.get_type_hints(section)
    return tuple(_property(field, hints[field.name]) for field in fields(section))


def _property(field: Field[Any], hint: Any) -> Property:
    optional = isinstance(hint, types.UnionType)
    kind = next(k for k in typing.get_args(hint) if k is not types.NoneType) if optional else hint
    type_, places = UNITS.get(field.metadata["unit"]) or (TYPES[kind], 0)
    name = "".join(word.capitalize() for word in re.sub(r"_(um|mm|deg|C)$", "", field.name).split("_"))
    name = TAKEN.get(name, name)
    return Property(
        field=field.name,
        name=name,
        type="App::PropertyEnumeration" if field.metadata["choices"] else type_,
        kind=kind,
        places=places,
        choices=field.metadata["choices"],
        doc=field.metadata["doc"],
        given=f"{name}Given" if optional else "",
    )


def declare(obj: Any, section: type, group: str) -> None:
    """Add the properties of a section that ``obj`` does not have yet, with defaults, under the heading ``group``."""
    defaults = section()
    for prop in properties(section):
        if prop.name in obj.PropertiesList:
            continue
        if prop.given:
            obj.addProperty("App::PropertyBool", prop.given, group, f"Not the default: {prop.doc}")
        obj.addProperty(prop.type, prop.name, group, prop.doc)
        if prop.choices:
            setattr(obj, prop.name, list(prop.choices))
        prop.write(obj, getattr(defaults, prop.field))


def write(obj: Any, section: Any) -> None:
    """Set the properties of ``obj`` to the values of a section."""
    for prop in properties(type(section)):
        prop.write(obj, getattr(section, prop.field))


def read(obj: Any, section: type) -> Any:
    """Return the section that the properties of ``obj`` hold."""
    return section(**{prop.field: prop.read(obj) for prop in properties(section)})


def label(section: str, name: str) -> str:
    """A property as a label: "TwistLimit" of the sheet becomes "Sheet twist limit"."""
    spaced = "".join(f" {c.lower()}" if c.isupper() else c for c in name)
    return f"{ONE.get(section, section)}{spaced}".capitalize()


ONE = {"domains": "domain", "channels": "channel", "plates": "plate", "marks": "mark"}
"""Sections named in the plural -> one of them."""
