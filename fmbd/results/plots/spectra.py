"""Spectra of charts over time: amplitudes by frequency."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from fmbd.results.plots.charts import Chart, Curve, Panel

Array = NDArray[np.float64]

#: A spectrum needs some samples, and a peak this share of the highest to be named.
SAMPLES = 8
SHARE = 0.01


def spectrum(x: Array, y: Array) -> tuple[Array, Array]:
    """Frequencies [Hz] and amplitudes of y, sampled evenly at times x [s], both (n,).

    The straight line of least squares is taken out, so that a drift is not a vibration; Hann's window, scaled so that
    a steady sine of amplitude a has a peak of height a. Raises ValueError for fewer than eight samples.
    """
    step = x[1] - x[0] if x.size > 1 else 1.0
    even = x.size - (x.size > 2 and abs(x[-1] - x[-2] - step) > 1e-6 * step)
    x, y = x[:even], y[:even]
    if x.size < SAMPLES:
        raise ValueError(f"a spectrum needs {SAMPLES} output times or more, there are {x.size}")
    window = np.hanning(x.size)
    about = x - x.mean()
    drift = y.mean() + about * (about @ y) / (about @ about)
    amplitudes = 2.0 * np.abs(np.fft.rfft((y - drift) * window)) / window.sum()
    return np.fft.rfftfreq(x.size, step)[1:], amplitudes[1:]


def spectra(chart: Chart) -> Chart:
    """The spectra of all curves of a chart over time."""
    rows = tuple(tuple(_spectra_of(panel) for panel in row) for row in chart.rows)
    return replace(
        chart,
        name=f"{chart.name}-spectrum",
        title=f"{chart.title}: amplitude spectrum",
        rows=rows,
        across=("frequency", "Hz"),
    )


def peaks(curve: Curve, most: int = 5) -> list[tuple[float, float]]:
    """Frequency [Hz] and height of the highest peaks of a spectrum, by height.

    Between its samples a peak is a parabola through the logarithms of three.
    """
    f, a = curve.x, curve.y
    tops = np.flatnonzero((a[1:-1] > a[:-2]) & (a[1:-1] >= a[2:]) & (a[1:-1] > SHARE * a.max())) + 1
    found = []
    for k in tops[np.argsort(-a[tops])][:most]:
        left, top, right = np.log(np.maximum(a[k - 1 : k + 2], 1e-300))
        shift = 0.5 * (left - right) / (left - 2.0 * top + right)
        found.append((f[k] + shift * (f[1] - f[0]), float(a[k])))
    return found


def _spectra_of(panel: Panel) -> Panel:
    curves = tuple(Curve(curve.label, *spectrum(curve.x, curve.y)) for curve in panel.curves)
    return replace(panel, quantity=f"{panel.quantity} amplitude", curves=curves, logarithmic=True)
