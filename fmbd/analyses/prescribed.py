"""Prescribed motions: functions of time in the words of the model file, or columns of a CSV file."""

import csv
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from fmbd.errors import ModelError
from fmbd.model import Model, load_model_text
from fmbd.model.document import parse
from fmbd.model.tables import Table
from fmbd.planar.signals import evaluate_signals
from fmbd.system.drives import SMOOTHLY, jump_of
from fmbd.system.signals import SignalTable

Array = np.ndarray


class Course:
    """Signals by name, evaluated at any time; smooth enough for a body to follow until the end [s].

    Raises ModelError for one that jumps, or whose rate does, or that has no value at the start.
    """

    def __init__(self, signals: Mapping[str, Any], end: float) -> None:
        self.signals = dict(signals)
        table = SignalTable()
        self._index = [table.add(signal) for signal in self.signals.values()]
        self._arrays = table.lower()
        for name, signal in self.signals.items():
            jump = jump_of(signal, table, lambda k, t: self._evaluate(t)[k], end)
            if jump:
                raise ModelError([f"motion of {name}: its {jump}, which no motor can do: {SMOOTHLY}"])
        if not np.all(np.isfinite(self.at(np.zeros(1)))):
            raise ModelError(["the motion has no finite value, rate and second derivative at t = 0"])

    def at(self, times: Array) -> Array:
        """Value, rate and second derivative at times [s] (nt,), shape (nt, signals, 3)."""
        return np.array([self._evaluate(float(t))[self._index] for t in times])

    def _evaluate(self, t: float) -> Array:
        records, program, knots = self._arrays
        values = np.zeros((records.size, 3))
        evaluate_signals(records, program, knots, np.zeros((64, 3)), t, values)
        return values


def read_signals(model: Model, given: Mapping[str, Any]) -> dict[str, Any]:
    """Signals from numbers, expressions, names of signals of the model, or mappings; a text is read as YAML.

    Raises ModelError.
    """
    entries = {
        name: parse(value, f"motion of {name}").data if isinstance(value, str) else value
        for name, value in given.items()
    }
    return _as_signals(model, entries, model.files)


def read_file(model: Model, path: str | Path, names: tuple[str, ...] = ()) -> dict[str, Any]:
    """Cubic tables from a CSV file, by the names in its header: a column `time` [s], and these, or all others.

    Raises ModelError, OSError.
    """
    path = Path(path)
    try:
        text = path.read_bytes().decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise ModelError([f"{path}: is not UTF-8 text (byte {error.start})"]) from None
    header = [name.strip() for name in next(csv.reader(text.splitlines()), [])]
    if "time" not in header or len(header) < 2:
        wanted = ", ".join(("time", *names)) if names else "time and joints"
        raise ModelError([f"{path}:1: the first line must name the columns: {wanted}"])
    entry = {"type": "table", "file": str(path), "time": "time", "interpolation": "cubic"}
    wanted_columns = names or tuple(name for name in header if name != "time")
    entries = {name: entry | {"value": name} for name in wanted_columns}
    tables = _as_signals(model, entries, {**model.files, str(path): text})
    end = model.simulation.duration
    return {
        name: _beyond(table) if abs(table.times[-1] - end) < 1e-9 * end else table
        for name, table in tables.items()
    }


def _beyond(table: Table) -> Table:
    """The same function for one interval more: where a table ends it has no rate."""
    from scipy.interpolate import CubicSpline

    time = 2.0 * table.times[-1] - table.times[-2]
    value = float(CubicSpline(table.times, table.values)(time))
    return replace(table, times=(*table.times, time), values=(*table.values, value))


def _as_signals(model: Model, entries: Mapping[str, Any], files: Mapping[str, str]) -> dict[str, Any]:
    """Read the entries as further signals of the model."""
    names = {name: f"motion_of_{name.replace('.', '_')}" for name in entries}
    known = model.document.data.get("signals") or {}
    more = {"signals": known | {names[name]: entry for name, entry in entries.items()}}
    others = {path: value for path, value in model.overrides.items() if path not in more}
    read = load_model_text(model.text, model.path, others | more, files)
    return {name: read.signals[own] for name, own in names.items()}
