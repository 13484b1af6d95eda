"""Prescribed motions: functions of time in the words of the model file, or columns of a CSV file."""

import csv
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from fmbd.analyses.guide import as_point
from fmbd.errors import ModelError
from fmbd.model import Model, load_model_text
from fmbd.model.document import parse
from fmbd.model.tables import Table
from fmbd.planar.signals import evaluate_signals
from fmbd.system.drives import SMOOTHLY, jump_of
from fmbd.system.signals import SignalTable

Array = np.ndarray

#: Of columns that are read; without a unit they are in these.
UNITS = ("", "s", "rad", "m")


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


def read_file(model: Model, path: str | Path, point: str | None = None) -> dict[str, Any]:
    """Cubic tables by name from a CSV file with a column `time` [s], the first line naming the columns.

    Of a point x and y, otherwise all columns, the joints. A column may be headed name[unit]; among quantities of a
    run, such as `fmbd inverse` and `fmbd export` write, only the point's position or the joints' coordinates are read.
    Raises ModelError, OSError.
    """
    path = Path(path)
    try:
        text = path.read_bytes().decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise ModelError([f"{path}: is not UTF-8 text (byte {error.start})"]) from None
    first, _, rows = text.partition("\n")
    header = [_heading(head) for head in next(csv.reader([first.rstrip("\r")]), [])]
    meant = [_meant(model, name, point) for name, _ in header]
    wanted = ("x", "y") if point else tuple(name for name in meant if name not in ("time", ""))
    if "time" not in meant or len(header) < 2 or not wanted:
        columns = ", ".join(("time", *wanted)) if wanted else "time and joints"
        raise ModelError([f"{path}:1: the first line must name the columns: {columns}"])
    for (name, unit), own in zip(header, meant, strict=True):
        if own in ("time", *wanted) and unit not in UNITS:
            raise ModelError([f"{path}:1: {name} is in {unit}: it is read in s, rad or m"])
    named = ",".join(f'"{own or name}"' for (name, _), own in zip(header, meant, strict=True))
    entry = {"type": "table", "file": str(path), "time": "time", "interpolation": "cubic"}
    entries = {name: entry | {"value": name} for name in wanted}
    tables = _as_signals(model, entries, {**model.files, str(path): f"{named}\n{rows}"})
    end = model.simulation.duration
    return {
        name: _beyond(table) if abs(table.times[-1] - end) < 1e-9 * end else table
        for name, table in tables.items()
    }


def _heading(text: str) -> tuple[str, str]:
    """Name and unit of a column headed `name[unit]`, or `name`."""
    name, bracket, unit = text.strip().partition("[")
    return name.strip(), unit.removesuffix("]").strip() if bracket else ""


def _meant(model: Model, name: str, point: str | None) -> str:
    """x, y, a joint or `time`; nothing for other quantities of a run."""
    part, _, rest = name.partition(".")
    if point is not None:
        own = {f"{alias}.position.{axis}": axis for alias in (point, as_point(model, point)) for axis in "xy"}
        return own.get(name, name)
    joint = model.joints.get(part)
    if joint is not None and rest and rest == joint.motor_coordinate:
        return part
    known = part in model.bodies or part in model.motors or joint is not None
    return "" if rest and known else name


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
