"""What the commands share: exit codes, arguments that name a model, plain and readable output."""

import argparse
import os
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any, BinaryIO

if TYPE_CHECKING:
    from rich.console import Console
    from rich.table import Table

    from fmbd.model import Model

DONE, STOPPED, BAD_INPUT, INTERRUPTED = 0, 1, 2, 130
#: Columns of output that goes to a file or a pipe, so that lines stay whole.
PLAIN_WIDTH = 150


def add_model(parser: argparse.ArgumentParser) -> None:
    """Arguments of a command that reads a model file."""
    parser.add_argument("model", metavar="MODEL", help="the model, a YAML file")
    parser.add_argument(
        "--set",
        metavar="PATH=VALUE",
        dest="changes",
        action="append",
        default=[],
        type=_change,
        help="change a value of the model, such as bodies.rod.elements=4, bodies.*.elements=4 or "
        "parameters.l1=0.3; may be repeated",
    )


def _change(text: str) -> tuple[str, str]:
    path, equals, value = text.partition("=")
    if not equals or not path:
        raise argparse.ArgumentTypeError(f"'{text}' is not of the form PATH=VALUE")
    return path.strip(), value


def read_model(args: argparse.Namespace, **changes: Any) -> "Model":
    """The model named on the command line with its changes, and others by path; raises ModelError."""
    from fmbd.model import load_model

    return load_model(args.model, {**dict(args.changes), **changes})


def terminal(stderr: bool = False) -> "Console":
    """Standard output, or standard error; without colours if it is not a terminal or NO_COLOR is set."""
    from rich.console import Console

    stream = sys.stderr if stderr else sys.stdout
    width = None if stream.isatty() or "COLUMNS" in os.environ else PLAIN_WIDTH
    return Console(stderr=stderr, width=width, markup=False, emoji=False, highlight=False)


def show(*parts: "str | Table", style: str | None = None) -> None:
    """Print lines and tables, without the blanks that rich leaves at the ends of lines."""
    out = terminal()
    with out.capture() as captured:
        for part in parts:
            out.print(part, style=style)
    for line in captured.get().splitlines():
        print(line.rstrip())


def facts(rows: Iterable[tuple[str, str]]) -> "Table":
    """Labels and values."""
    from rich.table import Table

    grid = Table.grid(padding=(0, 2, 0, 0))
    grid.add_column(style="bold", no_wrap=True)
    grid.add_column(overflow="fold")
    for label, value in rows:
        grid.add_row(label, value)
    return grid


def columns(*headings: str) -> "Table":
    """A table without lines; a heading that ends in a unit, `[m]`, is that of numbers; the last column may fold."""
    from rich.table import Table

    table = Table(box=None, pad_edge=False, padding=(0, 2, 0, 0), header_style="bold")
    for heading in headings:
        is_number = heading.endswith("]")
        table.add_column(heading, justify="right" if is_number else "left", no_wrap=heading != headings[-1])
    return table


def shown(names: Iterable[str], most: int = 8) -> str:
    """Names in one line, or `none`; the count of those that are left out."""
    names = list(names)
    left_out = f" and {len(names) - most} more" if len(names) > most else ""
    return (", ".join(names[:most]) or "none") + left_out


def course(statistics: Mapping[str, Any]) -> list[tuple[str, str]]:
    """How a run went, from the statistics that it leaves when it ends."""
    s = statistics
    if not s:
        return []
    return [
        ("steps", f"{s['steps']}, and {s['rejected_steps']} rejected; {s['evaluations']} evaluations"),
        ("time", f"{s['wall_time']:.3g} s on the clock, {s['cpu_time']:.3g} s of CPU"),
        ("constraint error", f"at most {s['largest_constraint_error']:.1e}"),
        ("energy balance", f"within {s['largest_energy_balance']:.1e} J"),
        *(("remark", remark) for remark in s["remarks"].splitlines()),
        *(("warning", warning) for warning in s.get("warnings", "").splitlines()),
    ]


@contextmanager
def compiling_announced(quiet: bool = False) -> Iterator[None]:
    """Say so, once, if Numba begins to compile: without a word half a minute is long."""
    from numba.core import event

    class Announcer(event.Listener):
        said = quiet

        def on_start(self, event: Any) -> None:
            if not self.said:
                print("compiling the kernels: once on this computer, up to a minute ...", file=sys.stderr)
            self.said = True

        def on_end(self, event: Any) -> None:
            pass

    with event.install_listener("numba:compile", Announcer()):
        yield


def suffixed(suffix: str) -> Callable[[str], Path]:
    """The type of an argument that names a file to write."""

    def path(text: str) -> Path:
        if Path(text).suffix.lower() != suffix:
            raise argparse.ArgumentTypeError(
                f"'{text}' does not end in {suffix}, which is what can be written"
            )
        return Path(text)

    return path


@contextmanager
def replacing(path: Path) -> Iterator[BinaryIO]:
    """A file to write that takes the place of `path` when it is complete, and not before."""
    beginning = path.with_name(f".{path.name}.{os.getpid()}")
    try:
        with beginning.open("wb") as file:
            yield file
        beginning.replace(path)
    except OSError as error:
        raise OSError(f"cannot write {path}: {error.strerror or error}") from None
    finally:
        beginning.unlink(missing_ok=True)
