"""The properties along a beam: pieces within which mass and stiffness are polynomials."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated, Any

from pydantic import BeforeValidator, model_validator

from fmbd.model.base import Part, Positive
from fmbd.model.context import reference, reject
from fmbd.model.materials import Material
from fmbd.model.sections import General, Section, section_properties, shear_coefficient

LENGTH_TOLERANCE = 1e-9  # relative to the length: positions this close to an end are the end


@dataclass(frozen=True, slots=True)
class BeamPiece:
    """Properties between `start` and `end` [m]: polynomials in the distance from `start`, ascending powers.

    `height` [m] in the plane of bending is None when it is not known, `rotary_inertia` rho I [kg m],
    `shear_stiffness` kappa G A [N] and `axial_stiffness` E A [N] when the beam leaves them out.
    """

    start: float
    end: float
    mass_per_length: tuple[float, ...]
    bending_stiffness: tuple[float, ...]
    height: tuple[float, ...] | None
    rotary_inertia: tuple[float, ...] | None = None
    shear_stiffness: tuple[float, ...] | None = None
    axial_stiffness: tuple[float, ...] | None = None


class Shear(Part):
    """Shear deformation of a beam by its stiffness kappa G A."""

    shear_coefficient: Positive | None = None
    """Shear coefficient kappa, instead of that of the section by Cowper's formula."""
    shear_stiffness: Positive | None = None
    """kappa G A [N], for a beam of mass_per_length and bending_stiffness."""


SectionRef = Annotated[Section, reference("sections", "section")]


class Taper(Part):
    """A section whose dimensions vary linearly."""

    start: SectionRef
    """Name of the section at the start."""
    end: SectionRef
    """Name of the section at the end, of the same type."""

    @model_validator(mode="after")
    def _check(self) -> "Taper":
        if self.start is not self.end:
            for key, section in (("start", self.start), ("end", self.end)):
                if isinstance(section, General):
                    reject((key,), "a 'general' section has no dimensions that could vary linearly")
            if self.start.type != self.end.type:
                message = (
                    f"is a {self.end.type}, but the start is a {self.start.type}: a taper keeps one type"
                )
                reject(("end",), message)
        return self


def _to_taper(value: Any) -> Any:
    return {"start": value, "end": value} if isinstance(value, str) else value


class SectionPiece(Part):
    """The section of a beam up to a position."""

    until: Positive | None = None
    """Position [m] at which the piece ends; the last piece ends where the beam does."""
    section: Annotated[Taper, BeforeValidator(_to_taper, json_schema_input_type=str | Taper)]
    """Name of a section, or a linear taper {start: name, end: name}."""


def _to_pieces(value: Any) -> Any:
    return value if isinstance(value, list) else [{"section": value}]


SectionLayout = Annotated[
    tuple[SectionPiece, ...],
    BeforeValidator(_to_pieces, json_schema_input_type=str | Taper | list[SectionPiece]),
]


def beam_pieces(
    layout: Sequence[SectionPiece],
    material: Material,
    length: float,
    rotary_inertia: bool = False,
    shear: Shear | None = None,
    stretch: bool = False,
) -> tuple[BeamPiece, ...]:
    """The pieces of a beam of one material; raises ValidationError when they do not cover its length.

    With rotary inertia, shear and axial flexibility (`stretch`) if these are asked for.
    """
    ends = _piece_ends(layout, length)
    starts = [0.0, *ends[:-1]]
    pieces = []
    for start, end, part in zip(starts, ends, layout, strict=True):
        area, second_moment, height = section_properties(part.section.start, part.section.end, end - start)
        pieces.append(
            BeamPiece(
                start,
                end,
                tuple(area * material.density),
                tuple(second_moment * material.youngs_modulus),
                None if height is None else tuple(height),
                tuple(second_moment * material.density) if rotary_inertia else None,
                tuple(area * _sheared_modulus(part.section, material, shear)) if shear else None,
                tuple(area * material.youngs_modulus) if stretch else None,
            )
        )
    return tuple(pieces)


def uniform_piece(
    length: float,
    mass_per_length: float,
    bending_stiffness: float,
    rotary_inertia: float | None = None,
    shear_stiffness: float | None = None,
    axial_stiffness: float | None = None,
) -> BeamPiece:
    """One piece of constant properties, without a known height."""
    options = [
        None if value is None else (value,) for value in (rotary_inertia, shear_stiffness, axial_stiffness)
    ]
    return BeamPiece(0.0, length, (mass_per_length,), (bending_stiffness,), None, *options)


def _sheared_modulus(section: Taper, material: Material, shear: Shear) -> float:
    """kappa G [Pa]."""
    if shear.shear_stiffness is not None:
        reject(("shear", "shear_stiffness"), "is for a beam of mass_per_length and bending_stiffness")
    E, nu, G = material.youngs_modulus, material.poissons_ratio, material.shear_modulus
    if nu is None:
        if G is None:
            reject(("material",), "needs 'poissons_ratio' or 'shear_modulus' for a beam with shear")
        nu = 0.5 * E / G - 1.0  # of an isotropic material
    if G is None:
        G = 0.5 * E / (1.0 + nu)
    kappa = shear.shear_coefficient
    if kappa is None and not -1.0 < nu <= 0.5:
        text = (
            f"this material of E / G = {E / G:.3g} is not isotropic: write shear: {{shear_coefficient: ...}}"
        )
        reject(("shear",), text)
    if kappa is None:
        kappa = shear_coefficient(section.start, section.end, nu)
    if kappa is None:
        text = "a 'general' section has no known shear coefficient: write shear: {shear_coefficient: ...}"
        reject(("shear",), text)
    return kappa * G


def _piece_ends(layout: Sequence[SectionPiece], length: float) -> list[float]:
    if not layout:
        reject(("section",), "needs at least one piece")
    ends: list[float] = []
    for number, piece in enumerate(layout[:-1]):
        before = ends[-1] if ends else 0.0
        if piece.until is None:
            reject(("section", number), "missing key 'until': only the last piece ends with the beam")
        if not before < piece.until < length:
            message = f"must lie between {before:g} and the beam's end at {length:g}, is {piece.until:g}"
            reject(("section", number, "until"), message)
        ends.append(piece.until)
    last = layout[-1].until
    if last is not None and abs(last - length) > LENGTH_TOLERANCE * length:
        message = f"the last piece must end with the beam at {length:g}, ends at {last:g}"
        reject(("section", len(layout) - 1, "until"), message)
    return [*ends, length]
