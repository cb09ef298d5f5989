"""A STEP file (ISO 10303-21, AP214) as it is written: statements are numbered in order and go out at once.

The bytes depend on what is written alone: no clock, no machine, no count of files written before. Rows of statements
that are alike are formatted in bulk, which is what makes a million of them cheap.
"""

from __future__ import annotations

import gzip
import re
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import IO, Any

import numpy as np

from lce_solver.types import Floats, Ints
from lce_workbench.core.digits import Texts, billionths, integers, lines
from lce_workbench.core.prism import Colour

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


def rows_text(text: str, first: int, n: int, columns: Mapping[str, Any]) -> bytes:
    """``n`` rows of the statements of ``text``, one a line, numbered from ``first``.

    In ``text``, ``@k`` is the number of the row's own statement k and ``>k`` that of the row whose index is in the
    column ``>``; ``{name:d}`` is an integer and ``{name:f}`` a length [mm] with 9 decimals, both from an array (n,);
    ``{name}`` is one text for all rows or a sequence of n.
    """
    pieces, size = _parsed(text)
    starts = {"@": np.arange(first, first + n * size, size)}
    starts[">"] = starts["@"][columns.get(">", slice(None))]

    def column(kind: str, name: str) -> bytes | Texts:
        if kind in "@>":
            return integers(starts[kind] + int(name))
        values = columns[name]
        if kind == "d":
            return integers(values)
        if kind == "f":
            return billionths(np.rint(values * 1e9).astype(np.int64))
        if isinstance(values, str | np.ndarray):
            return values.encode() if isinstance(values, str) else values
        return np.array([value.encode() for value in values])

    made = {field: column(*field) for field in {piece for piece in pieces if not isinstance(piece, bytes)}}
    return lines([piece if isinstance(piece, bytes) else made[piece] for piece in pieces])


@lru_cache(maxsize=32)
def _parsed(text: str) -> tuple[tuple[bytes | tuple[str, str], ...], int]:
    """What a row consists of, constant texts and fields (kind, name or k), and how many statements it has."""
    pieces: list[bytes | tuple[str, str]] = []
    for constant, mark, k, name, kind in re.findall(r"([^@>{]*)(?:([@>])(\d+)|\{(\w+):?(\w?)\}|$)", text):
        pieces.append((constant + "#" * bool(mark)).encode())
        if mark or name:
            pieces.append((mark or kind or "s", k or name))
    return tuple(piece for piece in pieces if piece), text.count("\n")


def real(value: float) -> str:
    """A number with as many decimals as it needs, at most 15."""
    return f"{value:.15f}".rstrip("0")


def references(numbers: Ints) -> str:
    """``,#1,#2,#3``: further items of a list."""
    return "".join(f",#{number}" for number in numbers.tolist())


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
@1=(REPRESENTATION_RELATIONSHIP('','',#{part_shape:d},#{whole_shape:d})\
REPRESENTATION_RELATIONSHIP_WITH_TRANSFORMATION(@0)SHAPE_REPRESENTATION_RELATIONSHIP());
@2=NEXT_ASSEMBLY_USAGE_OCCURRENCE('@2','{name}','',#{whole:d},#{part:d},$);
@3=PRODUCT_DEFINITION_SHAPE('','',@2);
@4=CONTEXT_DEPENDENT_SHAPE_REPRESENTATION(@1,@3);
"""

PROPERTIES = """\
@0=PROPERTY_DEFINITION('geometric validation property','volume',#{shape:d});
@1=MEASURE_REPRESENTATION_ITEM('volume measure',VOLUME_MEASURE({volume}),#18);
@2=REPRESENTATION('volume',(@1),#9);
@3=PROPERTY_DEFINITION_REPRESENTATION(@0,@2);
@4=PROPERTY_DEFINITION('geometric validation property','surface area',#{shape:d});
@5=MEASURE_REPRESENTATION_ITEM('surface area measure',AREA_MEASURE({area}),#16);
@6=REPRESENTATION('surface area',(@5),#9);
@7=PROPERTY_DEFINITION_REPRESENTATION(@4,@6);
@8=PROPERTY_DEFINITION('geometric validation property','centroid',#{shape:d});
@9=CARTESIAN_POINT('centre point',({x},{y},{z}));
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

STYLED = "@0=STYLED_ITEM('color',(#{style}),#{item:d});\n"


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
        self._styled: list[Ints] = []
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

    def rows(self, text: str, n: int, columns: Mapping[str, Any]) -> Ints:
        """Write ``n`` rows of statements in bulk, see `rows_text`; return the number of each row's first statement."""
        first, size = self.next, text.count("\n")
        self._file.write(rows_text(text, first, n, columns))
        self.next += n * size
        return np.arange(first, self.next, size)

    def product(self, name: str) -> Product:
        """Write a product without a shape of its own: an assembly."""
        return self.products([name], [np.empty(0, dtype=np.int64)])[0]

    def products(
        self, names: Sequence[str], items: Sequence[Ints], kind: str = "SHAPE_REPRESENTATION"
    ) -> list[Product]:
        """Write products; each consists of its ``items`` and the origin."""
        listed = [references(each) for each in items]
        first = self.rows(PRODUCT, len(names), {"name": names, "kind": kind, "refs": listed})
        return [Product(name, at) for name, at in zip(names, first.tolist(), strict=True)]

    def place(self, parts: Sequence[Product], whole: Product) -> None:
        """Make ``parts`` components of ``whole``, in the same coordinates."""
        n = len(parts)
        columns = {
            "name": [part.name for part in parts],
            "part": np.array([part.definition for part in parts]),
            "part_shape": np.array([part.representation for part in parts]),
            "whole": np.full(n, whole.definition),
            "whole_shape": np.full(n, whole.representation),
        }
        self.rows(OCCURRENCE, n, columns)

    def validate(self, parts: Sequence[Product], volume: Floats, area: Floats, centroid: Floats) -> None:
        """State volumes (n,) [mm3], surface areas (n,) [mm2] and centroids (n, 3) [mm], for a reader to compare."""
        measures = {name: [f"{v:.15E}" for v in values] for name, values in (("volume", volume), ("area", area))}
        places = {name: [f"{v:.12f}" for v in values] for name, values in zip("xyz", centroid.T, strict=True)}
        shapes = np.array([part.shape for part in parts])
        self.rows(PROPERTIES, len(parts), {**measures, **places, "shape": shapes})

    def paint(self, items: Ints, colour: Colour, opacity: float) -> None:
        """Give solids (n,) their colour (sRGB)."""
        look = colour, opacity
        if look not in self._styles:
            red, green, blue = colour
            style = self.add(STYLE, red=red, green=green, blue=blue, clear=1 - opacity)
            self._styles[look] = style + STYLE.count("\n") - 1
        style = str(self._styles[look])
        self._styled.append(self.rows(STYLED, len(items), {"style": style, "item": items}))

    def close(self) -> None:
        """Write the end."""
        if self._styled:
            refs = references(np.concatenate(self._styled))[1:]
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
