"""`fmbd animate`: moving pictures of a run, and stills."""

import argparse
import os
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from fmbd.cli.common import BAD_INPUT, DONE, positive, terminal

EPILOG = """\
  fmbd animate five-bar.vtkhdf five-bar.gif
  fmbd animate five-bar.vtkhdf five-bar.mp4 --speed 0.5 --size 1920x1080 --deflection 20 --colour stress
  fmbd animate five-bar.vtkhdf five-bar.png            a still: the last position, those before as ghosts
"""


def add(commands: Any) -> None:
    """Add the command to the parser."""
    parser = commands.add_parser(
        "animate",
        help="draw a run as a GIF, an MP4, or a still PNG with ghosts",
        description="Draw the mechanism in motion. No display is needed.",
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("archive", metavar="ARCHIVE", type=Path, help="the file that `fmbd run` wrote")
    parser.add_argument("output", metavar="OUT", type=Path, help="the file to write: .gif, .mp4 or .png")
    parser.add_argument(
        "--speed",
        metavar="NUMBER",
        type=positive,
        help="seconds of the run in a second (default: so that it takes about six)",
    )
    parser.add_argument("--size", metavar="WIDTHxHEIGHT", type=_size, help="pixels (default: 800 wide)")
    parser.add_argument(
        "--fps", metavar="NUMBER", type=_rate, default=25, help="frames a second (default: 25)"
    )
    parser.add_argument(
        "--trail", metavar="BODY.POINT", help="the point that leaves a trail; none for no trail"
    )
    parser.add_argument(
        "--deflection",
        metavar="FACTOR",
        type=positive,
        default=1.0,
        help="exaggerate the deflection of beams",
    )
    parser.add_argument(
        "--colour",
        metavar="WHAT",
        help="colour the beams by stress, bending_moment, shear_force, deflection or slope",
    )
    parser.add_argument(
        "--camera", choices=("tilted", "front"), default="tilted", help="from where (default: tilted)"
    )
    parser.add_argument(
        "--flat", action="store_true", help="draw as figures are drawn, without light and depth"
    )
    parser.set_defaults(command=_animate)


def _rate(text: str) -> int:
    if not text.isdecimal() or not 1 <= int(text) <= 100:
        raise argparse.ArgumentTypeError(f"'{text}' is not a whole number from 1 to 100")
    return int(text)


def _size(text: str) -> tuple[int, int]:
    width, _, height = text.partition("x")
    if not (
        width.isdecimal() and height.isdecimal() and 64 <= int(width) <= 7680 and 64 <= int(height) <= 7680
    ):
        raise argparse.ArgumentTypeError(f"'{text}' is not WIDTHxHEIGHT, such as 1280x720")
    return int(width), int(height)


def _animate(args: argparse.Namespace) -> int:
    from fmbd.results.animation.look import Look
    from fmbd.results.animation.movie import animate
    from fmbd.results.run import open_run

    trail = "" if args.trail == "none" else args.trail
    look = Look(args.speed, args.size, trail, args.deflection, args.colour, args.camera, args.flat, args.fps)
    run = open_run(args.archive)
    beginning = args.output.with_name(f".{args.output.stem}.{os.getpid()}{args.output.suffix}")
    try:
        with _progress() as on_frame:
            count = animate(run, beginning, look, on_frame, lambda remark: print(remark, file=sys.stderr))
        beginning.replace(args.output)
    except ValueError as error:
        print(error, file=sys.stderr)
        return BAD_INPUT
    except OSError as error:
        raise OSError(f"cannot write {args.output}: {error.strerror or error}") from None
    finally:
        beginning.unlink(missing_ok=True)
    size = args.output.stat().st_size / 1e6
    print(
        f"wrote {args.output} ({count} frames, {size:.2g} MB)"
        if count > 1
        else f"wrote {args.output} ({size:.2g} MB)"
    )
    return DONE


@contextmanager
def _progress() -> Iterator[Callable[[int, int], None]]:
    """A bar on a terminal."""
    if not sys.stderr.isatty():
        yield lambda done, count: None
        return
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TimeRemainingColumn

    columns = (BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())
    with Progress(*columns, console=terminal(stderr=True), transient=True) as bar:
        task = bar.add_task("drawing", total=None)
        yield lambda done, count: bar.update(task, completed=done, total=count)
