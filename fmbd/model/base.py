"""The base of every part, and the numbers in it."""

import math
from typing import Annotated, Any, Self

from pydantic import (
    AfterValidator,
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    ModelWrapValidatorHandler,
    Strict,
    ValidationError,
    ValidationInfo,
    model_validator,
)

from fmbd.model.context import context_of
from fmbd.model.expressions import ExpressionError, evaluate, names_in
from fmbd.model.names import described, shortened
from fmbd.model.problems import Muted, in_words

# Larger numbers would take products of four dimensions and a modulus out of range; smaller ones count as 0.
LARGEST = 1e30
SMALLEST = 1e-30


class Part(BaseModel):
    """A part as it is written: unknown keys are refused, nothing changes afterwards."""

    model_config = ConfigDict(frozen=True, extra="forbid", defer_build=True)  # build only what a model uses

    @model_validator(mode="wrap")
    @classmethod
    def _explain(cls, value: Any, handler: ModelWrapValidatorHandler[Self]) -> Self:
        try:
            return handler(value)
        except ValidationError as error:
            raise in_words(error, cls.key_names()) from None

    @classmethod
    def key_names(cls) -> list[str]:
        """The keys this part may have in a file."""
        return [field.alias or name for name, field in cls.model_fields.items()]


def to_number(value: Any, info: ValidationInfo) -> float:
    """A number of the model from a plain number or from an expression over the parameters."""
    number = evaluate_text(value, info) if isinstance(value, str) else finite_number(value)
    if abs(number) > LARGEST:
        raise ValueError(f"is too large: {number:g}; numbers up to {LARGEST:g} make sense")
    return number if abs(number) > SMALLEST else 0.0


def finite_number(value: Any) -> float:
    """A finite float from a plain number; raises ValueError for anything else."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise ValueError(f"must be a number or an expression, not {described(value)}")
    try:
        number = float(value)
    except OverflowError:
        number = math.inf
    if not math.isfinite(number):
        raise ValueError(f"must be a finite number, not {shortened(value)}")
    return number


def evaluate_text(text: str, info: ValidationInfo) -> float:
    """The value of an expression; Muted when it uses a parameter that has none."""
    context = context_of(info)
    try:
        return evaluate(text, context.parameters)
    except ExpressionError:
        if context.broken_parameters and names_in(text) & context.broken_parameters:
            raise Muted from None
        raise


def _whole(value: float) -> int:
    if value != math.floor(value):
        raise ValueError(f"must be a whole number, is {value:g}")
    return int(value)


def short_form(key: str, schema: Any) -> BeforeValidator:
    """Lets a part be written as its one essential value: anything but a mapping becomes {key: value}.

    `schema` is the type of both forms, for editors.
    """
    return BeforeValidator(
        lambda value: value if isinstance(value, dict | BaseModel) else {key: value},
        json_schema_input_type=schema,
    )


Number = Annotated[float, BeforeValidator(to_number, json_schema_input_type=float | str)]
Positive = Annotated[
    float, Field(gt=0), BeforeValidator(to_number, json_schema_input_type=Annotated[float, Field(gt=0)] | str)
]
NotNegative = Annotated[
    float, Field(ge=0), BeforeValidator(to_number, json_schema_input_type=Annotated[float, Field(ge=0)] | str)
]
Whole = Annotated[int, BeforeValidator(_whole), BeforeValidator(to_number, json_schema_input_type=int | str)]
Pair = tuple[Number, Number]
Flag = Annotated[bool, Strict()]
Text = Annotated[str, Strict()]


def _not_zero(value: float) -> float:
    if value == 0.0:
        raise ValueError("must not be zero")
    return value


NotZero = Annotated[Number, AfterValidator(_not_zero)]
