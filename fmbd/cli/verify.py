"""`fmbd verify`: models against the published numbers of their cases."""

import argparse
from collections.abc import Iterator, Sequence
from itertools import groupby
from typing import TYPE_CHECKING, Any

from fmbd.cli.common import (
    DONE,
    STOPPED,
    add_changes,
    add_jobs,
    columns,
    compiling_announced,
    progress_bar,
    show,
)

if TYPE_CHECKING:
    from fmbd.studies.verify import Comparison


def add(commands: Any) -> None:
    """Add the command to the parser."""
    parser = commands.add_parser(
        "verify",
        help="compare models with published numbers: the verification cases of fmbd, or your own",
        description="Run verification cases: models, and files NAME.case.yaml that say what they must give, by which "
        "source, to which tolerance. Of each quantity the value is shown that comes closest to failing. The exit code "
        "is 1 if any fails.",
    )
    parser.add_argument(
        "cases",
        metavar="CASE",
        nargs="*",
        help="a name of models/verification, a case file, a model with a case file beside it, or a folder "
        "(default: all of models/verification)",
    )
    add_changes(parser)
    add_jobs(parser)
    parser.add_argument(
        "--markdown", action="store_true", help="print the cases as a Markdown table; nothing is run"
    )
    parser.set_defaults(command=_verify)


def _verify(args: argparse.Namespace) -> int:
    from fmbd.studies.verify import markdown, verify

    if args.markdown:
        print(markdown(args.cases))
        return DONE
    with compiling_announced(), progress_bar("verification") as on_progress:
        found = verify(args.cases, dict(args.changes), args.jobs, on_progress)
    for case, comparisons in groupby(found, key=lambda comparison: comparison.case):
        _show(case, list(comparisons))
    failed = [comparison for comparison in found if not comparison.holds]
    values = sum(comparison.count for comparison in found)
    verdict = f"{len(failed)} of {len(found)} FAIL" if failed else "all hold"
    show("", f"{len(found)} quantities, {values} values: {verdict}", style="bold")
    return STOPPED if failed else DONE


def _show(case: str, comparisons: Sequence["Comparison"]) -> None:
    """One case: where its numbers are from, then a row for each quantity."""
    show("", case, style="bold")
    for source in dict.fromkeys(comparison.source for comparison in comparisons):
        show(source)
    numbers = "expected", "got", "error", "tolerance"
    table = columns("quantity", "at t [s]", *numbers, "verdict", numbers=numbers)
    for variant, rows in groupby(comparisons, key=lambda comparison: comparison.variant):
        if variant:
            table.add_row(f"{variant}:")
        for found in rows:
            table.add_row(*_cells(found), style=None if found.holds else "bold red")
    show(table)


def _cells(found: "Comparison") -> Iterator[str]:
    yield found.quantity + (f" [{found.unit}]" if found.unit else "")
    yield "" if found.time is None else f"{found.time:g}"
    yield f"{found.expected:.12g}"
    yield f"{found.found:.12g}"
    yield f"{found.error:.1e}"
    yield f"{found.tolerance:.1e}"
    yield "holds" if found.holds else f"FAILS {found.problem}"
