"""The drawing of a mechanism: its pieces, what connects their points, and where they are over time.

frames.py makes the frames of it that ParaView plays; scene.py draws figures and animations from the same pieces.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import NDArray

from fmbd.model import Beam, Model, RigidBody
from fmbd.model.points import CENTER_OF_MASS, GROUND, ORIGIN, PointRef
from fmbd.model.shapes import Disc, Rod, Shape
from fmbd.model.visuals import Visual
from fmbd.results.motion import Motion, PlaneJet
from fmbd.results.vtkhdf import KINDS, Drawing

Plane = NDArray[np.complex128]

CORNERS = 48  # of a disc
SEGMENTS = 24  # at least, of a beam
SEGMENTS_PER_ELEMENT = 4
#: Kind and topology of rigid bodies with so few corners.
OUTLINED = {1: ("mass", "vertices"), 2: ("rigid body", "lines")}
TRAIL = 60  # frames that a trail goes back


@dataclass(frozen=True)
class Piece:
    """A part of a drawing: n points that move, and what connects them.

    kind: one of vtkhdf.KINDS; body: the one it belongs to; name: the joint, spring or body that it shows
    place: jets of the points over a motion, shape (3, nt, n)
    faces: the points of each polygon; None: all of them make one vertex, line or polygon
    heights: z of the points [m]; stations: positions [m] of the points along a beam
    """

    kind: str
    body: str
    name: str
    place: Callable[[Motion], PlaneJet]
    points: int
    topology: str
    faces: tuple[tuple[int, ...], ...] | None = None
    heights: tuple[float, ...] | float = 0.0
    stations: tuple[float, ...] = ()

    @property
    def cells(self) -> Sequence[Sequence[int]]:
        """Points of each cell, counted within the piece."""
        return [range(self.points)] if self.faces is None else self.faces


def pieces(model: Model) -> list[Piece]:
    """Beams as curves, rigid bodies by their meshes, shapes or points, joints and ground points, springs as lines;
    those of vertices first, then of lines, then of polygons."""
    return sorted(_pieces(model), key=lambda piece: ("vertices", "lines", "polygons").index(piece.topology))


def _pieces(model: Model) -> Iterator[Piece]:
    used = [ref for joint in model.joints.values() for ref in joint.between]
    driven = {motor.joint for motor in model.motors.values()}
    for name, joint in model.joints.items():
        if joint.type != "free":
            slides = "x" in joint.coordinates
            at = joint.between[1 if slides else 0]
            kind = "motor" if name in driven else "joint"
            yield Piece(kind, at.body, name, partial(_ends, (at,)), 1, "vertices")
    for point in model.ground.points:
        if point != ORIGIN:
            place = partial(_ends, (PointRef(GROUND, point),))
            yield Piece("ground point", GROUND, point, place, 1, "vertices")
    for name, body in model.bodies.items():
        if isinstance(body, Beam):
            x = _stations(body)
            place = partial(_beam, name, x)
            yield Piece("beam", name, name, place, x.size, "lines", stations=tuple(x))
        elif body.visual is not None:
            yield _visual(name, body.visual)
        else:
            outline = _outline(body, {ref.point for ref in used if ref.body == name})
            kind, topology = OUTLINED.get(len(outline), ("rigid body", "polygons"))
            yield Piece(kind, name, name, partial(_fixed, name, outline), len(outline), topology)
    for name, spring in model.springs.items():
        if spring.type == "point_to_point":
            between = spring.between
            yield Piece("spring", between[0].body, name, partial(_ends, between), 2, "lines")


def connected(model: Model, parts: Sequence[Piece], fields: Sequence[str]) -> Drawing:
    """What connects the points of a drawing: each piece has its own."""
    names = (GROUND, *model.bodies)
    starts = np.cumsum([0, *(piece.points for piece in parts)])
    cells = [(piece, start + np.asarray(cell)) for piece, start in zip(parts, starts) for cell in piece.cells]
    by_topology = {
        topology: [cell for piece, cell in cells if piece.topology == topology]
        for topology in ("vertices", "lines", "polygons")
    }
    return Drawing(
        points_per_frame=int(starts[-1]),
        vertices=[int(cell[0]) for cell in by_topology["vertices"]],
        lines=by_topology["lines"],
        polygons=by_topology["polygons"],
        body_id=[names.index(piece.body) for piece, _ in cells],
        kind=[KINDS.index(piece.kind) for piece, _ in cells],
        names=names,
        labels=[piece.name for piece, _ in cells],
        fields=fields,
    )


def straight(model: Model, motion: Motion, name: str) -> Plane:
    """Ends of a beam's axis before it bends, shape (nt, 2); through its ends if both are held, so that it stays
    attached."""
    beam = model.bodies[name]
    assert isinstance(beam, Beam)
    held = {
        beam.points[ref.point] for joint in model.joints.values() for ref in joint.between if ref.body == name
    }
    ends = np.array([0.0, beam.length])
    if set(ends) <= held:
        return motion.beam_points(name, ends)[0]
    return motion.fixed_points(name, ends.astype(complex))[0]


def _ends(refs: Sequence[PointRef], motion: Motion) -> PlaneJet:
    return np.stack([motion.point(*ref).place for ref in refs], axis=-1)


def _beam(name: str, x: NDArray[np.float64], motion: Motion) -> PlaneJet:
    return motion.beam_points(name, x)


def _fixed(name: str, outline: Plane, motion: Motion) -> PlaneJet:
    return motion.fixed_points(name, outline)


def _visual(name: str, visual: Visual) -> Piece:
    x, y, z = np.array(visual.points).T
    place = partial(_fixed, name, x + 1j * y)
    return Piece("visual", name, name, place, x.size, "polygons", visual.faces, tuple(z))


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
