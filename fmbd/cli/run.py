"""`fmbd run`: simulate a model into an archive."""

import argparse
import re
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fmbd.cli.common import (
    BAD_INPUT,
    DONE,
    INTERRUPTED,
    STOPPED,
    add_model,
    compiling_announced,
    facts,
    progress_bar,
    read_model,
    show,
)
from fmbd.results.course import course

if TYPE_CHECKING:
    from fmbd.model.simulation import Simulation
    from fmbd.results.run import Run

SUFFIX = ".vtkhdf"


def add(commands: Any) -> None:
    """Add the command to the parser."""
    parser = commands.add_parser(
        "run",
        help="simulate a model and archive the results",
        description="Simulate a model. The results are archived while they are computed: the file can be read at any "
        "moment, and Ctrl-C keeps what is in it.",
    )
    add_model(parser)
    parser.add_argument(
        "-o",
        "--output",
        metavar="FILE",
        type=Path,
        help=f"the archive (default: the model's name + {SUFFIX})",
    )
    for key, metavar, what in (
        ("method", "NAME", "auto, dop853, rk45, rodas5p, radau, generalized_alpha or baumgarte"),
        ("rtol", "NUMBER", "relative tolerance of a step"),
        ("duration", "SECONDS", "simulated time"),
    ):
        parser.add_argument(f"--{key}", metavar=metavar, help=f"{what}; short for --set simulation.{key}=...")
    parser.add_argument(
        "--no-drawing", action="store_true", help="leave out what ParaView plays; the file is smaller"
    )
    parser.add_argument("--quiet", action="store_true", help="print nothing but errors")
    parser.set_defaults(command=_run)


def _run(args: argparse.Namespace) -> int:
    from fmbd.results.simulate import FRAMES, simulate

    given = {key: getattr(args, key) for key in ("method", "rtol", "duration")}
    model = read_model(
        args, **{f"simulation.{key}": value for key, value in given.items() if value is not None}
    )
    output = args.output or Path(re.sub(r"[^\w.-]+", "_", model.name) + SUFFIX)
    if refusal := _refusal(output):
        print(refusal, file=sys.stderr)
        return BAD_INPUT
    bar = progress_bar(model.name, model.simulation.duration, "t = {task.completed:.3g} s", quiet=args.quiet)
    with compiling_announced(args.quiet), bar as on_progress:
        run = simulate(model, output, on_progress, frames=0 if args.no_drawing else FRAMES)
    if not args.quiet:
        _summarise(run, output, drawn=not args.no_drawing)
    if run.status == "complete":
        return DONE
    if args.quiet:
        print(f"{model.name}: {run.status}", file=sys.stderr)
    return INTERRUPTED if run.status.startswith("stopped: interrupted") else STOPPED


def _refusal(output: Path) -> str:
    """Why a file must not be replaced; empty if it may be."""
    from fmbd.results.archive import ArchiveError
    from fmbd.results.reader import read_archive

    if not output.is_file():
        return ""
    try:
        running = read_archive(output).status == "running"
    except ArchiveError as error:
        return f"{error}; it is left as it is: name another file with -o"
    return f"{output}: another run is writing it: name another file with -o" if running else ""


def _accuracy(simulation: "Simulation") -> str:
    """What sets the steps."""
    step = simulation.generalized_alpha.step
    if simulation.method == "generalized_alpha" and step is not None:
        return f"steps of {step:g} s"
    return f"rtol {simulation.rtol:g}, atol {simulation.atol:g}"


def _method(run: "Run") -> str:
    picked = run.statistics.get("choice")
    return f"auto: {picked}" if picked else run.model.simulation.method


def _summarise(run: "Run", output: Path, drawn: bool) -> None:
    simulation = run.model.simulation
    size = output.stat().st_size / 1e6
    show(f"{run.model.name}: {run.status}", style="bold")
    rows = [
        ("method", f"{_method(run)}, {_accuracy(simulation)}"),
        (
            "simulated",
            f"{run.statistics['time_reached']:g} of {simulation.duration:g} s, {len(run.time)} outputs",
        ),
        *course(run.statistics),
        ("archive", f"{output} ({size:.3g} MB){'; ParaView plays it' if drawn else ''}"),
        ("next", f"fmbd info {output}"),
        ("", f"fmbd report {output}"),
        ("", f"fmbd plot {output}"),
        ("", f"fmbd export {output} {output.with_suffix('.csv')}"),
    ]
    show(facts(rows))
