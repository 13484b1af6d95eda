"""`fmbd inverse`: torques, currents and voltages for a prescribed motion."""

import argparse
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any, Never

from fmbd.cli.common import (
    DONE,
    STOPPED,
    add_model,
    add_output,
    columns,
    compiling_announced,
    facts,
    number,
    progress_bar,
    read_model,
    seconds,
    show,
    shown,
    suffixed,
    write_output,
)

if TYPE_CHECKING:
    from rich.table import Table

    from fmbd.analyses.inverse import Inverse

KINDS = (".csv", ".h5", ".json", ".npz", ".mat")


def add(commands: Any) -> None:
    """Add the command to the parser."""
    parser = commands.add_parser(
        "inverse",
        help="what motors must do for a prescribed motion: torques, currents, voltages",
        description="Inverse dynamics: what the motors must do so that their joints, or a point, move as prescribed "
        "over the time of the simulation. All else moves as the model does, beams vibrate. A path is followed by the "
        "rigid mechanism; how far beams and transmissions take the point off it is printed.",
        epilog="A SIGNAL is what the model file takes for one: a number, an expression in t, the name of a signal, or "
        "a mapping such as '{type: smooth_step, end: 1, from: 0.1, to: -0.1}'.",
    )
    add_model(parser)
    add_motion(parser)
    parser.add_argument(
        "--compensate",
        metavar="SECONDS",
        type=seconds,
        help="take up the deflection at rest, under gravity, so that the point comes to its path over this time",
    )
    parser.add_argument(
        "--model",
        dest="fed",
        metavar="FILE",
        type=suffixed(".yaml", ".yml"),
        help="write the model fed with these inputs, and their table beside it",
    )
    parser.add_argument(
        "--forward",
        metavar="ARCHIVE",
        type=suffixed(".vtkhdf"),
        help="run that model, write the archive, and say how closely it repeats the motion",
    )
    add_output(parser, "motion, torques, currents and voltages over time", KINDS)
    parser.set_defaults(command=lambda args: _inverse(args, parser.error))


def add_motion(parser: argparse.ArgumentParser) -> None:
    """Arguments that prescribe a motion."""
    parser.add_argument(
        "--joint",
        dest="joints",
        metavar="NAME=SIGNAL",
        action="append",
        type=_named,
        help="motion of a joint that a motor drives [rad or m]; may be repeated",
    )
    parser.add_argument(
        "--point", metavar="NAME", help="the point that moves: body.point, or a joint, for its first point"
    )
    parser.add_argument("--path", metavar=("X", "Y"), nargs=2, help="its place [m]: two signals")
    parser.add_argument(
        "--file",
        metavar="CSV",
        type=Path,
        help="instead of signals, a table with the columns time [s] and x, y, or the names of joints",
    )


def motion(args: argparse.Namespace, refuse: Callable[[str], Never]) -> dict[str, Any]:
    """The prescribed motion, as `fmbd.inverse` takes it; an unclear one is refused."""
    ways = [name for name in ("joints", "path", "file") if getattr(args, name)]
    if len(ways) != 1 or (args.joints if args.point else args.path):
        refuse("give the motion by --joint, by --point with --path or --file, or by --file alone")
    given = {"point": args.point, "path": args.path, "file": args.file}
    return given | {"joints": dict(args.joints) if args.joints else None}


def _named(text: str) -> tuple[str, str]:
    name, equals, value = text.partition("=")
    if not equals or not name:
        raise argparse.ArgumentTypeError(f"'{text}' is not of the form NAME=SIGNAL")
    return name.strip(), value


def _inverse(args: argparse.Namespace, refuse: Callable[[str], Never]) -> int:
    from fmbd.analyses.inverse import inverse

    given = motion(args, refuse)
    model = read_model(args)
    end = model.simulation.duration
    with compiling_announced(), progress_bar("following", end) as bar:
        found = inverse(model, **given, compensate=args.compensate, on_progress=bar)
    show(f"{model.name}: inverse dynamics over {end:g} s", style="bold")
    show(facts(_facts(found)))
    show("", _motors(found))
    code = DONE
    if args.forward:
        with compiling_announced(), progress_bar("running", end) as bar:
            run = found.forward(args.forward, on_progress=bar)
        away = (f"{name} within {number(size, 2)}" for name, size in found.deviation(run).items())
        code = DONE if run.status == "complete" else STOPPED
        show("", facts([("forward", f"{run.status}; {shown(away)}"), ("archive", str(args.forward))]))
    if args.fed:
        found.save_model(args.fed)
        show("", f"wrote {args.fed}; fmbd run {args.fed}")
    write_output(args.output, found.data(), found.table())
    return code


def _facts(found: "Inverse") -> Iterator[tuple[str, str]]:
    error = found.error
    if error is not None and found.path is not None:
        first, last = found.path[0], found.path[-1]
        yield (
            "point",
            f"{found.point}, from ({number(first[0], 4)}, {number(first[1], 4)}) "
            f"to ({number(last[0], 4)}, {number(last[1], 4)}) m",
        )
        k = int(error.argmax())
        rms = float((error**2).mean() ** 0.5)
        yield (
            "error",
            f"at most {number(error[k], 3)} m off its path, at {found.time[k]:g} s; RMS {number(rms, 3)} m",
        )
    for remark in found.remarks:
        yield "remark", remark


def _motors(found: "Inverse") -> "Table":
    table = columns(
        "motor",
        "torque, most [N m]",
        "RMS [N m]",
        "current, most [A]",
        "voltage, most [V]",
        "power, most [W]",
    )
    for k, name in enumerate(found.motors):
        torque, power = found.torque[:, k], found.power[:, k]
        electric = found.model.motors[name].type == "dc"
        more = [abs(found[f"{name}.{what}"]).max() if electric else None for what in ("current", "voltage")]
        values = (abs(torque).max(), (torque**2).mean() ** 0.5, *more, power.max())
        table.add_row(name, *("-" if value is None else number(value) for value in values))
    return table
