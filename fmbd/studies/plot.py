"""A study as a figure: a row for each quantity, its values, its differences to the finest, its errors."""

from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from fmbd.studies.study import Result, Study

Array = np.ndarray

STYLE: Any = {
    "axes.grid": True,
    "axes.spines.right": False,
    "axes.spines.top": False,
    "axes.titlesize": "medium",
    "font.size": 8,
    "grid.color": "0.88",
    "grid.linewidth": 0.5,
    "legend.edgecolor": "none",
    "legend.framealpha": 0.9,
    "lines.linewidth": 0.9,
    "lines.markersize": 4,
    "savefig.dpi": 200,
    "svg.hashsalt": "fmbd",
}
# light to dark, from coarse to fine
COLOURS = mpl.colormaps["viridis_r"]


def draw(study: Study, path: Path) -> None:
    """Write the figure of a study; the suffix of the file says in which format."""
    with mpl.rc_context(STYLE):
        metadata = {"Date": None} if path.suffix == ".svg" else None
        try:
            figure(study).savefig(path, metadata=metadata)
        except OSError as error:
            raise OSError(f"cannot write {path}: {error.strerror or error}") from None


def figure(study: Study) -> Figure:
    """Rows: results, of each quantity along each axis. Columns: over time values and differences; errors."""
    timed = any(result.is_over_time for result in study.results)
    rows, columns = max(1, len(study.results)), 3 if timed else 1
    drawing = Figure(figsize=(3.2 * columns + 0.4, 2.3 * rows + 0.3), layout="constrained")
    axes = drawing.subplots(rows, columns, squeeze=False)
    for row, result in zip(axes, study.results):
        if timed:
            values(row[0], study, result)
            differences(row[1], study, result)
        errors(row[-1], result)
    return drawing


def values(ax: Axes, study: Study, result: Result) -> None:
    """The quantity over time, of every member."""
    for label, colour, time, series in _series(study, result):
        for column in np.reshape(series, (len(time), -1)).T:
            ax.plot(time, column, color=colour, label=label)
            label = "_"
    ax.set(title=result.quantity, ylabel=f"[{result.unit}]", xlabel="time [s]")
    ax.margins(x=0)
    ax.legend(fontsize="small", title=result.axis.key, title_fontsize="small", loc="upper right")


def differences(ax: Axes, study: Study, result: Result) -> None:
    """Differences to the finest over time, and the error of its time integration."""
    *coarser, (_, _, time, reference) = _series(study, result)
    for _, colour, _, series in coarser:
        gap = np.linalg.norm(np.reshape(series - reference, (len(time), -1)), axis=1)
        if gap.any():
            ax.semilogy(time, np.where(gap > 0.0, gap, np.nan), color=colour)
    largest, smallest = result.found.differences[0].largest, result.found.differences[-1].mean
    if smallest > 0.0:
        ax.set_ylim(0.01 * smallest, 3.0 * largest)
    if result.time_error is not None and result.time_error.mean > 0.01 * smallest:
        ax.axhline(result.time_error.mean, color="0.3", linestyle=":", label="error of time")
        ax.legend(fontsize="small", loc="lower right")
    ax.set(
        title=f"difference to {result.axis.key} = {result.values[-1]:g}",
        ylabel=f"[{result.unit}]",
        xlabel="time [s]",
    )
    ax.margins(x=0)


def errors(ax: Axes, result: Result) -> None:
    """Differences to the finest and its error bar against what is refined, and the line of the observed order."""
    found, x = result.found, np.array(result.values, float)
    norms = (
        [("largest", "o", "largest"), ("mean", "s", "RMS")]
        if result.is_over_time
        else [("end", "o", "to finest")]
    )
    for norm, marker, label in norms:
        y = np.array([getattr(size, norm) for size in found.differences])
        if not y.any():
            continue
        ax.loglog(x[:-1], np.where(y > 0.0, y, np.nan), color="#0072B2", marker=marker, label=label)
        if (bar := getattr(found.bar, norm)) > 0.0:
            ax.loglog(
                x[-1:], [bar], color="#D55E00", marker=marker, linestyle="", label=f"{label}, error bar"
            )
    if found.is_settled:
        sizes = np.array([result.axis.sizes[result.axis.values.index(value)] for value in result.values])
        line = y[-1] * (sizes / sizes[-2]) ** found.order
        ax.loglog(x, line, color="0.3", linestyle=":", label=f"order {found.order:.2g}")
    title = (
        f"{'' if result.is_over_time else result.quantity + ', '}difference to {result.axis.key} = {x[-1]:g}"
    )
    ax.set(title=title, xlabel=result.axis.key, ylabel=f"[{result.unit}]")
    ax.set_xticks(x, [f"{value:g}" for value in x])
    ax.minorticks_off()
    if ax.lines:
        ax.legend(fontsize="small")


def _series(study: Study, result: Result) -> list[tuple[str, Any, Array, Array]]:
    """Label, colour, time and values of every member, from coarse to fine."""
    found = []
    for k, (i, value) in enumerate(zip(result.members, result.values)):
        measured = study.members[i].measured
        assert measured is not None and measured.time is not None
        colour = COLOURS(0.15 + 0.85 * k / (len(result.members) - 1))
        found.append((f"{value:g}", colour, measured.time, measured.values[result.quantity]))
    return found
