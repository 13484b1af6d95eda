"""`fmbd export`: quantities of a run as a table, or its drawing in files of its own."""

import argparse
import csv
import io
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fmbd.cli.common import BAD_INPUT, DONE, count, positive, progress_bar, replacing, suffixed

if TYPE_CHECKING:
    from fmbd.results.run import Run

BLOCK = 10_000
TABLE, DRAWINGS = ".csv", (".vtkhdf", ".pvd", ".vtu")
EPILOG = """\
  fmbd export five-bar.vtkhdf five-bar.csv --quantities effector.force rod_right.end.deflection
  fmbd export five-bar.vtkhdf slow.vtkhdf --frames 1000         more frames than the archive has
  fmbd export five-bar.vtkhdf bent.pvd --deflection 20          for ParaView before 5.13, and other programs
  fmbd export five-bar.vtkhdf end.vtu                           the last output time
"""


def add(commands: Any) -> None:
    """Add the command to the parser."""
    parser = commands.add_parser(
        "export",
        help="write quantities of a run to a CSV file, or its drawing for ParaView",
        description="Write quantities of a run, time first, to a CSV file: one row for each output time, one column "
        "for each quantity or component, headed name[unit], in full precision. Or draw the run anew for ParaView.",
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("archive", metavar="ARCHIVE", type=Path, help="the file that `fmbd run` wrote")
    parser.add_argument(
        "output",
        metavar="OUT",
        type=suffixed(TABLE, *DRAWINGS),
        help="the file to write: .csv, .vtkhdf, .pvd (with a folder of .vtu) or .vtu",
    )
    table = parser.add_argument_group("tables")
    table.add_argument(
        "--quantities",
        metavar="NAME",
        nargs="+",
        help="names as `fmbd info ARCHIVE --names` lists them (default: all coordinates)",
    )
    table.add_argument("--every", metavar="N", type=count, help="write every N-th output time")
    drawing = parser.add_argument_group("drawings")
    drawing.add_argument("--frames", metavar="N", type=count, help="at most so many frames (default: 300)")
    drawing.add_argument(
        "--deflection", metavar="FACTOR", type=positive, help="exaggerate the deflection of beams"
    )
    parser.set_defaults(command=_export)


def _export(args: argparse.Namespace) -> int:
    drawing = args.output.suffix.lower() != TABLE
    for option in ("quantities", "every") if drawing else ("frames", "deflection"):
        if getattr(args, option) is not None:
            kinds = TABLE if drawing else ", ".join(DRAWINGS)
            print(f"--{option} is for {kinds}, not for {args.output}", file=sys.stderr)
            return BAD_INPUT
    return _draw(args) if drawing else _tabulate(args)


def _draw(args: argparse.Namespace) -> int:
    from fmbd.results.paraview import draw
    from fmbd.results.run import open_run

    run = open_run(args.archive)
    if _is_archive(args.output):
        print(f"{args.output}: is the archive of a run: name another file", file=sys.stderr)
        return BAD_INPUT
    if not len(run.time):
        print(f"{args.archive}: has no outputs yet", file=sys.stderr)
        return BAD_INPUT
    with progress_bar("drawing", 1.0) as on_progress:
        frames = draw(run, args.output, args.frames, args.deflection or 1.0, on_progress)
    print(f"wrote {args.output}: {frames} frame{'s' if frames > 1 else ''}")
    return DONE


def _is_archive(path: Path) -> bool:
    from fmbd.results.archive import ArchiveError
    from fmbd.results.reader import read_archive

    try:
        read_archive(path)
    except ArchiveError:
        return False
    return True


def _tabulate(args: argparse.Namespace) -> int:
    import numpy as np

    from fmbd.results.run import open_run

    run = open_run(args.archive)
    names = args.quantities or list(run.source.coordinates)
    heads = [head for name in ["time", *names] for head in _heads(run, name)]
    values = np.column_stack([run.time, *(run[name] for name in names)])[:: args.every or 1]
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
