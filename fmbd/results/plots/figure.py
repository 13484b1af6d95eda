"""Draw charts by Matplotlib, as a journal prints them. No display is needed."""

from textwrap import fill
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine
from matplotlib.ticker import NullFormatter

from fmbd.results.plots.charts import Chart, Panel, scale_of
from fmbd.results.plots.style import MARKERS, TOLD_APART, WIDTH, graded, style, told_apart

ROW = 1.45  # inches, height of a panel
LINE = 0.16  # inches, of a legend

NAMED = 9  # curves of a family
AXIS_LINE = 20  # characters beside a panel
NO_BREAK = "\u00a0"
SPACING: Any = {"handlelength": 1.6, "columnspacing": 1.2}
CHARACTER = 0.062  # inches, in a legend


def draw(chart: Chart, width: float = WIDTH) -> Figure:
    """A figure of a chart, `width` inches wide."""
    with style():
        columns = max(len(row) for row in chart.rows)
        common = _have_one_legend(chart)
        lines = [
            0 if common else max(_legend_lines(panel, width / columns) for panel in row) for row in chart.rows
        ]
        heights = [ROW + LINE * count for count in lines]
        figure = Figure(figsize=(width, sum(heights) + 0.5), layout=ConstrainedLayoutEngine(h_pad=0.07))
        axes = figure.subplots(
            len(chart.rows), columns, sharex=True, squeeze=False, gridspec_kw={"height_ratios": heights}
        )
        for row, panels in zip(axes, chart.rows):
            for ax, panel in zip(row, panels):
                draw_panel(ax, panel)
                if not common and (panel is panels[0] or _labels(panel) != _labels(panels[0])):
                    _name_curves(ax, panel, width / columns)
            for ax in row[len(panels) :]:
                ax.remove()
        for ax in axes[-1]:
            ax.set_xlabel(f"{chart.across[0]} [{chart.across[1]}]")
        if common:
            _name_all(figure, chart, width)
        figure.align_ylabels()
        return figure


def draw_panel(ax: Axes, panel: Panel) -> None:
    """Curves, vertical axis and title of a panel."""
    factor, unit = scale_of(panel)
    for k, curve in enumerate(panel.curves):
        y = np.abs(curve.y) if panel.logarithmic else curve.y * factor
        ax.plot(curve.x, np.where(y > 0.0, y, np.nan) if panel.logarithmic else y, **_look(panel, k))
    if panel.logarithmic and any(np.nan_to_num(curve.y).any() for curve in panel.curves):
        _whole_decades(ax)
    elif panel.logarithmic:
        ax.text(0.5, 0.5, "zero throughout", transform=ax.transAxes, ha="center")
        ax.set_yticks([])
    ax.set_ylabel(fill(f"{panel.quantity} [{unit.replace(' ', NO_BREAK)}]", AXIS_LINE))
    ax.set_title(panel.title)


def _whole_decades(ax: Axes) -> None:
    """A logarithmic axis between powers of ten, the only ones that are named."""
    ax.set_yscale("log")
    low, high = np.log10(ax.dataLim.intervaly)
    ax.set_ylim(10.0 ** np.floor(low), 10.0 ** max(np.ceil(high), np.floor(low) + 1.0))
    ax.yaxis.set_minor_formatter(NullFormatter())


def _look(panel: Panel, k: int) -> dict[str, Any]:
    """Colour and dashes of a curve, marks of points."""
    if panel.curves[k].look == "guide":
        return {"color": "0.3", "linestyle": ":"}
    if _is_family(panel):
        return {"color": graded(k, len(panel.curves))}
    look = told_apart(k)
    if panel.curves[k].look == "points":
        look |= {"marker": MARKERS[k % len(MARKERS)]}
    if panel.together == "same" and k == 0:
        look |= {"linewidth": 2.4, "alpha": 0.5}  # still seen below others that are equal
    return look


def _is_family(panel: Panel) -> bool:
    """Whether curves are drawn in the order of a map of colours, and only some are named."""
    return panel.together == "family" or len(panel.curves) > TOLD_APART


def _labels(panel: Panel) -> list[str]:
    return [curve.label for curve in panel.curves]


def _named(panel: Panel) -> list[int]:
    """The curves that a legend names."""
    count = len(panel.curves)
    if not _is_family(panel):
        return [] if _labels(panel) == [panel.quantity] else list(range(count))
    return sorted({round(k) for k in np.linspace(0, count - 1, NAMED)})


def _have_one_legend(chart: Chart) -> bool:
    """Whether one legend above all panels says it."""
    labels = [_labels(panel) for panel in chart.panels]
    return any(panel.title for panel in chart.panels) or (
        len(labels) > 1 and all(own == labels[0] for own in labels)
    )


def _legend_columns(panel: Panel, width: float) -> int:
    count = len(_named(panel))
    longest = max((len(panel.curves[k].label) for k in _named(panel)), default=1)
    fit = max(1, int((width - 0.7) / (CHARACTER * longest + 0.42)))
    lines = max(1, -(-count // fit))
    return max(1, -(-count // lines))


def _legend_lines(panel: Panel, width: float) -> int:
    return -(-len(_named(panel)) // _legend_columns(panel, width))


def _name_curves(ax: Axes, panel: Panel, width: float) -> None:
    """A legend above a panel."""
    if _named(panel):
        lines = [ax.lines[k] for k in _named(panel)]
        place: Any = {"loc": "lower left", "bbox_to_anchor": (-0.01, 1.0), "borderaxespad": 0.1}
        ax.legend(
            lines,
            [panel.curves[k].label for k in _named(panel)],
            ncols=_legend_columns(panel, width),
            **SPACING,
            **place,
        )


def _name_all(figure: Figure, chart: Chart, width: float) -> None:
    """One legend above all panels."""
    panel = max(chart.panels, key=lambda panel: len(panel.curves))
    source = figure.axes[chart.panels.index(panel)]
    lines = [source.lines[k] for k in _named(panel)]
    labels = [panel.curves[k].label for k in _named(panel)]
    figure.legend(lines, labels, loc="outside upper center", ncols=_legend_columns(panel, width), **SPACING)
