"""A study as a figure: a row for each quantity, its values, its differences to the finest, its errors."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from fmbd.results.plots.figure import draw_panel
from fmbd.results.plots.style import DASHES, style
from fmbd.studies.charts import differences, errors, over_time
from fmbd.studies.study import Result, Study

WIDTHS = {1: 4.0, 3: 9.0}  # inches, by columns
ROW = 2.2  # inches
ABOVE = 14.0  # points, room for a legend between axes and title


def draw(study: Study, width: float | None = None) -> Figure:
    """Rows: results, of each quantity along each axis. Columns: over time values and differences; errors."""
    timed = any(result.is_over_time for result in study.results)
    rows, columns = max(1, len(study.results)), 3 if timed else 1
    with style():
        figure = Figure(figsize=(width or WIDTHS[columns], ROW * rows + 0.3), layout="constrained")
        axes = figure.subplots(rows, columns, squeeze=False)
        for row, result in zip(axes, study.results):
            if timed:
                _draw_values(row[0], study, result)
                draw_panel(row[1], differences(study, result))
                row[1].set(title="over time", xlabel="time [s]")
            _draw_errors(row[-1], result)
        return figure


def _draw_values(ax: Axes, study: Study, result: Result) -> None:
    """All columns of a quantity in one panel, each with dashes of its own."""
    for k, panel in enumerate(over_time(study, result)):
        before = len(ax.lines)
        draw_panel(ax, panel)
        if k:
            for line in ax.lines[before:]:
                line.set_linestyle(DASHES[k % len(DASHES)])
    ax.set_xlabel("time [s]")
    ax.set_title(result.quantity, pad=ABOVE)
    lines = ax.lines[: len(result.values)]
    labels = [f"{value:g}" for value in result.values]
    ax.legend(
        lines, labels, loc="lower left", bbox_to_anchor=(-0.02, 1.0), ncols=len(labels), borderaxespad=0.1
    )


def _draw_errors(ax: Axes, result: Result) -> None:
    panel = errors(result)
    draw_panel(ax, panel)
    values = np.array(result.values, float)
    ax.set_xscale("log")
    ax.margins(x=0.05)
    ax.set_xticks(values, [f"{value:g}" for value in values])
    ax.minorticks_off()
    ax.set(title="convergence" if result.is_over_time else result.quantity, xlabel=result.axis.path)
    if ax.lines:
        ax.legend(ax.lines, [curve.label for curve in panel.curves], loc="best")
