"""`fmbd refine`: how right the results of a model are, from the same model at ever finer resolution."""

import argparse
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from fmbd.cli.common import (
    DONE,
    INTERRUPTED,
    STOPPED,
    add_jobs,
    add_model,
    add_plot,
    columns,
    compiling_announced,
    facts,
    progress_bar,
    read_model,
    show,
    suffixed,
    write_plot,
)

if TYPE_CHECKING:
    from rich.table import Table

    from fmbd.studies.study import Result, Study

EPILOG = """\
  fmbd refine models/five_bar.yaml --over bodies.*.elements=1,2,4,8 --quantity rod_right.end.deflection
  fmbd refine models/pendulum.yaml --over simulation.rtol=1e-4,1e-6,1e-8 --quantity pivot.angle
  fmbd refine models/cantilever.yaml --over bodies.*.elements=1,2,4,8 --analysis modes --quantity frequency.1
"""


def add(commands: Any) -> None:
    """Add the command to the parser."""
    parser = commands.add_parser(
        "refine",
        help="run a model ever finer and say how right it is: orders, error bars, what is enough",
        description="Run a family of models, side by side, and compare. Where two orders of convergence in a row "
        "agree, the error of the finest follows from them (Richardson, with Roache's factor of safety of 1.25); "
        "elsewhere it is guessed as three times the last difference, and said to be so. The finest is run once more "
        "with a tenth of its tolerance, so that the error of the time integration is known, too. The exit code is 1 "
        "if a member fails.",
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
    parser.add_argument(
        "--quantity",
        metavar="NAME",
        dest="quantities",
        nargs="+",
        action="extend",
        required=True,
        help="what is compared, as `fmbd info ARCHIVE --names` lists it, or frequency.1 and so on of the modes",
    )
    parser.add_argument(
        "--analysis",
        choices=["run", "modes"],
        default="run",
        help="over time (default), or natural frequencies",
    )
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

    model = read_model(args)
    with compiling_announced(), progress_bar(model.name) as on_progress:
        study = refine(
            model, dict(args.over), args.quantities, args.analysis, args.jobs, args.check, on_progress
        )
    _summarise(study)
    if args.output:
        study.save(args.output)
        show(f"wrote {args.output}")
    write_plot(args.plot, study.plot)
    if study.is_interrupted:
        return INTERRUPTED
    return STOPPED if any(member.problem for member in study.members) else DONE


def _summarise(study: "Study") -> None:
    """Each quantity along each axis; at last what failed, and the verdicts."""
    for axis in study.axes:
        others = ", ".join(
            f"{other.path} = {other.values[-1]:g}" for other in study.axes if other is not axis
        )
        show("", f"{study.model.name}: {axis.path}" + (f", with {others}" if others else ""), style="bold")
        for result in study.results:
            if result.axis is axis:
                show("", *(_over_time if result.is_over_time else _once)(study, result))
    verdicts = [("verdict", result.verdict) for result in study.results]
    show("", facts([*_failures(study), *_time(study), *verdicts]))


def _over_time(study: "Study", result: "Result") -> Iterator["str | Table"]:
    """Differences to the finest, orders, bounds of the error, costs."""
    size, found = result.found.size, result.found
    itself = f"at most {size.largest:.4g}, RMS {size.mean:.4g}"
    yield f"{result.quantity} [{result.unit}], {itself}; differences to the finest:"
    numbers = [
        result.axis.key,
        "largest",
        "RMS",
        "at the end",
        "order",
        "error",
        "steps",
        "evaluations",
    ]
    table = columns(*numbers, numbers=numbers)
    for k, (value, share, order) in enumerate(zip(result.values, found.shares(), _orders(result))):
        measured = study.members[result.members[k]].measured
        sizes = [found.differences[k]] if k < len(found.differences) else []
        differences = [f"{x:.2e}" for size in sizes for x in (size.largest, size.mean, size.end)] or [""] * 3
        cost = measured.statistics if measured else {}
        table.add_row(
            f"{value:g}",
            *differences,
            order,
            _bound(result, share),
            str(cost["steps"]),
            str(cost["evaluations"]),
        )
    yield table


def _once(study: "Study", result: "Result") -> Iterator["str | Table"]:
    """Values, differences to the finest, orders, bounds of the error."""
    found = result.found
    yield f"{result.quantity} [{result.unit}]"
    numbers = [result.axis.key, "value", "difference", "order", "error"]
    table = columns(*numbers, numbers=numbers)
    for k, (value, share, order) in enumerate(zip(result.values, found.shares(), _orders(result))):
        measured = study.members[result.members[k]].measured
        difference = f"{found.differences[k].end:.2e}" if k < len(found.differences) else ""
        got = f"{measured.values[result.quantity]:.12g}" if measured else ""
        table.add_row(f"{value:g}", got, difference, order, _bound(result, share))
    if found.extrapolated is not None:
        table.add_row("limit", f"{found.extrapolated:.12g}")
    yield table


def _bound(result: "Result", share: float) -> str:
    """The bound of an error; about so where it is a guess."""
    from fmbd.studies.study import percent

    return f"{'' if result.found.is_settled else '~'}{percent(share)}"


def _orders(result: "Result") -> list[str]:
    """The order at the last of each three in a row."""
    return ["", "", *(f"{order.order:.2f}" for order in result.found.orders)][: len(result.values)]


def _failures(study: "Study") -> Iterator[tuple[str, str]]:
    for member in (*study.members, *([study.check] if study.check else [])):
        if member.problem:
            changes = ", ".join(f"{path} = {value}" for path, value in member.changes.items())
            yield "left out", f"{changes}: {member.problem}"


def _time(study: "Study") -> Iterator[tuple[str, str]]:
    """What share of the last differences is the error of the time integration."""
    from fmbd.studies.study import percent

    shares = {result.quantity: result.time_share for result in study.results if result.time_share is not None}
    if shares:
        worst = max(shares, key=lambda name: shares[name])
        advice = "" if shares[worst] <= 0.1 else ": too much, choose a tighter tolerance or a shorter step"
        yield (
            "time",
            f"its integration makes {percent(shares[worst])} of the last difference in {worst}{advice}",
        )
