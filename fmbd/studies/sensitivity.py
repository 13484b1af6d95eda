"""How named outputs of a model change with numbers of its file: see derivatives.py for the rules."""

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from fmbd.errors import AnalysisError, ModelError
from fmbd.model import Model, load_model
from fmbd.model.expressions import ExpressionError, evaluate
from fmbd.model.names import closest
from fmbd.studies.derivatives import Samples, delta_of, summaries
from fmbd.studies.measure import COMPLETE, Analysis, Kind, Measured, columns_of, measure
from fmbd.studies.pool import Report, side_by_side
from fmbd.studies.refine import changed

Array = np.ndarray

#: The larger step, in shares of the parameter; of a parameter that is zero, in its unit.
STEP = 1e-3
#: Runs have these tolerances, or tighter ones that the model asks for; others have the last one.
_TOLERANCES = {"auto": 1e-9, "rodas5p": 1e-9, "generalized_alpha": 1e-7}
_TOLERANCE = 1e-10
_LOOSER = 10.0


@dataclass(frozen=True)
class Number:
    """A number, its derivative by a parameter, and the error of that."""

    value: float
    derivative: float
    error: float


@dataclass(frozen=True)
class Derivative:
    """A quantity by a parameter; in SI units, by the unit of the parameter.

    values, derivative, error: shape (nt,) or (nt, columns) over time, () or (1, columns) of what has no time
    numbers: `end`, `peak` and `RMS` over time, otherwise `value`; of a quantity with columns `x end` and so on
    """

    quantity: str
    unit: str
    parameter: str
    nominal: float
    step: float  #: the larger one
    values: Array
    derivative: Array
    error: Array
    numbers: Mapping[str, Number]


@dataclass(frozen=True)
class Sensitivity:
    """What `sensitivity` finds; `found["quantity", "parameter"]` is a Derivative."""

    model: Model
    analysis: Analysis
    derivatives: tuple[Derivative, ...]
    time: Array | None  #: output times [s]

    def __getitem__(self, names: tuple[str, str]) -> Derivative:
        for found in self.derivatives:
            if (found.quantity, found.parameter) == names:
                return found
        raise KeyError(names)

    def save(self, path: str | Path) -> None:
        """Write an HDF5 file with all series and their errors, see sensitivity_file.py."""
        from fmbd.studies.sensitivity_file import write_sensitivity

        write_sensitivity(self, Path(path))


def sensitivity(
    model: Model | str | Path,
    to: Sequence[str],
    quantities: Sequence[str],
    analysis: Kind = "run",
    jobs: int = 1,
    step: float = STEP,
    on_progress: Report | None = None,
    *,
    time: float | None = None,
    lock: str | Sequence[str] | None = None,
    moving: bool = False,
) -> Sensitivity:
    """Derivatives of quantities by numbers of the model file, with their errors.

    to: paths of the numbers, such as `bodies.rod.length`, `parameters.l1`, `gravity.1`; with `*` all that have it,
    together, if they are the same number
    quantities, analysis, time, lock, moving: as in `refine`
    step: the larger of two, in shares of a parameter, or, of one that is zero, in its unit
    jobs: processes; a script that wants more than one needs `if __name__ == "__main__"`

    Raises ModelError and UnknownQuantity before anything is run, AnalysisError where a run does not get to its end.
    """
    if not isinstance(model, Model):
        model = load_model(model)
    asked = Analysis.of(analysis, time, lock, moving)
    if asked.kind == "run":
        model = _tight(model)
    columns = columns_of(model, quantities, asked)
    nominal = {path: nominal_value(model, path) for path in to}
    steps = {path: step * (abs(p) or 1.0) for path, p in nominal.items()}
    family = [{}, *(_loose(model) if asked.kind == "run" else ())]
    first = len(family)
    family += [{path: p + way * steps[path]} for path, p in nominal.items() for way in (1.0, -1.0, 0.5, -0.5)]
    tasks = [partial(_measured, _varied(model, changes), tuple(quantities), asked) for changes in family]
    results = dict(side_by_side(tasks, jobs, on_progress))
    found = [_complete(changes, results[k]) for k, changes in enumerate(family)]
    base, loose = found[0], found[1] if first == 2 else None
    derivatives = [
        _derivative(name, columns[name], path, p, steps[path], [base, *found[k : k + 4]], loose)
        for k, (path, p) in zip(range(first, len(found), 4), nominal.items(), strict=True)
        for name in quantities
    ]
    return Sensitivity(model, asked, tuple(derivatives), base.time)


def nominal_value(model: Model, path: str) -> float:
    """The number at a path of the model file; raises ModelError."""
    plain = path.replace("[", ".").replace("]", "")
    known = dict(_numbers(model.document.data, "", model.parameters))
    pattern = re.compile(re.escape(plain).replace(r"\*", r"[^.]+"))
    values = {known[name] for name in known if pattern.fullmatch(name)}
    if not values:
        near = closest(plain, known)
        hint = f", did you mean '{near}'?" if near else ""
        raise ModelError([f"{path}: the model file has no number there{hint}"])
    if len(values) > 1:
        raise ModelError(
            [f"{path}: these are different numbers, {', '.join(f'{x:g}' for x in sorted(values))}"]
        )
    return values.pop()


def _numbers(data: Any, path: str, parameters: Mapping[str, float]) -> Iterator[tuple[str, float]]:
    """All numbers of a model file by path, expressions too; not those of the simulation."""
    if isinstance(data, dict | list):
        parts = data.items() if isinstance(data, dict) else enumerate(data)
        for key, part in parts:
            if path or key not in ("fmbd", "name", "description", "simulation"):
                yield from _numbers(part, f"{path}.{key}".lstrip("."), parameters)
    elif isinstance(data, int | float) and not isinstance(data, bool):
        yield path, float(data)
    elif isinstance(data, str):
        try:
            yield path, evaluate(data, parameters)
        except ExpressionError:
            return


def _tight(model: Model) -> Model:
    """The model, integrated so tightly that its noise is small."""
    simulation = model.simulation
    tolerance = _TOLERANCES.get(simulation.method, _TOLERANCE)
    rtol, atol = min(simulation.rtol, tolerance), min(simulation.atol, tolerance)
    return changed(model, {"simulation.rtol": rtol, "simulation.atol": atol})


def _loose(model: Model) -> Iterator[dict[str, Any]]:
    """Changes of the run that shows the noise."""
    simulation = model.simulation
    yield {"simulation.rtol": _LOOSER * simulation.rtol, "simulation.atol": _LOOSER * simulation.atol}


def _varied(model: Model, changes: Mapping[str, Any]) -> Model:
    """The changed model; raises ModelError, also for what cannot be changed by a little."""
    try:
        return changed(model, changes)
    except ModelError as error:
        if "must be a whole number" not in str(error):
            raise
        (path,) = changes
        problem = "is a whole number, by which nothing can be differentiated: `fmbd refine` compares several"
        raise ModelError([f"{path}: {problem}"]) from None


def _measured(model: Model, names: Sequence[str], analysis: Analysis, report: Report) -> Measured:
    return measure(model, names, analysis, report)


def _complete(changes: Mapping[str, Any], result: "Measured | Exception") -> Measured:
    if isinstance(result, ModelError | AnalysisError | KeyError):
        raise result
    if isinstance(result, Exception) or result.status != COMPLETE:
        problem = result if isinstance(result, Exception) else result.status
        where = ", ".join(f"{path} = {value:.9g}" for path, value in changes.items()) or "the model as it is"
        raise AnalysisError(f"{where}: {problem}")
    return result


def _derivative(
    quantity: str,
    columns: tuple[str, ...],
    parameter: str,
    nominal: float,
    step: float,
    family: Sequence[Measured],
    loose: Measured | None,
) -> Derivative:
    values = np.array([member.values[quantity] for member in family])
    delta = delta_of(values[0], None if loose is None else loose.values[quantity])
    samples = Samples(values, step, delta)
    derivative, error = samples.derivative()
    if family[0].time is None:
        single = values.reshape(5, -1)
        parts = {"value": Samples(single, step, delta.reshape(-1))}
    else:
        series = values.reshape(5, values.shape[1], -1)
        parts = summaries(Samples(series, step, delta.reshape(values.shape[1], -1)))
    return Derivative(
        quantity=quantity,
        unit=family[0].units[quantity],
        parameter=parameter,
        nominal=nominal,
        step=step,
        values=values[0],
        derivative=derivative,
        error=error,
        numbers={
            f"{column} {what}".strip(): Number(*(float(x) for x in numbers))
            for what, part in parts.items()
            for column, *numbers in zip(columns or ("",), part.values[0], *part.derivative(), strict=True)
        },
    )
