"""The command line: `./lce COMMAND`. The only place that prints and that turns faults into exit codes.

Each command imports what it runs, so that `--help`, `--version` and a wrong word are answered at once.
"""

from __future__ import annotations

import argparse
import json
import math
import signal
import sys
import time
import traceback
from collections.abc import Callable
from contextlib import suppress
from dataclasses import asdict, replace
from pathlib import Path
from typing import TYPE_CHECKING, NoReturn

from lce_solver.errors import InputError, LceError
from lce_workbench import ROOT, __version__
from lce_workbench.packages import needed

if TYPE_CHECKING:
    from lce_solver.types import Progress
    from lce_workbench.core.job import Job

DEMO = ROOT / "templates" / "demo.toml"
TOGETHER = 0.5
"""Signals closer than this are one [s]."""


class Interrupted(KeyboardInterrupt):
    """A signal. A plain `KeyboardInterrupt` in code that a library's import executes makes Python end by SIGINT."""


class Parser(argparse.ArgumentParser):
    """Usage faults are one sentence and exit code 2."""

    more: Callable[[], str] = staticmethod(str)
    """What the help says beyond the description, made when it is asked for."""

    def format_help(self) -> str:
        return super().format_help() + self.more()

    def error(self, message: str) -> NoReturn:
        msg = f"{message}; see ./lce --help"
        raise InputError(msg)


def main(argv: list[str]) -> int:
    """Run one command; return the exit code of the contract."""
    return guarded(_command, argv)


def _command(argv: list[str]) -> int:
    args = _parser().parse_args(argv)
    code: int = args.run(args)
    return code


def guarded(command: Callable[[list[str]], int], argv: list[str]) -> int:
    """Run ``command`` and turn whatever it raises into one sentence and an exit code."""
    heard: list[float] = []

    def interrupt(*_: object) -> None:
        """Raise; but signals that come together are one: `timeout` sends two, and a library at its import bears one."""
        heard.append(time.monotonic())
        if len(heard) == 1 or heard[-1] - heard[-2] > TOGETHER:
            raise Interrupted

    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        signal.signal(number, interrupt)
    try:
        with needed():
            return command(argv)
    except (Exception, KeyboardInterrupt) as fault:
        # What a library makes of a signal while it is imported is an interruption too.
        sentence, code = _told(KeyboardInterrupt() if heard else fault)
        return _fail(sentence, code, debug="--debug" in argv)


def _told(fault: BaseException) -> tuple[str, int]:
    """The sentence and the exit code of whatever a command raised."""
    match fault:
        case LceError():
            return str(fault), fault.exit_code
        case KeyboardInterrupt():
            return "interrupted; nothing was changed", 130
        case MemoryError():
            return "out of memory; take larger domains or a smaller sheet", 4
        case OSError():
            return f"{fault.filename or 'a file'}: {fault.strerror or fault}", 4
        case _:
            return f"internal fault ({type(fault).__name__}: {fault}); run with --debug and report it", 4


def _fail(sentence: str, code: int, *, debug: bool) -> int:
    if debug:
        traceback.print_exc()
    print("lce: " + " ".join(sentence.split()), file=sys.stderr)
    return code


def _parser() -> Parser:
    common = Parser(add_help=False)
    common.add_argument("--quiet", action="store_true", default=argparse.SUPPRESS, help="no progress")
    common.add_argument(
        "--json", action="store_true", default=argparse.SUPPRESS, help="progress as JSON lines on stdout"
    )
    common.add_argument("--debug", action="store_true", default=argparse.SUPPRESS, help="show the traceback of a fault")
    parser = Parser(
        prog="lce",
        description="Molds for liquid-crystal-elastomer sheets.",
        epilog="./lce gui starts FreeCAD with the workbench, ./lce test runs the test suite.",
        parents=[common],
    )
    parser.add_argument("--version", action="version", version=f"lce {__version__}")
    commands = parser.add_subparsers(title="commands", required=True, metavar="COMMAND", parser_class=Parser)

    def command(name: str, run: Callable[[argparse.Namespace], int], doc: str) -> Parser:
        sub = commands.add_parser(name, help=doc, description=doc, parents=[common])
        sub.set_defaults(run=run, command=name)
        return sub

    demo = command("demo", _demo, "Designs the shipped face and builds all its molds.")
    demo.add_argument("--out", type=Path, default=Path("out/demo"), metavar="DIR")
    for name, doc in (
        ("build", "Builds all outputs of a job."),
        ("design", "Solves the inverse problem of a job: design.npz and domains.csv."),
    ):
        sub = command(name, _job, doc)
        sub.add_argument("job", type=Path, metavar="JOB.toml")
        sub.add_argument("--out", type=Path, metavar="DIR", help="output folder; default out/NAME beside the job file")
        sub.add_argument("--set", nargs="+", action="extend", default=[], metavar="KEY=VALUE", dest="settings")
        sub.add_argument(
            "--metric",
            type=Path,
            metavar="DIR",
            help="output folder whose flat sheet to take: only the twist is solved",
        )
        if name == "build":
            _scheduler(sub)
    for name, doc in (
        ("predict", "Simulates the heating of a designed sheet and compares it with the target."),
        ("mask", "Draws the masks of a designed folder."),
        ("cad", "Builds the CAD files of a designed folder."),
        ("drawings", "Draws the fabrication drawings of a designed folder."),
        ("review", "Reads a folder's files back and writes the review: report.html, report.pdf, report.json."),
    ):
        sub = command(name, _stage, doc)
        sub.add_argument("folder", type=Path, metavar="DIR")
        if name == "mask":
            _scheduler(sub)
    studied = command(
        "study", _study, "Simulates the heating many times, with faults of film, plates or material: into DIR/studies."
    )
    studied.more = _studies
    studied.add_argument("name", metavar="NAME", help="which study, see below")
    studied.add_argument("folder", type=Path, metavar="DIR")
    studied.add_argument("--samples", type=int, metavar="N", help="default: see below")
    _scheduler(studied)
    checked = command("verify", _verify, "Reads the written files back and compares them with the design.")
    checked.add_argument("folder", type=Path, metavar="DIR")
    tried = command(
        "feasibility", _feasibility, "Tries many lambdas, or temperatures, on a coarse mesh of a job's target."
    )
    tried.add_argument("job", type=Path, metavar="JOB.toml")
    tried.add_argument("--set", nargs="+", action="extend", default=[], metavar="KEY=VALUE", dest="settings")
    plate = command("plate", _plate, "Arranges the masks of several output folders on one plate of the laser writer.")
    plate.add_argument("folders", type=Path, nargs="+", metavar="DIR")
    plate.add_argument("--size", choices=("4in", "5in", "6in"), default="5in", help="of the square mask plate")
    plate.add_argument("--out", type=Path, required=True, metavar="DIR")
    readings = command("align", _align, "From mark readings to shift, rotation, scale and the worst mismatch.")
    readings.add_argument("readings", type=Path, metavar="READINGS.csv")
    new = command("new", _new, "Writes a commented job file for a mesh.")
    new.add_argument("target", type=Path, metavar="TARGET")
    new.add_argument("--out", type=Path, metavar="JOB.toml", help="default: TARGET with the ending .toml")
    return parser


def _scheduler(sub: argparse.ArgumentParser) -> None:
    sub.add_argument(
        "--scheduler",
        metavar="ADDRESS",
        help="Dask scheduler whose workers do the work (masks, samples): the same bytes; they need the same folders",
    )


def _studies() -> str:
    from lce_workbench.core.perturb import STUDIES
    from lce_workbench.studies import SAMPLES

    lines = (f"  {name:20}  {one.question}\n" for name, one in STUDIES.items())
    return f"\nstudies, {SAMPLES} samples unless you say another number:\n{''.join(lines)}"


def _demo(args: argparse.Namespace) -> int:
    from lce_workbench.core import jobfile
    from lce_workbench.stages import STAGES

    return _run(args, jobfile.load(DEMO), DEMO.parent, args.out, list(STAGES))


def _job(args: argparse.Namespace) -> int:
    from lce_workbench.core import jobfile
    from lce_workbench.stages import STAGES

    job = jobfile.load(args.job, args.settings)
    out = args.out or args.job.parent / "out" / args.job.stem
    names = list(STAGES) if args.command == "build" else ["design"]
    return _run(args, job, args.job.parent, out, names, metric=args.metric)


def _stage(args: argparse.Namespace) -> int:
    from lce_workbench.core import jobfile
    from lce_workbench.outputs import read_manifest

    read_manifest(args.folder)
    return _run(args, jobfile.load(args.folder / "job.toml"), args.folder, args.folder, [args.command])


def _run(
    args: argparse.Namespace, job: Job, base: Path, out: Path, names: list[str], *, metric: Path | None = None
) -> int:
    from lce_workbench.pipeline import build

    progress, close = _progress(args)
    scheduler = getattr(args, "scheduler", None)
    try:
        code = build(job, base, out, names, progress, metric=metric, scheduler=scheduler)
    finally:
        close()
    _tell(args, out, names, code)
    return code


def _tell(args: argparse.Namespace, out: Path, names: list[str], code: int) -> None:
    """Say what was found and where the files are; what the checks measured without complaint stands in the manifest."""
    from lce_workbench.outputs import read_manifest

    records = [r for r in read_manifest(out)["findings"] if r["stage"] in names]
    if getattr(args, "json", False):
        print(json.dumps({"out": str(out), "exit_code": code, "findings": records}))
        return
    quiet = getattr(args, "quiet", False)
    for record in records:
        if record["severity"] != "info" or (record["stage"] == "design" and not quiet):
            print(f"{record['severity']}: {record['message']}", file=sys.stderr)
    if not quiet:
        print(f"{', '.join(names)} written to {out}", file=sys.stderr)


def _study(args: argparse.Namespace) -> int:
    from lce_workbench.studies import SAMPLES, estimate, study

    samples = SAMPLES if args.samples is None else args.samples
    quiet = getattr(args, "quiet", False) or getattr(args, "json", False)
    if not quiet:
        print(f"study {args.name}: {estimate(args.folder, args.name, samples)}", file=sys.stderr)
    progress, close = _progress(args)
    try:
        found = study(args.folder, args.name, samples, scheduler=args.scheduler, progress=progress)
    finally:
        close()
    if getattr(args, "json", False):
        print(json.dumps(asdict(found)))
    elif not quiet:
        print(f"{found.message}\n{args.folder / 'studies' / args.name}.csv, .json and .png written", file=sys.stderr)
    return 0


def _verify(args: argparse.Namespace) -> int:
    from lce_workbench.outputs import has_error
    from lce_workbench.verify import verify

    progress, close = _progress(args)
    try:
        records = [asdict(finding) for finding in verify(args.folder, progress)]
    finally:
        close()
    for record in records:
        if getattr(args, "json", False):
            print(json.dumps(record))
        elif record["severity"] != "info" or not getattr(args, "quiet", False):
            print(f"{record['severity'].value:8}{record['check']:20} {record['message']}")
    return int(has_error(records))


def _plate(args: argparse.Namespace) -> int:
    from lce_workbench.multiplate import combine

    count = combine(args.folders, args.size, args.out)
    if not getattr(args, "quiet", False):
        print(f"{count} polygons of {2 * len(args.folders)} masks written to {args.out}", file=sys.stderr)
    return 0


def _align(args: argparse.Namespace) -> int:
    from lce_workbench.core import align

    found = align.fit(align.read(args.readings))
    numbers = align.told(found)
    if getattr(args, "json", False):
        print(json.dumps(numbers))
    else:
        for name in (name for name in numbers if f"{name}_95" in numbers):
            print(f"{name:20} {numbers[name]:10.4f} +- {numbers[f'{name}_95']:.4f} (95 %)")
        print("pass" if found.passed else "fail" + (": the readings contradict each other" if found.unlikely else ""))
    return 0 if found.passed else 1


def _feasibility(args: argparse.Namespace) -> int:
    from lce_workbench.core import feasibility, jobfile

    progress, close = _progress(args)
    try:
        found = feasibility.survey(jobfile.load(args.job, args.settings), args.job.parent, progress)
    finally:
        close()
    if getattr(args, "json", False):
        print(json.dumps(feasibility.told(found)))
    else:
        print(feasibility.table(found), end="")
    return 0 if found.best else 1


def _new(args: argparse.Namespace) -> int:
    from lce_solver.cut import handles
    from lce_solver.surface import boundary_loops, load
    from lce_workbench.core import jobfile
    from lce_workbench.core.job import Job, Target
    from lce_workbench.outputs import told

    target = args.target
    surface, findings = load(target, cuts=True)
    out = args.out or target.with_suffix(".toml")
    cuts = not (boundary_loops(surface.faces) and handles(surface) == 0)
    if out.exists():
        msg = f"{out} exists; choose another name with --out"
        raise InputError(msg)
    job = jobfile.with_default_material(replace(Job(), target=Target(mesh=_relative(target, out.parent), cuts=cuts)))
    with told(out):
        out.parent.mkdir(parents=True, exist_ok=True)
        out.write_text(jobfile.dump(job, comments=True), encoding="utf-8")
    for finding in findings:
        print(f"{finding.severity.value}: {finding.message}", file=sys.stderr)
    if cuts:
        print("info: the surface is closed or has handles, so target.cuts is true: it is cut open", file=sys.stderr)
    print(f"{out} written; look it over, then ./lce build {out}", file=sys.stderr)
    return 0


def _relative(path: Path, folder: Path) -> str:
    """``path`` as a job file in ``folder`` would name it."""
    full, home = path.resolve(), folder.resolve()
    return full.relative_to(home).as_posix() if full.is_relative_to(home) else str(full)


def _progress(args: argparse.Namespace) -> tuple[Progress, Callable[[], None]]:
    """The progress callback and how to end it: JSON lines, a bar on a terminal, or a line per stage."""
    from lce_solver.types import silent

    if getattr(args, "json", False):
        return _json_line, lambda: None
    if getattr(args, "quiet", False):
        return silent, lambda: None
    bar = Bar()
    return bar, bar.close


def _json_line(stage: str, fraction: float) -> None:
    with suppress(OSError):  # nobody listens any more: the work goes on
        energy = getattr(stage, "energy", math.nan)
        told = {"energy": energy} if math.isfinite(energy) else {}
        print(json.dumps({"stage": stage, "fraction": round(fraction, 4), **told}), flush=True)


SOON = 3.0
"""What is left of a stage is not told before so many seconds of it."""


class Bar:
    """Progress on stderr: a bar on a terminal, else one line a stage."""

    def __init__(self) -> None:
        self.stage, self.began, self.terminal = "", time.monotonic(), sys.stderr.isatty()
        self.entered, self.first, self.last = self.began, 0.0, 0.0

    def __call__(self, stage: str, fraction: float) -> None:
        now = time.monotonic()
        seconds = now - self.began
        if stage != self.stage or fraction < self.last:
            self.entered, self.first = now, fraction
        self.last = fraction
        if self.terminal:
            full = round(30 * min(max(fraction, 0.0), 1.0))
            print(
                f"\r\x1b[K{'#' * full}{'.' * (30 - full)} {stage} {seconds:.0f} s{self._left(now)}",
                end="",
                file=sys.stderr,
                flush=True,
            )
        elif stage != self.stage:
            print(f"{seconds:6.1f} s  {stage}", file=sys.stderr, flush=True)
        self.stage = stage

    def _left(self, now: float) -> str:
        """How long the stage may still take, if it goes on as it did; nothing in its first seconds."""
        done, spent = self.last - self.first, now - self.entered
        return f", about {(1 - self.last) * spent / done:.0f} s left" if spent > SOON and done > 0 else ""

    def close(self) -> None:
        """Leave the terminal's line clean."""
        if self.terminal:
            print("\r\x1b[K", end="", file=sys.stderr, flush=True)
