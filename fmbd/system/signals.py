"""Lower the signals of a model to flat records, and say when they jump or kink."""

from typing import Any

import numpy as np

from fmbd.planar import signals as kinds
from fmbd.planar.arrays import SIGNAL, records

Array = np.ndarray

#: Pulses of one signal whose edges a run lands on exactly; later ones are met by the step control.
MAX_PULSES = 100_000


class SignalTable:
    """Collects signals; `add` gives a signal's index, the same for the same object."""

    def __init__(self) -> None:
        self._signals: list[Any] = []
        self._index: dict[int, int] = {}

    def add(self, signal: Any) -> int:
        """Index of a signal object of the model."""
        if id(signal) not in self._index:
            self._index[id(signal)] = len(self._signals)
            self._signals.append(signal)
        return self._index[id(signal)]

    def find(self, signal: Any) -> int:
        """Index of a signal object of the model, -1 if nothing uses it."""
        return self._index.get(id(signal), -1)

    def lower(self) -> tuple[Any, Array, Array]:
        """Signal records, expression program (instructions, 2), table knots (knots, 5)."""
        out = records(len(self._signals), SIGNAL)
        program: list[tuple[float, float]] = []
        tables = [np.zeros((0, 5))]
        knots = 0
        for record, signal in zip(out, self._signals, strict=True):
            record.kind, numbers = _parameters(signal)
            record.p[: len(numbers)] = numbers
            if signal.type == "expression":
                record.start, record.count = len(program), len(signal.program)
                program += [(kinds.OPERATIONS.index(op), value) for op, value in signal.program]
            elif signal.type == "table":
                record.start, record.count = knots, len(signal.times)
                tables.append(_cubic_pieces(signal))
                knots += len(signal.times)
        return out, np.array(program).reshape(-1, 2), np.concatenate(tables)

    def breakpoints(self, end: float) -> Array:
        """Times in (0, end) at which a signal jumps, or one of its first derivatives does, ascending."""
        times = {t for signal in self._signals for t in _breaks(signal, end) if 0.0 < t < end}
        return np.array(sorted(times))

    def edges(self, signal: Any, end: float) -> list[tuple[float, float]]:
        """The breakpoints of one signal, each with a time before it at which the signal does not yet show it."""
        return [(t, t - 4.0 * kinds.EARLY * max(1.0, t)) for t in _breaks(signal, end) if 0.0 < t < end]


def _parameters(signal: Any) -> tuple[int, tuple[float, ...]]:
    s = signal
    match s.type:
        case "constant":
            return kinds.CONSTANT, (s.value,)
        case "step":
            return kinds.STEP, (s.at, s.before, s.after)
        case "ramp":
            return kinds.RAMP, (s.start, s.end, s.from_, s.to)
        case "smooth_step":
            return kinds.SMOOTH_STEP, (s.start, s.end, s.from_, s.to)
        case "sine":
            return kinds.SINE, (s.amplitude, s.frequency, s.phase, s.offset)
        case "pulse":
            return kinds.PULSE, (s.start, s.width, s.amplitude, s.offset, s.period or 0.0)
        case "expression":
            return kinds.EXPRESSION, ()
        case _:
            return kinds.TABLE, ()


def _cubic_pieces(signal: Any) -> Array:
    """Rows (t, c0, c1, c2, c3) with value c0 + c1 x + c2 x^2 + c3 x^3, x from the knot at t."""
    t = np.asarray(signal.times, float)
    u = np.asarray(signal.values, float)
    pieces = np.zeros((t.size, 5))
    pieces[:, 0], pieces[:, 1] = t, u
    if signal.interpolation == "linear":
        pieces[:-1, 2] = np.diff(u) / np.diff(t)
    else:
        from scipy.interpolate import CubicSpline

        ends: Any = [(1, rate) for rate in signal.end_rates] if signal.end_rates else "not-a-knot"
        # c is (4, n-1), highest power first
        pieces[:-1, 1:] = CubicSpline(t, u, bc_type=ends).c[::-1].T
    return pieces


def _breaks(signal: Any, end: float) -> list[float]:
    match signal.type:
        case "step":
            return [signal.at]
        case "ramp" | "smooth_step":
            return [signal.start, signal.end]
        case "pulse" if signal.period:
            count = min(MAX_PULSES, max(0, int((end - signal.start) / signal.period) + 1))
            starts = signal.start + signal.period * np.arange(count)
            return [*starts, *(starts + signal.width)]
        case "pulse":
            return [signal.start, signal.start + signal.width]
        case "table" if signal.interpolation == "linear":
            return list(signal.times)
        case "table":
            return [signal.times[0], signal.times[-1]]
        case _:
            return []
