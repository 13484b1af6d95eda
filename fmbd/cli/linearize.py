"""`fmbd linearize`: the state space of a mechanism, its frequency response."""

import argparse
import sys
from math import tau
from typing import TYPE_CHECKING, Any

from fmbd.cli.common import (
    BAD_INPUT,
    DONE,
    add_model,
    add_output,
    add_plot,
    add_rest,
    columns,
    compiling_announced,
    facts,
    number,
    read_model,
    show,
    shown,
    write_output,
    write_plot,
)
from fmbd.cli.modes import about_facts, add_about

if TYPE_CHECKING:
    from numpy.typing import NDArray
    from rich.table import Table

    from fmbd.analyses.state_space import StateSpace

KINDS = (".npz", ".mat", ".json", ".csv", ".h5")
POINTS = 25
#: Poles that are printed.
ROWS = 16


def add(commands: Any) -> None:
    """Add the command to the parser."""
    parser = commands.add_parser(
        "linearize",
        help="state space A, B, C, D with names, frequency response",
        description="Linearise a mechanism about a state: x' = A x + B u, y = C x + D u. The states are independent "
        "coordinates, as many as there are degrees of freedom, their rates, and those of motors and controllers.",
    )
    add_model(parser)
    add_about(parser)
    add_rest(parser)
    parser.add_argument(
        "--inputs",
        metavar="NAME",
        nargs="+",
        help="motor.voltage or motor.torque, added to what the motor is given; load.force.x, load.force.y or "
        "load.moment; signals of the model (default: of all motors, or of all loads if there is none)",
    )
    parser.add_argument(
        "--outputs",
        metavar="NAME",
        nargs="+",
        help="quantities as `fmbd info ARCHIVE --names` lists them (default: coordinates of joints and rotors)",
    )
    parser.add_argument(
        "--bode",
        metavar="FROM:TO[:N]",
        type=_range,
        help=f"print gain and phase at N frequencies [Hz] (default {POINTS}), evenly on a logarithmic scale",
    )
    add_plot(parser, "gain and phase from FROM to TO of --bode")
    add_output(parser, "A, B, C, D, the names, and the response of --bode", KINDS)
    parser.set_defaults(command=_linearize)


def _range(text: str) -> "NDArray[Any]":
    import numpy as np

    try:
        low, high, *count = text.split(":")
        n = int(count[0]) if count else POINTS
        found = np.geomspace(float(low), float(high), n) if len(count) < 2 else np.zeros(0)
    except ValueError:
        found = np.zeros(0)
    if found.size < 2 or not np.all(np.isfinite(found)) or found[0] >= found[-1] or found[0] <= 0.0:
        raise argparse.ArgumentTypeError(
            f"'{text}' is not of the form FROM:TO or FROM:TO:N, 0 < FROM < TO in Hz"
        )
    return found


def _linearize(args: argparse.Namespace) -> int:
    from fmbd.analyses.state_space import linearize

    if args.plot and args.bode is None:
        print(
            "--plot draws the frequency response: say of which frequencies, --bode FROM:TO", file=sys.stderr
        )
        return BAD_INPUT
    model = read_model(args)
    with compiling_announced():
        space = linearize(
            model,
            about=args.about,
            time=args.time,
            inputs=args.inputs,
            outputs=args.outputs,
            lock=args.lock,
            moving=args.moving,
            open_loop=args.open_loop,
        )
    show(f"{model.name}: state space about {space.base.place}", style="bold")
    kinds = (("states", space.states), ("inputs", space.inputs), ("outputs", space.outputs))
    named = [(kind, f"{len(pairs)}: {shown([f'{n} [{u}]' for n, u in pairs])}") for kind, pairs in kinds]
    show(facts([*about_facts(space.base), *named]))
    if args.bode is None:
        show("", _poles(space))
        if space.gain().size:
            show("", _gain(space))
    else:
        for k, (name, unit) in enumerate(space.inputs):
            show("", f"response to {name} [{unit}]: gain, phase [deg]", _response(space, args.bode, k))
    write_output(args.output, space.data(args.bode), space.table())
    write_plot(args.plot, space.plot, args.bode)
    return DONE


def _poles(space: "StateSpace") -> "Table":
    table = columns("pole, real part [1/s]", "imaginary part [1/s]", "frequency [Hz]")
    poles = [pole for pole in space.poles() if pole.imag >= 0.0]
    for pole in poles[:ROWS]:
        vibrates = pole.imag > 0.0
        imaginary = (f"+- {number(pole.imag)}", number(abs(pole) / tau)) if vibrates else ("", "")
        table.add_row(number(pole.real), *imaginary)
    if len(poles) > ROWS:
        table.add_row(f"... {len(poles) - ROWS} more")
    return table


def _gain(space: "StateSpace") -> "Table":
    """What constant inputs lead to; nothing definite where a motion is free."""
    table = columns("static gain", *(f"by {name} [{unit}]" for name, unit in space.inputs[:4]))
    gain = space.gain()
    for k, (name, unit) in enumerate(space.outputs[:ROWS]):
        table.add_row(
            f"{name} [{unit}]", *("-" if value != value else number(value) for value in gain[k, :4])
        )
    return table


def _response(space: "StateSpace", frequencies: "NDArray[Any]", k: int) -> "Table":
    from fmbd.analyses.sampling import phases

    response = space.frequency_response(frequencies)[:, :, k]
    phase = phases(space, frequencies)[:, :, k]
    table = columns("frequency [Hz]", *(f"{name} [{unit}]" for name, unit in space.outputs[:6]))
    for i, frequency in enumerate(frequencies):
        cells = (f"{abs(response[i, j]):.4e}  {phase[i, j]:7.1f}" for j in range(min(6, len(space.outputs))))
        table.add_row(number(frequency, 4), *cells)
    return table
