"""The drawing of a mechanism for ParaView: its points, what connects them, and where they are over time."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import partial

import numpy as np
from numpy.typing import NDArray

from fmbd.model import Beam, Model, RigidBody
from fmbd.model.points import CENTER_OF_MASS, GROUND, ORIGIN, PointRef
from fmbd.model.shapes import Disc, Rod, Shape
from fmbd.results.motion import Motion
from fmbd.results.vtkhdf import KINDS, Drawing

Plane = NDArray[np.complex128]
Place = Callable[[Motion], Plane]

CORNERS = 48  # of a disc
SEGMENTS = 24  # at least, of a beam
SEGMENTS_PER_ELEMENT = 4


@dataclass
class Sketch:
    """Cells of a drawing, each with the rule that places its points, shape (nt, n), over a motion."""

    names: tuple[str, ...]
    cells: dict[str, list[tuple[int, int, Place, int]]] = field(
        default_factory=lambda: {"vertices": [], "lines": [], "polygons": []}
    )

    def add(self, topology: str, body: str, kind: str, place: Place, points: int) -> None:
        """Add a cell of so many points."""
        self.cells[topology].append((self.names.index(body), KINDS.index(kind), place, points))

    @property
    def drawing(self) -> Drawing:
        """What connects the points: each cell has its own."""
        cells = [cell for group in self.cells.values() for cell in group]
        ends = np.cumsum([points for *_, points in cells], dtype=int)
        indices = [np.arange(end - points, end) for end, (*_, points) in zip(ends, cells, strict=True)]
        nv, nl = len(self.cells["vertices"]), len(self.cells["lines"])
        return Drawing(
            points_per_frame=int(ends[-1]) if cells else 0,
            vertices=[int(index[0]) for index in indices[:nv]],
            lines=indices[nv : nv + nl],
            polygons=indices[nv + nl :],
            body_id=[body for body, *_ in cells],
            kind=[kind for _, kind, *_ in cells],
            names=self.names,
        )

    def points(self, motion: Motion) -> NDArray[np.float32]:
        """Where the points are [m], shape (nt, points, 3)."""
        cells = [cell for group in self.cells.values() for cell in group]
        plane = np.concatenate([place(motion) for *_, place, _ in cells], axis=1)
        return np.stack([plane.real, plane.imag, np.zeros(plane.shape)], axis=-1).astype(np.float32)


def sketch(model: Model) -> Sketch:
    """Beams as curves, rigid bodies by their shapes or points, joints and ground points, springs as lines."""
    out = Sketch((GROUND, *model.bodies))
    used = [ref for joint in model.joints.values() for ref in joint.between]
    for joint in model.joints.values():
        if joint.type != "free":
            first = joint.between[0]
            out.add("vertices", first.body, "joint", partial(_ends, (first,)), 1)
    for point in model.ground.points:
        if point != ORIGIN:
            out.add("vertices", GROUND, "ground point", partial(_ends, (PointRef(GROUND, point),)), 1)
    for name, body in model.bodies.items():
        if isinstance(body, Beam):
            x = _stations(body)
            out.add("lines", name, "beam", partial(_beam, name, x), x.size)
            continue
        outline = _outline(body, {ref.point for ref in used if ref.body == name})
        topology = {1: "vertices", 2: "lines"}.get(len(outline), "polygons")
        out.add(topology, name, "rigid body", partial(_fixed, name, outline), len(outline))
    for spring in model.springs.values():
        if spring.type == "point_to_point":
            out.add("lines", spring.between[0].body, "spring", partial(_ends, spring.between), 2)
    return out


def _ends(refs: Sequence[PointRef], motion: Motion) -> Plane:
    return np.stack([motion.point(*ref).place[0] for ref in refs], axis=-1)


def _beam(name: str, x: NDArray[np.float64], motion: Motion) -> Plane:
    return motion.beam_points(name, x)


def _fixed(name: str, outline: Plane, motion: Motion) -> Plane:
    return motion.fixed_points(name, outline)


def _stations(beam: Beam) -> NDArray[np.float64]:
    """Positions along a beam: its nodes, and points between them."""
    elements = len(beam.nodes) - 1
    segments = max(SEGMENTS_PER_ELEMENT, -(-SEGMENTS // elements))
    return np.interp(np.arange(elements * segments + 1) / segments, np.arange(elements + 1), beam.nodes)


def _outline(body: RigidBody, used: set[str]) -> Plane:
    """Corners of a rigid body in its own frame, one or two for a body without width."""
    if body.shape is not None:
        return _outline_of_shape(body.shape)
    own = {n for n in body.points if n not in (ORIGIN, CENTER_OF_MASS)} | used
    places = [complex(*body.points[name].at) for name in own]
    if len(set(places)) < 2:
        places = [complex(*point.at) for point in body.points.values()]
    return convex_hull(np.array(places))


def _outline_of_shape(shape: Shape) -> Plane:
    if isinstance(shape, Disc):
        turns = np.arange(CORNERS) / CORNERS
        return complex(*shape.center) + shape.radius * np.exp(2j * np.pi * turns)
    along = np.exp(1j * shape.angle)
    if isinstance(shape, Rod):
        half = 0.5j * (shape.diameter or 0.0)
        corners = np.array([-half, shape.length - half, shape.length + half, half])
        if shape.diameter is None:
            corners = np.array([0.0, shape.length], complex)
        return complex(*shape.start) + along * corners
    corner = complex(shape.length, shape.height) / 2.0
    return complex(*shape.center) + along * np.array(
        [-corner, corner.conjugate(), corner, -corner.conjugate()]
    )


def convex_hull(points: Plane) -> Plane:
    """Corners of the convex hull, counter-clockwise (Andrew's monotone chain); two for points on a line."""
    ordered = np.unique(points)  # by x, then y
    if ordered.size < 3:
        return ordered
    lower, upper = _chain(ordered), _chain(ordered[::-1])
    return np.array([*lower[:-1], *upper[:-1]])


def _chain(points: Plane) -> list[complex]:
    """One side of the hull of points in order: always turning left."""
    chain: list[complex] = []
    size = float(np.abs(points - points[0]).max())
    for point in points:
        while len(chain) > 1 and _turns(chain[-2], chain[-1], point) <= 1e-9 * size**2:
            chain.pop()
        chain.append(point)
    return chain


def _turns(a: complex, b: complex, c: complex) -> float:
    """Twice the area of a triangle, positive when it goes round counter-clockwise."""
    return float(((b - a).conjugate() * (c - a)).imag)
