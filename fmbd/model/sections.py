"""Cross-sections of beams. Heights lie in the plane of bending.

Shear coefficients kappa: G. R. Cowper, The shear coefficient in Timoshenko's beam theory, Journal of Applied Mechanics
33 (1966), pp. 335-340; nu is Poisson's ratio.
"""

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

    def shear_coefficient(self, nu: float) -> float:
        """kappa."""
        return 10.0 * (1.0 + nu) / (12.0 + 11.0 * nu)


class Circle(Part):
    """A full circle."""

    type: Literal["circle"]
    diameter: Positive
    """Diameter [m]."""

    @staticmethod
    def properties(diameter: Polynomial) -> SectionProperties:
        """Of dimensions that may vary along the beam."""
        return SectionProperties(diameter**2 * (pi / 4.0), diameter**4 * (pi / 64.0), diameter)

    def shear_coefficient(self, nu: float) -> float:
        """kappa."""
        return 6.0 * (1.0 + nu) / (7.0 + 6.0 * nu)


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

    def shear_coefficient(self, nu: float) -> float:
        """kappa."""
        hole = (self.inner_diameter / self.outer_diameter) ** 2
        ring = (1.0 + hole) ** 2
        return 6.0 * (1.0 + nu) * ring / ((7.0 + 6.0 * nu) * ring + (20.0 + 12.0 * nu) * hole)


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

    def shear_coefficient(self, nu: float) -> float:
        """kappa of thin walls; the web reaches from the middle of one flange to that of the other."""
        web = self.height - self.flange_thickness
        n = self.flange_width / web
        m = 2.0 * n * self.flange_thickness / self.web_thickness
        below = 12.0 + 72.0 * m + 150.0 * m**2 + 90.0 * m**3
        below += nu * (11.0 + 66.0 * m + 135.0 * m**2 + 90.0 * m**3)
        below += 30.0 * n**2 * (m + m**2) + 5.0 * nu * n**2 * (8.0 * m + 9.0 * m**2)
        return 10.0 * (1.0 + nu) * (1.0 + 3.0 * m) ** 2 / below


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


def shear_coefficient(start: Section, end: Section, nu: float) -> float | None:
    """kappa, of a taper that in its middle; None if the section is known by its properties alone."""
    if isinstance(start, General):
        return None
    middle = {
        name: 0.5 * (getattr(start, name) + getattr(end, name))
        for name in type(start).model_fields
        if name != "type"
    }
    return start.model_copy(update=middle).shear_coefficient(nu)


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
