"""`fmbd sensitivity`: how the results of a model change with numbers of its file."""

import argparse
from typing import TYPE_CHECKING, Any

from fmbd.cli.common import (
    DONE,
    add_analysis,
    add_jobs,
    add_model,
    add_quantities,
    columns,
    compiling_announced,
    progress_bar,
    read_model,
    show,
    suffixed,
)

if TYPE_CHECKING:
    from rich.table import Table

    from fmbd.studies.sensitivity import Sensitivity

EPILOG = """\
  fmbd sensitivity models/five_bar.yaml --to bodies.rod_right.length parameters.stiffness --quantity elbow_right.angle
  fmbd sensitivity models/cantilever.yaml --to materials.steel.youngs_modulus --analysis modes --quantity frequency.1
"""


def add(commands: Any) -> None:
    """Add the command to the parser."""
    parser = commands.add_parser(
        "sensitivity",
        help="how much results change with lengths, masses, gains, any number of the model file",
        description="Derivatives of quantities by numbers of the model file: central differences of two steps, "
        "extrapolated, of runs with a tight tolerance (1e-9 or 1e-10, or tighter if the model asks for it). The error "
        "is what the extrapolation changes, and the noise of the integration, which a run of ten times the tolerance "
        "shows. Of runs it is the value at the end, the peak and the mean (RMS) over time; -o keeps all series.",
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    add_model(parser)
    parser.add_argument(
        "--to",
        metavar="PATH",
        nargs="+",
        action="extend",
        required=True,
        help="numbers of the model file, such as bodies.rod.length, bodies.*.damping.mass_proportional, parameters.l1 "
        "or gravity.1",
    )
    add_quantities(
        parser,
        "what is differentiated, as `fmbd info ARCHIVE --names` lists it; of modes frequency.1 and so on",
    )
    add_analysis(parser)
    parser.add_argument(
        "--step",
        metavar="SHARE",
        type=_share,
        default=1e-3,
        help="the larger step, in shares of the number; in its unit if it is zero (default 1e-3)",
    )
    parser.add_argument(
        "-o", "--output", metavar="FILE.h5", type=suffixed(".h5"), help="all series, with their errors"
    )
    add_jobs(parser)
    parser.set_defaults(command=_sensitivity)


def _share(text: str) -> float:
    try:
        share = float(text)
    except ValueError:
        share = 0.0
    if not 0.0 < share < 1.0:
        raise argparse.ArgumentTypeError(f"'{text}' is not a share between 0 and 1")
    return share


def _sensitivity(args: argparse.Namespace) -> int:
    from fmbd.studies.sensitivity import sensitivity

    model = read_model(args)
    with compiling_announced(), progress_bar(model.name) as on_progress:
        found = sensitivity(
            model,
            args.to,
            args.quantities,
            args.analysis,
            args.jobs,
            args.step,
            on_progress,
            time=args.time,
            lock=args.lock,
            moving=args.moving,
        )
    for path in dict.fromkeys(args.to):
        first = next(one for one in found.derivatives if one.parameter == path)
        steps = f"steps {first.step:.3g} and {first.step / 2:.3g}"
        show("", f"{model.name}: by {path} = {first.nominal:g}, {steps}", style="bold")
        show("", _table(found, path))
    if args.output:
        found.save(args.output)
        show("", f"wrote {args.output}")
    return DONE


def _table(found: "Sensitivity", path: str) -> "Table":
    """Derivatives by one number; also as the share by which a quantity changes when the number grows by a share."""
    numbers = "value", "derivative", "error", "relative"
    table = columns("quantity", *numbers, "", numbers=numbers)
    for one in found.derivatives:
        if one.parameter != path:
            continue
        for what, at in one.numbers.items():
            is_zero = abs(at.derivative) <= at.error
            share = at.derivative * one.nominal / at.value if at.value else 0.0
            column, _, what = what.rpartition(" ")
            name = f"{one.quantity}.{column}".rstrip(".")
            table.add_row(
                f"{name}{'' if found.time is None else f', {what}'} [{one.unit}]",
                f"{at.value:.9g}",
                f"{at.derivative:.9g}",
                f"{at.error:.1e}",
                f"{share:.4g}" if share and not is_zero else "",
                "zero, within the error" if is_zero else "",
            )
    return table
