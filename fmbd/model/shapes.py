"""Shapes of rigid bodies: mass, centre of mass and moment of inertia of homogeneous solids."""

from math import cos, pi, sin
from typing import Annotated, Literal

from pydantic import Field

from fmbd.model.base import Number, Pair, Part, Positive


class Box(Part):
    """A rectangular block."""

    type: Literal["box"]
    length: Positive
    """Size along x [m]."""
    height: Positive
    """Size along y [m]."""
    width: Positive | None = None
    """Depth out of the plane [m]; not needed when the mass is given."""
    center: Pair = (0.0, 0.0)
    """Centre [m] in the body's frame."""
    angle: Number = 0.0
    """Angle [rad] of the block's length against the body's x axis."""

    @property
    def volume(self) -> float | None:
        """Volume [m^3], None when the width is not known."""
        return None if self.width is None else self.length * self.height * self.width

    @property
    def centroid(self) -> tuple[float, float]:
        """Centre of mass [m]."""
        return self.center

    @property
    def inertia_per_mass(self) -> float:
        """Moment of inertia about the centre of mass, divided by the mass [m^2]."""
        return (self.length**2 + self.height**2) / 12.0


class Rod(Part):
    """A slender uniform bar."""

    type: Literal["rod"]
    length: Positive
    """Length [m]."""
    diameter: Positive | None = None
    """Diameter [m]; not needed when the mass is given."""
    start: Pair = (0.0, 0.0)
    """Start [m] in the body's frame."""
    angle: Number = 0.0
    """Angle [rad] of the bar against the body's x axis."""

    @property
    def volume(self) -> float | None:
        """Volume [m^3], None when the diameter is not known."""
        return None if self.diameter is None else pi / 4.0 * self.diameter**2 * self.length

    @property
    def centroid(self) -> tuple[float, float]:
        """Centre of mass [m]."""
        half = self.length / 2.0
        return self.start[0] + half * cos(self.angle), self.start[1] + half * sin(self.angle)

    @property
    def inertia_per_mass(self) -> float:
        """Moment of inertia about the centre of mass, divided by the mass [m^2]."""
        return self.length**2 / 12.0


class Disc(Part):
    """A flat cylinder that turns in the plane."""

    type: Literal["disc"]
    radius: Positive
    """Radius [m]."""
    thickness: Positive | None = None
    """Depth out of the plane [m]; not needed when the mass is given."""
    center: Pair = (0.0, 0.0)
    """Centre [m] in the body's frame."""

    @property
    def volume(self) -> float | None:
        """Volume [m^3], None when the thickness is not known."""
        return None if self.thickness is None else pi * self.radius**2 * self.thickness

    @property
    def centroid(self) -> tuple[float, float]:
        """Centre of mass [m]."""
        return self.center

    @property
    def inertia_per_mass(self) -> float:
        """Moment of inertia about the centre of mass, divided by the mass [m^2]."""
        return self.radius**2 / 2.0


Shape = Box | Rod | Disc
ShapeField = Annotated[Shape, Field(discriminator="type")]
# The dimension without which a shape has no volume.
DEPTH = {"box": "width", "rod": "diameter", "disc": "thickness"}
