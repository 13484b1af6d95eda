"""Figures of one run or of several, by the names that a user gives."""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from fmbd.results.plots.charts import Chart
from fmbd.results.plots.figure import draw
from fmbd.results.plots.kinds import DEFAULT, chart
from fmbd.results.plots.named import charts_of, compared, within
from fmbd.results.plots.spectra import spectra
from fmbd.results.plots.style import WIDTH

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from fmbd.results.run import Run

MECHANISM = "mechanism"
GHOSTS = 6
TRAIL_POINTS = 2000

EVER = (float("-inf"), float("inf"))


def charts(
    runs: "Mapping[str, Run]",
    names: Sequence[str] = (),
    spectrum: bool = False,
    between: tuple[float, float] = EVER,
) -> list[Chart]:
    """Charts of runs by label; names are quantities, patterns, and kinds of charts (see kinds.py).

    Without names: the paper's figures 4, 5 and 6, those that the model has. Several runs are compared curve by curve.
    spectrum: amplitudes by frequency; between: from when to when [s]

    Raises UnknownQuantity, and ValueError for what cannot be shown.
    """
    of_run = {label: _of_run(run, names) for label, run in runs.items()}
    made = []
    for k, first in enumerate(next(iter(of_run.values()))):
        same = {label: within(found[k], *between) for label, found in of_run.items() if k < len(found)}
        if spectrum:
            if first.across[0] != "time":
                raise ValueError(f"{first.name}: there is no spectrum of this")
            same = {label: spectra(each) for label, each in same.items()}
        made.append(compared(same) if len(runs) > 1 else next(iter(same.values())))
    return made


def figures(
    runs: "Mapping[str, Run]",
    names: Sequence[str] = (),
    spectrum: bool = False,
    between: tuple[float, float] = EVER,
    width: float = WIDTH,
) -> "dict[str, Figure]":
    """The charts drawn, by their names; `mechanism` draws its poses. Arguments as for `charts`."""
    plain = [name for name in names if name != MECHANISM]
    if len(plain) < len(names) and (spectrum or len(runs) > 1):
        raise ValueError(f"{MECHANISM}: shows one archive over time")
    found = charts(runs, plain, spectrum, between) if plain or not names else []
    drawn = {each.name: draw(each, width) for each in found}
    if MECHANISM in names:
        (run,) = runs.values()
        drawn[MECHANISM] = mechanism(run, between, width)
    return drawn


def mechanism(run: "Run", between: tuple[float, float] = EVER, width: float = WIDTH) -> "Figure":
    """Poses of a run's mechanism over a window of time."""
    from fmbd.results.plots.mechanism import snapshots
    from fmbd.results.scene import main_track, scene, spread, window

    rows = window(run.time, *between)
    shown = scene(run, rows[spread(len(rows), TRAIL_POINTS)])
    return snapshots(shown, spread(len(shown.time), GHOSTS), main_track(run, shown.tracks), width=width)


def _of_run(run: "Run", names: Sequence[str]) -> list[Chart]:
    if names:
        return charts_of(run, names)
    return [found for kind in DEFAULT if (found := chart(run, kind)).rows]
