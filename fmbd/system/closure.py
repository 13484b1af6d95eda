"""Position of the rigid mechanism: close its loops, with joints at given values and points at given places.

Straight beams, zero elastic coordinates. The unknowns are the joint coordinates of the tree; equations are the
constraints of the cut joints, given joint values, given places. Solved by a damped Gauss-Newton method; with no
full guess, from several starting points, so that other assembly modes are seen.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from fmbd.planar.arrays import ANGLE, rigid_joints
from fmbd.system.lowered import Lowered

Array = np.ndarray

CLOSED = 1e-10  # largest residual [m or rad] that counts as closed
STARTS = 48


@dataclass(frozen=True)
class Closure:
    """A solved position: q (nq,), what is left of the equations, and how many other assembly modes were seen."""

    q: Array
    residual: float
    others: int


class RigidMechanism:
    """The equations of position of a lowered model, evaluated by the reference kinematics."""

    def __init__(self, lowered: Lowered, reference: Any) -> None:
        self.lowered = lowered
        self.reference = reference
        planar = lowered.planar
        joints = rigid_joints(planar.bodies)
        self.unknowns = np.sort(joints[joints >= 0])
        angles = joints[:, 2]
        self.is_angle = np.isin(self.unknowns, angles[angles >= 0])

    def equations(
        self,
        q: Array,
        held: Mapping[tuple[str, str], float],
        places: Mapping[str, tuple[float, float]],
        t: float = 0.0,
    ) -> tuple[Array, Array]:
        """Residual (m,) and Jacobian (m, nq) of constraints, held joint coordinates and places."""
        _, stations = self.reference.frames(q, t)
        position, angle, jacobian = stations[:, :2, 0], stations[:, 2, 0], stations[..., 1:]
        lengths = self.reference.lengths(stations)
        values, gradients = lengths[:, 0], lengths[:, 1:]
        residual: list[float] = []
        rows: list[Array] = []
        planar = self.lowered.planar
        for c in planar.held:
            constraint = planar.constraints[c]
            path = constraint["pathway"]
            drive = self.reference.signal(constraint["driver"], t)[0] if constraint["driver"] >= 0 else 0.0
            value = values[path] + drive
            turning = planar.terms[planar.pathways[path]["term0"]]["kind"] == ANGLE
            residual.append(wrap(value) if turning else value)
            rows.append(gradients[path])
        for (joint, direction), wanted in held.items():
            value, row = self._coordinate(joint, direction, position, angle, jacobian)
            cut = joint in self.lowered.tree.cut and direction == "angle"
            residual.append(wrap(value - wanted) if cut else value - wanted)
            rows.append(row)
        for name, place in places.items():
            k = self.lowered.stations[self.lowered.place_point(name)]
            residual += list(position[k] - np.asarray(place))
            rows += list(jacobian[k, :2])
        nq = self.lowered.planar.nq
        return np.array(residual), np.array(rows).reshape(-1, nq + 1)[:, :nq]

    def _coordinate(
        self, joint: str, direction: str, position: Array, angle: Array, jacobian: Array
    ) -> tuple[float, Array]:
        """A joint's coordinate and its gradient (nq+1,), from the two stations that it joins.

        The angle of a cut joint is found up to full turns; the start says from which it is counted.
        """
        part = self.lowered.model.joints[joint]
        a, b = (self.lowered.stations[ref.body, ref.point] for ref in part.between)
        if direction == "angle":
            turn = self.lowered.turns.get(joint, 0.0)
            return angle[b] - angle[a] - turn, jacobian[b, 2] - jacobian[a, 2]
        c, s = np.cos(angle[a]), np.sin(angle[a])
        ex, ey = part.axis[0] * c - part.axis[1] * s, part.axis[0] * s + part.axis[1] * c
        if direction == "y":
            ex, ey = -ey, ex
        dx, dy = position[b] - position[a]
        moved = jacobian[b] - jacobian[a]
        return ex * dx + ey * dy, ex * moved[0] + ey * moved[1] + (ex * dy - ey * dx) * jacobian[a, 2]

    def coordinates(
        self, q: Array, wanted: Sequence[tuple[str, str]], t: float = 0.0
    ) -> list[tuple[float, Array]]:
        """Coordinates of joints, as (joint, direction), at q, and their gradients (nq+1,)."""
        stations = self.reference.stations(q, t) if wanted else ()
        return [self._coordinate(*pair, *stations) for pair in wanted]

    def solve(
        self,
        guess: Array,
        held: Mapping[tuple[str, str], float],
        places: Mapping[str, tuple[float, float]],
        t: float = 0.0,
    ) -> Closure:
        """Damped Gauss-Newton from one guess (nq,)."""
        q = np.array(guess, float)
        residual, jacobian = self.equations(q, held, places, t)
        size = np.linalg.norm(residual)
        for _ in range(60):
            if size == 0.0 or residual.size == 0:
                break
            step = np.linalg.lstsq(jacobian[:, self.unknowns], -residual, rcond=1e-12)[0]
            step *= min(1.0, 1.0 / max(np.abs(step).max(), 1e-300))
            fraction = 1.0
            while fraction > 1e-3:
                trial = q.copy()
                trial[self.unknowns] += fraction * step
                new, new_jacobian = self.equations(trial, held, places, t)
                if np.linalg.norm(new) < size:
                    break
                fraction *= 0.5
            else:
                break
            converging = np.linalg.norm(new) < 0.9 * size
            q, residual, jacobian, size = trial, new, new_jacobian, np.linalg.norm(new)
            if size < 1e-14 or (size < CLOSED and not converging):
                break
        return Closure(q, float(np.abs(residual).max(initial=0.0)), 0)

    def search(
        self,
        guess: Array,
        held: Mapping[tuple[str, str], float],
        places: Mapping[str, tuple[float, float]],
        hinted: bool,
        near: Mapping[tuple[str, str], float] | None = None,
    ) -> Closure:
        """The closed position that is found from the guess; if that is not hinted, the nearest of all assembly modes.

        That has the joint coordinates, of cut joints as of all others and angles without their turns, that differ
        least from those in `near`, 0 where it has none (default: the joint coordinates of the guess). Of modes
        equally near, the one whose first joint coordinates are greater is taken. Where the mechanism can still move
        and something is near, the position found from the guess stands.
        """
        if near is None:
            near = self.joint_coordinates(guess)
        in_tree = all(joint not in self.lowered.tree.cut for joint, _ in held)
        if in_tree and not places and not len(self.lowered.planar.held):
            return Closure(guess, 0.0, 0)
        miss = float(np.abs(self.equations(guess, held, places)[0]).max(initial=0.0))
        if miss < CLOSED:
            return Closure(guess, miss, 0)
        best = self.solve(guess, held, places)
        if best.residual < CLOSED and (hinted or (near and not self._determined(best.q, held, places))):
            return Closure(self._unwind(best.q, guess, held), best.residual, 0)
        found = [best.q] if best.residual < CLOSED else []
        rng = np.random.default_rng(20221230)
        span = np.where(self.is_angle, np.pi, self._size())
        for _ in range(STARTS):
            start = np.array(guess)
            start[self.unknowns] += span * rng.uniform(-1.0, 1.0, span.size)
            trial = self.solve(start, held, places)
            if trial.residual < CLOSED:
                q = self._unwind(trial.q, guess, held)
                if all(np.abs(q - self._unwind(other, guess, held)).max() > 1e-6 for other in found):
                    found.append(q)
            elif not found and trial.residual < best.residual:
                best = trial
        if not found:
            return best
        found = [self._unwind(q, guess, held) for q in found]
        nearest = min(found, key=lambda q: self._distance(q, near))
        return Closure(nearest, 0.0, len(found) - 1 if self._determined(nearest, held, places) else 0)

    def _determined(
        self, q: Array, held: Mapping[tuple[str, str], float], places: Mapping[str, tuple[float, float]]
    ) -> bool:
        """Whether the equations leave no motion at q."""
        rows = self.equations(q, held, places)[1][:, self.unknowns]
        return bool(np.linalg.matrix_rank(rows, tol=1e-9) == self.unknowns.size)

    def joint_coordinates(self, q: Array) -> dict[tuple[str, str], float]:
        """All joint coordinates that are not driven."""
        frames = self.reference.stations(q, 0.0)
        return {
            (name, direction): float(self._coordinate(name, direction, *frames)[0])
            for name, joint in self.lowered.model.joints.items()
            for direction in joint.coordinates
            if direction not in joint.driven
        }

    def _distance(self, q: Array, near: Mapping[tuple[str, str], float]) -> tuple[float, ...]:
        """Sorts positions by what their joint coordinates are away from those in `near`."""
        away = []
        for (joint, direction), value in self.joint_coordinates(q).items():
            step = value - near.get((joint, direction), 0.0)
            away.append(wrap(step) if direction == "angle" else step)
        return (round(float(np.linalg.norm(away)), 9), *(-np.round(away, 6)))

    def _unwind(self, q: Array, guess: Array, held: Mapping[tuple[str, str], float]) -> Array:
        """Take full turns out of the angles that are not held."""
        names = [name for name, _ in self.lowered.coordinates]
        fixed = [f"{joint}.{direction}" for joint, direction in held]
        free = [k for k in self.unknowns[self.is_angle] if names[k] not in fixed]
        q = np.array(q)
        q[free] -= turns(q[free] - guess[free])
        return q

    def _size(self) -> float:
        """A length of the mechanism [m]: the spread of its stations."""
        position = self.reference.stations(np.zeros(self.lowered.planar.nq), 0.0)[0]
        return float(np.ptp(position, axis=0).max()) or 1.0


def turns(angle: Any) -> Any:
    """The whole turns [rad] in an angle or an array of angles that leave it in (-pi, pi], -pi taken for pi."""
    return 2.0 * np.pi * np.ceil(angle / (2.0 * np.pi) - 0.5 - 1e-9)


def wrap(angle: float) -> float:
    """The same angle in (-pi, pi]."""
    return float(angle - turns(angle))
