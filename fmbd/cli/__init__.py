"""The command line, `fmbd COMMAND ...`: one file for each command, heavy imports inside them."""

import argparse
import io
import os
import sys
from collections.abc import Sequence

from fmbd import __version__
from fmbd.cli import (
    animate,
    check,
    export,
    info,
    inverse,
    kinematics,
    linearize,
    matrices,
    modes,
    plot,
    refine,
    report,
    run,
    schema,
    sensitivity,
    statics,
    verify,
)
from fmbd.cli.common import BAD_INPUT, INTERRUPTED, STOPPED
from fmbd.errors import AnalysisError, ModelError, UnknownQuantity

COMMANDS = (
    check,
    run,
    info,
    export,
    plot,
    report,
    animate,
    statics,
    modes,
    linearize,
    inverse,
    kinematics,
    refine,
    sensitivity,
    verify,
    matrices,
    schema,
)
PIPE_CLOSED = 141

EPILOG = """\
exit codes: 0 done, 1 a run stopped before its end (its archive is kept), an analysis found no answer or a case fails,
2 bad input, 130 interrupted

  fmbd check models/five_bar.yaml                        what the model is, and whether it is what was meant
  fmbd run models/five_bar.yaml                          simulate it; the results are in five-bar.vtkhdf
  fmbd refine models/five_bar.yaml --over bodies.*.elements=1,2,4,8 --quantity rod_right.end.deflection
  fmbd export five-bar.vtkhdf tip.csv --quantities rod_right.end.position
  fmbd plot five-bar.vtkhdf                              figures: joints, beams, constraints
  fmbd modes models/five_bar.yaml --plot modes.svg       frequencies, damping, the shapes drawn on the mechanism
  fmbd report five-bar.vtkhdf                            a page for the browser, with the mechanism in motion
  fmbd animate five-bar.vtkhdf five-bar.gif              the mechanism in motion
"""


def main(argv: Sequence[str] | None = None) -> int:
    """Run one command; returns the exit code. SystemExit for a command line that cannot be understood."""
    args = _parser().parse_args(argv)
    if isinstance(sys.stdout, io.TextIOWrapper):
        sys.stdout.reconfigure(errors="replace")  # terminals that cannot show a name show question marks
    try:
        code: int = args.command(args)
        sys.stdout.flush()
        return code
    except BrokenPipeError:
        # the reader of our output, `head` perhaps, has seen enough
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return PIPE_CLOSED
    except AnalysisError as error:
        print(error, file=sys.stderr)
        return STOPPED
    except _foreseen() as error:
        print(_in_words(error), file=sys.stderr)
        return BAD_INPUT
    except KeyboardInterrupt:
        print("interrupted", file=sys.stderr)
        return INTERRUPTED


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="fmbd",
        description="Planar flexible multibody dynamics: a YAML model in, an HDF5 archive for ParaView out.",
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
        allow_abbrev=False,
    )
    parser.add_argument("--version", action="version", version=f"fmbd {__version__}")
    commands = parser.add_subparsers(metavar="COMMAND", required=True)
    for command in COMMANDS:
        command.add(commands)
    return parser


def _foreseen() -> tuple[type[Exception], ...]:
    """Errors that are answered by one line; looked up when there is one, as ArchiveError brings h5py."""
    from fmbd.results.archive import ArchiveError

    return ModelError, ArchiveError, UnknownQuantity, OSError


def _in_words(error: Exception) -> str:
    if isinstance(error, OSError) and error.filename is not None:
        return f"{error.filename}: {error.strerror}"
    return str(error)
