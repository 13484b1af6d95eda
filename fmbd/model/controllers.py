"""Feedback controllers of motors."""

from typing import Annotated, Any, Literal

from pydantic import (
    AfterValidator,
    BeforeValidator,
    ConfigDict,
    Field,
    PlainValidator,
    TypeAdapter,
    ValidationInfo,
)

from fmbd.model.base import Number, Part, Text, to_number
from fmbd.model.context import context_of
from fmbd.model.places import PlacesField
from fmbd.model.signals import Constant, Signal, SignalField, check_signal_name, to_signal


class Placement(Part):
    """Points of the rigid mechanism brought to places: the joint coordinates follow."""

    places: PlacesField = Field(alias="place")
    """Places [m] of points: {point or joint: [x, y]}."""


class GravityCompensation(Part):
    """The input that holds the rigid mechanism against gravity."""

    type: Literal["gravity_compensation"] = "gravity_compensation"
    computed: Literal["target", "online"] = "target"
    """Once, at the target, or at the present configuration at all times."""


def _joint_name(name: str, info: ValidationInfo) -> str:
    context_of(info).find("joints", name, "joint")
    return name


_Targets = dict[Annotated[Text, AfterValidator(_joint_name)], SignalField]
_targets: TypeAdapter[dict[str, Signal]] = TypeAdapter(_Targets, config=ConfigDict(defer_build=True))


def _to_target(value: Any, info: ValidationInfo) -> Signal | dict[str, Signal] | Placement:
    if isinstance(value, Placement):
        return value
    if isinstance(value, dict) and "type" not in value:
        if "place" in value:
            return Placement.model_validate(value, context=info.context)
        return _targets.validate_python(value, context=info.context)
    return to_signal(value, info)


def _to_feedforward(value: Any, info: ValidationInfo) -> Signal | GravityCompensation:
    if isinstance(value, GravityCompensation):
        return value
    if value == "gravity_compensation":
        return GravityCompensation()
    if isinstance(value, dict) and value.get("type") == "gravity_compensation":
        return GravityCompensation.model_validate(value, context=info.context)
    if isinstance(value, str):
        check_signal_name(value, context_of(info), "signal", ["gravity_compensation"])
    return to_signal(value, info)


def _to_limits(value: Any, info: ValidationInfo) -> Any:
    if value is None or isinstance(value, list | tuple):
        return value
    size = to_number(value, info)
    if size <= 0.0:
        raise ValueError(f"must be positive, is {size:g}")
    return -size, size


def _increasing(limits: tuple[float, float]) -> tuple[float, float]:
    if limits[0] >= limits[1]:
        raise ValueError(f"must be [low, high] with low < high, is [{limits[0]:g}, {limits[1]:g}]")
    return limits


_Limits = Annotated[
    tuple[Number, Number],
    AfterValidator(_increasing),
    BeforeValidator(_to_limits, json_schema_input_type=Number | tuple[Number, Number]),
]


class PDController(Part):
    """input = kp (target - angle) - kd rate + feedforward, within its limits."""

    type: Literal["pd"]
    kp: Number
    """Proportional gain [V/rad or N m/rad]."""
    kd: Number = 0.0
    """Gain of the rate [V s/rad or N m s/rad]."""
    measure: Literal["rotor", "joint"] | None = None
    """What is fed back, the rotor if there is one; its set point is gear_ratio times the target."""
    target: Annotated[
        Signal | dict[str, Signal] | Placement,
        PlainValidator(_to_target, json_schema_input_type=SignalField | Placement | dict[str, SignalField]),
    ]
    """Joint coordinate: a signal, {joint: signal}, or where points are to be, {place: {point: [x, y]}}."""
    feedforward: Annotated[
        Signal | GravityCompensation,
        PlainValidator(
            _to_feedforward,
            json_schema_input_type=Literal["gravity_compensation"] | GravityCompensation | SignalField,
        ),
    ] = Constant(value=0.0)
    """Added to the input: a signal, or gravity_compensation."""
    limit: _Limits | None = None
    """Saturation of the input: a number for both directions, or [low, high]."""


class PIDController(PDController):
    """A PD controller with an integral term that starts at 0."""

    type: Literal["pid"]  # type: ignore[assignment]
    ki: Number
    """Integral gain [V/(rad s) or N m/(rad s)]."""


Controller = PDController | PIDController
ControllerField = Annotated[Controller, Field(discriminator="type")]
