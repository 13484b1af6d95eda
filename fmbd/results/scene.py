"""A mechanism in motion as pictures need it: items such as beams, pins and blocks, with their points over time.

Figures, animations and report pages all draw a `Scene`; the drawing in the archive, for ParaView, is drawing.py.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from fmbd.model import Beam, Model, RigidBody
from fmbd.model.points import CENTER_OF_MASS, GROUND, PointRef
from fmbd.model.visuals import Visual
from fmbd.results.drawing import convex_hull, pieces, straight
from fmbd.results.motion import Motion

if TYPE_CHECKING:
    from fmbd.results.run import Run

Array = NDArray[np.float64]
Plane = NDArray[np.complex128]

#: Size of symbols against that of the mechanism.
SYMBOL = 0.022


@dataclass(frozen=True)
class Mesh:
    """A mesh for looks, and the outline by which it is placed, both in the frame of its body."""

    visual: Visual
    outline: Plane


@dataclass(frozen=True)
class Item:
    """A part of a picture: `points` are its points over time, x + iy [m], shape (nt, n).

    kind, and what its points are:
      ground    where something is held on the ground
      clamp     where something is fixed to the ground; a second point along the direction of what is held
      rail      ends of the line on which something slides
      body      what a rigid body connects: the convex outline of its points, a line for two of them
      shape     outline of a rigid body by its shape or its mesh
      wheel     a rigid body without extent: centre, and a point on the rim that turns with it
      beam      axis of a beam
      spring    ends
      block     corners of a slider
      pin       a joint that turns
      motor     a joint with a motor
    other: of a joint the other body
    straight: ends of the axis of a beam before it bends, shape (nt, 2): from them a deflection is exaggerated
    along: where the points of a beam are, in lengths from its start, shape (n,)
    mesh: of a body with a mesh for looks; its outline are the points
    """

    kind: str
    body: str
    points: Plane
    straight: Plane | None = None
    along: Array | None = None
    other: str = ""
    mesh: Mesh | None = None

    def exaggerated(self, scale: float) -> "Item":
        """The item with `scale` times the deflection."""
        if self.straight is None or self.along is None:
            return self
        start, end = self.straight[:, :1], self.straight[:, 1:]
        straight = start + (end - start) * self.along
        return replace(self, points=straight + scale * (self.points - straight))


@dataclass(frozen=True)
class Scene:
    """Items of a mechanism at times [s] (nt,), and the tracks, (nt,), of points that leave a trail, by name.

    extent: (left, right, bottom, top) of all items over all times [m]
    """

    time: Array
    items: tuple[Item, ...]
    tracks: dict[str, Plane]
    extent: tuple[float, float, float, float]

    @property
    def size(self) -> float:
        """The larger side of the extent [m]."""
        left, right, bottom, top = self.extent
        return max(right - left, top - bottom)

    def exaggerated(self, scale: float) -> "Scene":
        """The scene with `scale` times the deflections of beams, and room for them."""
        if scale == 1.0:
            return self
        items = tuple(item.exaggerated(scale) for item in self.items)
        ends = {f"{item.body}.end": item.points[:, -1] for item in items if item.kind == "beam"}
        tracks = {name: ends.get(name, track) for name, track in self.tracks.items()}
        return Scene(self.time, items, tracks, _extent([_reach(item) for item in items]))


def scene(run: "Run", rows: Sequence[int] | NDArray[np.int64]) -> Scene:
    """The mechanism of a run at the output times of these rows."""
    rows = np.asarray(rows)
    motion = Motion(
        run.system, run.time[rows], run.position[rows], run.velocity[rows], run.acceleration[rows]
    )
    parts = list(_parts(run.model, motion))
    tracks = _tracks(run.model, motion)
    extent = _extent([part.points for part in parts] + [track[:, None] for track in tracks.values()])
    size = SYMBOL * max(extent[1] - extent[0], extent[3] - extent[2])
    items = [*parts, *_wheels(run.model, motion, 3.0 * size), *_joints(run.model, motion, size)]
    order = ("rail", "ground", "clamp", "body", "shape", "wheel", "beam", "spring", "block", "motor", "pin")
    items.sort(key=lambda item: order.index(item.kind))
    reach = [_reach(item) for item in items]
    return Scene(motion.time, tuple(items), tracks, _extent(reach))


def _reach(item: Item) -> Plane:
    """Points that a picture of an item must have room for."""
    if item.kind != "wheel":
        return item.points
    centre, radius = item.points[:, :1], np.abs(np.diff(item.points))
    return centre + radius * np.array([1.0, 1j, -1.0, -1j])


def _extent(points: Sequence[Plane]) -> tuple[float, float, float, float]:
    every = np.concatenate([each.ravel() for each in points]) if points else np.zeros(1, complex)
    left, right, bottom, top = every.real.min(), every.real.max(), every.imag.min(), every.imag.max()
    if max(right - left, top - bottom) < 1e-9:
        return left - 0.5, right + 0.5, bottom - 0.5, top + 0.5
    return float(left), float(right), float(bottom), float(top)


def _parts(model: Model, motion: Motion) -> Iterator[Item]:
    """Bodies with an extent, beams and springs, as in the drawing of the archive."""
    for piece in pieces(model):
        if piece.topology == "vertices":
            continue
        if piece.kind == "visual":
            yield _visual(model, motion, piece.body)
            continue
        points = piece.place(motion)[0]
        if piece.kind == "beam":
            along = np.array(piece.stations) / piece.stations[-1]
            yield Item("beam", piece.body, points, straight(model, motion, piece.body), along)
        elif piece.kind == "spring":
            yield Item("spring", piece.body, points)
        else:
            shaped = getattr(model.bodies[piece.body], "shape", None) is not None and points.shape[1] > 2
            yield Item("shape" if shaped else "body", piece.body, points)


def _visual(model: Model, motion: Motion, name: str) -> Item:
    """The outline of a mesh, and the mesh."""
    body = model.bodies[name]
    assert isinstance(body, RigidBody) and body.visual is not None
    x, y, _ = np.array(body.visual.points).T
    outline = convex_hull(x + 1j * y)
    kind = "shape" if outline.size > 2 else "body"
    return Item(kind, name, motion.fixed_points(name, outline)[0], mesh=Mesh(body.visual, outline))


def _wheels(model: Model, motion: Motion, radius: float) -> Iterator[Item]:
    for piece in pieces(model):
        if piece.kind == "mass":
            centre = piece.place(motion)[0]
            spoke = radius * np.exp(1j * motion.frame(piece.body).angle[0])[:, None]
            yield Item("wheel", piece.body, np.concatenate([centre, centre + spoke], axis=1))


def _joints(model: Model, motion: Motion, size: float) -> Iterator[Item]:
    """Symbols of joints, and of what they hold on the ground."""
    driven = {motor.joint for motor in model.motors.values()}
    for name, joint in model.joints.items():
        first, second = (motion.point(*ref) for ref in joint.between)
        body = joint.between[1].body
        here = first.place[0][:, None]
        if joint.type == "free":
            continue
        turns = "angle" in joint.coordinates
        if "x" in joint.coordinates:
            along = np.exp(1j * first.angle[0])[:, None] * complex(*joint.axis)
            slider = second.place[0][:, None]
            travel = ((slider - here) * along.conj()).real
            ends = np.array([travel.min() - 3.0 * size, travel.max() + 3.0 * size])
            yield Item("rail", joint.between[0].body, here + along * ends)
            corners = size * np.array([-1.6 - 1j, 1.6 - 1j, 1.6 + 1j, -1.6 + 1j])
            yield Item("block", body, slider + along * corners)
            here = slider
        elif GROUND in (ref.body for ref in joint.between):
            if turns:
                yield Item("ground", GROUND, here)
            else:
                other = second if joint.between[0].body == GROUND else first
                along = size * np.exp(1j * other.angle[0])[:, None]
                yield Item("clamp", GROUND, np.concatenate([here, here + along], axis=1))
        if turns:
            yield Item("motor" if name in driven else "pin", body, here, other=joint.between[0].body)


def _tracks(model: Model, motion: Motion) -> dict[str, Plane]:
    """Paths of points that a picture may trail: what joints connect, ends of beams, points of rigid bodies."""
    refs = [ref for joint in model.joints.values() for ref in joint.between]
    for name, body in model.bodies.items():
        own = ("end",) if isinstance(body, Beam) else tuple(body.points)
        refs += [PointRef(name, point) for point in own]
    tracks = {}
    for ref in dict.fromkeys(ref for ref in refs if ref.body != GROUND):
        track = motion.point(*ref).place[0]
        if np.abs(track - track[0]).max() > 1e-9:
            tracks[f"{ref.body}.{ref.point}"] = track
    return tracks


def main_track(run: "Run", tracks: dict[str, Plane]) -> str | None:
    """The point that a picture trails unasked: one that the model places, else the last beam's end, else that
    which goes farthest."""
    placed = [run.model.joints[name].between for name in run.model.initial.place if name in run.model.joints]
    at = [name for refs in placed for ref in refs if (name := f"{ref.body}.{ref.point}") in tracks]
    ends = [name for name in tracks if name.endswith(".end") and _is_beam(run.model, name)]
    if at or ends:
        return at[0] if at else ends[-1]
    named = [name for name in tracks if not name.endswith(f".{CENTER_OF_MASS}")] or list(tracks)
    return max(named, key=lambda name: float(np.abs(np.diff(tracks[name])).sum()), default=None)


def _is_beam(model: Model, name: str) -> bool:
    return isinstance(model.bodies[name.partition(".")[0]], Beam)


def spread(count: int, most: int) -> NDArray[np.int64]:
    """At most so many of `count` rows, evenly from the first to the last."""
    return np.unique(np.linspace(0, count - 1, min(most, count)).round().astype(np.int64))


def window(time: Array, start: float, end: float) -> NDArray[np.int64]:
    """The rows of the times [s] from start to end; raises ValueError when there are fewer than two."""
    rows = np.flatnonzero((time >= start) & (time <= end))
    if rows.size < 2:
        raise ValueError(f"fewer than two output times lie between {start:g} and {end:g} s")
    return rows
