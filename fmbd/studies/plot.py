"""A study as a figure: a row for each quantity, its values, its differences to the finest, its errors."""

from dataclasses import replace

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from fmbd.results.plots.charts import Panel
from fmbd.results.plots.figure import draw_panel
from fmbd.results.plots.style import DASHES, style
from fmbd.studies.charts import differences, errors, over_time
from fmbd.studies.study import Result, Study

WIDTHS = {1: 5.0, 3: 9.0}  # inches, by columns
ROW = 2.2  # inches
SMALL = 0.01  # smaller powers of ten are written as such


def draw(study: Study, width: float | None = None) -> Figure:
    """Rows: results, of each quantity along each axis. Columns: over time values and differences; errors."""
    rows = max(1, len(study.results))
    columns = 3 if any(result.is_over_time for result in study.results) else 1
    with style():
        figure = Figure(figsize=(width or WIDTHS[columns], ROW * rows), layout="constrained")
        parts = figure.subfigures(rows, 1, squeeze=False)[:, 0]
        for part, result in zip(parts, study.results):
            *timed, last = part.subplots(1, columns, squeeze=False)[0]
            part.suptitle(f"{result.quantity} by {result.axis.path}", x=0.01, ha="left")
            if timed:
                _draw_over_time(timed[0], timed[1], study, result)
                labels = [f"{value:g}" for value in result.values]
                lines = timed[0].lines[: len(labels)]
                part.legend(lines, labels, title=result.axis.key, loc="outside right upper", alignment="left")
            panel = errors(result)
            _draw_errors(last, panel, result)
            part.legend(last.lines, [curve.label for curve in panel.curves], loc="outside right lower")
        return figure


def _draw_over_time(left: Axes, right: Axes, study: Study, result: Result) -> None:
    """All columns of a quantity in one panel, each with dashes of its own; the differences."""
    panels = over_time(study, result)
    pair = len(panels) == 2
    for k, panel in enumerate(panels):
        before = len(left.lines)
        draw_panel(
            left, replace(panel, quantity=panel.quantity.removesuffix(f" {'xy'[k]}")) if pair else panel
        )
        for line in left.lines[before:]:
            line.set_linestyle(DASHES[k % len(DASHES)])
    if pair:
        left.set_title("x full, y dashed")
    draw_panel(right, differences(study, result))
    right.set_xlim(left.get_xlim())
    for ax in (left, right):
        ax.set_xlabel("time [s]")


def _draw_errors(ax: Axes, panel: Panel, result: Result) -> None:
    draw_panel(ax, panel)
    ax.set_xscale("log")
    values = np.array(result.values, float)
    room = (values.max() / values.min()) ** 0.08
    ax.set_xlim(values.min() / room, values.max() * room)
    ax.set_xticks(values, [_in_print(value) for value in result.values])
    ax.minorticks_off()
    ax.set_xlabel(result.axis.key)


def _in_print(value: float) -> str:
    power = np.log10(value)
    is_power = abs(power - round(power)) < 1e-9
    return f"$10^{{{round(power)}}}$" if is_power and value <= SMALL else f"{value:g}"
