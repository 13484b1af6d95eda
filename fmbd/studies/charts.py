"""What pictures of a study show: quantities over time, differences to the finest, errors against what is refined."""

from collections.abc import Iterator
from typing import Literal

import numpy as np

from fmbd.results.plots.charts import Chart, Curve, Panel
from fmbd.studies.study import Result, Study

Array = np.ndarray
Look = Literal["line", "points", "guide"]

#: Differences below this share of the smallest in the mean are left out: there curves only cross.
CROSSING = 0.01


def charts(study: Study) -> Iterator[Chart]:
    """Of each quantity along each axis: over time; then the errors."""
    for result in study.results:
        if result.is_over_time:
            name, title = f"{result.quantity} over time", f"{result.quantity} by {result.axis.path}"
            yield Chart(name, title, ((*over_time(study, result), differences(study, result)),))
    for result in study.results:
        title = f"Convergence: {result.quantity} by {result.axis.path}"
        yield Chart(result.quantity, title, ((errors(result),),), (result.axis.key, ""), True)


def over_time(study: Study, result: Result) -> list[Panel]:
    """Each column of a quantity, of all members from coarse to fine."""
    series = list(_series(study, result))
    columns = series[-1][2].shape[1]
    names = [""] if columns == 1 else ["x", "y"] if columns == 2 else [f"{j + 1}" for j in range(columns)]
    return [
        Panel(
            f"{_short(result)} {names[j]}".strip(),
            result.unit,
            tuple(Curve(label, time, values[:, j]) for label, time, values in series),
        )
        for j in range(columns)
    ]


def differences(study: Study, result: Result) -> Panel:
    """Differences to the finest over time, and the error of its time integration."""
    series = list(_series(study, result))
    _, time, reference = series[-1]
    least = CROSSING * result.found.differences[-1].mean
    gaps = [(label, np.linalg.norm(values - reference, axis=1)) for label, _, values in series]
    curves = [Curve(label, time, np.where(gap > least, gap, np.nan)) for label, gap in gaps]
    if result.time_error is not None and result.time_error.mean > least:
        level = np.full(2, result.time_error.mean)
        curves.append(Curve("time integration", time[[0, -1]], level, "guide"))
    return Panel("difference", result.unit, tuple(curves), True, f"difference to {_finest(result)}")


def errors(result: Result) -> Panel:
    """Differences to the finest and its error bar against what is refined, and the line of the observed order."""
    found = result.found
    x = np.array(result.values, float)
    norms = {"largest": "largest", "mean": "RMS"} if result.is_over_time else {"end": "difference"}
    curves = []
    for norm, label in norms.items():
        y = np.array([getattr(size, norm) for size in found.differences])
        if y.any():
            curves.append(_ascending(label, x[:-1], np.where(y > 0.0, y, np.nan), "points"))
    for norm, label in norms.items():
        if (bar := getattr(found.bar, norm)) > 0.0:
            name = f"error bar, {label}" if result.is_over_time else "error bar"
            curves.append(Curve(name, x[-1:], np.array([bar]), "points"))
    if found.is_settled:
        sizes = np.array([result.axis.sizes[result.axis.values.index(value)] for value in result.values])
        line = y[-1] * (sizes / sizes[-2]) ** found.order
        curves.append(_ascending(f"order {found.order:.2g}", x, line, "guide"))
    return Panel("difference", result.unit, tuple(curves), True, f"difference to {_finest(result)}")


def _ascending(label: str, x: Array, y: Array, look: Look) -> Curve:
    order = np.argsort(x)
    return Curve(label, x[order], y[order], look)


def _short(result: Result) -> str:
    """The name of a quantity without that of its owner."""
    return result.quantity.partition(".")[2].replace(".", " ").replace("_", " ") or result.quantity


def _finest(result: Result) -> str:
    return f"{result.axis.key} = {result.values[-1]:g}"


def _series(study: Study, result: Result) -> Iterator[tuple[str, Array, Array]]:
    """Label, time and values (nt, columns) of every member, from coarse to fine."""
    for i, value in zip(result.members, result.values):
        measured = study.members[i].measured
        assert measured is not None and measured.time is not None
        series = np.reshape(measured.values[result.quantity], (len(measured.time), -1))
        yield f"{value:g}", measured.time, series
