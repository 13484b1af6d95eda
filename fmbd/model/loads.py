"""Forces and moments that are given over time."""

from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field, PlainValidator, ValidationInfo, model_validator

from fmbd.model.base import NotNegative, Part, Positive
from fmbd.model.beam import Beam
from fmbd.model.context import context_of, reject
from fmbd.model.names import described
from fmbd.model.pieces import LENGTH_TOLERANCE
from fmbd.model.points import PointRefField
from fmbd.model.signals import SignalField

Frame = Literal["fixed", "following"]


class ForceLoad(Part):
    """A force at a point."""

    type: Literal["force"]
    at: PointRefField
    """The point it acts on: body.point."""
    force: tuple[SignalField, SignalField]
    """Components over time [N]."""
    frame: Frame = "fixed"
    """Axes of the components: the world's, or the point's."""


class MomentLoad(Part):
    """A moment on the body at a point."""

    type: Literal["moment"]
    at: PointRefField
    """The point it acts on: body.point."""
    moment: SignalField
    """Moment over time [N m]."""


def _beam_name(value: Any, info: ValidationInfo) -> str:
    if not isinstance(value, str):
        raise ValueError(f"must be the name of a beam, not {described(value)}")
    if not isinstance(context_of(info).find("bodies", value, "beam"), Beam):
        raise ValueError(f"the body '{value}' is rigid: a distributed load needs a beam")
    return value


def _beam_end(value: Any, info: ValidationInfo) -> Any:
    if value is not None or "on" not in info.data:
        return 1.0 if value is None else value
    return context_of(info).find("bodies", info.data["on"], "beam").length


class DistributedLoad(Part):
    """A uniform force per length along a stretch of a beam."""

    type: Literal["distributed"]
    on: Annotated[str, PlainValidator(_beam_name, json_schema_input_type=str)]
    """Name of the beam."""
    force: tuple[SignalField, SignalField]
    """Components over time [N/m]."""
    frame: Frame = "fixed"
    """Axes of the components: the world's, or the beam's floating frame, that of each segment if it has several."""
    from_: NotNegative = Field(0.0, alias="from")
    """Start of the stretch [m]."""
    to: Annotated[Positive, BeforeValidator(_beam_end)] = Field(None, validate_default=True)
    """End of the stretch [m]; the end of the beam when left out."""

    @model_validator(mode="after")
    def _check(self, info: ValidationInfo) -> "DistributedLoad":
        length = context_of(info).find("bodies", self.on, "beam").length
        if self.to > length * (1.0 + LENGTH_TOLERANCE):
            reject(("to",), f"lies off the beam: {self.to:g} m on a length of {length:g} m")
        if self.from_ >= self.to:
            reject(("from",), f"must be less than the end of the load ({self.to:g}), is {self.from_:g}")
        return self


Load = ForceLoad | MomentLoad | DistributedLoad
LoadField = Annotated[Load, Field(discriminator="type")]
