"""Joints between two points."""

from math import hypot
from typing import Annotated, Any, Literal, get_args

from pydantic import AfterValidator, BeforeValidator, Field, ValidationInfo, model_validator

from fmbd.model.base import Flag, NotNegative, Number, Pair, Part, short_form
from fmbd.model.context import reject
from fmbd.model.laws import Friction, Limits, SpringLaw
from fmbd.model.names import closest, described
from fmbd.model.points import PointRefField
from fmbd.model.signals import SignalField

Coordinate = Literal["x", "y", "angle"]

FREE_COORDINATES: dict[str, tuple[Coordinate, ...]] = {
    "revolute": ("angle",),
    "prismatic": ("x",),
    "weld": (),
    "pin_in_slot": ("x", "angle"),
    "free": ("x", "y", "angle"),
}


FrictionField = Annotated[Friction, short_form("viscous", NotNegative | Friction)]


class JointSpring(SpringLaw):
    """A spring and damper in a joint coordinate."""

    rest: Number = 0.0
    """Coordinate at which the stretch is zero [m or rad]."""


def by_coordinate(value: Any, coordinates: tuple[Coordinate, ...], is_value: bool) -> Any:
    """A quantity of a joint by coordinate; with one free coordinate the quantity alone will do.

    `is_value` says that a mapping, too, is the quantity itself. Raises ValueError.
    """
    if not coordinates:
        raise ValueError("a weld has no free coordinate")
    if isinstance(value, dict) and not is_value:
        for name in value:
            if name not in coordinates:
                raise ValueError(
                    f"'{name}' is not a free coordinate of this joint ({', '.join(coordinates)})"
                )
        return value
    if len(coordinates) > 1:
        form = ", ".join(f"{name}: ..." for name in coordinates)
        raise ValueError(f"must say which coordinate: {{{form}}}, not {described(value)}")
    return {coordinates[0]: value}


def _law(part: type[Part], entry: Any) -> BeforeValidator:
    """Spreads a part by coordinate; a mapping is the part itself if none of its names is like a coordinate's.

    `entry` is the type of its value in a file, for editors.
    """

    def spread(value: Any, info: ValidationInfo) -> Any:
        coordinates = get_args(Coordinate)
        known = (*part.key_names(), *coordinates)
        is_value = isinstance(value, dict) and not any(closest(name, known) in coordinates for name in value)
        return _spread(value, info, is_value)

    return BeforeValidator(spread, json_schema_input_type=entry | dict[Coordinate, entry])


def _signal(value: Any, info: ValidationInfo) -> Any:
    return _spread(value, info, isinstance(value, dict) and "type" in value)


def _spread(value: Any, info: ValidationInfo, is_value: bool) -> Any:
    if "type" not in info.data:
        return {}
    return by_coordinate(value, FREE_COORDINATES[info.data["type"]], is_value)


def _normalised(axis: tuple[float, float]) -> tuple[float, float]:
    length = hypot(*axis)
    if length == 0.0:
        raise ValueError("must be a direction, not [0, 0]")
    return axis[0] / length, axis[1] / length


class Joint(Part):
    """A joint: which of x, y and angle between the frames of two points are free.

    The coordinates are the motion of the second point seen from the first: x and y along the first point's
    axes, turned by `axis`; angle is the angle of the second point's frame minus that of the first.
    """

    type: Literal["revolute", "prismatic", "weld", "pin_in_slot", "free"]
    """Free are: revolute angle; prismatic x; weld nothing; pin_in_slot x and angle; free x, y and angle."""
    between: tuple[PointRefField, PointRefField]
    """The two points, of different bodies: [body.point, body.point]."""
    axis: Annotated[Pair, AfterValidator(_normalised)] = (1.0, 0.0)
    """Direction of x in the first point's frame."""
    spring: Annotated[dict[Coordinate, JointSpring], _law(JointSpring, JointSpring)] = Field(
        default_factory=dict
    )
    """Spring and damper {stiffness, damping, rest, backlash, force_table}, by coordinate if there are several."""
    friction: Annotated[dict[Coordinate, FrictionField], _law(Friction, FrictionField)] = Field(
        default_factory=dict
    )
    """Viscous friction [N s/m or N m s/rad], or {viscous, coulomb, static, stribeck_speed, transition_speed}."""
    limits: Annotated[dict[Coordinate, Limits], _law(Limits, Limits)] = Field(default_factory=dict)
    """Stops {lower, upper, stiffness, damping, transition}, by coordinate if there are several."""
    driven: Annotated[
        dict[Coordinate, SignalField],
        BeforeValidator(_signal, json_schema_input_type=SignalField | dict[Coordinate, SignalField]),
    ] = Field(default_factory=dict)
    """Prescribed motion: a signal [m or rad], by coordinate if there are several."""
    cut: Flag = False
    """Marks the joint that closes a loop; left out, the program chooses."""

    @property
    def coordinates(self) -> tuple[Coordinate, ...]:
        """The free coordinates."""
        return FREE_COORDINATES[self.type]

    @property
    def motor_coordinate(self) -> Coordinate | None:
        """The coordinate that a motor on this joint moves: the only one, or the angle; None for a weld."""
        coordinates = self.coordinates
        return "angle" if "angle" in coordinates else coordinates[0] if coordinates else None

    @model_validator(mode="after")
    def _check(self) -> "Joint":
        first, second = self.between
        if first.body == second.body:
            what = "the ground twice" if first.body == "ground" else f"the body '{first.body}' twice"
            reject(("between",), f"holds {what}: a joint connects two different bodies")
        return self
