"""Frames of a drawing for ParaView: where its points are, and what is known of them, one frame after the other."""

from collections.abc import Iterator
from functools import partial

import numpy as np
from numpy.typing import NDArray

from fmbd.beams.bending import bending_moment, upper_stress
from fmbd.model import Beam, Model
from fmbd.model.points import GROUND, PointRef
from fmbd.results.drawing import TRAIL, Piece, connected, pieces, straight
from fmbd.results.forces import Forces
from fmbd.results.motion import Motion, PlaneJet
from fmbd.system import System

Array = NDArray[np.float64]
Plane = NDArray[np.complex128]
Fields = dict[str, NDArray[np.float32]]

#: Points of all frames together, in a drawing that is not asked for more; each takes up to 72 bytes.
POINTS = 1_000_000
#: Points of all frames that are worked out at once.
AT_ONCE = 200_000


class Frames:
    """Draws a system; its frames are asked for in the order of time.

    deflection: the factor by which the deflection of beams is exaggerated

    The fields of the points, in the world's axes, are
      displacement    from where the point was in the first frame [m]
      velocity        [m/s]
      deflection      of a beam, from its axis before it bends [m]; zero elsewhere. "Warp By Vector" exaggerates it
      force           what a joint's constraints put on the body of its first point [N]; zero elsewhere
      bending_moment  of a beam [N m]; not a number elsewhere
      stress          of a beam, in the fibre y = h/2 [Pa]; not a number elsewhere
    Displacement and velocity are those of the mechanism, not of the exaggeration.
    """

    def __init__(self, system: System, deflection: float = 1.0) -> None:
        self.system, self.scale = system, deflection
        self._trailed = trailed(system.model)
        self.pieces = pieces(system.model)
        if self._trailed is not None:
            self._insert_trail(self._trailed)
        self.drawing = connected(system.model, self.pieces, _fields(self.pieces, system.model))
        self._first: Array | None = None
        self._track = np.empty(0, complex)

    def most(self, wanted: int) -> int:
        """So many frames as wanted; of drawings with many points fewer, but ten."""
        return min(wanted, max(10, POINTS // max(1, self.drawing.points_per_frame)))

    def draw(
        self, time: Array, position: Array, velocity: Array, acceleration: Array, states: Array
    ) -> Iterator[tuple[Array, NDArray[np.float32], Fields]]:
        """Times [s] (k,), points [m] (k, n, 3) and fields, (k, n) or (k, n, 3), of the next frames, some at a time.

        time (nt,); position, velocity, acceleration: nodal (nt, nq); states (nt, nz)
        """
        step = max(1, AT_ONCE // max(1, self.drawing.points_per_frame))
        for start in range(0, len(time), step):
            rows = slice(start, start + step)
            motion = Motion(self.system, time[rows], position[rows], velocity[rows], acceleration[rows])
            forces = None
            if "force" in self.drawing.fields:
                forces = Forces(motion, position[rows], velocity[rows], states[rows])
            yield motion.time, *self._drawn(motion, forces)

    def _drawn(self, motion: Motion, forces: Forces | None) -> tuple[NDArray[np.float32], Fields]:
        shape = (len(motion.time), self.drawing.points_per_frame)
        jets = np.zeros((3, *shape), complex)
        heights = np.zeros(shape[1])
        deflection, force = np.zeros(shape, complex), np.zeros(shape, complex)
        moment, stress = np.full(shape, np.nan), np.full(shape, np.nan)
        start = 0
        for piece in self.pieces:
            here = slice(start, start + piece.points)
            start += piece.points
            heights[here] = piece.heights
            if piece.kind == "trail":
                jets[..., here] = self._trail(motion)
                continue
            jets[..., here] = piece.place(motion)
            if piece.kind == "beam":
                beam, x = self.system.model.bodies[piece.body], np.array(piece.stations)
                assert isinstance(beam, Beam)
                deflection[:, here] = jets[0][:, here] - _unbent(self.system.model, motion, piece)
                moment[:, here] = motion.along(piece.body, x, bending_moment)
                if (modulus := beam.stress_modulus) is not None:
                    rows = partial(upper_stress, youngs_modulus=modulus)
                    stress[:, here] = motion.along(piece.body, x, rows)
            elif piece.kind in ("joint", "motor") and forces is not None:
                force[:, here] = forces.joint(piece.name)[0][:, None]
        places = _vectors(jets[0], heights)
        if self._first is None:
            self._first = places[0]
        values = {
            "displacement": places - self._first,
            "velocity": _vectors(jets[1]),
            "deflection": _vectors(deflection),
            "force": _vectors(force),
            "bending_moment": moment,
            "stress": stress,
        }
        drawn = places + (self.scale - 1.0) * values["deflection"]
        fields = {name: values[name].astype(np.float32) for name in self.drawing.fields}
        return drawn.astype(np.float32), fields

    def _insert_trail(self, ref: PointRef) -> None:
        """The trail comes before the first polygon."""
        trail = Piece("trail", ref.body, ref.body, lambda motion: motion.point(*ref).place, TRAIL, "lines")
        at = next(
            (k for k, piece in enumerate(self.pieces) if piece.topology == "polygons"), len(self.pieces)
        )
        self.pieces.insert(at, trail)

    def _trail(self, motion: Motion) -> PlaneJet:
        """Where a point was in the frames before, the present one first; before the start it was there."""
        assert self._trailed is not None
        now = motion.point(*self._trailed).place[0]
        before = self._track if self._track.size else np.repeat(now[:1], TRAIL)
        track = np.concatenate([before, now])
        self._track = track[-TRAIL:]
        windows = np.lib.stride_tricks.sliding_window_view(track, TRAIL)[-now.size :, ::-1]
        return np.stack([windows, 0.0 * windows, 0.0 * windows])


def trailed(model: Model) -> PointRef | None:
    """The point that leaves a trail: one that the model places, else the end of the last beam, else the last point
    of the last body that has one of its own."""
    for name in model.initial.place:
        ref = model.joints[name].between[0] if name in model.joints else PointRef(*name.split("."))
        if ref.body != GROUND:
            return ref
    for name, body in reversed(model.bodies.items()):
        if isinstance(body, Beam):
            return PointRef(name, "end")
    named = [
        PointRef(name, list(body.points)[-1]) for name, body in model.bodies.items() if len(body.points) > 2
    ]
    return named[-1] if named else None


def _fields(parts: list[Piece], model: Model) -> tuple[str, ...]:
    """The fields that tell something of a model."""
    kinds = {piece.kind for piece in parts}
    beams = [body for body in model.bodies.values() if isinstance(body, Beam)]
    return (
        "displacement",
        "velocity",
        *(("deflection",) if beams else ()),
        *(("force",) if kinds & {"joint", "motor"} else ()),
        *(("bending_moment",) if beams else ()),
        *(("stress",) if any(beam.stress_modulus is not None for beam in beams) else ()),
    )


def _unbent(model: Model, motion: Motion, piece: Piece) -> Plane:
    """Where the points of a beam would be if it did not bend."""
    start, end = straight(model, motion, piece.body).T[..., None]
    return start + (end - start) * np.array(piece.stations) / piece.stations[-1]


def _vectors(plane: Plane, heights: Array | float = 0.0) -> Array:
    return np.stack([plane.real, plane.imag, np.broadcast_to(heights, plane.shape)], axis=-1)
