"""`fmbd modes`: natural frequencies, damping and shapes."""

import argparse
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from fmbd.cli.common import (
    DONE,
    add_model,
    add_rest,
    columns,
    compiling_announced,
    facts,
    lock_choice,
    number,
    read_model,
    replacing,
    show,
    shown,
    suffixed,
)

if TYPE_CHECKING:
    from rich.table import Table

    from fmbd.analyses import Modes
    from fmbd.analyses.about import Base

KINDS = (".json", ".csv", ".npz", ".mat", ".h5")


def add(commands: Any) -> None:
    """Add the command to the parser."""
    parser = commands.add_parser(
        "modes",
        help="natural frequencies, damping ratios and mode shapes",
        description="Natural frequencies, damping ratios and shapes of the small motions about a state: of all forces, "
        "gravity and those in joints included, motors, controllers and rotating frames.",
    )
    add_model(parser)
    add_about(parser)
    add_rest(parser)
    parser.add_argument(
        "--release",
        action="store_true",
        help="let go the motors that were held to find the equilibrium: they turn at the constant input that held them",
    )
    parser.add_argument("--number", metavar="N", type=_count, default=12, help="modes to print (default 12)")
    parser.add_argument(
        "-o",
        "--output",
        metavar="FILE",
        type=suffixed(*KINDS),
        help=f"write all modes with their shapes ({', '.join(KINDS)})",
    )
    parser.set_defaults(command=_modes)


def add_about(parser: argparse.ArgumentParser) -> None:
    """Arguments that say what a linearisation is about."""
    parser.add_argument(
        "--about",
        metavar="STATE",
        default="equilibrium",
        help="`equilibrium` (default), `start`, or the archive of a run, whose state at --time (default: its end) is taken",
    )
    parser.add_argument(
        "--open-loop", action="store_true", help="controllers do not act; their motors keep the input that they have"
    )


def _count(text: str) -> int:
    if not text.isdecimal() or int(text) < 1:
        raise argparse.ArgumentTypeError(f"'{text}' is not a whole number from 1 on")
    return int(text)


def _modes(args: argparse.Namespace) -> int:
    from fmbd.analyses import modes
    from fmbd.results.files import write_data

    model = read_model(args)
    with compiling_announced():
        found = modes(
            model,
            about=args.about,
            time=args.time,
            lock=lock_choice(args.lock),
            moving=args.moving,
            release=args.release,
            open_loop=args.open_loop,
        )
    show(f"{model.name}: modes about {found.base.place}", style="bold")
    show(facts([*about_facts(found.base), ("stability", _stability(found))]))
    show("", _table(found, args.number))
    if args.output:
        with replacing(args.output) as file:
            write_data(file, args.output.suffix.lower(), found.data(), found.table())
        show("", f"wrote {args.output}")
    return DONE


def about_facts(base: "Base") -> Iterator[tuple[str, str]]:
    """What was done with motors, and remarks."""
    from fmbd.cli.statics import held

    if base.locked:
        yield "motors held", held(base.locked, base.chosen)
    if base.constant:
        inputs = dict(zip(base.linearisation.arrangement.constant, base.linearisation.arrangement.inputs(), strict=True))
        model = base.linearisation.system.model
        names = list(model.motors)
        units = {"dc": "V", "torque": "N m"}
        fed = (f"{n} at {number(inputs[names.index(n)])} {units[model.motors[n].type]}" for n in base.constant)
        yield "motors free", f"{shown(fed)}, constant"
    for remark in base.remarks:
        yield "remark", remark


def _stability(found: "Modes") -> str:
    if found.stable:
        return "no motion grows"
    growing = [k + 1 for k, time in enumerate(found.decay_times) if time < 0.0]
    return f"UNSTABLE: {'modes' if len(growing) > 1 else 'mode'} {shown(map(str, growing))}"


def _table(found: "Modes", most: int) -> "Table":
    table = columns("no. []", "frequency [Hz]", "damping ratio []", "decay time [s]", "motion, by share in the kinetic energy")
    for k, pole in enumerate(found.poles[:most]):
        ratio, time = found.damping_ratios[k], found.decay_times[k]
        steady = not abs(time) < float("inf")
        if pole == 0.0:
            what = ("-", "-", "free")
        elif pole.imag > 0.0:
            what = (number(found.frequencies[k], 7), "0" if steady else number(ratio, 4), "-" if steady else number(time, 4))
        else:
            what = ("-", "-", number(time, 4))
        parts = [f"{name} {share:.0%}" for name, share in found.shares[k].items() if share > 0.05][:4]
        moving = ", ".join(parts) if max(found.shares[k].values(), default=0.0) > 0.0 else "currents alone"
        table.add_row(str(k + 1), *what, moving)
    if found.poles.size > most:
        table.add_row("...", "", "", "", f"{found.poles.size - most} more up to {number(found.frequencies.max(), 4)} Hz")
    return table
