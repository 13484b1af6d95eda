"""Charts of what a user names: quantities, patterns, components, a window of time, several runs."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from fnmatch import fnmatchcase
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from fmbd.errors import UnknownQuantity
from fmbd.results.plots.charts import Chart, Curve, Panel, panels_by_unit
from fmbd.results.plots.kinds import KINDS, chart

if TYPE_CHECKING:
    from fmbd.results.run import Run

Array = NDArray[np.float64]

#: Panels that a comparison may have, one above the other.
MOST_COMPARED = 24


def charts_of(run: "Run", names: Sequence[str]) -> list[Chart]:
    """A chart for each kind that is named, and one for all quantities.

    A quantity may be a pattern, `*.rotor`, or a component, `rod.end.position.x`. Raises UnknownQuantity, and
    ValueError for a kind that the model has nothing of.
    """
    charts = [_present(chart(run, name), run) for name in names if name in KINDS]
    quantities = [name for name in names if name not in KINDS]
    if quantities:
        found = panels_by_unit(series(run, quantities), run.time)
        charts.append(Chart("quantities", ", ".join(quantities), tuple((panel,) for panel in found)))
    return charts


def series(run: "Run", names: Iterable[str]) -> Iterable[tuple[str, str, Array]]:
    """Name, unit and values (nt,) of the quantities that are named, by their components."""
    for name in dict.fromkeys(each for given in names for each in _matching(run, given)):
        owner, _, part = name.rpartition(".")
        if name not in run and owner in run and part in run.columns(owner):
            yield name, run.units(owner), run[owner][:, run.columns(owner).index(part)]
            continue
        if name not in run:
            raise _unknown(run, name)
        values, columns = run[name], run.columns(name)
        if not columns:
            yield name, run.units(name), values
        for k, column in enumerate(columns):
            yield f"{name}.{column}", run.units(name), values[:, k]


def _matching(run: "Run", name: str) -> list[str]:
    """The quantities that a pattern stands for."""
    if "*" not in name and "?" not in name:
        return [name]
    found = [each for each in run if fnmatchcase(each, name)]
    if not found:
        raise UnknownQuantity(f"no quantity is like '{name}' (run.names lists all names)")
    return found


def _unknown(run: "Run", name: str) -> UnknownQuantity:
    """The error for a name that is neither a quantity nor a kind of chart, with what is nearest."""
    from fmbd.model.names import closest
    from fmbd.results.quantities import unknown_quantity

    kind = closest(name, KINDS) if "." not in name else None
    if kind is not None:
        return UnknownQuantity(f"no quantity '{name}', did you mean '{kind}'?")
    return unknown_quantity(name, {each: run.quantity(each) for each in run}, run.model)


def _present(found: Chart, run: "Run") -> Chart:
    if not found.rows:
        raise ValueError(f"{found.name}: the model '{run.model.name}' has nothing to show there")
    return found


def within(chart: Chart, start: float, end: float) -> Chart:
    """The part of a chart over time from start to end [s]; raises ValueError when no output lies there."""

    def cut(curve: Curve) -> Curve:
        kept = (curve.x >= start) & (curve.x <= end)
        if np.count_nonzero(kept) < 2:
            raise ValueError(f"fewer than two output times lie between {start:g} and {end:g} s")
        return Curve(curve.label, curve.x[kept], curve.y[kept])

    if chart.across[0] != "time":
        return chart
    return _changed(chart, lambda panel: replace(panel, curves=tuple(map(cut, panel.curves))))


def compared(charts: Mapping[str, Chart]) -> Chart:
    """The same chart of several runs, by label: a panel for each curve, with the curve of every run in it.

    Raises ValueError for more panels than fit a page.
    """
    first, *_ = charts.values()
    count = sum(len(row[0].curves) for row in first.rows)
    if count > MOST_COMPARED:
        raise ValueError(f"{count} curves are too many to compare: name up to {MOST_COMPARED} quantities")
    rows = []
    for i, row in enumerate(first.rows):
        for k in range(len(row[0].curves)):
            across = [(j, panel) for j, panel in enumerate(row) if k < len(panel.curves)]
            rows.append(tuple(_together(charts, i, j, k, panel) for j, panel in across))
    return replace(first, rows=tuple(rows))


def _together(charts: Mapping[str, Chart], i: int, j: int, k: int, panel: Panel) -> Panel:
    label = panel.curves[k].label
    curves = []
    for run, found in charts.items():
        others = found.rows[i][j].curves if i < len(found.rows) and j < len(found.rows[i]) else ()
        curves += [Curve(run, curve.x, curve.y) for curve in others if curve.label == label]
    return replace(panel, curves=tuple(curves), title=label, together="same")


def _changed(chart: Chart, change: Callable[[Panel], Panel]) -> Chart:
    return replace(chart, rows=tuple(tuple(change(panel) for panel in row) for row in chart.rows))
