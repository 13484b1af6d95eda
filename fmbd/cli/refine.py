"""`fmbd refine`: how right the results of a model are, from the same model at ever finer resolution."""

import argparse
from typing import TYPE_CHECKING, Any

from fmbd.cli.common import (
    DONE,
    INTERRUPTED,
    STOPPED,
    add_analysis,
    add_jobs,
    add_model,
    add_plot,
    add_quantities,
    columns,
    compiling_announced,
    facts,
    progress_bar,
    read_model,
    show,
    suffixed,
    write_plot,
)
from fmbd.errors import ModelError

if TYPE_CHECKING:
    from fmbd.model import Model
    from fmbd.studies.study import Study

EPILOG = """\
  fmbd refine models/five_bar.yaml --over bodies.*.elements=1,2,4,8 --quantity rod_right.end.deflection
  fmbd refine models/pendulum.yaml --over simulation.rtol=1e-4,1e-6,1e-8 --quantity pivot.angle
  fmbd refine models/cantilever.yaml --over bodies.*.elements=1,2,4,8 --analysis modes --quantity frequency.1
  fmbd refine five_bar.yaml --over bodies.*.elements=1,2,4 --quantity energy.elastic --analysis statics --lock all
"""


def add(commands: Any) -> None:
    """Add the command to the parser."""
    parser = commands.add_parser(
        "refine",
        help="run a model ever finer and say how right it is: orders, error bars, what is enough",
        description="Run a family of models, side by side, and compare. Where two orders of convergence in a row "
        "agree, the error of the finest follows from them (Richardson, with Roache's factor of safety of 1.25); "
        "elsewhere it is guessed, three times the last difference or more, and said to be so. The finest is run once "
        "more with a tenth of its tolerance, so that the error of the time integration is known, too. The exit code "
        "is 1 if a member fails.",
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    add_model(parser)
    parser.add_argument(
        "--over",
        metavar="PATH=V1,V2,...",
        action="append",
        required=True,
        type=_over,
        help="values from coarse to fine; may be repeated: each is refined while the others are at their finest",
    )
    add_quantities(
        parser,
        "what is compared, as `fmbd info ARCHIVE --names` lists it; of modes frequency.1, damping_ratio.1 and so "
        "on, or mode.1.NAME, how much a mode of modal mass 1 moves what has the NAME",
    )
    add_analysis(parser)
    parser.add_argument(
        "-o", "--output", metavar="FILE.h5", type=suffixed(".h5"), help="all series and results"
    )
    add_plot(parser, "values, differences over time and convergence")
    parser.add_argument(
        "--no-check", dest="check", action="store_false", help="do not run the finest once more"
    )
    add_jobs(parser)
    parser.set_defaults(command=_refine)


def _over(text: str) -> tuple[str, list[Any]]:
    from fmbd.model.document import scalar

    path, equals, values = text.partition("=")
    if not equals or not path:
        raise argparse.ArgumentTypeError(f"'{text}' is not of the form PATH=V1,V2,...")
    return path.strip(), [scalar(value.strip()) for value in values.split(",")]


def _refine(args: argparse.Namespace) -> int:
    from fmbd.studies.refine import refine

    model = _read(args)
    with compiling_announced(), progress_bar(model.name) as on_progress:
        study = refine(
            model,
            dict(args.over),
            args.quantities,
            args.analysis,
            args.jobs,
            args.check,
            on_progress,
            time=args.time,
            lock=args.lock,
            moving=args.moving,
        )
    _summarise(study)
    if args.output:
        study.save(args.output)
        show(f"wrote {args.output}")
    write_plot(args.plot, study.plot)
    if study.is_interrupted:
        return INTERRUPTED
    return STOPPED if any(member.problem for member in study.members) else DONE


def _read(args: argparse.Namespace) -> "Model":
    """The model, at its finest if it is none without the values to refine, as segments of beams that stretch."""
    try:
        return read_model(args)
    except ModelError:
        return read_model(args, **{path: values[-1] for path, values in args.over})


def _summarise(study: "Study") -> None:
    """Each quantity along each axis; at last what failed, and the verdicts."""
    from fmbd.studies.tables import failures, share_of_time, table

    for axis in study.axes:
        others = ", ".join(
            f"{other.path} = {other.values[-1]:g}" for other in study.axes if other is not axis
        )
        show("", f"{study.model.name}: {axis.path}" + (f", with {others}" if others else ""), style="bold")
        for result in study.results:
            if result.axis is axis:
                caption, headings, rows = table(study, result)
                shown = columns(*headings, numbers=headings)
                for row in rows:
                    shown.add_row(*row)
                show("", caption, shown)
    left_out = [("left out", text) for text in failures(study)]
    time = [("time", text) for text in share_of_time(study)]
    verdicts = [("verdict", result.verdict) for result in study.results]
    show("", facts([*left_out, *time, *verdicts]))
