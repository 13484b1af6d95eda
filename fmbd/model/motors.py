"""Motors on joints."""

from typing import Annotated, Any, Literal, NamedTuple

from pydantic import AfterValidator, BeforeValidator, Field, PlainValidator, ValidationInfo, model_validator

from fmbd.model.base import NotNegative, NotZero, Part, Positive, Text, short_form
from fmbd.model.context import context_of, reject
from fmbd.model.laws import Backlash
from fmbd.model.signals import Signal, SignalField, check_signal_name, to_signal


class ControllerRef(NamedTuple):
    """The name of the controller that gives a motor's input."""

    name: str


class Transmission(Part):
    """An elastic shaft between gear and joint."""

    stiffness: Positive
    """Torsional stiffness at the joint [N m/rad]."""
    damping: NotNegative = 0.0
    """Viscous damping at the joint [N m s/rad]; with backlash, where the shaft takes hold."""
    backlash: Annotated[Backlash | None, short_form("gap", Positive | Backlash)] = None
    """Play of the gear at the joint: its whole width [rad], or {gap, transition}."""


def _to_input(value: Any, info: ValidationInfo) -> Signal | ControllerRef:
    """A controller by its name, or a signal."""
    if isinstance(value, ControllerRef):
        return value
    if isinstance(value, str):
        context = context_of(info)
        if context.knows("controllers", value):
            return ControllerRef(value)
        check_signal_name(value, context, "signal or controller", context.parts.get("controllers", {}))
    return to_signal(value, info)


Input = Annotated[Signal | ControllerRef, PlainValidator(_to_input, json_schema_input_type=SignalField)]


def _joint_name(name: str, info: ValidationInfo) -> str:
    joint = context_of(info).find("joints", name, "joint")
    if joint.motor_coordinate is None:
        raise ValueError(f"the joint '{name}' is a weld: a motor needs a coordinate to move")
    if joint.motor_coordinate in joint.driven:
        raise ValueError(f"the joint '{name}' is driven: it cannot carry a motor, too")
    return name


class _Motor(Part):
    joint: Annotated[Text, AfterValidator(_joint_name)]
    """Name of the joint it moves: by its only coordinate, or by its angle."""
    gear_ratio: NotZero = 1.0
    """Rotor angle per joint coordinate."""
    rotor_inertia: NotNegative = 0.0
    """Moment of inertia of the rotor [kg m^2]."""
    transmission: Annotated[
        Transmission | None,
        BeforeValidator(
            lambda value: None if value == "rigid" else value,
            json_schema_input_type=Literal["rigid"] | Transmission,
        ),
    ] = None
    """Elastic shaft {stiffness, damping, backlash}, or rigid."""

    @model_validator(mode="after")
    def _check(self) -> "_Motor":
        if self.transmission is not None and self.rotor_inertia == 0.0:
            reject(("transmission",), "an elastic transmission needs a rotor_inertia greater than 0")
        return self


class DCMotor(_Motor):
    """A DC motor: inductance i' + resistance i + back_emf rotor' = voltage, torque = torque_constant i."""

    type: Literal["dc"]
    resistance: Positive
    """Armature resistance [Ohm]."""
    inductance: NotNegative = 0.0
    """Armature inductance [H]; 0 neglects it."""
    torque_constant: Positive
    """Torque per current [N m/A]."""
    back_emf: NotNegative = Field(default_factory=lambda data: data["torque_constant"])
    """Voltage per rotor rate [V s/rad]; the torque constant when left out."""
    input: Input = Field(alias="voltage")
    """Voltage over time [V], or the name of a controller."""


class TorqueMotor(_Motor):
    """An ideal source of torque on the rotor."""

    type: Literal["torque"]
    input: Input = Field(alias="torque")
    """Torque over time [N m], or the name of a controller."""


Motor = DCMotor | TorqueMotor
MotorField = Annotated[Motor, Field(discriminator="type")]
