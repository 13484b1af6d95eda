"""The properties along a beam: pieces within which mass and stiffness are polynomials."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated, Any

from pydantic import BeforeValidator, model_validator

from fmbd.model.base import Part, Positive
from fmbd.model.context import reference, reject
from fmbd.model.materials import Material
from fmbd.model.polynomials import Polynomial
from fmbd.model.sections import General, Section, section_properties

LENGTH_TOLERANCE = 1e-9  # relative to the length: positions this close to an end are the end


@dataclass(frozen=True, slots=True)
class BeamPiece:
    """Properties between `start` and `end` [m]: polynomials in the distance from `start`, ascending powers.

    `height` [m] in the plane of bending is None when it is not known.
    """

    start: float
    end: float
    mass_per_length: tuple[float, ...]
    bending_stiffness: tuple[float, ...]
    height: tuple[float, ...] | None


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


def beam_pieces(layout: Sequence[SectionPiece], material: Material, length: float) -> tuple[BeamPiece, ...]:
    """The pieces of a beam of one material; raises ValidationError when they do not cover its length."""
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
                _stiffness(second_moment, material),
                _tuple(height),
            )
        )
    return tuple(pieces)


def uniform_piece(length: float, mass_per_length: float, bending_stiffness: float) -> BeamPiece:
    """One piece of constant properties, without a known height."""
    return BeamPiece(0.0, length, (mass_per_length,), (bending_stiffness,), None)


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


def _stiffness(second_moment: Polynomial, material: Material) -> tuple[float, ...]:
    return tuple(second_moment * material.youngs_modulus)


def _tuple(polynomial: Polynomial | None) -> tuple[float, ...] | None:
    return None if polynomial is None else tuple(polynomial)
