"""What the commands share: exit codes, arguments that name a model, plain and readable output."""

import argparse
import os
import sys
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any, BinaryIO, SupportsFloat

if TYPE_CHECKING:
    from rich.console import Console
    from rich.table import Table

    from fmbd.model import Model

#: Kinds of files that figures are written to.
PICTURES = (".svg", ".pdf", ".png")

DONE, STOPPED, BAD_INPUT, INTERRUPTED = 0, 1, 2, 130
#: Columns of output that goes to a file or a pipe, so that lines stay whole.
PLAIN_WIDTH = 150


def add_model(parser: argparse.ArgumentParser) -> None:
    """Arguments of a command that reads a model file."""
    parser.add_argument("model", metavar="MODEL", help="the model, a YAML file")
    add_changes(parser)


def add_changes(parser: argparse.ArgumentParser) -> None:
    """The argument --set."""
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


def add_jobs(parser: argparse.ArgumentParser) -> None:
    """The argument --jobs."""
    available = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    parser.add_argument(
        "--jobs",
        metavar="N",
        type=count,
        default=available,
        help=f"runs side by side (default: {available}, the processors there are)",
    )


def count(text: str) -> int:
    """The type of an argument that counts something."""
    if not text.isdecimal() or int(text) < 1:
        raise argparse.ArgumentTypeError(f"'{text}' is not a whole number from 1 on")
    return int(text)


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


def columns(*headings: str, numbers: Collection[str] = ()) -> "Table":
    """A table without lines; headings that end in a unit, `[m]`, and those of `numbers` are put to the right; the last
    column may fold."""
    from rich.table import Table

    table = Table(box=None, pad_edge=False, padding=(0, 2, 0, 0), header_style="bold")
    for heading in headings:
        is_number = heading.endswith("]") or heading in numbers
        table.add_column(heading, justify="right" if is_number else "left", no_wrap=heading != headings[-1])
    return table


def shown(names: Iterable[str], most: int = 8) -> str:
    """Names in one line, or `none`; the count of those that are left out."""
    names = list(names)
    left_out = f" and {len(names) - most} more" if len(names) > most else ""
    return (", ".join(names[:most]) or "none") + left_out


@contextmanager
def compiling_announced(quiet: bool = False) -> Iterator[None]:
    """Say so, once, if Numba begins to compile: without a word half a minute is long."""
    from numba.core import event

    class Announcer(event.Listener):
        said = quiet

        def on_start(self, event: Any) -> None:
            if not self.said:
                print("compiling the kernels: once on this computer, a minute or two ...", file=sys.stderr)
            self.said = True

        def on_end(self, event: Any) -> None:
            pass

    with event.install_listener("numba:compile", Announcer()):
        yield


@contextmanager
def progress_bar(
    what: str, total: float = 1.0, reached: str = "", quiet: bool = False
) -> Iterator[Callable[[float], None] | None]:
    """A bar with the time left, on a terminal; `reached` is a format of how far {task.completed} of the total is."""
    if quiet or not sys.stderr.isatty():
        yield None
        return
    from rich.progress import BarColumn, Progress, TaskProgressColumn, TextColumn, TimeRemainingColumn

    columns = (
        TextColumn("{task.description}", markup=False),
        BarColumn(),
        TaskProgressColumn(),
        *([TextColumn(reached)] if reached else []),
        TimeRemainingColumn(),
        TextColumn("left"),
    )
    with Progress(*columns, console=terminal(stderr=True), transient=True) as bar:
        task = bar.add_task(what, total=total)
        yield lambda done: bar.update(task, completed=done)


def add_output(parser: argparse.ArgumentParser, what: str, kinds: Sequence[str]) -> None:
    """The argument -o of a command that writes a table of data in one of several formats."""
    parser.add_argument(
        "-o",
        "--output",
        metavar="FILE",
        type=suffixed(*kinds),
        help=f"write {what} ({', '.join(kinds)})",
    )


def write_output(output: Path | None, data: Mapping[str, Any], table: Iterable[Sequence[Any]]) -> None:
    """Write the file of -o, if it was asked for."""
    from fmbd.results.files import write_data

    if output:
        with replacing(output) as file:
            write_data(file, output.suffix.lower(), data, table)
        show("", f"wrote {output}")


def add_plot(parser: argparse.ArgumentParser, what: str) -> None:
    """The argument --plot of a command whose result can be drawn."""
    parser.add_argument(
        "--plot", metavar="FILE", type=suffixed(*PICTURES), help=f"draw {what} ({', '.join(PICTURES)})"
    )


def write_plot(path: Path | None, plot: Callable[..., None], *arguments: Any) -> None:
    """Write the file of --plot, if it was asked for: `plot` takes its path and the arguments."""
    if path:
        plot(path, *arguments)
        show("", f"wrote {path}")


def suffixed(*suffixes: str) -> Callable[[str], Path]:
    """The type of an argument that names a file to write, of one of these kinds."""

    def path(text: str) -> Path:
        if Path(text).suffix.lower() not in suffixes:
            raise argparse.ArgumentTypeError(
                f"'{text}' does not end in {' or '.join(suffixes)}, which is what can be written"
            )
        return Path(text)

    return path


def add_rest(parser: "argparse.ArgumentParser | argparse._ArgumentGroup") -> None:
    """Arguments of a command that looks for an equilibrium."""
    parser.add_argument(
        "--lock",
        metavar="MOTOR,...",
        type=_motors,
        help="hold the shafts of these motors, or of `all` or `none`, at their start angles (default: of those "
        "without which the mechanism would be free to fall)",
    )
    parser.add_argument(
        "--time", metavar="SECONDS", type=seconds, help="time of loads, motors and driven joints (default 0)"
    )
    parser.add_argument(
        "--moving",
        action="store_true",
        help="driven joints keep the speed that they have then, as in a rotating frame, and do not stand still",
    )


def add_quantities(parser: argparse.ArgumentParser, text: str) -> None:
    """The argument --quantity, with its help."""
    parser.add_argument(
        "--quantity",
        metavar="NAME",
        dest="quantities",
        nargs="+",
        action="extend",
        required=True,
        help=text,
    )


def add_analysis(parser: argparse.ArgumentParser) -> None:
    """The argument --analysis, and those of an equilibrium."""
    parser.add_argument(
        "--analysis",
        choices=["run", "statics", "modes", "frequencies"],
        default="run",
        help="over time (default); at the equilibrium; modes about it, as `fmbd modes` finds them; or undamped "
        "frequencies of beams and springs alone, as `fmbd check` shows them",
    )
    add_rest(parser.add_argument_group("of statics and modes"))


def _motors(text: str) -> str | list[str]:
    return text if text in ("all", "none") else text.split(",")


def seconds(text: str) -> float:
    """The type of an argument that is a time."""
    try:
        time = float(text)
    except ValueError:
        time = -1.0
    if not 0.0 <= time < float("inf"):
        raise argparse.ArgumentTypeError(f"'{text}' is not a time from 0 on")
    return time


def positive(text: str) -> float:
    """The type of an argument that is a positive number."""
    value = float(text)
    if not 0.0 < value < float("inf"):
        raise argparse.ArgumentTypeError(f"'{text}' is not a positive number")
    return value


def number(value: SupportsFloat, digits: int = 6) -> str:
    """A number in a table: round-off of zero is zero."""
    value = float(value)
    return f"{value if abs(value) > 1e-12 else 0.0:.{digits}g}"


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
