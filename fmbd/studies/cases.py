"""Verification cases: files that say what a model must give, and from where that is known.

    fmbd: 1
    model: ../pendulum.yaml                       # the model, seen from this file
    source: IFToMM library of multibody benchmarks, A01
    set: {simulation.rtol: 1e-12}                 # changes to the model, by path
    expect:
      - quantities: [pivot.angle, pivot.angle.rate]
        at: {1: [0.1, 2.3], 2: [0.4, -1.2]}       # their values by time [s]
        tolerance: 1e-9
      - analysis: modes
        variant: twice as long
        set: {parameters.length: 2}               # further changes
        quantities: [frequency.1]
        values: [0.353]                           # what has no time
        tolerance: {relative: 1e-4}
      - analysis: modes
        quantities: [frequency.1]
        over: {bodies.rod.elements: [4, 8, 16]}
        order: 4                                  # of convergence, observed in the last three
        tolerance: 0.1

Numbers may be expressions over the parameters of the model. Analyses and the names of their quantities are those of
`measure.Analysis`; `time`, `lock` and `moving` say more about statics and modes.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

from pydantic import Field, PlainValidator, TypeAdapter, ValidationError, model_validator

from fmbd.errors import ModelError
from fmbd.model import Model, load_model
from fmbd.model.base import NotNegative, Number, Part, Text, short_form
from fmbd.model.context import Context, reject
from fmbd.model.document import Document, parse
from fmbd.model.fileformat import supported_format
from fmbd.model.names import described
from fmbd.model.problems import Problems
from fmbd.studies.measure import Analysis, Kind

#: What the names of case files end in.
SUFFIX = ".case.yaml"


class Tolerance(Part):
    """|found - expected| <= absolute + relative |expected|."""

    absolute: NotNegative = 0.0
    relative: NotNegative = 0.0

    def permits(self, expected: float) -> float:
        """The largest error that passes."""
        return self.absolute + self.relative * abs(expected)

    def __str__(self) -> str:
        parts = (f"{self.absolute:.0e}", self.absolute), (f"{self.relative:.0e} relative", self.relative)
        return " + ".join(text for text, value in parts if value) or "0"


class Check(Part):
    """What one analysis of the model, changed by `set`, must give."""

    variant: Text = ""
    set: dict[Text, Any] = Field(default_factory=dict)
    analysis: Kind = "run"
    time: NotNegative | None = None
    lock: Text | list[Text] | None = None
    moving: bool = False
    quantities: list[Text]
    at: dict[Number, list[Number]] | None = None
    values: list[Number] | None = None
    over: dict[Text, list[Number]] | None = None
    order: Number | None = None
    tolerance: Annotated[Tolerance, short_form("absolute", float | str)]
    source: Text | None = None

    @model_validator(mode="after")
    def _check(self) -> "Check":
        if [self.at, self.values, self.order].count(None) != 2:
            reject((), "needs one of the keys 'at', 'values' and 'order'")
        if (self.order is None) != (self.over is None):
            reject((), "has one of the keys 'order' and 'over' without the other")
        if self.over is not None and (len(self.over) != 1 or len(*self.over.values()) < 3):
            reject(("over",), "must be one path with three values or more, from coarse to fine")
        if self.order is None and (self.at is None) == (self.analysis == "run"):
            kinds = ("values", "at") if self.analysis == "run" else ("at", "values")
            reject(
                (kinds[0],), f"is not for the analysis '{self.analysis}', which is compared by '{kinds[1]}'"
            )
        try:
            _ = self.asked
        except ModelError as error:
            reject((), str(error))
        for path, row in self._rows():
            if len(row) != len(self.quantities):
                reject(path, f"has {len(row)} values for {len(self.quantities)} quantities")
        return self

    @property
    def asked(self) -> Analysis:
        """The analysis with its options; raises ModelError for those that it does not have."""
        return Analysis.of(self.analysis, self.time, self.lock, self.moving)

    @property
    def count(self) -> int:
        """Values to compare."""
        return len(self.quantities) * max(1, len(self.at or {}))

    def _rows(self) -> list[tuple[tuple[str, ...], list[float]]]:
        if self.values is not None:
            return [(("values",), self.values)]
        return [(("at", f"{time:g}"), row) for time, row in (self.at or {}).items()]


class CaseFile(Part):
    """The keys of a case file."""

    fmbd: Annotated[int, PlainValidator(supported_format)]
    model: Text
    source: Text
    note: Text | None = None
    set: dict[Text, Any] = Field(default_factory=dict)
    expect: list[Check]


@dataclass(frozen=True)
class Case:
    """A case file and its model, with the changes of the case made."""

    path: Path
    model: Model
    file: CaseFile
    document: Document

    @property
    def name(self) -> str:
        """The file's name without its suffix."""
        return self.path.name.removesuffix(SUFFIX)

    def variants(self, k: int, changes: Mapping[str, Any]) -> list[Model]:
        """The models of the k-th check: one, or those of the values of its `over`; `changes` come last.

        Raises ModelError.
        """
        check = self.file.expect[k]
        together = {**self.model.overrides, **check.set, **changes}
        family: list[dict[str, Any]] = [{}]
        if check.over is not None:
            family = [{path: value} for path, values in check.over.items() for value in values]
        file = Path(self.model.path or "")
        return [
            _changed(file, {**together, **member}, self.document, ("expect", k, "over" if member else "set"))
            for member in family
        ]

    def error(self, path: tuple[str | int, ...], message: str) -> ModelError:
        """The error of a case that cannot be compared with its model."""
        return ModelError([self.document.problem(path, message)])


def load_case(path: str | Path) -> Case:
    """The case in a file and its model; raises ModelError with all that is wrong."""
    label, path = str(path), Path(path)
    try:
        document = parse(path.read_text("utf-8-sig"), label)
    except (OSError, UnicodeDecodeError) as error:
        raise ModelError([f"{label}: cannot be read: {error}"]) from None
    problems = Problems(document)
    if not isinstance(document.data, dict):
        problems.add((), f"a case file must be a mapping, not {described(document.data)}")
        problems.check()
    model = _model(document, path, problems)
    try:
        context = Context(parameters=model.parameters if model else {})
        file = TypeAdapter(CaseFile).validate_python(document.data, context=context)
    except ValidationError as error:
        problems.add((), error)
    problems.check()
    assert model is not None
    return Case(path, model, file, document)


def _model(document: Document, path: Path, problems: Problems) -> Model | None:
    """The model that a case names, changed; None where the case says that wrongly, which is reported later."""
    name, changes = document.data.get("model"), document.data.get("set") or {}
    if not isinstance(name, str) or not isinstance(changes, dict):
        return None
    file = path.parent / name
    if not file.is_file():
        problems.add(("model",), f"there is no file '{file}'")
        problems.check()
    return _changed(file, changes, document, ("set",))


def _changed(
    file: Path, changes: Mapping[str, Any], document: Document, path: tuple[str | int, ...]
) -> Model:
    """A model with changes; what is wrong with the changes is a problem of the case at `path`."""
    load_model(file)
    try:
        return load_model(file, changes)
    except ModelError as error:
        raise ModelError([document.problem(path, problem) for problem in error.problems]) from None
