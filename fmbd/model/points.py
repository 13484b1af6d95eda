"""Points of bodies and of the ground, and references to them."""

from dataclasses import dataclass
from typing import Annotated, Any, NamedTuple

from pydantic import AfterValidator, Field, PlainValidator, ValidationInfo

from fmbd.model.base import Number, Pair, Part, Text, short_form
from fmbd.model.context import context_of, reject
from fmbd.model.names import NAME_PATTERN, described, is_name, shortened, unknown

GROUND = "ground"
ORIGIN = "origin"
CENTER_OF_MASS = "center_of_mass"


class Point(Part):
    """A point fixed to a rigid body or to the ground, with a frame of its own."""

    at: Pair
    """Position [m] in the frame of the body."""
    angle: Number = 0.0
    """Angle [rad] of the point's frame against the body's."""


def checked_name(name: str) -> str:
    """A name of a part or point; raises ValueError."""
    if not is_name(name):
        raise ValueError(
            f"the name '{shortened(name)}' may hold letters, digits and underscores only, no digit in front"
        )
    return name


Name = Annotated[Text, AfterValidator(checked_name), Field(json_schema_extra={"pattern": NAME_PATTERN})]
PointField = Annotated[Point, short_form("at", Pair | Point)]
PointsField = dict[Name, PointField]


@dataclass(frozen=True, slots=True)
class Ground:
    """The fixed world; `points` includes `origin` at [0, 0]."""

    points: dict[str, Point]


class GroundEntry(Part):
    """The fixed world."""

    points: PointsField = Field(default_factory=dict)
    """Points of the ground; `origin` at [0, 0] always exists."""

    def resolve(self) -> Ground:
        """The ground with its origin."""
        return Ground(with_built_in(self.points, {ORIGIN: Point(at=(0.0, 0.0))}))


def with_built_in(points: dict[str, Any], built_in: dict[str, Any]) -> dict[str, Any]:
    """All points of a body, the built-in ones first; raises ValueError when one is defined again."""
    for name in points:
        if name in built_in:
            reject(("points", name), f"the point '{name}' always exists and cannot be defined")
    return built_in | points


class PointRef(NamedTuple):
    """A point of a body, `body.point` in the file."""

    body: str
    point: str

    def __str__(self) -> str:
        return f"{self.body}.{self.point}"


def to_point(value: Any, info: ValidationInfo) -> PointRef:
    """A reference `body.point` to a point that exists."""
    if isinstance(value, PointRef):
        return value
    if not isinstance(value, str) or value.count(".") != 1:
        raise ValueError(f"must be a point such as 'rod.end' or 'ground.origin', not {described(value)}")
    body, point = value.split(".")
    context = context_of(info)
    if body == GROUND:
        owner = context.find(GROUND, GROUND, "body")
    else:
        bodies = context.parts.get("bodies", {})
        if body not in bodies:
            raise ValueError(unknown("body", body, [GROUND, *bodies]))
        owner = context.find("bodies", body, "body")
    if point not in owner.points:
        raise ValueError(unknown("point", point, owner.points, f" of '{body}'"))
    return PointRef(body, point)


PointRefField = Annotated[
    PointRef,
    PlainValidator(to_point, json_schema_input_type=Annotated[str, Field(pattern=r"^\w+\.\w+$")]),
]
