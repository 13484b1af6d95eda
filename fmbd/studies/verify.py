"""Run verification cases and compare what they give with what they must give."""

import json
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from fmbd.errors import ModelError, UnknownQuantity
from fmbd.model import Model
from fmbd.model.names import unknown
from fmbd.studies.cases import SUFFIX, Case, Check, load_case
from fmbd.studies.convergence import observed_order
from fmbd.studies.measure import COMPLETE, Analysis, Measured, columns_of, measure
from fmbd.studies.pool import Report, side_by_side

#: Where the cases of fmbd itself are.
CASES = Path(__file__).parents[2] / "models" / "verification"


@dataclass(frozen=True)
class Comparison:
    """A quantity against what a case expects of it; of several values the one that comes closest to failing."""

    case: str
    variant: str
    source: str
    quantity: str
    unit: str
    count: int  #: values compared
    time: float | None  #: of this one [s]; None where there is no time
    expected: float
    found: float
    tolerance: float
    problem: str = ""  #: why nothing was found

    @property
    def error(self) -> float:
        """|found - expected|."""
        return abs(self.found - self.expected)

    @property
    def holds(self) -> bool:
        """Whether the error is within the tolerance."""
        return self.error <= self.tolerance


def find_cases(names: Iterable[str | Path] = ()) -> list[Path]:
    """Files of cases by file, by folder, or by name among those of fmbd, which are meant by default.

    Raises ModelError for a name that is none.
    """
    return [path for name in (list(names) or [CASES]) for path in _found(str(name))]


def _found(name: str) -> list[Path]:
    path = Path(name)
    if path.is_dir() and (inside := sorted(path.glob(f"*{SUFFIX}"))):
        return inside
    for file in (path, path.with_suffix(SUFFIX)):
        if file.is_file() and file.name.endswith(SUFFIX):
            return [file]
    if path.exists() or path.suffix or path.name != name:
        raise ModelError([f"{name}: there are no verification cases (names end in {SUFFIX})"])
    own = {file.name.removesuffix(SUFFIX): file for file in sorted(CASES.glob(f"*{SUFFIX}"))}
    if name not in own:
        raise ModelError([unknown("verification case", name, own)])
    return [own[name]]


def verify(
    cases: Iterable[str | Path] = (),
    changes: Mapping[str, Any] | None = None,
    jobs: int = 1,
    on_progress: Report | None = None,
) -> list[Comparison]:
    """Run verification cases and compare: one Comparison for each quantity of each check, in the order of the files.

    cases: files, folders, or names of fmbd's own (default: all of models/verification)
    changes: to the models, by path, on top of those of the cases
    jobs: processes; a script that wants more than one needs `if __name__ == "__main__"`
    on_progress: called with the share that is done, often

    Raises ModelError for a case that is wrongly written, or asks its model for what it does not have.
    """
    checks = [
        _Checked(case, k, case.variants(k, changes or {}))
        for case in map(load_case, find_cases(cases))
        for k in range(len(case.file.expect))
    ]
    # what several checks ask of one model is measured at once
    models: dict[Key, Model] = {}
    names: dict[Key, list[str]] = {}
    for checked in checks:
        for key, model in checked.models.items():
            models[key] = model
            names[key] = list(dict.fromkeys([*names.get(key, []), *checked.check.quantities]))
    tasks = [partial(_measured, model, names[key], key[1]) for key, model in models.items()]
    results = dict(side_by_side(tasks, jobs, on_progress))
    measured = {key: results[k] for k, key in enumerate(models)}
    return [found for checked in checks for found in checked.compare(measured)]


def _measured(model: Model, names: Sequence[str], analysis: Analysis, report: Report) -> Measured:
    return measure(model, names, analysis, report)


Key = tuple[str, Analysis]  # changed model and analysis


class _Checked:
    """The k-th check of a case and its models: one, or those whose order of convergence is asked for."""

    def __init__(self, case: Case, k: int, models: Sequence[Model]) -> None:
        self.case, self.k = case, k
        self.check: Check = case.file.expect[k]
        self.models: dict[Key, Model] = {
            (json.dumps([str(case.path), model.overrides]), self.check.asked): model for model in models
        }

    def compare(self, results: "Mapping[Key, Measured | Exception]") -> Iterator[Comparison]:
        """One Comparison for each quantity."""
        measured = []
        problem = ""
        for key in self.models:
            result = results[key]
            if isinstance(result, UnknownQuantity):
                raise self.case.error(("expect", self.k, "quantities"), str(result))
            if isinstance(result, ModelError):
                raise result
            if isinstance(result, Exception):
                problem = problem or f"{type(result).__name__}: {result}"
            else:
                problem = problem or (result.status if result.status != COMPLETE else "")
                measured.append(result)
        for column, name in enumerate(self.check.quantities):
            if measured and measured[0].values[name].ndim > (measured[0].time is not None):
                raise self.case.error(
                    ("expect", self.k, "quantities"),
                    f"'{name}' has several columns: name one, such as {self._column(name)}",
                )
            if problem:
                yield self._comparison(name, "", 0, None, np.nan, np.nan, problem)
            elif self.check.order is not None:
                yield self._order(name, measured)
            else:
                yield self._values(name, column, measured[0])

    def _column(self, name: str) -> str:
        """The first of the columns of a quantity."""
        model = next(iter(self.case.variants(self.k, {})))
        return f"{name}.{columns_of(model, [name], self.check.asked)[name][0]}"

    def _values(self, name: str, column: int, measured: Measured) -> Comparison:
        """The value that comes closest to failing, or fails by most."""
        times: list[float | None]
        if self.check.values is not None:
            times, expected = [None], np.array([self.check.values[column]])
            found = np.array([measured.values[name]])
        else:
            assert self.check.at is not None and measured.time is not None
            times = list(self.check.at)
            expected = np.array([row[column] for row in self.check.at.values()])
            found = measured.values[name][[self._row(time, measured.time) for time in self.check.at]]
        permitted = [self.check.tolerance.permits(value) for value in expected]
        with np.errstate(divide="ignore", invalid="ignore"):
            used = np.abs(found - expected) / permitted
        k = int(np.argmax(np.where(np.isnan(used), np.inf, used)))
        unit = measured.units[name]
        return self._comparison(name, unit, len(times), times[k], float(expected[k]), float(found[k]))

    def _row(self, time: float, times: np.ndarray) -> int:
        """The row of an output time."""
        k = int(np.argmin(np.abs(times - time)))
        if abs(times[k] - time) > 1e-9 * max(1.0, times[-1]):
            raise self.case.error(
                ("expect", self.k, "at"), f"{time:g} s is no output time; near it there is {times[k]:.9g} s"
            )
        return k

    def _order(self, name: str, measured: Sequence[Measured]) -> Comparison:
        """Order of convergence, observed in the last three."""
        assert self.check.over is not None and self.check.order is not None
        ((path, sizes),) = self.check.over.items()
        coarse, middle, fine = (found.values[name] for found in measured[-3:])
        h = sizes[-3:] if sizes[-1] < sizes[0] else [1.0 / size for size in sizes[-3:]]
        found = observed_order(coarse - middle, middle - fine, h).order
        last = path.rpartition(".")[2]
        return self._comparison(f"order of {name} in {last}", "", 1, None, self.check.order, found)

    def _comparison(
        self,
        quantity: str,
        unit: str,
        count: int,
        time: float | None,
        expected: float,
        found: float,
        problem: str = "",
    ) -> Comparison:
        return Comparison(
            case=self.case.name,
            variant=self.check.variant,
            source=self.check.source or self.case.file.source,
            quantity=quantity,
            unit=unit,
            count=count,
            time=time,
            expected=expected,
            found=found,
            tolerance=self.check.tolerance.permits(expected),
            problem=problem,
        )


def markdown(cases: Iterable[str | Path] = ()) -> str:
    """The cases as a Markdown table: what of a model is compared with which source, to which tolerance."""
    rows = ["| case | source | values | agreement |", "|---|---|---|---|"]
    for case in map(load_case, find_cases(cases)):
        checks = case.file.expect
        sources = dict.fromkeys(check.source or case.file.source for check in checks)
        values = sum(check.count for check in checks)
        agreement = dict.fromkeys(f"{_briefly(check)} to {check.tolerance}" for check in checks)
        rows.append(f"| {case.name} | {'; '.join(sources)} | {values} | {'; '.join(agreement)} |")
    return "\n".join(rows)


def _briefly(check: Check) -> str:
    """The quantities of a check in a few words."""
    first, *others = (f"`{name}`" for name in check.quantities)
    more = f" and {len(others)} more" if len(others) > 1 else "".join(f", {name}" for name in others)
    return f"{'order of ' if check.order is not None else ''}{first}{more}"
