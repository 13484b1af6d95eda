"""Force laws: springs, linear, with backlash or by a table; friction; stops."""

from dataclasses import dataclass
from typing import Annotated, Any, Literal

from pydantic import Field, PlainValidator, ValidationInfo, model_validator

from fmbd.model.base import NotNegative, Number, Pair, Part, Positive, short_form
from fmbd.model.context import context_of, reject
from fmbd.model.names import described
from fmbd.model.tables import Column, TableFile

Interpolation = Literal["monotone", "linear"]


class Backlash(Part):
    """A dead zone about the rest of a spring."""

    gap: Positive
    """Width of the dead zone, half of it to either side of the rest [m or rad]."""
    transition: Positive = Field(default_factory=lambda data: 0.1 * data["gap"])
    """Width [m or rad] over which the spring takes hold at either side; a tenth of the gap when left out."""

    @model_validator(mode="after")
    def _check(self) -> "Backlash":
        if self.transition > self.gap:
            message = f"must not be wider than the gap ({self.gap:g}), is {self.transition:g}"
            reject(("transition",), message)
        return self


@dataclass(frozen=True, slots=True)
class ForceTable:
    """Tensions [N or N m] at strictly increasing stretches [m or rad]."""

    stretches: tuple[float, ...]
    forces: tuple[float, ...]
    interpolation: Interpolation


class ForceFile(TableFile):
    """Force over stretch from a CSV file; before the first and after the last row the curve goes on straight."""

    stretch: Column = 0
    """Column of the stretches [m or rad]: its header, or its number from 0."""
    force: Column = 1
    """Column of the forces [N] or moments [N m]: its header, or its number from 0."""
    interpolation: Interpolation = "monotone"
    """Between the rows: a smooth curve that rises and falls only where the rows do, or straight lines."""


class ForcePoints(Part):
    """Force over stretch through points; before the first and after the last the curve goes on straight."""

    points: tuple[Pair, ...]
    """Pairs [stretch, force], stretches ascending [m or rad; N or N m]."""
    interpolation: Interpolation = "monotone"
    """Between the points: a smooth curve that rises and falls only where the points do, or straight lines."""

    @model_validator(mode="after")
    def _check(self) -> "ForcePoints":
        if len(self.points) < 2:
            reject(("points",), f"a table needs at least two points, has {len(self.points)}")
        for k in range(1, len(self.points)):
            x, before = self.points[k][0], self.points[k - 1][0]
            if x <= before:
                reject(("points", k), f"the stretch {x:g} does not increase (before: {before:g})")
        return self


def _to_force_table(value: Any, info: ValidationInfo) -> ForceTable:
    """A table from the name of a file, a list of points, or a mapping with either."""
    if isinstance(value, ForceTable):
        return value
    if isinstance(value, list):
        value = {"points": value}
    elif isinstance(value, str):
        value = {"file": value}
    elif not isinstance(value, dict):
        raise ValueError(f"must be a file, a list of points or a mapping, not {described(value)}")
    if "points" in value:
        inline = ForcePoints.model_validate(value, context=info.context)
        stretches, forces = zip(*inline.points, strict=True)
        return ForceTable(stretches, forces, inline.interpolation)
    entry = ForceFile.model_validate(value, context=info.context)
    return ForceTable(*entry.columns(context_of(info), "stretch", "force"), entry.interpolation)


ForceTableField = Annotated[
    ForceTable,
    PlainValidator(_to_force_table, json_schema_input_type=str | list[Pair] | ForceFile | ForcePoints),
]


class SpringLaw(Part):
    """The force of a spring and damper over stretch and rate; linear, with backlash, or by a table."""

    stiffness: NotNegative = 0.0
    """Stiffness [N/m or N m/rad]."""
    damping: NotNegative = 0.0
    """Viscous damping [N s/m or N m s/rad]; with backlash, where the spring takes hold."""
    backlash: Annotated[Backlash | None, short_form("gap", Positive | Backlash)] = None
    """Dead zone: its whole width [m or rad], or {gap, transition}."""
    force_table: ForceTableField | None = None
    """In place of a stiffness, tension [N or N m] over stretch: a CSV file, [[stretch, force], ...], or a mapping."""

    @model_validator(mode="after")
    def _check_law(self) -> "SpringLaw":
        if self.force_table is not None:
            for key in ("stiffness", "backlash"):
                if getattr(self, key):
                    reject((key,), "'force_table' is given, too: it is the whole force of the spring")
        elif self.backlash is not None and self.stiffness == 0.0:
            reject(("backlash",), "needs a stiffness greater than 0")
        return self


class Friction(Part):
    """Friction of given size, whatever the load on the joint: viscous, and dry, which falls with the speed.

    viscous v + (coulomb + (static - coulomb) exp(-(v / stribeck_speed)^2)) tanh(v / transition_speed)
    """

    viscous: NotNegative = 0.0
    """Viscous friction [N s/m or N m s/rad]."""
    coulomb: NotNegative = 0.0
    """Dry friction in motion [N or N m]."""
    static: NotNegative = Field(default_factory=lambda data: data["coulomb"])
    """Dry friction at the onset of motion [N or N m]; coulomb when left out."""
    stribeck_speed: Positive | None = None
    """Speed [m/s or rad/s] at which static friction has given way to coulomb, to 1/e."""
    transition_speed: Positive = 1e-3
    """Speed [m/s or rad/s] about which dry friction takes hold; what sticks creeps more slowly than that."""

    @model_validator(mode="after")
    def _check(self) -> "Friction":
        if self.static < self.coulomb:
            reject(("static",), f"must not be less than coulomb ({self.coulomb:g}), is {self.static:g}")
        if self.static > self.coulomb and self.stribeck_speed is None:
            reject(("static",), "needs a stribeck_speed, at which it gives way to coulomb")
        if self.stribeck_speed is not None and self.stribeck_speed < 2.0 * self.transition_speed:
            message = f"must be at least twice the transition_speed ({self.transition_speed:g})"
            reject(("stribeck_speed",), f"{message}, is {self.stribeck_speed:g}")
        return self


class Limits(Part):
    """Elastic stops of a joint coordinate.

    stiffness depth max(0, 1 + damping depth') behind the stop: what hits it at the speed v bounces back with about
    (1 - 2/3 damping v) v. Hunt and Crossley, Journal of Applied Mechanics 42 (2), 1975, pp. 440-445.
    """

    lower: Number | None = None
    """Place of the lower stop [m or rad]; none when left out."""
    upper: Number | None = None
    """Place of the upper stop [m or rad]; none when left out."""
    stiffness: Positive
    """Stiffness of a stop [N/m or N m/rad]."""
    damping: NotNegative = 0.0
    """Damping of a stop, share of its force per speed of approach [s/m or s/rad]."""
    transition: Positive = 1e-3
    """Width [m or rad] about the place of a stop over which it takes hold."""

    @model_validator(mode="after")
    def _check(self) -> "Limits":
        if self.lower is None and self.upper is None:
            reject((), "missing key 'lower' or 'upper'")
        if self.lower is not None and self.upper is not None and self.upper - self.lower < self.transition:
            message = f"must be above lower ({self.lower:g}) by the transition ({self.transition:g}) at least"
            reject(("upper",), f"{message}, is {self.upper:g}")
        return self
