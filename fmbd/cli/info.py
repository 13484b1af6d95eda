"""`fmbd info`: how a run went, what its archive holds and can be asked for; what a study found."""

import argparse
from pathlib import Path
from typing import Any

from fmbd.cli.common import DONE, columns, facts, show, shown
from fmbd.results.course import course


def add(commands: Any) -> None:
    """Add the command to the parser."""
    parser = commands.add_parser(
        "info",
        help="say how a run went and what its archive holds, or what a study found",
        description="Say how a run went and what its archive holds, also while it is being written; or what a study "
        "found.",
    )
    parser.add_argument(
        "archive", metavar="ARCHIVE", type=Path, help="the file that `fmbd run` wrote, or `fmbd refine`"
    )
    parser.add_argument("--names", action="store_true", help="list all quantities that the archive gives")
    parser.set_defaults(command=_info)


def _info(args: argparse.Namespace) -> int:
    from fmbd.studies.summary import is_study, summary

    if is_study(args.archive):
        show(f"{args.archive}: a study", style="bold")
        show(
            facts(
                [
                    *summary(args.archive),
                    ("next", f"fmbd report {args.archive}"),
                    ("", f"fmbd plot {args.archive}"),
                ]
            )
        )
    elif args.names:
        _list(args.archive)
    else:
        _describe(args.archive)
    return DONE


def _describe(path: Path) -> None:
    from fmbd.results.reader import read_archive

    archive = read_archive(path)
    about = archive.attributes
    show(f"{path}: {archive.status}", style="bold")
    reached = f"t = {archive.time[0]:g} to {archive.time[-1]:g} s" if len(archive) else "none yet"
    named = (
        ("coordinates", archive.coordinates, "position"),
        ("multipliers", archive.constraints, "multipliers"),
        ("states", archive.state_names, "states"),
    )
    rows = [
        ("model", about["model_file"]),
        ("command", about["command"]),
        ("started", f"{str(about['started'])[:19].replace('T', ' ')} UTC, by fmbd {about['fmbd_version']}"),
        ("outputs", f"{len(archive)}, {reached}"),
        *course(archive.statistics),
        *(
            (label, shown([f"{n} [{u}]" for n, u in zip(names, archive.units[result])], most=40))
            for label, names, result in named
            if names
        ),
        ("next", f"fmbd info {path} --names"),
    ]
    show(facts((label, str(value)) for label, value in rows))


def _list(path: Path) -> None:
    from fmbd.results.run import open_run

    run = open_run(path)
    table = columns("quantity", "unit", "columns")
    for name in run.names:
        table.add_row(name, run.units(name), " ".join(run.columns(name)))
    show(table)
