"""The files of a study: its samples as a table, what they come to, and a plot."""

from __future__ import annotations

import csv
import json
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from lce_solver.compare import REACH
from lce_workbench.core.perturb import STUDIES

Row = dict[str, Any]

OUTCOMES = {"reached": ("tab:green", "o"), "mirror image": ("tab:red", "v"), "another shape": ("tab:orange", "s")}
"""Colour and mark of a sample in the plot."""


def write_samples(_: str, rows: Sequence[Row], __: Sequence[Row], path: Path) -> None:
    """Write one line for each sample; numbers to the last bit."""
    with path.open("w", newline="", encoding="utf-8") as file:
        table = csv.DictWriter(file, list(rows[0]))
        table.writeheader()
        table.writerows(rows)


def write_summary(name: str, rows: Sequence[Row], table: Sequence[Row], path: Path) -> None:
    """Write the question and one entry for each value."""
    record = {
        "study": name,
        "question": STUDIES[name].question,
        "axis": STUDIES[name].axis,
        "samples": len(rows),
        "reached_below_rms_pct": REACH,
        "table": list(table),
    }
    path.write_text(json.dumps(record, indent=1) + "\n", encoding="utf-8")


def write_plot(name: str, rows: Sequence[Row], table: Sequence[Row], path: Path) -> None:
    """Draw the distance from the target of every sample over the values, and the share that arrives."""
    from matplotlib.figure import Figure
    from matplotlib.ticker import FormatStrFormatter, LogLocator, NullFormatter

    study = STUDIES[name]
    figure = Figure(figsize=(7, 5), dpi=150, layout="constrained")
    axes = figure.subplots()
    place, turn = np.array([divmod(row["sample"], len(study.values))[::-1] for row in rows]).T
    x = place + 0.5 * ((turn + 0.5) / (turn.max() + 1) - 0.5)
    rms, kinds = np.array([row["rms_pct"] for row in rows]), np.array([outcome(row) for row in rows])
    for kind, (colour, mark) in OUTCOMES.items():
        own = kinds == kind
        axes.plot(x[own], rms[own], mark, color=colour, ms=4, label=f"{kind}: {own.sum()}")
    axes.plot(range(len(table)), [row["rms_pct_median"] for row in table], "_", color="black", ms=24)
    axes.axhline(REACH, color="grey", lw=0.8, ls="--", label=f"limit, {REACH:g} %")
    labels = [
        f"{', '.join(f'{v:g}' for v in value.values())}\n{row['reached']:.0%} arrive"
        for value, row in zip(study.values, table, strict=True)
    ]
    axes.set_xticks(range(len(table)), labels, fontsize=8)
    axes.set(yscale="log", ylim=(min(rms.min(), REACH) / 2, 2 * max(rms.max(), REACH)))
    axes.set(xlabel=study.axis, ylabel="rms distance from the target [% of its diagonal]")
    axes.yaxis.set_major_locator(LogLocator(subs=(1, 2, 5)))
    axes.yaxis.set_major_formatter(FormatStrFormatter("%g"))
    axes.yaxis.set_minor_formatter(NullFormatter())
    axes.set_title(f"{study.question}\nSimulated; a mark for each sample, a bar for the median", fontsize=8)
    figure.legend(loc="outside lower center", ncols=4, fontsize=8)
    figure.savefig(path, metadata={"Software": None})


def outcome(row: Row) -> str:
    """Which of `OUTCOMES` a sample is."""
    if row["reached"]:
        return "reached"
    return "mirror image" if row["mirrored"] and row["mirror_rms_pct"] <= REACH else "another shape"


Write = Callable[[str, Sequence[Row], Sequence[Row], Path], None]
KINDS: dict[str, Write] = {"csv": write_samples, "json": write_summary, "png": write_plot}
"""The files of a study, by their endings."""
