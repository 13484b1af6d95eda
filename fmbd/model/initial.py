"""The state a simulation starts from."""

from typing import Annotated, Any

from pydantic import AfterValidator, BeforeValidator, Field, ValidationInfo

from fmbd.model.base import Flag, Number, Part
from fmbd.model.context import context_of, reject
from fmbd.model.joints import Coordinate, Joint, by_coordinate
from fmbd.model.places import PlacesField


def _by_joint(value: Any, info: ValidationInfo) -> Any:
    """Values of joint coordinates in their long form, {joint: {coordinate: value}}."""
    if not isinstance(value, dict):
        return value
    spread = {}
    for name, number in value.items():
        try:
            joint: Joint = context_of(info).find("joints", name, "joint")
            spread[name] = by_coordinate(number, joint.coordinates, is_value=False)
        except ValueError as error:
            reject((name,), error)
    return spread


def _not_driven(value: dict[str, dict[str, float]], info: ValidationInfo) -> dict[str, dict[str, float]]:
    for name, numbers in value.items():
        for coordinate in context_of(info).find("joints", name, "joint").driven:
            if coordinate in numbers:
                reject((name,), f"the joint is driven: its signal sets the {coordinate}")
    return value


JointValues = Annotated[
    dict[str, dict[Coordinate, Number]],
    BeforeValidator(_by_joint, json_schema_input_type=dict[str, Number | dict[Coordinate, Number]]),
]


class Initial(Part):
    """The start: what is given here, completed so that all loops are closed."""

    joints: Annotated[JointValues, AfterValidator(_not_driven)] = Field(default_factory=dict)
    """Joint coordinates [m or rad], by coordinate if a joint has several."""
    rates: Annotated[JointValues, AfterValidator(_not_driven)] = Field(default_factory=dict)
    """Rates of joint coordinates [m/s or rad/s]."""
    place: PlacesField = Field(default_factory=dict)
    """Places [m] that points are brought to: {point or joint: [x, y]}; a joint stands for its first point."""
    hints: JointValues = Field(default_factory=dict)
    """Rough joint coordinates that choose among the ways to assemble the mechanism."""
    consistent: Flag = True
    """false: start from exactly these joint coordinates, even if a loop is open."""
