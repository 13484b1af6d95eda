"""Cross-sections of beams. Heights lie in the plane of bending."""

from math import pi
from typing import Annotated, Literal, NamedTuple

from pydantic import Field, model_validator

from fmbd.model.base import Part, Positive
from fmbd.model.context import reject
from fmbd.model.polynomials import Polynomial, linear


class SectionProperties(NamedTuple):
    """Area [m^2], second moment of area [m^4] and height [m] as polynomials along a beam."""

    area: Polynomial
    second_moment: Polynomial
    height: Polynomial | None


class Rectangle(Part):
    """A full rectangle: I = width height^3 / 12."""

    type: Literal["rectangle"]
    width: Positive
    """Size out of the plane [m]."""
    height: Positive
    """Size in the plane of bending [m]."""

    @staticmethod
    def properties(width: Polynomial, height: Polynomial) -> SectionProperties:
        """Of dimensions that may vary along the beam."""
        return SectionProperties(width * height, width * height**3 / 12.0, height)


class Circle(Part):
    """A full circle."""

    type: Literal["circle"]
    diameter: Positive
    """Diameter [m]."""

    @staticmethod
    def properties(diameter: Polynomial) -> SectionProperties:
        """Of dimensions that may vary along the beam."""
        return SectionProperties(diameter**2 * (pi / 4.0), diameter**4 * (pi / 64.0), diameter)


class Tube(Part):
    """A circle with a concentric hole."""

    type: Literal["tube"]
    outer_diameter: Positive
    """Outer diameter [m]."""
    inner_diameter: Positive
    """Inner diameter [m], smaller than the outer one."""

    @model_validator(mode="after")
    def _check(self) -> "Tube":
        if self.inner_diameter >= self.outer_diameter:
            message = (
                f"must be smaller than outer_diameter ({self.outer_diameter:g}), is {self.inner_diameter:g}"
            )
            reject(("inner_diameter",), message)
        return self

    @staticmethod
    def properties(outer_diameter: Polynomial, inner_diameter: Polynomial) -> SectionProperties:
        """Of dimensions that may vary along the beam."""
        area = (outer_diameter**2 - inner_diameter**2) * (pi / 4.0)
        return SectionProperties(area, (outer_diameter**4 - inner_diameter**4) * (pi / 64.0), outer_diameter)


class IBeam(Part):
    """A doubly symmetric I-section, bent in the plane of its web."""

    type: Literal["i_beam"]
    height: Positive
    """Overall height in the plane of bending [m]."""
    flange_width: Positive
    """Width of both flanges [m]."""
    flange_thickness: Positive
    """Thickness of each flange [m], less than half the height."""
    web_thickness: Positive
    """Thickness of the web [m], at most the flange width."""

    @model_validator(mode="after")
    def _check(self) -> "IBeam":
        if 2.0 * self.flange_thickness >= self.height:
            message = f"must be less than half the height ({self.height:g}), is {self.flange_thickness:g}"
            reject(("flange_thickness",), message)
        if self.web_thickness > self.flange_width:
            message = f"must be at most flange_width ({self.flange_width:g}), is {self.web_thickness:g}"
            reject(("web_thickness",), message)
        return self

    @staticmethod
    def properties(
        height: Polynomial, flange_width: Polynomial, flange_thickness: Polynomial, web_thickness: Polynomial
    ) -> SectionProperties:
        """Of dimensions that may vary along the beam: the full rectangle without its two cut-outs."""
        gap = flange_width - web_thickness
        web_height = height - flange_thickness * 2.0
        area = flange_width * height - gap * web_height
        return SectionProperties(area, (flange_width * height**3 - gap * web_height**3) / 12.0, height)


class General(Part):
    """A section that is known by its properties alone."""

    type: Literal["general"]
    area: Positive
    """Area [m^2]."""
    second_moment: Positive
    """Second moment of area for bending in the plane [m^4]."""
    height: Positive | None = None
    """Height in the plane of bending [m]; needed for stresses only."""


Section = Rectangle | Circle | Tube | IBeam | General
SectionField = Annotated[Section, Field(discriminator="type")]


def section_properties(start: Section, end: Section, length: float) -> SectionProperties:
    """Properties along a beam whose dimensions vary linearly from one section to another of the same type.

    A `general` section has no dimensions that could vary: then start and end are the same.
    """
    if isinstance(start, General):
        height = None if start.height is None else Polynomial((start.height,))
        return SectionProperties(Polynomial((start.area,)), Polynomial((start.second_moment,)), height)
    dimensions = {
        name: linear(getattr(start, name), getattr(end, name), length)
        for name in type(start).model_fields
        if name != "type"
    }
    return start.properties(**dimensions)
