"""Springs, motors with their controllers, and loads as generalised forces, for system.matrices.

x, r    coordinates (q, t) and their rates (q', 1), shape (nq+1,)
l, l'   value and rate of a pathway; row: its derivatives by x
"""

from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from fmbd.planar import laws
from fmbd.planar.arrays import Planar
from fmbd.system.reference import Reference

Array = np.ndarray


class Paths(NamedTuple):
    """All pathways at a state, `linear` those that are linear in q; shapes (np,), rows (np, nq+1)."""

    values: Array
    rows: Array
    rates: Array
    linear: Array


@dataclass(frozen=True, eq=False)
class Motors:
    """Generalised forces B u - D q' + f of the motors; `inputs` numbers the motors of B's columns."""

    inputs: Array
    B: Array
    u: Array
    D: Array
    f: Array


def apply_springs(planar: Planar, paths: Paths, x: Array, r: Array) -> tuple[Array, Array, Array]:
    """K, D (nq+1, nq+1) of linear springs and dampers if linear in q, and all else that springs do, f (nq+1,)."""
    springs = planar.springs
    path = springs["pathway"]
    k, d, rows = springs["k"], springs["d"], paths.rows[path]
    K, D = _quadratic(rows, k * paths.linear[path]), _quadratic(rows, d * paths.linear[path])
    stretch, rates = paths.values[path] - springs["rest"], paths.rates[path]
    force = -k * stretch - d * rates + nonlinear_forces(planar, stretch, rates)
    return K, D, force @ rows + _without_time(K, x) + _without_time(D, r)


def nonlinear_forces(planar: Planar, stretch: Array, rates: Array) -> Array:
    """What the laws of the springs (see planar.laws) add to linear ones, shape (springs,)."""
    force = np.zeros(stretch.size)
    for index, spring in enumerate(planar.springs):
        s, v = stretch[index], rates[index]
        match int(spring["kind"]):
            case laws.STOP:
                lower, upper, stiffness, damping, transition = spring["p"]
                for side, depth in ((-1.0, s - upper), (1.0, lower - s)):
                    push = np.maximum(1.0 - side * damping * v, 0.0)
                    force[index] += side * stiffness * _taken_up(depth, transition)[0] * push
            case laws.BACKLASH:
                lower, upper, stiffness, damping, transition = spring["p"]
                ahead, back = _taken_up(s - upper, transition), _taken_up(lower - s, transition)
                force[index] = stiffness * (back[0] - ahead[0]) - damping * (back[1] + ahead[1]) * v
            case laws.FRICTION:
                coulomb, static, stribeck, transition, _ = spring["p"]
                share = np.exp(-np.square(v / stribeck))
                force[index] = -(share * static + (1.0 - share) * coulomb) * np.tanh(v / transition)
            case laws.TABLE:
                pieces = planar.curves[spring["start"] :][: spring["count"]]
                s0, *c, _ = pieces[max(np.searchsorted(pieces[:, 0], s, "right") - 1, 0)]
                force[index] = -np.polyval(c[::-1], s - s0)
    return force


def _taken_up(depth: float, transition: float) -> tuple[float, float]:
    """Depth taken up behind the end of a gap, rounded over the transition, and its derivative by the depth."""
    share = min(max(depth / transition + 0.5, 0.0), 1.0)
    rounded = transition * float(np.polyval([-0.5, 1.0, 0.0, 0.0, 0.0], share))
    return rounded + max(depth - 0.5 * transition, 0.0), float(np.polyval([-2.0, 3.0, 0.0, 0.0], share))


def apply_motors(planar: Planar, paths: Paths, r: Array, signals: Array, z: Array, online: Array) -> Motors:
    """Forces of all motors; z (nz,): currents and integrals; online (motors,): torques against gravity."""
    motors = planar.motors
    path, state, Km = motors["pathway"], motors["state"], motors["Km"]
    rows, inductive = paths.rows[path], state >= 0
    gain = np.divide(Km, motors["Ra"], out=np.ones(motors.size), where=motors["electric"] == 1)
    drag = np.where(inductive, 0.0, gain * motors["Ke"])
    D = _quadratic(rows, drag * paths.linear[path])
    torque = -drag * paths.rates[path]
    torque[inductive] += Km[inductive] * z[state[inductive]]
    inputs = np.flatnonzero(~inductive)
    return Motors(
        inputs=inputs,
        B=(rows.T * gain)[:, inputs],
        u=np.array([motor_input(planar, motor, paths, signals, z, online) for motor in motors[inputs]]),
        D=D,
        f=torque @ rows + _without_time(D, r),
    )


def motor_input(planar: Planar, motor: Any, paths: Paths, signals: Array, z: Array, online: Array) -> float:
    """Voltage or torque of a motor from its signal, or from its controller, which may saturate."""
    if motor["controller"] < 0:
        return float(signals[motor["signal"], 0])
    law = planar.controllers[motor["controller"]]
    error, error_rate = law["shift"] - paths.values[law["pathway"]], -paths.rates[law["pathway"]]
    if law["target"] >= 0:
        value, rate, _ = signals[law["target"]]
        error, error_rate = error + law["scale"] * value, error_rate + law["scale"] * rate
    wanted = law["bias"] + law["kp"] * error + law["kd"] * error_rate
    if law["feedforward"] >= 0:
        wanted += signals[law["feedforward"], 0]
    if law["online"] >= 0:
        wanted += law["gravity_gain"] * online[law["online"]]
    if law["state"] >= 0:
        wanted += law["ki"] * z[law["state"]]
    return float(min(max(wanted, law["low"]), law["high"]))


def apply_loads(
    planar: Planar, reference: Reference, bodies: Array, stations: Array, x: Array, signals: Array
) -> Array:
    """Generalised force (nq+1,) of the loads, from the frames (n, 3, d) of bodies and stations."""
    f = np.zeros(x.size)
    for load in planar.loads:
        frame = stations[load["station"]]
        fx, fy, moment = (signals[load[k], 0] if load[k] >= 0 else 0.0 for k in ("fx", "fy", "moment"))
        f += np.array([*_world(load, frame, fx, fy), moment]) @ frame[:, 1:]
    if planar.distributed.size:
        sums = reference.stretches.sums(bodies[planar.distributed["body"]], x)
        for load, sum_ in zip(planar.distributed, sums, strict=True):
            fx, fy = signals[load["fx"], 0], signals[load["fy"], 0]
            f += _world(load, bodies[load["body"]], fx, fy) @ sum_[:, 1:]
    return f


def _world(load: Any, frame: Array, fx: float, fy: float) -> Array:
    """A load's force in world axes; a following one turns with its frame."""
    angle = frame[2, 0] if load["following"] else 0.0
    c, s = np.cos(angle), np.sin(angle)
    return np.array([c * fx - s * fy, s * fx + c * fy])


def _quadratic(rows: Array, weights: Array) -> Array:
    """sum of weight * row^T row."""
    return (rows.T * weights) @ rows


def _without_time(matrix: Array, vector: Array) -> Array:
    """Matrix times vector, the last (time) component of which is left out: it does not move with q."""
    return matrix[:, :-1] @ vector[:-1]
