"""The same bytes for the same shapes: what OpenCASCADE's STEP writer leaves to clock and chance is put in order."""

from __future__ import annotations

import re
from itertools import count

HEADER = "FILE_NAME('{}','1980-01-01T00:00:00',(''),(''),'Open CASCADE','lce-molds','');"
USAGE = "NEXT_ASSEMBLY_USAGE_OCCURRENCE"
PRESENTATION = "MECHANICAL_DESIGN_GEOMETRIC_PRESENTATION_REPRESENTATION"

REFERENCE = re.compile(r"#\d+")
STATEMENT = re.compile(r"^(#\d+) = (.*?);$", re.MULTILINE | re.DOTALL)


def canonical(text: str, name: str) -> str:
    """A STEP file as the writer left it, with a fixed header, occurrences counted from 1, and its styles sorted.

    The writer counts occurrences since the process began. Styles come last in the file, a `PRESENTATION` per product
    and then what it refers to, in the order of memory addresses.
    """
    text = re.sub(r"FILE_NAME\(.*?\);", HEADER.format(name), text, count=1, flags=re.DOTALL)
    numbers = count(1)
    text = re.sub(
        rf"{USAGE}\(\s*'\d+'(.*?);", lambda hit: f"{USAGE}('{next(numbers)}'{_unfolded(hit[1])};", text, flags=re.DOTALL
    )
    styles = re.search(rf"^#\d+ = {PRESENTATION}", text, re.MULTILINE)
    if styles is None:
        return text
    start, end = styles.start(), text.index("ENDSEC;", styles.start())
    return text[:start] + _sorted_styles(text[start:end]) + text[end:]


def _sorted_styles(text: str) -> str:
    """The statements of ``text`` in the order in which the sorted products need them, renumbered."""
    body = {key: _unfolded(value) for key, value in STATEMENT.findall(text)}
    products = [key for key, value in body.items() if value.startswith(PRESENTATION)]
    waiting = sorted(products, key=lambda key: _last(body[key]), reverse=True)
    free = count(min(int(key[1:]) for key in body))
    names: dict[str, str] = {}
    while waiting:
        key = waiting.pop()
        if key not in names:
            names[key] = f"#{next(free)}"
            waiting += [ref for ref in reversed(REFERENCE.findall(body[key])) if ref in body]
    lines = (REFERENCE.sub(lambda hit: names.get(hit[0], hit[0]), body[key]) for key in names)
    return "".join(f"{name} = {line};\n" for name, line in zip(names.values(), lines, strict=True))


def _last(statement: str) -> int:
    """Number of the last entity that a statement refers to: a presentation's context, which no other one has."""
    return int(REFERENCE.findall(statement)[-1][1:])


def _unfolded(statement: str) -> str:
    """The statement in one line."""
    return re.sub(r"\s*\n\s*", "", statement)
