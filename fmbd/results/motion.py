"""Where bodies and points are over time, how they move, from the coordinates and their rates.

A jet is a quantity with its first two derivatives by time: an array (3, nt). Points of the plane are complex
numbers x + iy, so that turning by an angle is multiplying by exp(i angle).
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from fmbd.beams import FloatingBeam
from fmbd.model import Beam
from fmbd.system import System
from fmbd.system.bodies import DIRECTIONS

Array = NDArray[np.float64]
Jet = NDArray[np.float64]
PlaneJet = NDArray[np.complex128]
Rows = Callable[[FloatingBeam, Array], Array]


def product(a: PlaneJet, b: PlaneJet) -> PlaneJet:
    """The jet of a b."""
    return np.stack([a[0] * b[0], a[1] * b[0] + a[0] * b[1], a[2] * b[0] + 2.0 * a[1] * b[1] + a[0] * b[2]])


def turn(angle: Jet) -> PlaneJet:
    """The jet of exp(i angle)."""
    e = np.exp(1j * angle[0])
    return np.stack([e, 1j * angle[1] * e, (1j * angle[2] - angle[1] ** 2) * e])


@dataclass(frozen=True, eq=False)
class Track:
    """A frame over time: jets of its place [m] and of its angle [rad]."""

    place: PlaneJet
    angle: Jet

    def seen_from(self, other: "Track") -> "Track":
        """This frame in the axes of another."""
        return Track(product(turn(-other.angle), self.place - other.place), self.angle - other.angle)

    def followed_by(self, local: "Track") -> "Track":
        """A frame that is `local` in the axes of this one."""
        return Track(self.place + product(turn(self.angle), local.place), self.angle + local.angle)


def _drawn(e: Jet, H: Array) -> Jet:
    """The jet of u = -1/2 e^T H e; e (3, nt, n)."""
    pull = -e @ H
    u, du = 0.5 * (pull[0] * e[0]).sum(axis=-1), (pull[0] * e[1]).sum(axis=-1)
    return np.stack([u, du, (pull[0] * e[2] + pull[1] * e[1]).sum(axis=-1)])


class Motion:
    """Tracks of all bodies and points of a system at times [s] (nt,), with nodal q, q', q'' (nt, nq)."""

    def __init__(
        self, system: System, time: Array, position: Array, velocity: Array, acceleration: Array
    ) -> None:
        self.system = system
        self.time = time
        self._jets = np.stack([position, velocity, acceleration])
        self._frames = {"ground": self._still(0.0, 0.0)}
        for link in system.tree.links:
            if link.joint is not None:
                self._frames[link.name] = self._place_body(link.name)
        for name in system.lowered.segmentation.beams:
            if system.lowered.segmentation.is_cut(name):
                self._frames[name] = self._place_beam(name)

    def frame(self, body: str) -> Track:
        """The frame of a body; of a beam its floating frame, in segments the tangent or chord of the whole."""
        return self._frames[body]

    def point(self, body: str, point: str) -> Track:
        """A point of a body or of the ground, with its axes; that of a beam turns with its cross-section."""
        body, point = self.system.lowered.segmentation.place(body, point)
        return self._frames[body].followed_by(self._local(body, point))

    def joint(self, name: str) -> Track:
        """The second point of a joint seen from the first: x + iy along the joint's axes, angle.

        The angle of a joint that closes a loop is counted as at the start.
        """
        joint = self.system.model.joints[name]
        first, second = (self.point(*ref) for ref in joint.between)
        seen = second.seen_from(first)
        seen.angle[0] -= self.system.lowered.turns.get(name, 0.0)
        return Track(seen.place * complex(joint.axis[0], -joint.axis[1]), seen.angle)

    def beam_points(self, body: str, x: Array) -> PlaneJet:
        """Jets of points of the deflected axis of a beam at positions x [m] (n,), shape (3, nt, n)."""
        out = np.empty((3, len(self.time), x.size), complex)
        for segment, here, local in self.system.lowered.segmentation.at(body, x):
            out[..., here] = self.segment_points(segment.body, local)
        return out

    def segment_points(self, segment: str, x: Array) -> PlaneJet:
        """Jets of points of the axis of a beam, or of one segment of it, at its own positions x [m] (n,)."""
        return self._carried(segment, self._axis(segment, x))

    def segment_angle(self, segment: str, x: Array, order: int) -> Array:
        """Derivative by time [rad/s^order] of the angles of its cross-sections there, shape (nt, n)."""
        return self._frames[segment].angle[order][:, None] + self._rows(segment, x, FloatingBeam.slope, order)

    def fixed_points(self, body: str, local: NDArray[np.complex128]) -> PlaneJet:
        """Jets of points given in the frame of a body (n,), shape (3, nt, n)."""
        still = np.zeros((3, len(self.time), local.size), complex)
        still[0] = local
        return self._carried(body, still)

    def _carried(self, body: str, local: PlaneJet) -> PlaneJet:
        """Jets of points that move in the frame of a body, in the world, shape (3, nt, n)."""
        frame = self._frames[body]
        return frame.place[..., None] + product(turn(frame.angle)[..., None], local)

    def deflection(self, body: str, x: Array) -> Array:
        """Deflection [m] of a beam from its frame at positions x [m] (n,), shape (nt, n)."""
        if not self.system.lowered.segmentation.is_cut(body):
            return self.along(body, x, FloatingBeam.shape)
        frame = self._frames[body]
        seen = self.beam_points(body, x)[0] - frame.place[0][:, None]
        return (seen * np.exp(-1j * frame.angle[0])[:, None]).imag

    def slope(self, body: str, x: Array) -> Array:
        """Angle [rad] of the cross-sections of a beam against its frame at positions x [m] (n,), shape (nt, n)."""

        def angle(segment: str, local: Array) -> Array:
            turned = self._frames[segment].angle[0] - self._frames[body].angle[0]
            return turned[:, None] + self._rows(segment, local, FloatingBeam.slope)

        return self._mean(body, x, angle)

    def section_angle(self, body: str, x: Array, order: int) -> Array:
        """Derivative by time [rad/s^order] of the angles of a beam's cross-sections at x [m] (n,), shape (nt, n)."""
        return self._mean(body, x, lambda segment, local: self.segment_angle(segment, local, order))

    def along(self, body: str, x: Array, rows: Rows) -> Array:
        """Rows at positions x [m] (n,) of a beam times its elastic coordinates, shape (nt, n).

        Where segments meet it is the mean of both.
        """
        return self._mean(body, x, lambda segment, local: self._rows(segment, local, rows))

    def _mean(self, body: str, x: Array, values: Callable[[str, Array], Array]) -> Array:
        total, count = np.zeros((len(self.time), x.size)), np.zeros(x.size)
        for segment, here, local in self.system.lowered.segmentation.at(body, x):
            total[:, here] += values(segment.body, local)
            count[here] += 1.0
        return total / count

    def _rows(self, segment: str, local: Array, rows: Rows, order: int = 0) -> Array:
        """Rows times the elastic coordinates of a segment, or times a derivative of them by time."""
        index = self.system.lowered.body_index[segment]
        return self._elastic(segment)[order] @ rows(self.system.beams[index], local).T

    def _place_beam(self, name: str) -> Track:
        """The frame of a beam in segments: the tangent at its start, or the line through both ends."""
        start = self.point(name, "start")
        if self.system.model.bodies[name].frame == "clamped":
            return start
        chord = self.point(name, "end").place - start.place
        turned = np.angle(chord[0] * np.exp(-1j * start.angle[0]))
        rate = chord[1] / chord[0]
        change = chord[2] / chord[0] - rate**2
        angle = np.stack([start.angle[0] + np.unwrap(turned), rate.imag, change.imag])
        return Track(start.place, angle)

    def _place_body(self, name: str) -> Track:
        """The frame of a body from the point that its joint holds it at, and the joint's coordinates."""
        lowered = self.system.lowered
        index = lowered.body_index[name]
        link = self.system.tree.links[index]
        outer = self.point(*lowered.outer_point(link))
        inner = self._local(*lowered.inner_point(link))
        x, y, angle = (self._coordinate(index, d) for d in range(len(DIRECTIONS)))
        axis = complex(*lowered.model.joints[str(link.joint)].axis)
        joint = Track((x + 1j * y) * axis, angle)
        if link.forward:
            held = outer.followed_by(joint)
        else:
            # the axes of the joint are those of the body that it carries
            own = outer.angle - angle
            held = Track(outer.place - product(turn(own), joint.place), own)
        theta = held.angle - inner.angle
        return Track(held.place - product(turn(theta), inner.place), theta)

    def _coordinate(self, body: int, d: int) -> Jet:
        """Free, prescribed or zero: a coordinate of the joint that carries a body."""
        record = self.system.planar.bodies[body]
        if record.coordinate[d] >= 0:
            return self._jets[:, :, record.coordinate[d]]
        if record.driver[d] >= 0:
            return self.signals[:, record.driver[d]].T
        return np.zeros((3, len(self.time)))

    def _local(self, body: str, point: str) -> Track:
        """A point in the frame of its body."""
        model = self.system.lowered.model
        if body == "ground":
            place = model.ground.points[point]
            return self._still(complex(*place.at), place.angle)
        part = model.bodies[body]
        if not isinstance(part, Beam):
            place = part.points[point]
            return self._still(complex(*place.at), place.angle)
        x = part.points[point]
        slope = self._elastic(body) @ self.system.beams[self.system.lowered.body_index[body]].slope(x)
        return Track(self._axis(body, np.array([x]))[..., 0], slope)

    def _axis(self, body: str, x: Array) -> PlaneJet:
        """Jets of points of a beam's axis in its frame, at positions x [m] (n,), shape (3, nt, n)."""
        lowered = self.system.lowered
        index = lowered.body_index[body]
        elastic = self._elastic(body)
        points = np.zeros((3, len(self.time), x.size), complex)
        points.imag = elastic @ self.system.beams[index].shape(x).T
        points[0] += x
        if shortening := lowered.shortenings.get(index):
            eta = shortening.amplitudes(elastic)
            for k, position in enumerate(x):
                points[..., k] += _drawn(eta, shortening.at(position))
        return points

    def _elastic(self, body: str) -> Array:
        """Jets of the elastic coordinates of a beam, shape (3, nt, nf)."""
        record = self.system.planar.bodies[self.system.lowered.body_index[body]]
        return self._jets[:, :, record.first_q : record.first_q + record.nf]

    def _still(self, place: complex, angle: float) -> Track:
        track = Track(np.zeros((3, len(self.time)), complex), np.zeros((3, len(self.time))))
        track.place[0], track.angle[0] = place, angle
        return track

    @cached_property
    def signals(self) -> Array:
        """Value and two derivatives of every signal, shape (nt, signals, 3)."""
        return np.stack([self.system.reference.signals(t) for t in self.time])
