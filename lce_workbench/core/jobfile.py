"""Job files: TOML to the frozen `Job` and back. Unknown keys, wrong types and values out of limits are errors."""

from __future__ import annotations

import difflib
import math
import operator
import tomllib
from collections.abc import Callable, Iterable, Mapping
from dataclasses import Field, fields, replace
from pathlib import Path
from types import NoneType, UnionType
from typing import Any, get_args, get_type_hints

from lce_solver.errors import InputError
from lce_workbench.core.job import RELIEF_UM, Job

Section = Any
"""One of the frozen dataclasses of `core.job`."""

DEFAULT_PRESET = "rm82-pdt-1to1"


def load(path: Path, settings: Iterable[str] = ()) -> Job:
    """Read a job file and apply ``key=value`` settings (``sheet.gap_um=150``) on top.

    Raises
    ------
    InputError
        The file is missing, unreadable or not TOML, or a key or value is wrong.
    """
    try:
        text = path.read_text(encoding="utf-8-sig")
    except FileNotFoundError:
        msg = f"job file {path} does not exist; `./lce new TARGET` writes one"
        raise InputError(msg) from None
    except (OSError, UnicodeDecodeError) as fault:
        msg = f"job file {path} cannot be read ({_reason(fault)}); give a UTF-8 text file you may read"
        raise InputError(msg) from None
    return parse(text, str(path), settings)


RELIEF_PIXELS = 25e6
"""More take minutes and gigabytes."""


def parse(text: str, name: str = "job", settings: Iterable[str] = ()) -> Job:
    """Turn TOML text into a checked `Job`; ``name`` is used in messages."""
    try:
        table = tomllib.loads(text)
    except (ValueError, RecursionError) as fault:  # Python refuses integers of thousands of digits, and deep nesting
        msg = f"{name} is not valid TOML: {fault}"
        raise InputError(msg) from None
    for setting in settings:
        _apply(table, setting)
    return _consistent(from_table(table, name), name)


def from_table(table: Mapping[str, Any], name: str = "job") -> Job:
    """Build the job from nested tables, section by section."""
    sections = {f.name: f for f in fields(Job)}
    for key in table:
        if key not in sections:
            raise InputError(_unknown(f"[{key}]", key, sections, name))
    built = {key: _section(getattr(Job(), key), values, key, name) for key, values in table.items()}
    return replace(Job(), **built)


def _section(default: Section, values: Any, title: str, name: str) -> Section:
    if not isinstance(values, Mapping):
        msg = f"{name}: {title} must be a table, write [{title}] on a line of its own"
        raise InputError(msg)
    declared = {toml_name(f): f for f in fields(default)}
    hints = get_type_hints(type(default))
    changes = {}
    for key, value in values.items():
        if key not in declared:
            raise InputError(_unknown(f"{title}.{key}", key, declared, name))
        f = declared[key]
        changes[f.name] = _checked(value, hints[f.name], f, f"{title}.{key}")
    return replace(default, **changes)


def toml_name(f: Field[Any]) -> str:
    """The key in the job file: the field's name without the underscore that avoids a Python keyword."""
    return f.name.rstrip("_")


def _unknown(label: str, key: str, known: Iterable[str], name: str) -> str:
    close = difflib.get_close_matches(key, list(known), 1)
    hint = f"did you mean {close[0]}?" if close else "known are " + ", ".join(known)
    return f"{name}: unknown key {label}; {hint}"


def _checked(value: Any, hint: Any, f: Field[Any], label: str) -> Any:
    """``value`` in the declared type and within the declared limits."""
    kinds = get_args(hint) if isinstance(hint, UnionType) else (hint,)
    kind = next(k for k in kinds if k is not NoneType)
    if str(kind).startswith("tuple"):
        return _checked_list(value, get_args(kind)[0], label)
    if kind is float and type(value) is int:
        value = _as_float(value)
    if type(value) is not kind:
        msg = f"{label} must be {WORDS[kind]}, not {value!r}"
        raise InputError(msg)
    _within(value, f, label)
    return value


def _as_float(value: float) -> float:
    """The number as a float; too large a one becomes infinite, which is refused with the other infinities."""
    try:
        return float(value)
    except OverflowError:
        return math.inf


WORDS = {float: "a number", int: "a whole number", bool: "true or false", str: "a text in quotes"}


def _checked_list(value: Any, kind: type, label: str) -> tuple[Any, ...]:
    if not isinstance(value, list) or any(type(item) is not kind for item in value):
        msg = f"{label} must be a list in which each item is {WORDS[kind]}, not {value!r}"
        raise InputError(msg)
    twice = [item for k, item in enumerate(value) if kind is str and item in value[:k]]
    if twice:
        msg = f"{label} lists {twice[0]!r} twice; name it once"
        raise InputError(msg)
    return tuple(value)


def _within(value: Any, f: Field[Any], label: str) -> None:
    meta = f.metadata
    if meta["choices"] and value not in meta["choices"]:
        msg = f"{label} is {value!r}; choose one of {', '.join(meta['choices'])}"
        raise InputError(msg)
    if type(value) not in {int, float}:
        return
    value = _as_float(value)
    if not math.isfinite(value):
        msg = f"{label} is {value}; give a finite number"
        raise InputError(msg)
    unit = f" {meta['unit']}" if meta["unit"] else ""
    for name, (bad, words) in LIMITS.items():
        limit = meta[name]
        if limit is not None and bad(value, limit):
            msg = f"{label} is {value:g}{unit}; it must be {words} {limit:g}{unit}"
            raise InputError(msg)


LIMITS: dict[str, tuple[Callable[[float, float], bool], str]] = {
    "above": (operator.le, "greater than"),
    "low": (operator.lt, "at least"),
    "high": (operator.gt, "at most"),
}
"""Kind of limit -> (test that finds the fault, words)."""


def _apply(table: dict[str, Any], setting: str) -> None:
    """Put one ``section.key=value`` into the table; a value that is not TOML is taken as text."""
    key, equals, raw = setting.partition("=")
    section, dot, name = key.strip().partition(".")
    if not (equals and dot and section and name):
        msg = f"--set {setting!r} is not of the form section.key=value, for example sheet.gap_um=150"
        raise InputError(msg)
    try:
        value = tomllib.loads(f"v = {raw.strip()}")["v"]
    except (ValueError, RecursionError):
        value = raw.strip()
    part = table.setdefault(section, {})
    if isinstance(part, dict):
        part[name] = value


def _consistent(job: Job, name: str) -> Job:
    """Check what no single parameter shows; fill in the default material.

    Raises
    ------
    InputError
        Parameters contradict each other.
    """
    fault = next((words for test in CONTRADICTIONS if (words := test(job))), "")
    if fault:
        msg = f"{name}: {fault}"
        raise InputError(msg)
    return job if any(_given(job)) else with_default_material(job)


def _given(job: Job) -> list[bool]:
    """Whether preset, numbers and curve of the material are given."""
    material = job.material
    return [bool(material.preset), material.lambda_ is not None or material.nu is not None, bool(material.curve)]


def _target_fault(job: Job) -> str:
    if job.target.mesh and job.target.surface:
        return "target.mesh and target.surface are both given; keep one of them"
    if not job.target.mesh and not job.target.surface:
        return 'there is no target; give target.mesh = "file" or target.surface = "face"'
    return ""


def _material_fault(job: Job) -> str:
    material, given = job.material, _given(job)
    if sum(given) > 1:
        return "the material is given twice; keep one of material.preset, material.lambda with nu, material.curve"
    if given[1] and (material.lambda_ is None or material.nu is None):
        return "material.lambda and material.nu belong together; give both (nu = 0.5 conserves volume)"
    if given[2] != (material.temperature_C is not None):
        return "material.curve and material.temperature_C belong together; give both or neither"
    return ""


def _size_fault(job: Job) -> str:
    domains, channels, sheet = job.domains, job.channels, job.sheet
    if domains.size >= sheet.width_mm:
        return (
            f"domains.size_um = {domains.size_um:g} is not smaller than the sheet "
            f"(sheet.width_mm = {sheet.width_mm:g}); domains of 200 to 500 um are usual"
        )
    if domains.size < 4 * channels.pitch:
        return (
            f"domains.size_um = {domains.size_um:g} holds hardly a channel at a pitch of "
            f"{channels.pitch * 1e3:g} um; make the domains larger or the channels finer"
        )
    for key, layer, size in (
        ("plates.epoxy_um", "the epoxy layer that holds them", job.plates.epoxy_um),
        ("sheet.gap_um", "the film that fills them", sheet.gap_um),
    ):
        if channels.depth_um >= size:
            return (
                f"channels.depth_um = {channels.depth_um:g} is not smaller than {layer} ({key} = {size:g}); "
                f"make the channels shallower (0.6 um is usual) or raise {key}"
            )
    return ""


def _relief_fault(job: Job) -> str:
    output = job.output
    x0, y0, x1, y1 = output.step_window_um or (0.0, 0.0, RELIEF_UM, RELIEF_UM)
    pixels = abs((x1 - x0) * (y1 - y0)) * 1e6 / output.relief_pixel_nm**2
    if output.relief and pixels > RELIEF_PIXELS:
        return (
            f"the relief would have {pixels:.2g} pixels, more than {RELIEF_PIXELS:.2g}; make output.relief_pixel_nm "
            "larger or output.step_window_um smaller"
        )
    return ""


CONTRADICTIONS: tuple[Callable[[Job], str], ...] = (_target_fault, _material_fault, _size_fault, _relief_fault)
"""Each says what is wrong, or nothing."""


METRIC_SECTIONS = ("target", "material", "sheet", "domains", "solver")
"""What the flat sheet and its director are made from, but for what only the twist depends on."""

TWIST_KEYS = ("gap_um", "twist_gain", "twist_limit_deg", "edge_overdrive")
"""Parameters of the sheet that the metric does not depend on."""

FILES = {"target.mesh", "material.curve"}
"""Names of files, relative to the job file: two jobs are compared by what stands in the files."""


def metric_values(job: Job) -> dict[str, Any]:
    """Name as in the job file -> value of all that the metric depends on, without the names of files."""
    values = {
        f"{name}.{toml_name(f)}": getattr(getattr(job, name), f.name)
        for name in METRIC_SECTIONS
        for f in fields(getattr(job, name))
    }
    return {name: value for name, value in values.items() if name not in FILES | {f"sheet.{k}" for k in TWIST_KEYS}}


def with_default_material(job: Job) -> Job:
    """The job with the default preset."""
    return replace(job, material=replace(job.material, preset=DEFAULT_PRESET))


def dump(job: Job, *, comments: bool = False) -> str:
    """Write the job as TOML with every default; with ``comments`` each key is explained."""
    lines: list[str] = []
    for part in fields(Job):
        section = getattr(job, part.name)
        lines += [f"[{part.name}]" + (f"  # {_first_line(section)}" if comments else "")]
        lines += [_line(f, getattr(section, f.name), comments=comments) for f in fields(section)]
        lines += [""]
    return "\n".join(line for line in lines if line is not None)


def _first_line(section: Section) -> str:
    return (type(section).__doc__ or "").splitlines()[0]


def _line(f: Field[Any], value: Any, *, comments: bool) -> Any:
    unset = value is None or value == ""
    if unset and not comments:
        return None
    shown = '""' if value == "" else "?" if value is None else toml_value(value)
    text = f"{'# ' if unset else ''}{toml_name(f)} = {shown}"
    return f"{text:<34}  # {f.metadata['doc']}" if comments else text


def toml_value(value: Any) -> str:
    """One value in TOML; floats in the shortest form that reads back the same."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        escaped = value.replace("\\", "\\\\").replace('"', '\\"')
        return '"' + "".join(c if c.isprintable() else f"\\u{ord(c):04x}" for c in escaped) + '"'
    if isinstance(value, tuple):
        return "[" + ", ".join(toml_value(item) for item in value) + "]"
    return repr(value)


def _reason(fault: Exception) -> str:
    return fault.strerror or "unknown fault" if isinstance(fault, OSError) else "not UTF-8 text"
