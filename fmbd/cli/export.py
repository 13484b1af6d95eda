"""`fmbd export`: quantities of a run as a table."""

import argparse
import csv
import io
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fmbd.cli.common import DONE, count, replacing, suffixed

if TYPE_CHECKING:
    from fmbd.results.run import Run

BLOCK = 10_000


def add(commands: Any) -> None:
    """Add the command to the parser."""
    parser = commands.add_parser(
        "export",
        help="write quantities of a run to a CSV file",
        description="Write quantities of a run, time first, to a CSV file: one row for each output time, one column "
        "for each quantity or component, headed name[unit], in full precision.",
    )
    parser.add_argument("archive", metavar="ARCHIVE", type=Path, help="the file that `fmbd run` wrote")
    parser.add_argument("output", metavar="OUT.csv", type=suffixed(".csv"), help="the file to write")
    parser.add_argument(
        "--quantities",
        metavar="NAME",
        nargs="+",
        help="names as `fmbd info ARCHIVE --names` lists them (default: all coordinates)",
    )
    parser.add_argument("--every", metavar="N", type=count, default=1, help="write every N-th output time")
    parser.set_defaults(command=_export)


def _export(args: argparse.Namespace) -> int:
    import numpy as np

    from fmbd.results.run import open_run

    run = open_run(args.archive)
    names = args.quantities or list(run.source.coordinates)
    heads = [head for name in ["time", *names] for head in _heads(run, name)]
    values = np.column_stack([run.time, *(run[name] for name in names)])[:: args.every]
    with replacing(args.output) as file, io.TextIOWrapper(file, encoding="utf-8", newline="") as text:
        table = csv.writer(text, lineterminator="\n")
        table.writerow(heads)
        for first in range(0, len(values), BLOCK):
            table.writerows(values[first : first + BLOCK].tolist())
    print(f"wrote {args.output}: {len(values)} rows, {len(heads)} columns")
    return DONE


def _heads(run: "Run", name: str) -> list[str]:
    """Heads of a quantity's columns: hinge.angle[rad], or tip.position.x[m] and tip.position.y[m]."""
    unit, parts = run.units(name), run.columns(name)
    return [f"{name}.{part}[{unit}]" for part in parts] if parts else [f"{name}[{unit}]"]
