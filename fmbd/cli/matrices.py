"""`fmbd matrices`: M, C, D, K, g, B, Phi, Phi_q of a model at a state, in the paper's coordinates."""

import argparse
import math
import shutil
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fmbd.cli.common import (
    DONE,
    STOPPED,
    add_model,
    compiling_announced,
    read_model,
    replacing,
    suffixed,
)

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from fmbd.system.matrices import Matrices

EQUATION = "M q'' + C q' + D q' + K q + g = B u + f + Phi_q^T lambda,    Phi_q q'' = gamma"
PLAIN_WIDTH = 150


def add(commands: Any) -> None:
    """Add the command to the parser."""
    parser = commands.add_parser(
        "matrices",
        help="print M, C, D, K, g, B, Phi, Phi_q with the names of the coordinates",
        description=f"Print the matrices of a model at a state, SI units, zeros as dots: {EQUATION}",
    )
    add_model(parser)
    parser.add_argument(
        "--at",
        metavar="TIME",
        type=_time,
        default=0.0,
        help="time [s] that the model is simulated to, or `initial` (default)",
    )
    parser.add_argument(
        "--precision", metavar="N", type=_digits, default=6, help="significant digits (default 6)"
    )
    parser.add_argument(
        "--npz",
        metavar="FILE.npz",
        type=suffixed(".npz"),
        help="write the matrices, in full precision and with the names, to a NumPy file instead",
    )
    parser.set_defaults(command=_matrices)


def _time(text: str) -> float:
    try:
        time = 0.0 if text == "initial" else float(text)
    except ValueError:
        time = math.nan
    if not 0.0 <= time < math.inf:
        raise argparse.ArgumentTypeError(f"'{text}' is neither a time nor `initial`")
    return time


def _digits(text: str) -> int:
    if not text.isdecimal() or not 1 <= int(text) <= 17:
        raise argparse.ArgumentTypeError(f"'{text}' is not a number of digits from 1 to 17")
    return int(text)


def _matrices(args: argparse.Namespace) -> int:
    t = args.at
    changes = {"simulation.duration": t, "simulation.output_interval": t} if t else {}
    model = read_model(args, **changes)
    if t == 0.0:
        from fmbd.system import assemble

        matrices = assemble(model).matrices()
    else:
        from fmbd.results.simulate import simulate

        with compiling_announced():
            run = simulate(model)
        if run.status != "complete":
            print(f"{model.name}: {run.status}", file=sys.stderr)
            return STOPPED
        matrices = run.system.matrices(run.position[-1], run.velocity[-1], t, run.states[-1])
    if args.npz:
        _save(args.npz, matrices, t)
        print(f"wrote {args.npz}")
    else:
        print(f"{model.name} at t = {t:g} s\n{EQUATION}\n")
        print("\n".join(_report(matrices, args.precision)).rstrip())
    return DONE


def _save(path: Path, matrices: "Matrices", t: float) -> None:
    import numpy as np

    with replacing(path) as file:
        np.savez(file, t=t, **vars(matrices))


def _report(m: "Matrices", digits: int) -> Iterator[str]:
    """All vectors beside the names, then all matrices with numbered columns."""
    coordinates, inputs, constraints = (
        _numbered(names) for names in (m.coordinates, m.inputs, m.constraints)
    )
    vectors = list(zip(m.q, m.v, m.g, m.f, strict=True))
    yield from _table("coordinates", coordinates, ["q", "q'", "g", "f"], vectors, digits)
    if inputs:
        yield from _table("inputs", inputs, ["u"], m.u[:, None], digits)
    if constraints:
        errors = list(zip(m.Phi, m.gamma, strict=True))
        yield from _table("constraints", constraints, ["Phi", "gamma"], errors, digits)
    numbers = [str(k + 1) for k in range(len(coordinates))]
    for name, rows, heads in (
        *((name, coordinates, numbers) for name in "MCDK"),
        ("B", coordinates, inputs),
        ("Phi_q", constraints, numbers),
    ):
        matrix = getattr(m, name)
        if matrix.any():
            yield from _table(name, rows, heads, matrix, digits)
        elif matrix.size:
            yield f"{name}  zero ({len(rows)} x {len(heads)})\n"


def _numbered(names: Sequence[str]) -> list[str]:
    width = len(str(len(names)))
    return [f"{k:>{width}} {name}" for k, name in enumerate(names, 1)]


def _table(
    title: str, rows: Sequence[str], heads: Sequence[str], values: "NDArray[Any] | Sequence[Any]", digits: int
) -> Iterator[str]:
    """Lines of a table; too wide for the terminal, it goes on below."""
    cells = [[_number(float(value), digits) for value in row] for row in values]
    widths = [max(map(len, column)) for column in zip(heads, *cells, strict=True)]
    label = max(map(len, (title, *rows)))
    room = shutil.get_terminal_size((PLAIN_WIDTH, 0)).columns - label
    first = 0
    while first < len(heads):
        last, used = first + 1, widths[first] + 2
        while last < len(heads) and used + widths[last] + 2 <= room:
            used += widths[last] + 2
            last += 1
        for name, line in zip((title, *rows), (heads, *cells), strict=True):
            numbers = (f"  {line[k]:>{widths[k]}}" for k in range(first, last))
            yield f"{name:{label}}{''.join(numbers)}"
        yield ""
        first = last


def _number(value: float, digits: int) -> str:
    return "." if value == 0.0 else f"{value:.{digits}g}"
