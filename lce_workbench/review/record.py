"""The review as plain numbers and sentences: report.json, and what both other forms print."""

from __future__ import annotations

import tomllib
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import asdict
from typing import Any

import numpy as np

from lce_solver.compare import Verdict
from lce_solver.types import Floats, Status
from lce_workbench import ROOT
from lce_workbench.core import jobfile
from lce_workbench.core.perturb import STUDIES
from lce_workbench.core.units import UM
from lce_workbench.review.data import STAGE, Review
from lce_workbench.review.measures import PAPERS, POLARISERS, anchoring, bending, budget, transmission
from lce_workbench.review.numbers import numbers, short

SCHEMA = "lce-report"
VERSION = 1
"""Raised whenever a name or a meaning in report.json changes; additions do not raise it."""

SEVERITIES = ("error", "warning", "info")
ORDERS = (0.15, 0.20)
"""Birefringence of such films, for the number of interference orders; literature values, an assumption."""
GREEN = 0.55 * UM
"""[mm]"""

APPROXIMATIONS = (
    "The metric is met in the mean over each domain; the residual stretches are listed for every domain.",
    (
        "The heated sheet is a thin shell in equilibrium: no gravity, no contact with the hot plate, no self-contact, "
        "no director that turns while the sheet stretches."
    ),
    (
        "The twist follows the linear law (the paper, S4) with the sign of our own derivation and half of what its S5 "
        "prints; it is averaged over the film's thickness and cut off at the limit."
    ),
    "A vertex of the target may have moved by resampling; the target drawn here is the resampled one.",
    "Channels end square, up to one channel width before their domain's border.",
    "Write times come from a cleanroom's public price note.",
)


def as_record(review: Review) -> dict[str, Any]:
    """Everything that is printed, as JSON holds it; see resources/report.schema.json."""
    worst = worst_of(review.findings)
    return {
        "schema": SCHEMA,
        "version": VERSION,
        "title": review.title,
        "design_code": review.code,
        "verdict": {"severity": worst, "text": VERDICTS[worst]},
        "counts": {name: sum(r["severity"] == name for r in review.findings) for name in SEVERITIES},
        "questions": [dict(zip(("question", "severity", "answer"), q, strict=True)) for q in questions(review)],
        "numbers": numbers(review),
        "findings": sorted(review.findings, key=lambda r: SEVERITIES.index(r["severity"])),
        "material": material(review),
        "prediction": review.prediction.record if review.prediction else None,
        "twist": twist(review),
        "starts": starts(review),
        "studies": list(review.studies),
        "energy": [short(e) for e in review.design.flattening.energy],
        "alignment": alignment(review),
        "anchoring": {"depth_um": review.job.channels.depth_um, "pitch_um": short(review.job.channels.pitch / UM),
                      "ratio": {name: short(ratio) for name, ratio in anchoring(review.job.channels).items()},
                      "papers": {name: list(geometry) for name, geometry in PAPERS.items()}},
        "polarisers": polarisers(review),
        "process": process(review),
        "assumptions": assumptions(review),
        "left_out": list(left_out(review)),
        "provenance": {"job": jobfile.dump(review.job), "versions": dict(review.versions),
                       "inputs": list(review.inputs), "files": list(review.files)},
        "domains": {name: _numbers(column) for name, column in review.columns.items()},
    }  # fmt: skip


VERDICTS = {
    "error": "Do not make this: at least one check found an error.",
    "warning": "Can be made; read the warnings first.",
    "info": "Can be made: every check is within its limit.",
}


def worst_of(records: Iterable[Mapping[str, Any]]) -> str:
    """The highest severity among findings; info when there are none."""
    found = {record["severity"] for record in records}
    return next((name for name in SEVERITIES if name in found), "info")


def questions(review: Review) -> Iterator[tuple[str, str, str]]:
    """The four questions of a reviewer: question, severity of the answer, answer."""
    by_stage = {s: [r for r in review.findings if r["stage"] == s] for s in ("design", "predict", "mask", "cad", STAGE)}
    yield "What will come out?", worst_of(by_stage["predict"]), _outcome(review)
    yield "How sure are we?", _sure(review)[0], _sure(review)[1]
    alarms = [r for r in review.findings if r["severity"] != "info"]
    told = " ".join(_sentence(r["message"]) for r in sorted(alarms, key=lambda r: SEVERITIES.index(r["severity"])))
    yield "What could go wrong?", worst_of(alarms), told or "No check found anything beyond its limit."
    yield "Is what we write what we designed?", *_written(by_stage)


def _sentence(message: str) -> str:
    return message[:1].upper() + message[1:].rstrip(".") + "."


def _outcome(review: Review) -> str:
    if review.prediction is None:
        return "Not simulated in this folder; run `./lce predict`."
    found = review.prediction.record
    verdict = Verdict[found["verdict"].upper()].value
    diagonal = float(np.linalg.norm(np.ptp(review.design.surface.vertices, axis=0)))
    far = review.prediction.deviation.max()
    return _sentence(
        f"In the simulation {verdict}. Its distance from the target is {found['rms_pct']:.2f} % rms and "
        f"{found['max_pct']:.2f} % at most of the diagonal of {diagonal:.1f} mm, that is up to {far:.2f} mm"
    )


def _sure(review: Review) -> tuple[str, str]:
    estimate = any(r["check"] == "material_estimate" for r in review.findings)
    solved = review.design.flattening.status is Status.CONVERGED
    said = [
        "The solver converged." if solved else "The solver did not converge.",
        "Lambda and nu are an estimate, not a measurement of this film: of all that is assumed, this weighs most."
        if estimate
        else f"Lambda and nu: {_sentence(review.design.material.source)}",
    ]
    if review.prediction is None:
        said.append("The shape was not simulated.")
    studies = [_sentence(r["message"]) for r in review.findings if r["check"] == "study"]
    said += studies or ["No study of tolerances is in this folder, so how far errors of the bench carry is not known."]
    return ("warning" if estimate or review.prediction is None else "info") if solved else "error", " ".join(said)


def _written(by_stage: Mapping[str, Sequence[Mapping[str, Any]]]) -> tuple[str, str]:
    checked, own = by_stage[STAGE], [*by_stage["mask"], *by_stage["cad"]]
    if checked:
        bad = sum(r["severity"] == "error" for r in checked)
        found = f"{bad} of them differ from the design" if bad else "all of them agree with the design"
        return worst_of(
            checked
        ), f"The written files were read back by independent readers, {len(checked)} checks: {found}."
    if own:
        worst = worst_of(own)
        found = "without an error" if worst != "error" else "with errors"
        return worst, f"Checked while they were made, {len(own)} checks {found}; not read back from the files."
    return "warning", "No masks and no CAD files are in this folder."


def material(review: Review) -> dict[str, Any]:
    """Stretches and where they come from."""
    matter = review.design.material
    return {
        "lambda": matter.lambda_,
        "nu": matter.nu,
        "across": short(matter.across),
        "source": matter.source,
        "estimate": any(r["check"] == "material_estimate" for r in review.findings),
    }


def twist(review: Review) -> dict[str, float]:
    """How much of the target's bending the twist reaches; rms over the target's area [1 / mm]."""
    bent = bending(review.design)
    return {
        "along_per_mm": short(bent.rms(bent.wanted[:, 0, 0])),
        "across_per_mm": short(bent.rms(bent.wanted[:, 1, 1])),
        "shear_per_mm": short(bent.rms(bent.wanted[:, 0, 1])),
        "prescribed_per_mm": short(bent.rms(bent.prescribed)),
        "bending_left": short(review.design.bending_left),
    }


def starts(review: Review) -> list[dict[str, Any]]:
    """The starts that competed; the design is made of the winner."""
    return [
        {
            **asdict(start),
            "angle": short(np.degrees(start.angle)),
            "status": start.status.name.lower(),
            "score": short(start.score),
            "heated_pct": short(start.heated_pct) if np.isfinite(start.heated_pct) else None,
        }
        for start in review.design.starts
    ]


def alignment(review: Review) -> dict[str, Any]:
    """The error budget; lengths in um."""
    plan = budget(review.frame, review.domains, review.job)
    rows = (
        ("One vernier, read to its step of 1 µm", plan.reading),
        (f"Shift, from all {len(review.frame.marks)} clusters", plan.shift),
        (f"Rotation (± {np.degrees(plan.rotation):.4f}°) over the lever arm of {plan.lever:.1f} mm", plan.turned),
        (f"Scale (± {plan.scale * 1e6:.0f} ppm) over the same", plan.grown),
        ("Read-out of the mismatch at the sheet's farthest corner", plan.known),
        ("Left for the hand at the microscope", plan.left),
    )
    return {
        "tolerance_um": review.job.marks.tolerance_um,
        "rows": [{"name": name, "value_um": short(value / UM)} for name, value in rows],
        "known_um": short(plan.known / UM),
        "crossed_pct": short(100 * plan.crossed),
        "twist_error_deg": short(np.degrees(plan.twist)),
    }


def polarisers(review: Review) -> dict[str, Any]:
    """Mean transmission at each angle, and what the pictures can and cannot show."""
    most = float(np.abs(review.domains.dtheta).max())
    low, high = (birefringence * review.design.thickness / GREEN for birefringence in ORDERS)
    return {
        "mean": {
            f"{angle:g}": short(
                np.average(transmission(review.domains, np.radians(angle)), weights=review.domains.area)
            )
            for angle in POLARISERS
        },
        "can": [
            "A domain is uniformly grey; it is black where the director lies along or across the first polariser.",
            (
                "The pictures at 0°, 22.5° and 45° together give the director modulo 90°; one picture alone also "
                "leaves θ and its mirror image open."
            ),
            "A plate that was mirrored, turned or exchanged shows: the dark brushes lie elsewhere.",
        ],
        "cannot": [
            (
                f"Twist hardly shows: at the largest twist of {np.degrees(most):.1f}° a dark domain passes "
                f"{100 * np.sin(most) ** 2 / 2:.2f} % of the light. To see it, set the first polariser along the "
                "bottom channels and the second across the top ones."
            ),
            (
                f"No interference colours: with a birefringence of {ORDERS[0]:g} to {ORDERS[1]:g} (assumed) the film "
                f"is {low:.0f} to {high:.0f} orders thick in green light, so it looks white to grey."
            ),
            (
                "The channels' own texture and diffraction, and the smooth passage between domains over about the "
                "film's thickness, are not drawn."
            ),
        ],
    }


def process(review: Review) -> list[dict[str, Any]]:
    """The process sheet: the paper's steps with the job's numbers filled in."""
    job = review.job
    spec = job.material
    hot = f"{spec.temperature_C:g} °C" if spec.temperature_C is not None else "180 °C (the paper's)"
    filled = {
        "width_um": f"{job.channels.width_um:g}",
        "spacing_um": f"{job.channels.spacing_um:g}",
        "depth_um": f"{job.channels.depth_um:g}",
        "gap_um": f"{job.sheet.gap_um:g}",
        "tolerance_um": f"{job.marks.tolerance_um:g}",
        "temperature": hot,
    }
    steps = tomllib.loads((ROOT / "resources" / "process.toml").read_text(encoding="utf-8"))["step"]
    return [
        {
            "name": step["name"],
            "what": step["what"].format_map(filled),
            "values": [[name, value.format_map(filled)] for name, value in step["values"]],
            "source": step["source"],
        }
        for step in steps
    ]


def assumptions(review: Review) -> list[str]:
    """What was assumed or is approximate."""
    told = [_sentence(r["message"]) for r in review.findings if r["check"] == "material_estimate"]
    return [*told, *APPROXIMATIONS]


def left_out(review: Review) -> Iterator[str]:
    """Sections that the folder has no data for."""
    if review.prediction is None:
        yield "Predicted shape: run `./lce predict` on the folder, then `./lce review`."
    if review.cell is None:
        yield "Assembled cell: run `./lce cad` on the folder, then `./lce review`."
    if not review.design.starts:
        yield "Starts that competed: the design does not record them."
    if not review.studies:
        yield (
            "Tolerance study: run `./lce study NAME DIR` on the folder, NAME being one of "
            f"{', '.join(STUDIES)}, then `./lce review DIR`."
        )


def _numbers(column: Floats) -> list[float]:
    return [int(v) if v.is_integer() else v for v in column.tolist()]
