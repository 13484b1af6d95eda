"""Points that are to be brought to places in the plane."""

from typing import Annotated

from pydantic import AfterValidator, ValidationInfo

from fmbd.model.base import Pair, Text
from fmbd.model.context import context_of
from fmbd.model.names import unknown
from fmbd.model.points import to_point


def _placed(name: str, info: ValidationInfo) -> str:
    """A joint's name (its first point is meant) or `body.point`."""
    if "." in name:
        if to_point(name, info).body == "ground":
            raise ValueError(f"the ground's point '{name}' cannot be placed")
        return name
    context = context_of(info)
    joints = context.parts.get("joints", {})
    if name not in joints:
        raise ValueError(unknown("joint or point", name, joints))
    context.find("joints", name, "joint")
    return name


PlacesField = dict[Annotated[Text, AfterValidator(_placed)], Pair]
