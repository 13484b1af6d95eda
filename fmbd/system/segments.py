"""Beams cut into segments, each a body with a floating frame of its own, welded end to end.

Linear theory within each segment, large rotations between them: what is left out falls with the square of their
number. The frames of segments go through both of their ends, whatever that of the whole beam is: the error is a quarter
of that of frames tangent at the start, and has even powers only. A beam that stretches does so where its segments meet:
each slides there on a spring, by what the halves beside it would stretch. To the user it stays one beam; its segments
are bodies `rod.segment1`, `rod.segment2`, ... of a second model, which is what is lowered.

Source of the method: S. C. Wu, E. J. Haug, Geometric non-linear substructuring for dynamics of flexible mechanical
systems, International Journal for Numerical Methods in Engineering 26, 1988, pp. 2211-2226.
"""

from collections.abc import Iterator
from dataclasses import dataclass, fields, replace
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.polynomial.polynomial import Polynomial
from numpy.typing import ArrayLike, NDArray

from fmbd.beams.pieces import evaluate, gauss_points
from fmbd.model import Beam, Joint, Model, RigidBody
from fmbd.model.joints import Coordinate, JointSpring
from fmbd.model.pieces import BeamPiece
from fmbd.model.points import PointRef

Place = tuple[str, str]  # a body and a point of it


@dataclass(frozen=True)
class Segment:
    """A stretch of a beam: its name as a body, where it starts and ends [m], the number of its first node."""

    body: str
    start: float
    end: float
    first_node: int


@dataclass(frozen=True)
class Segmentation:
    """A model with its beams cut; `beams` has the segments of every beam, one for a beam that is whole."""

    model: Model
    beams: dict[str, tuple[Segment, ...]]
    places: dict[Place, Place]  #: points of the beams that are cut, and where they are now
    seams: frozenset[str] = frozenset()  #: joints between segments

    def place(self, body: str, point: str) -> Place:
        """The body and point that a point of the model as written has become."""
        return self.places.get((body, point), (body, point))

    def is_cut(self, body: str) -> bool:
        """Whether a body is a beam of several segments."""
        return len(self.beams.get(body, ())) > 1

    def at(self, beam: str, x: ArrayLike) -> Iterator[tuple[Segment, NDArray[np.intp], NDArray[np.float64]]]:
        """Segments of a beam that hold some of the positions x [m] (n,): which ones, and where in the segment.

        A position where two segments meet is in both.
        """
        x = np.asarray(x, float)
        for segment in self.beams[beam]:
            here = np.flatnonzero((x >= segment.start) & (x <= segment.end))
            if here.size:
                yield segment, here, x[here] - segment.start


def cut_beams(model: Model) -> Segmentation:
    """The model with each beam of several segments replaced by as many beams, welded."""
    beams = {name: _segments(name, body) for name, body in model.bodies.items() if isinstance(body, Beam)}
    cut = {name: segments for name, segments in beams.items() if len(segments) > 1}
    if not cut:
        return Segmentation(model, beams, {})
    places: dict[Place, Place] = {}
    bodies: dict[str, RigidBody | Beam] = {}
    for name, body in model.bodies.items():
        if isinstance(body, Beam) and name in cut:
            owner = {point: _owner(x, cut[name]) for point, x in body.points.items()}
            places |= {(name, point): (segment.body, point) for point, segment in owner.items()}
            bodies |= {segment.body: _stretch(body, segment, owner) for segment in cut[name]}
        else:
            bodies[name] = body
    seams = _joints(model, cut)
    built = replace(
        model,
        bodies=bodies,
        joints=_moved(model.joints, "between", places) | seams,
        springs=_moved(model.springs, "between", places),
        loads=_loads(model, cut, places),
    )
    return Segmentation(built, beams, places, frozenset(seams))


def _segments(name: str, beam: Beam) -> tuple[Segment, ...]:
    if beam.segments == 1:
        return (Segment(name, 0.0, beam.length, 0),)
    each = (len(beam.nodes) - 1) // beam.segments
    firsts = range(0, len(beam.nodes) - 1, each)
    return tuple(
        Segment(f"{name}.segment{number}", beam.nodes[first], beam.nodes[first + each], first)
        for number, first in enumerate(firsts, 1)
    )


def _owner(x: float, segments: tuple[Segment, ...]) -> Segment:
    """The segment that holds the position x [m]; where two meet, the one that ends there."""
    return next(segment for segment in segments if x <= segment.end)


def _stretch(beam: Beam, segment: Segment, owner: dict[str, Segment]) -> Beam:
    """A segment as a beam, with the points that it owns."""
    x0, x1 = segment.start, segment.end
    mine = [point for point in beam.points if owner[point] is segment]
    each = (len(beam.nodes) - 1) // beam.segments
    nodes = beam.nodes[segment.first_node : segment.first_node + each + 1]
    return replace(
        beam,
        length=x1 - x0,
        nodes=tuple(x - x0 for x in nodes),
        frame="chord",
        points={"start": 0.0, "end": x1 - x0} | {point: beam.points[point] - x0 for point in mine},
        point_masses={point: mass for point, mass in beam.point_masses.items() if point in mine},
        pieces=tuple(_piece(piece, x0, x1) for piece in beam.pieces if piece.start < x1 and piece.end > x0),
        segments=1,
    )


def _piece(piece: BeamPiece, x0: float, x1: float) -> BeamPiece:
    """What lies of a piece between x0 and x1 [m], seen from x0."""
    start = max(piece.start, x0)
    along = Polynomial([start - piece.start, 1.0])

    def shifted(coefficients: tuple[float, ...] | None) -> tuple[float, ...] | None:
        if coefficients is None or len(coefficients) == 1:
            return coefficients
        return tuple(Polynomial(coefficients)(along).coef)

    properties: dict[str, Any] = {
        field.name: shifted(getattr(piece, field.name)) for field in fields(piece)[2:]
    }
    return replace(piece, start=start - x0, end=min(piece.end, x1) - x0, **properties)


def _joints(model: Model, cut: dict[str, tuple[Segment, ...]]) -> dict[str, Joint]:
    """What holds the segments of each beam together: welds, or slides on springs if it stretches."""
    joints: dict[str, Joint] = {}
    for name, segments in cut.items():
        beam = model.bodies[name]
        assert isinstance(beam, Beam)
        for number, (before, after) in enumerate(pairwise(segments), 1):
            between = PointRef(before.body, "end"), PointRef(after.body, "start")
            if beam.stretch:
                start = 0.0 if before is segments[0] else 0.5 * (before.start + before.end)
                end = beam.length if after is segments[-1] else 0.5 * (after.start + after.end)
                spring: dict[Coordinate, JointSpring] = {"x": _axial_spring(beam, start, end)}
                joints[f"{name}.stretch{number}"] = Joint(type="prismatic", between=between, spring=spring)
            else:
                joints[f"{name}.weld{number}"] = Joint(type="weld", between=between)
    return joints


def _axial_spring(beam: Beam, start: float, end: float) -> JointSpring:
    """Stiffness 1 / int dx / E A of a beam between two places [m], and its damping."""
    breaks = np.array([start, *(p.start for p in beam.pieces if start < p.start < end), end])
    # one over a polynomial: accurate enough at 8 points, since a piece does not taper to nothing
    x, dx = gauss_points(breaks, 15)
    stiffness = 1.0 / float(dx @ (1.0 / evaluate(beam.pieces, "axial_stiffness", x)))
    return JointSpring(stiffness=stiffness, damping=beam.damping.stiffness_proportional * stiffness)


def _moved(parts: dict[str, Any], key: str, places: dict[Place, Place]) -> dict[str, Any]:
    """Parts with two points, these put on segments."""

    def refs(part: Any) -> tuple[PointRef, ...]:
        return tuple(PointRef(*places.get(ref, ref)) for ref in getattr(part, key))

    return {name: part.model_copy(update={key: refs(part)}) for name, part in parts.items()}


def _loads(model: Model, cut: dict[str, tuple[Segment, ...]], places: dict[Place, Place]) -> dict[str, Any]:
    """Loads, put on segments; what is distributed over several is one load on each."""
    loads: dict[str, Any] = {}
    for name, load in model.loads.items():
        if load.type != "distributed":
            loads[name] = load.model_copy(update={"at": PointRef(*places.get(load.at, load.at))})
        elif load.on not in cut:
            loads[name] = load
        else:
            for segment in cut[load.on]:
                first, last = max(load.from_, segment.start), min(load.to, segment.end)
                if first < last:
                    part = {
                        "on": segment.body,
                        "from_": first - segment.start,
                        "to": last - segment.start,
                    }
                    loads[f"{name}.{segment.body}"] = load.model_copy(update=part)
    return loads
