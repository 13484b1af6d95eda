"""`fmbd plot`: figures of one archive, of several in comparison, of a study."""

import argparse
import re
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fmbd.cli.common import BAD_INPUT, DONE, PICTURES, columns, compiling_announced, replacing, show, suffixed

if TYPE_CHECKING:
    from fmbd.results.plots.charts import Chart

KINDS = "joints, beams, constraints, energy, motors, reactions, shapes, mechanism"

EPILOG = f"""\
figures by name: {KINDS}
  shapes are those of the beams over time; mechanism shows the whole of it at six times

  fmbd plot five-bar.vtkhdf                                    figures 4, 5 and 6 of the paper
  fmbd plot five-bar.vtkhdf energy motors -o budget.pdf        budget-energy.pdf and budget-motors.pdf
  fmbd plot five-bar.vtkhdf rod_left.end.position '*.voltage'  quantities: those of one unit share a panel
  fmbd plot five-bar.vtkhdf rod_left.end.deflection --spectrum --from 1
  fmbd plot coarse.vtkhdf fine.vtkhdf beams -o compared.svg    several archives in one figure
  fmbd plot study.h5 -o study.svg                              convergence, from the file of `fmbd refine`
"""


def add(commands: Any) -> None:
    """Add the command to the parser."""
    parser = commands.add_parser(
        "plot",
        help="draw figures of an archive, of several in comparison, of a study",
        description="Draw figures for print. Without names: positions and rates of the joints, deflection and slope of "
        "the beams, error of the constraints.",
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument(
        "archive", metavar="ARCHIVE", type=Path, help="the file that `fmbd run` wrote, or `fmbd refine`"
    )
    parser.add_argument(
        "names",
        metavar="NAME",
        nargs="*",
        help="a quantity as `fmbd info ARCHIVE --names` lists them, a component such as rod.end.position.x, a "
        "pattern such as '*.rotor', a figure by name (see below), or another archive",
    )
    parser.add_argument(
        "-o",
        "--output",
        metavar="FILE",
        type=suffixed(*PICTURES),
        help="the file, .png, .svg or .pdf (default: the archive's name and that of the figure, .png)",
    )
    parser.add_argument("--spectrum", action="store_true", help="amplitudes by frequency instead of time")
    parser.add_argument(
        "--from",
        metavar="SECONDS",
        dest="start",
        type=float,
        default=float("-inf"),
        help="leave out what is before",
    )
    parser.add_argument(
        "--to",
        metavar="SECONDS",
        dest="end",
        type=float,
        default=float("inf"),
        help="leave out what is after",
    )
    parser.add_argument(
        "--width",
        metavar="INCHES",
        type=float,
        help="of the figure (default: 6.7, two columns; of a study 9)",
    )
    parser.set_defaults(command=_plot)


def _plot(args: argparse.Namespace) -> int:
    from fmbd.results.plots.plot import charts, figures
    from fmbd.results.plots.style import WIDTH, save
    from fmbd.results.run import open_run
    from fmbd.studies.summary import is_study

    if is_study(args.archive):
        return _plot_study(args)
    archives = [args.archive, *(Path(name) for name in args.names if _is_archive(name))]
    names = [name for name in args.names if not _is_archive(name)]
    runs = {label: open_run(path) for label, path in zip(_labels(archives), archives)}
    try:
        with compiling_announced():
            drawn = figures(runs, names, args.spectrum, (args.start, args.end), args.width or WIDTH)
    except ValueError as error:
        print(error, file=sys.stderr)
        return BAD_INPUT
    for name, figure in drawn.items():
        path = _file(args, name, len(drawn))
        with replacing(path) as file:
            save(figure, file, path.suffix.lower())
        print(f"wrote {path}")
    if args.spectrum:
        _show_peaks(charts(runs, names, True, (args.start, args.end)))
    return DONE


def _plot_study(args: argparse.Namespace) -> int:
    from fmbd.results.plots.style import save
    from fmbd.studies.plot import draw
    from fmbd.studies.study_file import open_study

    if args.names or args.spectrum:
        print(f"{args.archive}: a study is drawn whole, without names and alone", file=sys.stderr)
        return BAD_INPUT
    path = args.output or Path(f"{args.archive.stem}.png")
    with replacing(path) as file:
        save(draw(open_study(args.archive), args.width), file, path.suffix.lower())
    print(f"wrote {path}")
    return DONE


def _is_archive(name: str) -> bool:
    return Path(name).suffix == ".vtkhdf" or Path(name).is_file()


def _labels(archives: Sequence[Path]) -> list[str]:
    """Names of files without folder and suffix, if that tells them apart."""
    stems = [path.stem for path in archives]
    return stems if len(set(stems)) == len(stems) else [str(path) for path in archives]


def _file(args: argparse.Namespace, name: str, count: int) -> Path:
    """Where a figure goes; several of them by their own names."""
    if args.output is None:
        name = re.sub(r"[^\w.-]+", "_", f"{args.archive.stem}-{name}")
        return Path(f"{name}.png")
    return args.output if count == 1 else args.output.with_stem(f"{args.output.stem}-{name}")


def _show_peaks(charts: "Sequence[Chart]") -> None:
    """The highest peaks of every spectrum."""
    from fmbd.results.plots.charts import scaled
    from fmbd.results.plots.spectra import peaks

    table = columns("curve", "peaks")
    for panel in (panel for chart in charts for panel in chart.panels):
        for curve in panel.curves:
            found = []
            for frequency, height in peaks(curve):
                factor, unit = scaled(panel.unit, height)
                found.append(f"{frequency:.4g} Hz ({height * factor:.2g} {unit})")
            name = f"{panel.title} {panel.quantity.removesuffix(' amplitude')}, {curve.label}".strip()
            table.add_row(name, ", ".join(found) or "none")
    show(table)
