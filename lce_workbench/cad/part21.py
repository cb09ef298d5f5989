"""A STEP file (ISO 10303-21, AP214) as it is written: statements are numbered in order and go out at once.

The bytes depend on what is written alone: no clock, no machine, no count of files written before. Rows of statements
that are alike are formatted in bulk, which is what makes a million of them cheap.
"""

from __future__ import annotations

import gzip
import re
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import IO, Any

import numpy as np

from lce_solver.types import Floats
from lce_workbench.core.cell import Colour

HEADER = """\
ISO-10303-21;
HEADER;
FILE_DESCRIPTION(('mold for a liquid-crystal-elastomer sheet'),'2;1');
FILE_NAME('{}','1980-01-01T00:00:00',(''),(''),'lce-molds','lce-molds','');
FILE_SCHEMA(('AUTOMOTIVE_DESIGN {{ 1 0 10303 214 1 1 1 1 }}'));
ENDSEC;
DATA;
"""

COMMON = """\
#1=APPLICATION_CONTEXT('core data for automotive mechanical design processes');
#2=APPLICATION_PROTOCOL_DEFINITION('international standard','automotive_design',2000,#1);
#3=PRODUCT_CONTEXT('',#1,'mechanical');
#4=PRODUCT_DEFINITION_CONTEXT('part definition',#1,'design');
#5=(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.MILLI.,.METRE.));
#6=(NAMED_UNIT(*)PLANE_ANGLE_UNIT()SI_UNIT($,.RADIAN.));
#7=(NAMED_UNIT(*)SI_UNIT($,.STERADIAN.)SOLID_ANGLE_UNIT());
#8=UNCERTAINTY_MEASURE_WITH_UNIT(LENGTH_MEASURE(1.E-07),#5,'distance_accuracy_value','confusion accuracy');
#9=(GEOMETRIC_REPRESENTATION_CONTEXT(3)GLOBAL_UNCERTAINTY_ASSIGNED_CONTEXT((#8))\
GLOBAL_UNIT_ASSIGNED_CONTEXT((#5,#6,#7))REPRESENTATION_CONTEXT('mm','3D'));
#10=CARTESIAN_POINT('',(0.,0.,0.));
#11=DIRECTION('',(0.,0.,1.));
#12=DIRECTION('',(1.,0.,0.));
#13=AXIS2_PLACEMENT_3D('',#10,#11,#12);
#14=VECTOR('',#11,1.);
#15=DERIVED_UNIT_ELEMENT(#5,2.);
#16=DERIVED_UNIT((#15));
#17=DERIVED_UNIT_ELEMENT(#5,3.);
#18=DERIVED_UNIT((#17));
"""
"""What every file begins with; other statements refer to these by number: 9 the context in mm, 11 up, 12 along x,
13 the origin, 14 a vector up, 16 and 18 the units of area and volume."""

END = "ENDSEC;\nEND-ISO-10303-21;\n"


def rows_text(text: str, first: int, n: int, columns: Mapping[str, Any]) -> str:
    """``n`` rows of the statements of ``text``, one a line, numbered from ``first``.

    In ``text``, ``@k`` is the number of the row's own statement k and ``>k`` that of the row whose index is in the
    column ``>``; ``{name:%d}`` is formatted from an array (n,), ``{name}`` is a constant text.
    """
    pattern, fields, size = _parsed(text)
    for name, value in columns.items():
        if isinstance(value, str):
            pattern = pattern.replace(f"{{{name}}}", value)
    own = first + size * np.arange(n)
    other = first + size * columns[">"] if ">" in columns else own
    numbers = {"@": own, ">": other}
    flat: list[Any] = [None] * (n * len(fields))
    for j, (kind, k, name) in enumerate(fields):
        flat[j :: len(fields)] = (columns[name] if name else numbers[kind] + int(k)).tolist()
    return (pattern * n) % tuple(flat)


@lru_cache(maxsize=16)
def _parsed(text: str) -> tuple[str, list[tuple[str, str, str]], int]:
    """Pattern for the % operator, what its fields hold (``@`` or ``>`` and k, or a column), and the statements."""
    fields = re.findall(r"([@>])(\d+)|\{(\w+):", text)
    pattern = re.sub(r"[@>]\d+", "#%d", re.sub(r"\{\w+:([^}]+)\}", r"\1", text))
    return pattern, fields, text.count("\n")


def real(value: float) -> str:
    """A number with as many decimals as it needs, at most 15."""
    return f"{value:.15f}".rstrip("0")


PRODUCT = """\
@0=PRODUCT('{name}','{name}','',(#3));
@1=PRODUCT_DEFINITION_FORMATION('','',@0);
@2=PRODUCT_DEFINITION('design','',@1,#4);
@3=PRODUCT_DEFINITION_SHAPE('','',@2);
@4=PRODUCT_RELATED_PRODUCT_CATEGORY('part',$,(@0));
@5={kind}('',(#13{refs}),#9);
@6=SHAPE_DEFINITION_REPRESENTATION(@3,@5);
"""

OCCURRENCE = """\
@0=ITEM_DEFINED_TRANSFORMATION('','',#13,#13);
@1=(REPRESENTATION_RELATIONSHIP('','',#{part.representation},#{whole.representation})\
REPRESENTATION_RELATIONSHIP_WITH_TRANSFORMATION(@0)SHAPE_REPRESENTATION_RELATIONSHIP());
@2=NEXT_ASSEMBLY_USAGE_OCCURRENCE('@2','{part.name}','',#{whole.definition},#{part.definition},$);
@3=PRODUCT_DEFINITION_SHAPE('','',@2);
@4=CONTEXT_DEPENDENT_SHAPE_REPRESENTATION(@1,@3);
"""

PROPERTIES = """\
@0=PROPERTY_DEFINITION('geometric validation property','volume',#{shape});
@1=MEASURE_REPRESENTATION_ITEM('volume measure',VOLUME_MEASURE({volume:.15E}),#18);
@2=REPRESENTATION('volume',(@1),#9);
@3=PROPERTY_DEFINITION_REPRESENTATION(@0,@2);
@4=PROPERTY_DEFINITION('geometric validation property','surface area',#{shape});
@5=MEASURE_REPRESENTATION_ITEM('surface area measure',AREA_MEASURE({area:.15E}),#16);
@6=REPRESENTATION('surface area',(@5),#9);
@7=PROPERTY_DEFINITION_REPRESENTATION(@4,@6);
@8=PROPERTY_DEFINITION('geometric validation property','centroid',#{shape});
@9=CARTESIAN_POINT('centre point',({x:.12f},{y:.12f},{z:.12f}));
@10=REPRESENTATION('centroid',(@9),#9);
@11=PROPERTY_DEFINITION_REPRESENTATION(@8,@10);
"""

STYLE = """\
@0=COLOUR_RGB('',{red:.6f},{green:.6f},{blue:.6f});
@1=FILL_AREA_STYLE_COLOUR('',@0);
@2=FILL_AREA_STYLE('',(@1));
@3=SURFACE_STYLE_FILL_AREA(@2);
@4=SURFACE_STYLE_TRANSPARENT({clear:.6f});
@5=SURFACE_STYLE_RENDERING_WITH_PROPERTIES(.NORMAL_SHADING.,@0,(@4));
@6=SURFACE_SIDE_STYLE('',(@3,@5));
@7=SURFACE_STYLE_USAGE(.BOTH.,@6);
@8=PRESENTATION_STYLE_ASSIGNMENT((@7));
"""


@dataclass(frozen=True)
class Product:
    """A part or an assembly in the file, by the numbers of its statements."""

    name: str
    first: int
    """The first statement of `PRODUCT`."""

    DEFINITION = 2
    SHAPE = 3
    REPRESENTATION = 5

    @property
    def definition(self) -> int:
        """Its PRODUCT_DEFINITION."""
        return self.first + self.DEFINITION

    @property
    def shape(self) -> int:
        """Its PRODUCT_DEFINITION_SHAPE."""
        return self.first + self.SHAPE

    @property
    def representation(self) -> int:
        """Its SHAPE_REPRESENTATION."""
        return self.first + self.REPRESENTATION


class Part21:
    """The file."""

    def __init__(self, file: IO[bytes], name: str) -> None:
        self._file, self.name = file, name
        self._styles: dict[tuple[Colour, float], int] = {}
        self._styled: list[int] = []
        self._text(HEADER.format(name) + COMMON)
        self.next = COMMON.count(";\n") + 1

    def _text(self, text: str) -> None:
        self._file.write(text.encode("ascii"))

    def add(self, statements: str, **names: Any) -> int:
        """Write statements, one a line, with ``@k`` for the number of line k; return the number of the first."""
        first = self.next
        self._text(re.sub(r"@(\d+)", lambda hit: f"#{first + int(hit[1])}", statements.format(**names)))
        self.next += statements.count("\n")
        return first

    def rows(self, text: str, n: int, columns: Mapping[str, Any]) -> int:
        """Write ``n`` rows of statements in bulk, see `rows_text`; return the number of the first statement."""
        first = self.next
        self._text(rows_text(text, first, n, columns))
        self.next += n * text.count("\n")
        return first

    def product(self, name: str, items: Iterable[int] = (), kind: str = "SHAPE_REPRESENTATION") -> Product:
        """Write a product that consists of ``items`` and the origin."""
        first = self.add(PRODUCT, name=name, kind=kind, refs="".join(f",#{item}" for item in items))
        return Product(name, first)

    def place(self, part: Product, whole: Product) -> None:
        """Make ``part`` a component of ``whole``, in the same coordinates."""
        self.add(OCCURRENCE, part=part, whole=whole)

    def validate(self, product: Product, volume: float, area: float, centroid: Floats) -> None:
        """State volume [mm3], surface area [mm2] and centroid (3,) [mm], for the reader to compare with his own."""
        x, y, z = centroid
        self.add(PROPERTIES, shape=product.shape, volume=volume, area=area, x=x, y=y, z=z)

    def paint(self, item: int, colour: Colour, opacity: float) -> None:
        """Give a solid its colour (sRGB)."""
        look = colour, opacity
        if look not in self._styles:
            red, green, blue = colour
            style = self.add(STYLE, red=red, green=green, blue=blue, clear=1 - opacity)
            self._styles[look] = style + STYLE.count("\n") - 1
        self._styled.append(
            self.add("@0=STYLED_ITEM('color',(#{style}),#{item});\n", style=self._styles[look], item=item)
        )

    def close(self) -> None:
        """Write the end."""
        if self._styled:
            refs = ",".join(f"#{item}" for item in self._styled)
            self.add("@0=MECHANICAL_DESIGN_GEOMETRIC_PRESENTATION_REPRESENTATION('',({refs}),#9);\n", refs=refs)
        self._text(END)


@contextmanager
def part21(path: Path) -> Iterator[Part21]:
    """Open a STEP file to write into; it is compressed if its name ends in ``.gz``.

    Raises
    ------
    OSError
        The file cannot be written.
    """
    with path.open("wb") as raw:
        packed = path.suffix == ".gz"
        file: Any = gzip.GzipFile("", "wb", 6, raw, mtime=0) if packed else raw
        out = Part21(file, path.name.split(".")[0])
        yield out
        out.close()
        if packed:
            file.close()
