"""`fmbd report`: one page about a run, or about a study, for a browser."""

import argparse
import sys
from pathlib import Path
from typing import Any

from fmbd.cli.common import BAD_INPUT, DONE, compiling_announced, replacing, suffixed


def add(commands: Any) -> None:
    """Add the command to the parser."""
    parser = commands.add_parser(
        "report",
        help="write a page about a run or a study: the moving mechanism, plots, the model",
        description="Write one page of HTML about a run: the moving mechanism, plots to zoom and to read, the model, "
        "warnings, provenance; or about a study: verdicts, its series, convergence. It needs no network and no other "
        "file: any browser opens it from the disk.",
    )
    parser.add_argument(
        "archive", metavar="ARCHIVE", type=Path, help="what `fmbd run` or `fmbd refine` wrote"
    )
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
    from fmbd.studies.study_file import open_study
    from fmbd.studies.summary import is_study

    output = args.output or Path(f"{args.archive.stem}.html")
    try:
        with compiling_announced():
            is_about_study = is_study(args.archive)
            text = open_study(args.archive).report() if is_about_study else report(open_run(args.archive))
    except ValueError as error:
        print(f"{args.archive}: {error}", file=sys.stderr)
        return BAD_INPUT
    page = text.encode()
    with replacing(output) as file:
        file.write(page)
    print(f"wrote {output} ({len(page) / 1e6:.2g} MB)")
    return DONE
