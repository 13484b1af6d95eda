"""`fmbd modes`: natural frequencies, damping and shapes."""

import argparse
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from fmbd.cli.common import (
    DONE,
    add_model,
    add_output,
    add_plot,
    add_rest,
    columns,
    compiling_announced,
    count,
    facts,
    number,
    read_model,
    show,
    shown,
    write_output,
    write_plot,
)

if TYPE_CHECKING:
    from rich.table import Table

    from fmbd.analyses.about import Base
    from fmbd.analyses.vibrations import Modes

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
    parser.add_argument(
        "--number", metavar="N", type=count, default=12, help="modes to print and draw (default 12)"
    )
    add_plot(parser, "the shapes of the modes, drawn on the mechanism")
    add_output(parser, "all modes with their shapes", KINDS)
    parser.set_defaults(command=_modes)


def add_about(parser: argparse.ArgumentParser) -> None:
    """Arguments that say what a linearisation is about."""
    parser.add_argument(
        "--about",
        metavar="STATE",
        default="equilibrium",
        help="`equilibrium` (default), `start`, or the archive of a run: its state at --time (default: its end)",
    )
    parser.add_argument(
        "--open-loop",
        action="store_true",
        help="controllers do not act; their motors keep the input that they have",
    )


def _modes(args: argparse.Namespace) -> int:
    from fmbd.analyses.vibrations import modes

    model = read_model(args)
    with compiling_announced():
        found = modes(
            model,
            about=args.about,
            time=args.time,
            lock=args.lock,
            moving=args.moving,
            release=args.release,
            open_loop=args.open_loop,
        )
    show(f"{model.name}: modes about {found.base.place}", style="bold")
    show(facts([*about_facts(found.base), ("stability", _stability(found))]))
    show("", _table(found, args.number))
    write_output(args.output, found.data(), found.table())
    write_plot(args.plot, found.plot, args.number)
    return DONE


def about_facts(base: "Base") -> Iterator[tuple[str, str]]:
    """What was done with motors, and remarks."""
    from fmbd.cli.statics import held

    if base.locked:
        yield "motors held", held(base.locked, base.chosen)
    if base.constant:
        arrangement = base.linearisation.arrangement
        inputs = dict(zip(arrangement.constant, arrangement.inputs(), strict=True))
        model = base.linearisation.system.model
        names = list(model.motors)
        units = {"dc": "V", "torque": "N m"}
        fed = (
            f"{n} at {number(inputs[names.index(n)])} {units[model.motors[n].type]}" for n in base.constant
        )
        yield "motors free", f"{shown(fed)}, constant"
    for remark in base.remarks:
        yield "remark", remark


def _stability(found: "Modes") -> str:
    if not found.poles.size:
        return "nothing can move"
    if found.stable:
        return "no motion grows"
    growing = [k + 1 for k, time in enumerate(found.decay_times) if time < 0.0]
    return f"UNSTABLE: {'modes' if len(growing) > 1 else 'mode'} {shown(map(str, growing))}"


def _table(found: "Modes", most: int) -> "Table":
    motion = "motion, by share in the kinetic energy"
    table = columns("no. []", "frequency [Hz]", "damping ratio []", "decay time [s]", motion)
    for k in range(min(most, found.poles.size)):
        table.add_row(str(k + 1), *_numbers(found, k), _motion(found.shares[k]))
    if found.poles.size > most:
        highest = number(found.frequencies.max(), 4)
        table.add_row("...", "", "", "", f"{found.poles.size - most} more, up to {highest} Hz")
    return table


def _numbers(found: "Modes", k: int) -> tuple[str, str, str]:
    """Frequency, damping ratio, decay time."""
    if found.poles[k] == 0.0:
        return "-", "-", "free"
    decay = float(found.decay_times[k])
    lasting = abs(decay) == float("inf")
    time = "-" if lasting else number(decay, 4) if decay > 0.0 else f"grows, {number(-decay, 4)}"
    if found.frequencies[k] == 0.0:
        return "-", "-", time
    return number(found.frequencies[k], 7), "0" if lasting else number(found.damping_ratios[k], 4), time


def _motion(shares: dict[str, float]) -> str:
    parts = [f"{name} {share:.0%}" for name, share in shares.items() if share > 0.05]
    return ", ".join(parts[:3]) or "currents alone"
