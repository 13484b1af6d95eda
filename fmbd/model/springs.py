"""Springs and dampers between points."""

from typing import Annotated, Literal

from pydantic import Field, model_validator

from fmbd.model.base import NotNegative, Number
from fmbd.model.context import reject
from fmbd.model.laws import SpringLaw
from fmbd.model.points import PointRefField


class PointToPointSpring(SpringLaw):
    """A spring and damper along the line between two points."""

    type: Literal["point_to_point"]
    between: tuple[PointRefField, PointRefField]
    """The two points: [body.point, body.point]."""
    rest_length: NotNegative | None = None
    """Length at which the stretch is zero [m]; that at the start when left out."""

    @model_validator(mode="after")
    def _check(self) -> "PointToPointSpring":
        if self.between[0].body == self.between[1].body:
            reject(("between",), f"both points belong to '{self.between[0].body}'")
        return self


class TorsionalSpring(SpringLaw):
    """A spring and damper on the angle of the second point's frame minus the first's.

    The angle counts the turns of the joints between the two points. If one of these joints is part of a closed loop,
    the turns are counted from the start, which is then within half a turn of the rest angle.
    """

    type: Literal["torsional"]
    between: tuple[PointRefField, PointRefField]
    """The two points: [body.point, body.point]."""
    rest_angle: Number | None = None
    """Angle at which the stretch is zero [rad]; that at the start when left out."""


Spring = PointToPointSpring | TorsionalSpring
SpringField = Annotated[Spring, Field(discriminator="type")]
