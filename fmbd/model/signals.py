"""Signals: functions of time that drive joints, motors, loads and set points."""

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Annotated, Any, ClassVar, Literal

from pydantic import (
    AfterValidator,
    ConfigDict,
    Field,
    PlainValidator,
    TypeAdapter,
    ValidationInfo,
    model_validator,
)
from typing_extensions import TypeAliasType

from fmbd.model.base import NotNegative, Number, Part, Positive, Text, to_number
from fmbd.model.context import Context, context_of, reject
from fmbd.model.expressions import CONSTANTS, ExpressionError, compile_time_expression, names_in
from fmbd.model.names import is_name, unknown
from fmbd.model.problems import Muted
from fmbd.model.tables import Table, TableEntry


class Constant(Part):
    """The same value at all times."""

    type: Literal["constant"] = "constant"
    value: Number
    """The value."""


class Step(Part):
    """A jump."""

    type: Literal["step"]
    at: Number = 0.0
    """Time of the jump [s]."""
    before: Number = 0.0
    """Value before the jump."""
    after: Number
    """Value from the jump on."""


class _Transition(Part):
    start: Number = 0.0
    """Time at which the value begins to change [s]."""
    end: Number
    """Time at which it has arrived [s]."""
    from_: Number = Field(0.0, alias="from")
    """Value up to the start."""
    to: Number
    """Value from the end on."""

    @model_validator(mode="after")
    def _check(self) -> "_Transition":
        if self.end <= self.start:
            reject(("end",), f"must be later than start ({self.start:g}), is {self.end:g}")
        return self


class Ramp(_Transition):
    """A linear transition between two values."""

    type: Literal["ramp"]


class SmoothStep(_Transition):
    """A quintic transition whose rate and curvature vanish at both ends."""

    type: Literal["smooth_step"]


class Sine(Part):
    """offset + amplitude sin(2 pi frequency t + phase)."""

    type: Literal["sine"]
    amplitude: Number
    """Amplitude."""
    frequency: NotNegative
    """Frequency [Hz]."""
    phase: Number = 0.0
    """Phase at t = 0 [rad]."""
    offset: Number = 0.0
    """Mean value."""


class Pulse(Part):
    """A rectangular pulse, repeated when it has a period."""

    type: Literal["pulse"]
    start: Number = 0.0
    """Time at which the first pulse begins [s]."""
    width: Positive
    """Duration of a pulse [s]."""
    amplitude: Number
    """Height of a pulse above the offset."""
    offset: Number = 0.0
    """Value outside the pulse."""
    period: Positive | None = None
    """Time from pulse to pulse [s]; a single pulse when left out."""

    @model_validator(mode="after")
    def _check(self) -> "Pulse":
        if self.period is not None and self.period < self.width:
            reject(("period",), f"must not be shorter than width ({self.width:g}), is {self.period:g}")
        return self


@dataclass(frozen=True, slots=True)
class TimeExpression:
    """An expression in t, lowered to a postfix program of (operation, constant) pairs."""

    type: ClassVar[str] = "expression"
    program: tuple[tuple[str, float], ...]
    text: str


class TimeExpressionEntry(Part):
    """An arithmetic expression in the time t [s] and the parameters."""

    type: Literal["expression"]
    value: Text
    """For instance '0.3*sin(2*pi*t)'."""


def _compiled(entry: TimeExpressionEntry, info: ValidationInfo) -> TimeExpression | Constant:
    context = context_of(info)
    try:
        program = compile_time_expression(entry.value, context.parameters)
    except ExpressionError as error:
        if context.broken_parameters and names_in(entry.value) & context.broken_parameters:
            raise Muted from None
        reject(("value",), str(error))
    if len(program) == 1 and program[0][0] == "const":
        return Constant(value=program[0][1])
    return TimeExpression(tuple(program), entry.value)


def _read(entry: TableEntry, info: ValidationInfo) -> Table:
    return entry.read(context_of(info))


Signal = Constant | Step | Ramp | SmoothStep | Sine | Pulse | TimeExpression | Table

_Mapping = Annotated[
    Constant
    | Step
    | Ramp
    | SmoothStep
    | Sine
    | Pulse
    | Annotated[TimeExpressionEntry, AfterValidator(_compiled)]
    | Annotated[TableEntry, AfterValidator(_read)],
    Field(discriminator="type"),
]
_mapping: TypeAdapter[Any] = TypeAdapter(_Mapping, config=ConfigDict(defer_build=True))


def to_signal(value: Any, info: ValidationInfo) -> Signal:
    """A signal from a number, an expression, the name of a signal or a mapping."""
    if isinstance(value, Signal):
        return value
    if isinstance(value, str):
        context = context_of(info)
        if context.knows("signals", value):
            named: Signal = context.find("signals", value, "signal")
            return named
        check_signal_name(value, context, "signal", ())
        value = {"type": "expression", "value": value}
    elif not isinstance(value, dict):
        return Constant(value=to_number(value, info))
    signal: Signal = _mapping.validate_python(value, context=info.context)
    return signal


def check_signal_name(text: str, context: Context, kind: str, others: Iterable[str]) -> None:
    """Refuse a bare name that is neither a signal, a parameter nor t; `others` are proposed too."""
    known = {
        *context.parameters,
        *context.broken_parameters,
        *CONSTANTS,
        *context.parts.get("signals", {}),
        "t",
    }
    if is_name(text) and text not in known:
        raise ValueError(
            unknown(kind, text, [*context.parts.get("signals", {}), *others, *context.parameters])
        )


# An alias of its own, so that the schema describes signals once.
SignalEntry = TypeAliasType("SignalEntry", float | str | _Mapping)
SignalField = Annotated[Signal, PlainValidator(to_signal, json_schema_input_type=SignalEntry)]
