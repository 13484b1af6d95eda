"""`fmbd report`: one page about a run, for a browser."""

import argparse
import sys
from pathlib import Path
from typing import Any

from fmbd.cli.common import BAD_INPUT, DONE, compiling_announced, replacing, suffixed


def add(commands: Any) -> None:
    """Add the command to the parser."""
    parser = commands.add_parser(
        "report",
        help="write a page about a run: the moving mechanism, plots, the model",
        description="Write one page of HTML about a run: the moving mechanism, plots to zoom and to read, the model, "
        "warnings, provenance. It needs no network and no other file: any browser opens it from the disk.",
    )
    parser.add_argument("archive", metavar="ARCHIVE", type=Path, help="the file that `fmbd run` wrote")
    parser.add_argument(
        "-o",
        "--output",
        metavar="FILE.html",
        type=suffixed(".html"),
        help="the file to write (default: the archive's name + .html)",
    )
    parser.set_defaults(command=_report)


def _report(args: argparse.Namespace) -> int:
    from fmbd.results.report.page import report
    from fmbd.results.run import open_run

    run = open_run(args.archive)
    output = args.output or Path(f"{args.archive.stem}.html")
    try:
        with compiling_announced():
            page = report(run).encode()
    except ValueError as error:
        print(f"{args.archive}: {error}", file=sys.stderr)
        return BAD_INPUT
    with replacing(output) as file:
        file.write(page)
    print(f"wrote {output} ({len(page) / 1e6:.2g} MB)")
    return DONE
