"""Flexible beams."""

import re
from dataclasses import dataclass
from typing import Annotated, Any, ClassVar, Literal

from pydantic import Discriminator, Field, Tag, ValidationInfo, model_validator

from fmbd.model.base import Flag, NotNegative, Number, Part, Positive, Text, Whole, short_form
from fmbd.model.context import Context, context_of, reference, reject
from fmbd.model.materials import Material
from fmbd.model.names import unknown
from fmbd.model.pieces import LENGTH_TOLERANCE, BeamPiece, SectionLayout, Shear, beam_pieces, uniform_piece
from fmbd.model.points import Name

MAX_ELEMENTS = 100_000  # of all beams of a model


class PointMass(Part):
    """A mass fixed to a point of a beam."""

    mass: NotNegative = 0.0
    """Mass [kg]."""
    inertia: NotNegative = 0.0
    """Moment of inertia [kg m^2]."""


def _number_or_list(value: Any) -> str:
    return "list" if isinstance(value, list | tuple) else "number"


class Damping(Part):
    """Damping of a beam: D = stiffness_proportional K + mass_proportional M, plus ratios of its modes."""

    stiffness_proportional: NotNegative = 0.0
    """Factor of the stiffness matrix [s]."""
    mass_proportional: NotNegative = 0.0
    """Factor of the mass matrix [1/s]."""
    modal_ratios: Annotated[
        Annotated[NotNegative, Tag("number")] | Annotated[tuple[NotNegative, ...], Tag("list")],
        Discriminator(_number_or_list),
    ] = 0.0
    """Damping ratios of the modes: one for all of them, or a list for the first ones."""


class UpTo(Part):
    """All modes up to a frequency."""

    up_to: Positive
    """Frequency [Hz]."""


def _kind_of_modes(value: Any) -> str:
    return "all" if value == "all" else "up_to" if isinstance(value, dict | UpTo) else "number"


def _flag_or(tag: str) -> Discriminator:
    """Tells true and false from what a switch may say more."""
    return Discriminator(lambda value: "flag" if isinstance(value, bool) else tag)


@dataclass(frozen=True, slots=True)
class Beam:
    """A planar beam along the x axis of its floating frame: Euler-Bernoulli, unless its pieces have more.

    `nodes` are positions [m] from 0 to `length`; `points` are positions of all named points, start, end and
    node0 to nodeN included; `pieces` cover the length; mass and stiffness are polynomials within each.
    `youngs_modulus` [Pa] is None when the bending stiffness was given as a number. `segments` divides the number
    of elements. `mass` is distributed along the elements or lumped at the nodes.
    """

    type: ClassVar[str] = "beam"
    length: float
    nodes: tuple[float, ...]
    frame: Literal["clamped", "chord"]
    points: dict[str, float]
    point_masses: dict[str, PointMass]
    damping: Damping
    pieces: tuple[BeamPiece, ...]
    youngs_modulus: float | None
    segments: int = 1
    modes: Literal["all"] | int | UpTo = "all"
    foreshortening: bool = False
    mass: Literal["consistent", "lumped"] = "consistent"

    @property
    def rotary_inertia(self) -> bool:
        """Whether the cross-sections have inertia of their own."""
        return self.pieces[0].rotary_inertia is not None

    @property
    def shear(self) -> bool:
        """Whether the beam shears."""
        return self.pieces[0].shear_stiffness is not None

    @property
    def stretch(self) -> bool:
        """Whether the beam stretches."""
        return self.pieces[0].axial_stiffness is not None

    @property
    def stress_modulus(self) -> float | None:
        """Young's modulus [Pa] where stresses follow from bending: None without a section of known height."""
        return self.youngs_modulus if all(piece.height is not None for piece in self.pieces) else None


class BeamEntry(Part):
    """A slender beam that bends in the plane."""

    type: Literal["beam"]
    length: Positive
    """Length [m]."""
    elements: Whole | None = None
    """Number of equal finite elements."""
    nodes: tuple[Number, ...] | None = None
    """Positions of the nodes [m], from 0 to the length, instead of a number of elements."""
    segments: Whole = 1
    """Stretches of equally many elements, each with a floating frame of its own, for large deflections."""
    material: Annotated[Material, reference("materials", "material")] | None = None
    """Name of a material."""
    section: SectionLayout | None = None
    """Name of a section, a taper {start: name, end: name}, or a list of pieces {until: position, section}."""
    mass_per_length: Positive | None = None
    """Mass per length [kg/m], with bending_stiffness instead of material and section."""
    bending_stiffness: Positive | None = None
    """Bending stiffness E I [N m^2]."""
    modes: Annotated[
        Annotated[Literal["all"], Tag("all")]
        | Annotated[Whole, Tag("number")]
        | Annotated[UpTo, Tag("up_to")],
        Discriminator(_kind_of_modes),
    ] = "all"
    """Modes that are kept: all, so many of the first, or {up_to: frequency [Hz]}."""
    frame: Literal["clamped", "chord"] = "clamped"
    """Floating frame: tangent to the beam at its start, or through both ends. Deflections are measured from it."""
    foreshortening: Flag = False
    """Whether bending draws the beam's points towards its start, to second order: geometric stiffening."""
    rotary_inertia: Annotated[
        Annotated[Flag, Tag("flag")] | Annotated[Positive, Tag("number")], _flag_or("number")
    ] = False
    """Whether cross-sections have inertia against turning (Rayleigh); a number, rho I [kg m], with mass_per_length."""
    shear: Annotated[Annotated[Flag, Tag("flag")] | Annotated[Shear, Tag("shear")], _flag_or("shear")] = False
    """Whether the beam shears (Timoshenko), or how: {shear_coefficient: ...} or {shear_stiffness: ...}."""
    stretch: Annotated[
        Annotated[Flag, Tag("flag")] | Annotated[Positive, Tag("number")], _flag_or("number")
    ] = False
    """Whether segments stretch (axial flexibility); a number, E A [N], with mass_per_length."""
    mass: Literal["consistent", "lumped"] = "consistent"
    """Mass distributed along the elements, or lumped at the nodes."""
    points: dict[Name, NotNegative] = Field(default_factory=dict)
    """Points by name: distance from the start [m]. start, end and node0, node1, ... always exist."""
    point_masses: dict[Text, Annotated[PointMass, short_form("mass", NotNegative | PointMass)]] = Field(
        default_factory=dict
    )
    """Masses fixed to points of the beam: a mass [kg] or {mass, inertia}."""
    damping: Damping = Damping()
    """Structural damping."""

    @model_validator(mode="before")
    @classmethod
    def _bends(cls, value: Any) -> Any:
        if isinstance(value, dict) and "visual" in value:
            reject(("visual",), "a mesh for looks does not bend: only rigid bodies may have one")
        return value

    def resolve(self, info: ValidationInfo) -> Beam:
        """The beam with its nodes, points and properties worked out."""
        self._count_elements(context_of(info))
        nodes = self._mesh()
        self._check_segments(len(nodes) - 1)
        self._check_modes(len(nodes) - 1)
        self._check_stretch()
        points = self._named_points(nodes)
        for name in self.point_masses:
            if name not in points:
                reject(("point_masses", name), unknown("point", name, points))
        return Beam(
            self.length,
            nodes,
            self.frame,
            points,
            self.point_masses,
            self.damping,
            self._properties(),
            self.material.youngs_modulus if self.material else None,
            self.segments,
            self.modes,
            self.foreshortening,
            self.mass,
        )

    def _count_elements(self, context: Context) -> None:
        """All beams together stay within what memory holds."""
        context.elements += len(self.nodes) - 1 if self.nodes else self.elements or 0
        if context.elements > MAX_ELEMENTS:
            key = "nodes" if self.nodes else "elements"
            reject(
                (key,), f"the beams up to here have {context.elements} elements; {MAX_ELEMENTS} are allowed"
            )

    def _mesh(self) -> tuple[float, ...]:
        if self.elements is None and self.nodes is None:
            reject((), "missing key 'elements' (or 'nodes')")
        if self.nodes is None:
            return self._equal_elements(self.elements or 0)
        if self.elements is not None:
            reject(("nodes",), "'elements' is given too: leave out one of them")
        return self._checked_nodes(self.nodes)

    def _equal_elements(self, count: int) -> tuple[float, ...]:
        if count < 1:
            reject(("elements",), f"must be at least 1, is {count}")
        return (*(self.length * k / count for k in range(count)), self.length)

    def _check_segments(self, elements: int) -> None:
        if not 1 <= self.segments <= elements or elements % self.segments:
            reject(
                ("segments",),
                f"must divide the number of elements, {elements}, into equal parts, is {self.segments}",
            )
        damping = self.damping
        by_mode = [
            key for key in ("mass_proportional", "modal_ratios") if getattr(damping, key) not in (0.0, ())
        ]
        if self.segments > 1 and by_mode:
            reject(
                ("damping", by_mode[0]),
                "belongs to the motion of the beam as a whole; in segments it can have 'stiffness_proportional' only",
            )

    def _check_stretch(self) -> None:
        if self.stretch and self.segments == 1:
            reject(
                ("stretch",), "is that of a beam's segments against each other: needs 'segments', 2 or more"
            )

    def _check_modes(self, elements: int) -> None:
        if self.segments > 1 and self.modes != "all":
            reject(("modes",), "are those of a whole beam: a beam in segments has all of them")
        if isinstance(self.modes, int) and not 1 <= self.modes <= 2 * elements:
            reject(
                ("modes",),
                f"must be between 1 and twice the number of elements, {2 * elements}, is {self.modes}",
            )

    def _checked_nodes(self, nodes: tuple[float, ...]) -> tuple[float, ...]:
        if len(nodes) < 2:
            reject(("nodes",), "needs at least two positions, 0 and the length")
        if nodes[0] != 0.0:
            reject(("nodes", 0), f"the first node must be at 0, is at {nodes[0]:g}")
        for k in range(1, len(nodes)):
            if nodes[k] <= nodes[k - 1]:
                reject(
                    ("nodes", k),
                    f"must be greater than the node before it ({nodes[k - 1]:g}), is {nodes[k]:g}",
                )
        if abs(nodes[-1] - self.length) > LENGTH_TOLERANCE * self.length:
            reject(
                ("nodes", len(nodes) - 1), f"the last node must be at {self.length:g}, is at {nodes[-1]:g}"
            )
        return (*nodes[:-1], self.length)

    def _named_points(self, nodes: tuple[float, ...]) -> dict[str, float]:
        points = {"start": 0.0, "end": self.length} | {f"node{k}": x for k, x in enumerate(nodes)}
        for name, x in self.points.items():
            if name in ("start", "end", "frame") or re.fullmatch(r"node[0-9]+", name):
                reject(("points", name), f"the name '{name}' is kept for the beam's own points")
            if x > self.length * (1.0 + LENGTH_TOLERANCE):
                reject(("points", name), f"lies off the beam: {x:g} m on a length of {self.length:g} m")
            points[name] = min(x, self.length)
        return points

    def _properties(self) -> tuple[BeamPiece, ...]:
        by_number = ("mass_per_length", "bending_stiffness")
        by_section = ("material", "section")
        numbers = [key for key in by_number if getattr(self, key) is not None]
        sections = [key for key in by_section if getattr(self, key) is not None]
        if numbers and sections:
            reject((numbers[0],), f"'{sections[0]}' is given too: leave out one of them")
        for key in by_number if numbers else by_section:
            if getattr(self, key) is None:
                also = "" if numbers else " (or mass_per_length and bending_stiffness)"
                reject((), f"missing key '{key}'{also}")
        if self.material is not None and self.section is not None:
            for key in ("rotary_inertia", "stretch"):
                if not isinstance(getattr(self, key), bool):
                    reject((key,), "is true or false for a beam of material and section")
            shear = (Shear() if self.shear else None) if isinstance(self.shear, bool) else self.shear
            options = bool(self.rotary_inertia), shear, bool(self.stretch)
            return beam_pieces(self.section, self.material, self.length, *options)
        return (self._uniform_piece(),)

    def _uniform_piece(self) -> BeamPiece:
        """Of numbers by length."""
        assert self.mass_per_length is not None
        assert self.bending_stiffness is not None
        for key, number in (("rotary_inertia", "rho I [kg m]"), ("stretch", "E A [N]")):
            if getattr(self, key) is True:
                reject((key,), f"must be a number, {number}, for a beam of mass_per_length")
        shear = self.shear.shear_stiffness if isinstance(self.shear, Shear) else None
        if self.shear and shear is None:
            reject(
                ("shear",), "must be {shear_stiffness: ...}, kappa G A [N], for a beam of bending_stiffness"
            )
        if isinstance(self.shear, Shear) and self.shear.shear_coefficient is not None:
            reject(("shear", "shear_coefficient"), "is for a beam of material and section")
        rotary, axial = (None if value is False else value for value in (self.rotary_inertia, self.stretch))
        return uniform_piece(self.length, self.mass_per_length, self.bending_stiffness, rotary, shear, axial)
