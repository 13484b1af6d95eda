"""Derivatives by differences, and how far they can be trusted.

    f(p)     a number, or a series over time, that comes with noise: an error that differs from run to run
    D(h)     (f(p + h) - f(p - h)) / 2h = f' + h^2 f''' / 6 + ...
    R        (4 D(h/2) - D(h)) / 3, without the term of h^2 (Richardson)
    delta    how much f changes where its tolerance is ten times as large; a third of it is taken for the noise, which
             then changes R by 3 (delta / 3) / h at most
The error is |R - D(h/2)| + delta / h: what the extrapolation did, though R is better than that, and the noise.
"""

from dataclasses import dataclass

import numpy as np

Array = np.ndarray

#: Where there is no tolerance: what is left of round-off, in shares of a number.
ROUND_OFF = 3e-12


@dataclass(frozen=True)
class Samples:
    """f at p, p + h, p - h, p + h/2 and p - h/2; shape (5, ...)."""

    values: Array
    h: float
    delta: Array  #: shape (...)

    def derivative(self) -> tuple[Array, Array]:
        """R and its error, each of shape (...)."""
        _, more, less, bit_more, bit_less = self.values
        whole, half = (more - less) / (2.0 * self.h), (bit_more - bit_less) / self.h
        R = (4.0 * half - whole) / 3.0
        return R, np.abs(R - half) + self.delta / self.h


def delta_of(values: Array, loose: Array | None) -> Array:
    """delta of a series (nt, ...), which only grows over time, or of what has no time, where nothing is loose."""
    if loose is None:
        return ROUND_OFF * np.abs(values)
    return np.asarray(np.maximum.accumulate(np.abs(values - loose), axis=0))


def summaries(samples: Samples) -> dict[str, Samples]:
    """Value at the end, largest size and mean (RMS) of series: values (5, nt, columns) become (5, columns)."""
    delta = samples.delta
    return {
        "end": Samples(samples.values[:, -1], samples.h, delta[-1]),
        "peak": Samples(np.array([_peaks(series) for series in samples.values]), samples.h, delta[-1]),
        "RMS": Samples(
            np.sqrt((samples.values**2).mean(axis=1)), samples.h, np.sqrt((delta**2).mean(axis=0))
        ),
    }


def _peaks(series: Array) -> Array:
    """The largest size of each column (nt, columns), also between output times: of a parabola through three."""
    size = np.abs(series)
    rows = size.argmax(axis=0)
    k = np.clip(rows, 1, len(size) - 2)
    before, at, after = (np.take_along_axis(size, (k + j)[None], axis=0)[0] for j in (-1, 0, 1))
    bend = before - 2.0 * at + after
    above = np.divide((after - before) ** 2, -8.0 * bend, out=np.zeros_like(at), where=bend < 0.0)
    return np.where(rows == k, at + above, size.max(axis=0))
