"""Inverse kinematics: how the joints of the motors must move so that a point of the rigid mechanism follows a path.

    Phi(q) = 0    closed loops, driven joints        A    rows of the motors' joints
    p(q)          the point                          x    all joint coordinates, beams straight
Where det [Phi_x; A] = 0 the motors do not hold the mechanism: a path through such a position is refused.
"""

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from fmbd.analyses.structure import independent_rows
from fmbd.errors import AnalysisError, UnknownQuantity
from fmbd.model import Model
from fmbd.model.names import unknown
from fmbd.system import System
from fmbd.system.closure import CLOSED, RigidMechanism
from fmbd.system.motors import motor_coordinate

Array = np.ndarray
Coordinate = tuple[str, str]

#: Stages in which the point is brought from the start to the beginning of the path.
_STAGES = 20
#: Step of derivatives without a formula, such as those of a determinant [rad, m].
_STEP = 1e-6


def actuated(model: Model, motors: list[str]) -> list[Coordinate]:
    """The joint coordinates that these motors move, each once."""
    return list(
        dict.fromkeys((model.motors[m].joint, motor_coordinate(model, model.motors[m])) for m in motors)
    )


def checked_point(model: Model, name: str) -> str:
    """A joint, for its first point, or body.point; raises UnknownQuantity for a name that the model does not have."""
    body, _, point = name.partition(".")
    if name in model.joints or (body in model.bodies and point in model.bodies[body].points):
        return name
    if body in model.bodies:
        raise UnknownQuantity(unknown("point", point, model.bodies[body].points, f" of '{body}'"))
    raise UnknownQuantity(unknown("joint or point", name, [*model.joints, *model.bodies]))


def as_point(model: Model, name: str) -> str:
    """body.point of a point, or of the first point of a joint."""
    return str(model.joints[name].between[0]) if name in model.joints else name


class Guide:
    """The rigid mechanism of a system, moved by the joints of its motors or by a point of it.

    The point's station must be there (`assemble(model, points=[point])`).
    """

    def __init__(self, system: System, joints: list[Coordinate], point: str | None = None) -> None:
        self.joints, self.point = joints, point
        self._origin = {point: (0.0, 0.0)} if point is not None else {}
        self.mechanism = RigidMechanism(system.lowered, system.reference)
        self.start = system.start.q * ~system.elastic
        self._loops = self.mechanism.equations(self.start, {}, {})[0].size
        A = self._rows(self.start, 0.0)[: self._loops]
        self._kept = independent_rows(A)

    def place(self, q: Array, t: float) -> Array:
        """Where the point is at nodal coordinates q (nq,), shape (2,)."""
        return self.mechanism.equations(q, {}, self._origin, t)[0][-2:]

    def values(self, q: Array, t: float) -> Array:
        """The joint coordinates of the motors at q, shape (joints,)."""
        return np.array([value for value, _ in self.mechanism.coordinates(q, self.joints, t)])

    def rows(self, q: Array, t: float) -> tuple[Array, Array, Array]:
        """Derivatives by the joint coordinates x (n,): of independent loops, of the motors' joints, of the point."""
        rows = self._rows(q, t)
        end = self._loops + len(self.joints)
        return rows[: self._loops][self._kept], rows[self._loops : end], rows[end:]

    def at_point(self, guess: Array, place: Array, t: float) -> Array:
        """q near a guess with the point at a place (2,); AnalysisError if that is out of reach."""
        where = float(place[0]), float(place[1])
        closure = self.mechanism.solve(guess, {}, dict.fromkeys(self._origin, where), t)
        if closure.residual > CLOSED:
            miss = np.linalg.norm(self.place(self.closest(guess, place, t), t) - place)
            raise AnalysisError(
                f"{self.point} cannot reach ({where[0]:.6g}, {where[1]:.6g}) at t = {t:.6g} s: "
                f"the nearest position found misses by {miss:.4g} m"
            )
        return closure.q

    def at_joints(self, guess: Array, values: Array, t: float) -> Array:
        """q near a guess with the motors' joints at values (joints,); AnalysisError if the loops cannot be closed."""
        held = dict(zip(self.joints, map(float, values), strict=True))
        closure = self.mechanism.solve(guess, held, {}, t)
        if closure.residual > CLOSED:
            given = ", ".join(f"{joint} {value:.6g}" for (joint, _), value in held.items())
            raise AnalysisError(
                f"the loops cannot be closed at t = {t:.6g} s with {given}: "
                f"the nearest position found misses by {closure.residual:.3g} m"
            )
        return closure.q

    def begin(self, place: Array) -> Array:
        """q with the point at a place, moved there from the start in stages, to stay in the assembly mode."""
        return _staged(self.at_point, self.start, self.place(self.start, 0.0), place)

    def begin_joints(self, values: Array) -> Array:
        """q with the motors' joints at values, moved there from the start in stages."""
        return _staged(self.at_joints, self.start, self.values(self.start, 0.0), values)

    def follow(self, times: Array, path: Array) -> Array:
        """q (nt, nq) with the point on a path (nt, 2), held by the motors; AnalysisError if it cannot, or is not."""
        qs = self.follow_path(times, path)
        control = np.array([self.control(q, float(t)) for q, t in zip(qs, times, strict=True)])
        lost = np.flatnonzero(control[:-1] * control[1:] <= 0.0)
        if lost.size:
            raise AnalysisError(
                f"on its way {self.point} passes a position at t = {times[lost[0] + 1]:.6g} s where the motors do "
                "not hold the mechanism (fmbd kinematics looks for such singular positions)"
            )
        return qs

    def follow_path(self, times: Array, path: Array) -> Array:
        """q (nt, nq) with the point on a path (nt, 2); AnalysisError where that is out of reach."""
        return _followed(self.at_point, self.begin(path[0]), times, path)

    def follow_joints(self, times: Array, values: Array) -> Array:
        """q (nt, nq) with the motors' joints at values (nt, joints); AnalysisError where that is not possible."""
        return _followed(self.at_joints, self.begin_joints(values[0]), times, values)

    def control(self, q: Array, t: float) -> float:
        """det [Phi_x; A], zero where the motors do not hold the mechanism; with motors to spare a measure above 0.

        Raises AnalysisError if there are not enough motors.
        """
        loops, inputs, _ = self.rows(q, t)
        stacked = np.vstack([loops, inputs])
        if stacked.shape[0] == stacked.shape[1]:
            return float(np.linalg.det(stacked))
        size = np.linalg.svd(stacked, compute_uv=False)
        if len(stacked) < stacked.shape[1]:
            free, n = stacked.shape[1] - len(loops), len(self.joints)
            driven = f"{n} joint{'s' if n != 1 else ''} with {'motors' if n != 1 else 'a motor'}"
            raise AnalysisError(
                f"the mechanism has {free} degrees of freedom, and {driven}, which do not settle where {self.point} is"
            )
        return float(size[-1])

    def miss(self, q: Array, t: float) -> Array:
        """By how much independent loops are open at q [m or rad]."""
        return self.mechanism.equations(q, {}, {}, t)[0][self._kept]

    def all_joints(self, q: Array) -> dict[Coordinate, float]:
        """All joint coordinates that are not driven, at the start of time."""
        return self.mechanism.joint_coordinates(q)

    def closest(self, q: Array, place: Array, t: float, *vanishing: Callable[[Array], float]) -> Array:
        """Nodal coordinates near q, loops closed, whose point is nearest to a place (2,): a local minimum.

        vanishing: functions of nodal coordinates that are to be zero there, too.
        """
        from scipy import optimize

        unknowns = self.mechanism.unknowns

        def at(x: Array) -> Array:
            moved = q.copy()
            moved[unknowns] = x
            return moved

        def away(x: Array) -> Array:
            return self.place(at(x), t) - place

        def slope(function: Callable[[Array], float], x: Array) -> Array:
            steps = _STEP * np.eye(x.size)
            return np.array([function(at(x + h)) - function(at(x - h)) for h in steps]) / (2.0 * _STEP)

        closed = {
            "type": "eq",
            "fun": lambda x: self.miss(at(x), t),
            "jac": lambda x: self.rows(at(x), t)[0],
        }
        zeros = [
            {"type": "eq", "fun": lambda x, f=f: f(at(x)), "jac": lambda x, f=f: slope(f, x)}
            for f in vanishing
        ]
        minimise: Any = optimize.minimize  # its annotations know no method with gradients of constraints
        found = minimise(
            lambda x: float(away(x) @ away(x)),
            q[unknowns],
            jac=lambda x: 2.0 * away(x) @ self.rows(at(x), t)[2],
            method="SLSQP",
            constraints=[closed, *zeros],
            options={"ftol": 1e-14, "maxiter": 200},
        )
        return at(found.x)

    def _rows(self, q: Array, t: float) -> Array:
        """Of all loops, the motors' joints and the point."""
        held: Mapping[Coordinate, float] = dict.fromkeys(self.joints, 0.0)
        jacobian = self.mechanism.equations(q, held, self._origin, t)[1]
        return jacobian[:, self.mechanism.unknowns]


def _followed(solve: Callable[[Array, Array, float], Array], q: Array, times: Array, wanted: Array) -> Array:
    qs = [q]
    for t, values in zip(times[1:], wanted[1:], strict=True):
        qs.append(solve(_ahead(qs[-4:]), values, float(t)))
    return np.array(qs)


def _ahead(qs: list[Array]) -> Array:
    """The next of up to four, by the polynomial through them."""
    weights = {1: [1], 2: [-1, 2], 3: [1, -3, 3], 4: [-1, 4, -6, 4]}[len(qs)]
    return np.tensordot(weights, qs, 1)


def _staged(solve: Callable[[Array, Array, float], Array], q: Array, first: Array, last: Array) -> Array:
    for share in np.linspace(0.0, 1.0, _STAGES + 1)[1:]:
        try:
            q = solve(q, first + share * (last - first), 0.0)
        except AnalysisError as error:
            solve(q, last, 0.0)  # out of reach itself, it is to be named
            raise AnalysisError(f"on the straight way from the start {error}") from None
    return q
