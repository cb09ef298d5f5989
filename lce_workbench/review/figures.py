"""The figures, drawn once as SVG for the page and for paper; colours are safe for the colour-blind."""

from __future__ import annotations

import io
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from lce_solver.contest import FAVOUR
from lce_solver.types import Floats
from lce_workbench.core.domains import Domains
from lce_workbench.review.data import Predicted, Review
from lce_workbench.review.measures import POLARISERS, bending, jumps, transmission

if TYPE_CHECKING:
    from matplotlib.axes import Axes

INK, PALE, FIRST, SECOND, THIRD = "#1b1f24", "#8a929c", "#0b6fa4", "#c1550b", "#5b5f97"
STYLE: Any = {
    "svg.fonttype": "none", "svg.hashsalt": "lce", "font.family": "DejaVu Sans", "font.size": 8,
    "axes.edgecolor": PALE, "axes.labelcolor": INK, "xtick.color": INK, "ytick.color": INK, "text.color": INK,
    "axes.spines.top": False, "axes.spines.right": False, "axes.linewidth": 0.6, "legend.frameon": False,
    "lines.linewidth": 1.3, "axes.titlesize": 8, "path.simplify": True,
}  # fmt: skip
SIZE = (5.0, 2.7)
"""Of a figure [inch]."""
BINS = 60
PIXELS = 640
"""Longer side of a picture between crossed polarisers."""


@dataclass(frozen=True)
class Drawn:
    """One figure."""

    name: str
    title: str
    caption: str
    svg: str


@dataclass(frozen=True)
class Plan:
    """How one figure is made: it draws on its axes and is left out when the folder has no data for it."""

    title: str
    caption: str
    draw: Callable[[Review, Mapping[str, Any], Any], None]
    axes: int = 1
    wanted: Callable[[Review], bool] = lambda _: True


def drawn(review: Review, record: Mapping[str, Any]) -> tuple[Drawn, ...]:
    """Every figure that the folder has data for, and one for each study in it."""
    studies = {f"study-{told['study']}": _study_plan(told) for told in record["studies"]}
    return tuple(
        Drawn(name, plan.title, plan.caption, _svg(plan, review, record))
        for name, plan in {**FIGURES, **studies}.items()
        if plan.wanted(review)
    )


def _svg(plan: Plan, review: Review, record: Mapping[str, Any]) -> str:
    from matplotlib import rc_context
    from matplotlib.figure import Figure

    with rc_context(STYLE):
        figure = Figure(figsize=SIZE, layout="constrained")
        axes = figure.subplots(1, plan.axes, squeeze=False)[0]
        plan.draw(review, record, axes if plan.axes > 1 else axes[0])
        text = io.StringIO()
        figure.savefig(text, format="svg", transparent=True, metadata={"Date": None, "Creator": None})
    return text.getvalue()[text.getvalue().index("<svg") :]


def _stretches(review: Review, _record: Mapping[str, Any], axes: Any) -> None:
    for side, name, colour, errors in zip(axes, ("along", "across"), (FIRST, SECOND), review.errors.T, strict=True):
        side.hist(100 * errors, bins=BINS, weights=review.domains.area, color=colour)
        side.axvline(0, color=INK, linewidth=0.8)
        side.set(xlabel=f"error {name} the director [%]", ylabel="area [mm²]", yscale="log")


def _angles(review: Review, _record: Mapping[str, Any], axes: Any) -> None:
    area, domains = review.domains.area, review.domains
    axes[0].hist(np.degrees(domains.theta), bins=np.arange(0, 181, 3), weights=area, color=FIRST)
    axes[0].set(xlabel="director θ [°]", ylabel="area [mm²]", xticks=np.arange(0, 181, 45))
    axes[1].hist(np.degrees(domains.dtheta), bins=BINS, weights=area, color=SECOND)
    axes[1].set(xlabel="twist Δθ [°]")


def _jumps(review: Review, _record: Mapping[str, Any], axes: Axes) -> None:
    turn = np.degrees(jumps(review.domains))
    axes.hist(turn, bins=BINS, color=FIRST)
    axes.axvline(np.percentile(turn, 99), color=SECOND)
    axes.annotate(
        "99 of 100", (np.percentile(turn, 99), 0.96), (4, 0), axes.get_xaxis_transform(), "offset points", va="top"
    )
    axes.set(xlabel="turn of the director across a border [°]", ylabel="borders", yscale="log")


def _energy(review: Review, _record: Mapping[str, Any], axes: Axes) -> None:
    energy = review.design.flattening.energy
    axes.plot(np.arange(len(energy)), energy, color=FIRST)
    axes.set(xlabel="iteration on the finest mesh", ylabel="energy (S3), normalised", yscale="log")


def _starts(_review: Review, record: Mapping[str, Any], axes: Axes) -> None:
    for start in record["starts"]:
        good = not (start["flipped"] or start["crossings"])
        colour = SECOND if start["winner"] else FIRST if good else PALE
        axes.bar(start["angle"], 100 * start["score"], width=120 / len(record["starts"]), color=colour,
                 hatch="" if good else "///", edgecolor="white" if good else INK, linewidth=0.4)  # fmt: skip
        heated = [] if start["heated_pct"] is None else [f"heated: {start['heated_pct']:.2g} %"]
        marks = ["◆"] * start["symmetric"] + heated + ["wins"] * start["winner"]
        axes.annotate(
            "\n".join(marks), (start["angle"], 100 * start["score"]), (0, 2), textcoords="offset points", ha="center"
        )
    axes.margins(x=0.12, y=0.22)
    axes.set(xlabel="direction of the first stretch [°]", ylabel="rms × bending left [%]")


def _reach(review: Review, _record: Mapping[str, Any], axes: Axes) -> None:
    bent = bending(review.design)
    wanted, made = bent.wanted[:, 0, 1], bent.prescribed
    far = max(float(np.percentile(np.abs(wanted), 99.5)), float(np.abs(made).max()), 1e-9)
    inside = (np.abs(wanted) <= far) & (np.abs(made) <= far)
    axes.hexbin(wanted[inside], made[inside], gridsize=44, bins="log", mincnt=1, cmap="viridis", linewidths=0.1,
                extent=(-far, far, -far, far))  # fmt: skip
    axes.plot([-far, far], [-far, far], color=INK, linewidth=0.8, linestyle="--")
    axes.set(xlabel="twist curvature of the target [1/mm]", ylabel="prescribed [1/mm]")


def _heating(_review: Review, record: Mapping[str, Any], axes: Axes) -> None:
    steps = record["prediction"]["heating"]
    lambdas = [step["lambda_"] for step in steps]
    for name, colour, look in (("stretching", FIRST, "o-"), ("bending", SECOND, "s-")):
        axes.plot(lambdas, [step[name] for step in steps], look, color=colour, markersize=3, label=name)
    axes.set(xlabel="stretch λ along the director while heating", ylabel="energy / E [mm³]", yscale="log")
    axes.set_xlim(1, lambdas[-1])
    axes.legend()


def _budget(_review: Review, record: Mapping[str, Any], axes: Axes) -> None:
    told = record["alignment"]
    rows = [row for row in told["rows"] if row["value_um"] < told["tolerance_um"]]
    names = ["one vernier", "shift", "rotation × lever", "scale × lever", "read-out, total", "left for the hand"]
    axes.barh(names[: len(rows)], [row["value_um"] for row in rows], color=[FIRST] * 4 + [THIRD, PALE], height=0.6)
    for k, row in enumerate(rows):
        beyond = 18 if row["value_um"] > 0.85 * told["tolerance_um"] else 4  # beyond the line of the tolerance
        axes.annotate(
            f"{row['value_um']:.2f}", (row["value_um"], k), (beyond, 0), textcoords="offset points", va="center"
        )
    axes.axvline(told["tolerance_um"], color=SECOND)
    axes.annotate(
        "tolerance",
        (told["tolerance_um"], -0.75),
        (-4, 0),
        textcoords="offset points",
        ha="right",
        va="center",
        color=SECOND,
        annotation_clip=False,
    )
    axes.invert_yaxis()
    axes.set(xlabel="µm, half of the 95 % interval")
    axes.set_xlim(0, told["tolerance_um"] * 1.12)


OUTCOME = ("samples", "reached", "mirrored", "rms_pct_median", "rms_pct_max")
"""What a row of a study's table says of its samples; the other names are the value that was tried."""


def _study_plan(told: Mapping[str, Any]) -> Plan:
    """The figure of one study in the folder."""

    def draw(_review: Review, _record: Mapping[str, Any], axes: Axes) -> None:
        table, limit = told["table"], told["reached_below_rms_pct"]
        for k, row in enumerate(table):
            colour = FIRST if row["reached"] == 1 else SECOND
            axes.plot([k, k], [row["rms_pct_median"], row["rms_pct_max"]], color=colour)
            axes.plot(k, row["rms_pct_median"], "o" if row["reached"] == 1 else "s", color=colour, markersize=4)
        axes.axhline(limit, color=PALE, linestyle="--", linewidth=0.8)
        axes.annotate(f"limit, {limit:g} %", (1, limit), (-2, 2), axes.get_yaxis_transform(), "offset points",
                      ha="right", color=PALE)  # fmt: skip
        values = [", ".join(f"{value:g}" for name, value in row.items() if name not in OUTCOME) for row in table]
        shares = [f"{value}\n{row['reached']:.0%}" for value, row in zip(values, table, strict=True)]
        axes.set_xticks(range(len(table)), shares, fontsize=7)
        axes.margins(x=0.08, y=0.2)
        axes.set(xlabel=f"{told['axis']}; share that arrives", ylabel="rms from the target [%]", yscale="log")

    caption = (
        f"{told['question']} {told['samples']} simulated samples: median (mark) and largest (line) distance from the "
        "target; orange squares where some samples miss it or become its mirror image."
    )
    return Plan(f"Study: {told['study']}", caption, draw)


FIGURES: dict[str, Plan] = {
    "stretches": Plan("Stretches", "Errors of the stretches, by area of the sheet.", _stretches, axes=2),
    "angles": Plan("Angles", "Director and twist, by area of the sheet.", _angles, axes=2),
    "jumps": Plan("Jumps between neighbours", "Where the director turns much, the film has to even it out.", _jumps),
    "energy": Plan(
        "Energy history",
        "The winner's energy on the finest mesh, with the weight of the director's smoothness. Where the last point "
        "lies apart, another sheet with the same metric was taken, whose twist carries more of the bending: its energy "
        "without that weight.",
        _energy,
        wanted=lambda review: bool(np.any(review.design.flattening.energy > 0)),
    ),
    "starts": Plan(
        "Starts that competed",
        "The lowest bar wins: error of the stretches times the share of bending that twist cannot reach. A symmetric "
        f"solution (◆) wins over lopsided ones less than {100 * FAVOUR:.0f} % better. Hatched: flipped triangles "
        "or a crossing outline; starts that dropped out early show what they had by then. Where the corrected sheet is "
        "heated, its distance from the target is written; if it does not arrive, the next finalist is heated too.",
        _starts,
        wanted=lambda review: bool(review.design.starts),
    ),
    "reach": Plan(
        "Curvature reached by twist",
        "Twist curvature of the target against what the twist prescribes (dashed: all of it); filtering and the cap "
        "on the twist flatten the cloud.",
        _reach,
    ),
    "heating": Plan(
        "Heating",
        "Energies of the simulated sheet, per Young's modulus.",
        _heating,
        wanted=lambda review: review.prediction is not None,
    ),
    "budget": Plan("Alignment error budget", "What the verniers can tell, against the tolerance.", _budget),
}
"""The figures in the order of the report."""

THEMED = {INK: "var(--ink)", PALE: "var(--pale)", FIRST: "var(--first)", SECOND: "var(--second)", THIRD: "var(--third)"}


def themed(svg: str, name: str) -> str:
    """A figure that follows the page: its colours become CSS variables, its names unique on the page."""
    for colour, variable in THEMED.items():
        svg = svg.replace(colour, variable)
    svg = re.sub(r'id="', f'id="{name}-', svg)
    svg = re.sub(r'(url\(#|href="#)', rf"\g<1>{name}-", svg)
    svg = re.sub(
        r'<svg [^>]*?viewBox="([^"]*)"[^>]*>',
        rf'<svg viewBox="\1" role="img" aria-labelledby="fig-{name}">',
        svg,
        count=1,
    )
    return svg.replace("DejaVu Sans", "inherit").replace("'inherit'", "inherit")


def palette(name: str) -> Floats:
    """(256, 3) colours in [0, 1]; the cyclic map is turned by 45 degrees, so that the axes have its colours."""
    from matplotlib import colormaps

    colours = colormaps[name](np.linspace(0, 1, 256))[:, :3]
    return np.asarray(np.roll(colours, 64, axis=0) if name == "twilight" else colours)


def polarised(domains: Domains) -> dict[str, bytes]:
    """The sheet between crossed polarisers, as PNG by angle of the first polariser, seen from above."""
    return {f"{angle:g}": _grey(domains, transmission(domains, np.radians(angle))) for angle in POLARISERS}


def _grey(domains: Domains, share: Floats) -> bytes:
    from matplotlib.collections import PolyCollection
    from matplotlib.figure import Figure

    low, high = domains.vertices.min(axis=0), domains.vertices.max(axis=0)
    size = (high - low) / (high - low).max() * PIXELS / 100
    figure = Figure(figsize=(float(size[0]), float(size[1])))
    axes = figure.add_axes((0, 0, 1, 1), xlim=(low[0], high[0]), ylim=(low[1], high[1]))
    axes.set_axis_off()
    axes.add_collection(
        PolyCollection(
            list(domains.corners), array=share, cmap="gray", clim=(0, 0.5), edgecolors="face", linewidths=0.3
        )
    )
    data = io.BytesIO()
    figure.savefig(data, dpi=100, transparent=True, metadata={"Software": None})
    return data.getvalue()


def maps(review: Review) -> bytes:
    """The sheet in four colourings, as SVG for paper; domains are one picture, letters stay letters."""
    from matplotlib import rc_context
    from matplotlib.collections import LineCollection, PolyCollection
    from matplotlib.colors import ListedColormap
    from matplotlib.figure import Figure

    domains, theta = review.domains, review.domains.theta
    twist = float(np.degrees(np.abs(domains.dtheta).max())) or 1.0
    edge = np.sqrt(np.abs(domains.area) * 4 / np.sqrt(3)) * 1000
    shown = (
        ("director θ [°]", np.degrees(theta), "twilight", (0, 180)),
        ("twist Δθ [°]", np.degrees(domains.dtheta), "PuOr", (-twist, twist)),
        ("error of stretches [%]", 100 * np.abs(review.errors).max(axis=1), "viridis", None),
        ("size: edge [µm]", edge, "cividis", None),
    )
    low, high = domains.vertices.min(axis=0), domains.vertices.max(axis=0)
    tall = high[1] - low[1] > 1.3 * (high[0] - low[0])
    with rc_context(STYLE):
        figure = Figure(figsize=(7.5, 5.2 if tall else 6.6), layout="constrained")
        for axes, (label, values, name, limits) in zip(
            figure.subplots(*((1, 4) if tall else (2, 2))).flat, shown, strict=True
        ):
            look: Any = {"edgecolors": "face", "linewidths": 0.2, "rasterized": True}
            colours = ListedColormap(palette(name))
            drawn_ = PolyCollection(list(domains.corners), array=values, cmap=colours, clim=limits, **look)
            axes.add_collection(drawn_)
            axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), aspect="equal", xlabel="x [mm]")
            figure.colorbar(drawn_, ax=axes, location="bottom", label=label, shrink=0.9)
            if name == "twilight":
                some = slice(None, None, max(1, len(domains) // 700))
                reach = 0.3 * np.sqrt(np.prod(high - low) / 700) * np.column_stack([np.cos(theta), np.sin(theta)])[some]
                ends = np.stack([domains.centroid[some] - reach, domains.centroid[some] + reach], axis=1)
                axes.add_collection(LineCollection(list(ends), colors="black", linewidths=0.4))
        data = io.BytesIO()
        figure.savefig(data, format="svg", dpi=220, transparent=True, metadata={"Date": None, "Creator": None})
    return data.getvalue()


def shapes(review: Review, found: Predicted) -> bytes:
    """Target and prediction seen along z, as PNG for paper: shaded target, deviation, and heights."""
    from matplotlib import rc_context
    from matplotlib.figure import Figure

    target, faces = review.design.surface.vertices, review.design.surface.faces
    hot = found.frames[-1]
    height = (min(target[:, 2].min(), hot[:, 2].min()), max(target[:, 2].max(), hot[:, 2].max()))
    low = np.minimum(target.min(axis=0), hot.min(axis=0))[:2]
    high = np.maximum(target.max(axis=0), hot.max(axis=0))[:2]
    panels = (
        ("target, height z [mm]", target, target[:, 2], "cividis", height),
        ("prediction, height z [mm]", hot, hot[:, 2], "cividis", height),
        ("distance from the target [mm]", hot, found.deviation, "viridis", (0, None)),
    )
    with rc_context(STYLE):
        figure = Figure(figsize=(7.5, 3.9), layout="constrained")
        for axes, (label, points, values, name, limits) in zip(figure.subplots(1, 3), panels, strict=True):
            drawn_ = axes.tripcolor(points[:, 0], points[:, 1], faces, values, shading="gouraud", cmap=name,
                                    vmin=limits[0], vmax=limits[1])  # fmt: skip
            axes.tricontour(points[:, 0], points[:, 1], faces, points[:, 2], levels=10, colors="white", linewidths=0.3)
            axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), aspect="equal", xlabel="x [mm]")
            figure.colorbar(drawn_, ax=axes, location="bottom", label=label, shrink=0.9)
        data = io.BytesIO()
        figure.savefig(data, dpi=200, metadata={"Software": None})
    return data.getvalue()
