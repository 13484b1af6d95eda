"""Rigid bodies."""

from dataclasses import dataclass
from typing import Annotated, ClassVar, Literal

from pydantic import Field

from fmbd.model.base import NotNegative, Pair, Part, Positive, Text, short_form
from fmbd.model.context import reference, reject
from fmbd.model.materials import Material
from fmbd.model.names import unknown
from fmbd.model.points import CENTER_OF_MASS, ORIGIN, Point, PointsField, with_built_in
from fmbd.model.shapes import DEPTH, Shape, ShapeField
from fmbd.model.visuals import Visual, VisualField


@dataclass(frozen=True, slots=True)
class RigidBody:
    """A rigid body: mass [kg], moment of inertia about the centre of mass [kg m^2], centre of mass [m].

    `points` includes `origin` and `center_of_mass`; `shape` and `visual` are None unless the file gives them.
    """

    type: ClassVar[str] = "rigid"
    mass: float
    inertia: float
    center_of_mass: tuple[float, float]
    points: dict[str, Point]
    shape: Shape | None
    visual: Visual | None = None


class InertiaAbout(Part):
    """A moment of inertia about a point of the body."""

    about: Text = CENTER_OF_MASS
    """The name of a point of the body; the centre of mass when left out."""
    value: NotNegative
    """Moment of inertia about that point [kg m^2]."""


class RigidBodyEntry(Part):
    """A rigid body, given by mass and inertia or by a homogeneous shape."""

    type: Literal["rigid"]
    mass: NotNegative | None = None
    """Mass [kg]."""
    inertia: Annotated[InertiaAbout, short_form("value", NotNegative | InertiaAbout)] | None = None
    """Moment of inertia about the centre of mass [kg m^2], or about a named point."""
    center_of_mass: Pair | None = None
    """Centre of mass [m] in the body's frame; default [0, 0]."""
    shape: ShapeField | None = None
    """A homogeneous solid, instead of inertia and centre of mass."""
    density: Positive | None = None
    """Density of the shape [kg/m^3]."""
    material: Annotated[Material, reference("materials", "material")] | None = None
    """Material of the shape, instead of a density."""
    points: PointsField = Field(default_factory=dict)
    """Points of the body by name: [x, y] or {at: [x, y], angle: rad}."""
    visual: VisualField | None = None
    """A mesh for looks: a file beside the model, or {file, at, angle, scale}."""

    def resolve(self) -> RigidBody:
        """The body with its mass properties worked out."""
        if self.shape is not None:
            mass, inertia, center = self._from_shape()
        else:
            mass, inertia, center = self._from_numbers()
        built_in = {ORIGIN: Point(at=(0.0, 0.0)), CENTER_OF_MASS: Point(at=center)}
        points = with_built_in(self.points, built_in)
        return RigidBody(mass, inertia, center, points, self.shape, self.visual)

    def _from_numbers(self) -> tuple[float, float, tuple[float, float]]:
        for key in ("density", "material"):
            if getattr(self, key) is not None:
                reject((key,), "needs a 'shape' to give a mass")
        if self.mass is None:
            reject((), "missing key 'mass' (or a 'shape' with a density)")
        if self.inertia is None:
            reject((), "missing key 'inertia' (0 for a point mass)")
        center = self.center_of_mass or (0.0, 0.0)
        return self.mass, self._shifted(self.mass, self.inertia, center), center

    def _shifted(self, mass: float, inertia: InertiaAbout, center: tuple[float, float]) -> float:
        """The moment of inertia about the centre of mass, by the parallel-axis theorem."""
        places = {ORIGIN: (0.0, 0.0), CENTER_OF_MASS: center} | {k: p.at for k, p in self.points.items()}
        if inertia.about not in places:
            reject(("inertia", "about"), unknown("point", inertia.about, places))
        x, y = places[inertia.about]
        least = mass * ((x - center[0]) ** 2 + (y - center[1]) ** 2)
        if inertia.value < least * (1.0 - 1e-12):
            about = f"{inertia.value:g} about '{inertia.about}'"
            message = (
                f"is {about}, less than mass times its squared distance from the centre of mass, {least:g}"
            )
            reject(("inertia", "value"), message)
        return max(inertia.value - least, 0.0)

    def _from_shape(self) -> tuple[float, float, tuple[float, float]]:
        assert self.shape is not None
        for key in ("inertia", "center_of_mass"):
            if getattr(self, key) is not None:
                reject((key,), "follows from 'shape': leave out one of them")
        mass = self._mass_of_shape(self.shape)
        return mass, mass * self.shape.inertia_per_mass, self.shape.centroid

    def _mass_of_shape(self, shape: Shape) -> float:
        given = [key for key in ("mass", "density", "material") if getattr(self, key) is not None]
        if not given:
            reject((), "missing key 'density' (or 'material' or 'mass') beside 'shape'")
        if len(given) > 1:
            reject((given[1],), f"'{given[0]}' gives the mass already: leave out one of them")
        if self.mass is not None:
            return self.mass
        if shape.volume is None:
            reject(("shape",), f"missing key '{DEPTH[shape.type]}' (the mass follows from the volume)")
        density = self.material.density if self.material is not None else self.density
        assert density is not None
        return density * shape.volume
