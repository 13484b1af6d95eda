"""The right-hand side, the projection onto the constraints, and energies: what an integrator calls.

y = [q (nq), v (nq), z (nz), dissipated energy, work]      state of an explicit method
Phi = 0, Phi' = 0                                          constraints, position and velocity
"""

from typing import Any

import numpy as np

from fmbd.planar.compile import compiled, inner, part
from fmbd.planar.forces import applied_forces, body_forces, clear_forces
from fmbd.planar.gravity_compensation import compensate_gravity
from fmbd.planar.kinematics import kinematics
from fmbd.planar.laws import law
from fmbd.planar.pathways import pathways
from fmbd.planar.recursion import joint_direction, joint_reaction, outer_acceleration, solve
from fmbd.planar.signals import evaluate_signals

# of the distance from the world's origin: errors of a place that is computed along a chain of bodies
_ROUND_OFF = 4e-15
# |Phi| to put up with where Newton gets no further: lengths of redundant constraints contradict each other a little,
# differently along the motion; a start is accepted with a tenth of it
_CONTRADICTION = 1e-9


@part
def accelerations(
    sys: Any,
    work: Any,
    t: float,
    q: np.ndarray,
    v: np.ndarray,
    z: np.ndarray,
    dz: np.ndarray,
    qdd: np.ndarray,
    drag: float,
    pull: float,
) -> tuple[int, float, float]:
    """q'' (nq,), z' (nz,) and the multipliers (in work) at time t.

    The constraints are asked to obey Phi'' + drag Phi' + pull Phi = 0 (Baumgarte: drag = 2 delta omega,
    pull = omega^2; both 0: the plain second derivative).
    Returns the index of a body whose joint has no inertia (or -1), the power dissipated and the power put in [W].
    """
    dissipated, power = forces_of_state(sys, work, t, q, v, z, dz)
    for c in range(sys.constraints.size):
        value, rate, second = constraint(sys.constraints[c], work.lengths, work.signal)
        work.reactions[c].target = -second - drag * rate - pull * value
    failed = solve(sys, work, qdd)
    return failed, dissipated, power + driving_power(sys, work)


@part
def forces_of_state(
    sys: Any, work: Any, t: float, q: np.ndarray, v: np.ndarray, z: np.ndarray, dz: np.ndarray
) -> tuple[float, float]:
    """All that follows from time and state: places, rates and forces, in `work`, and z' (nz,).

    Returns the power dissipated and the power that motors and loads put in [W].
    """
    evaluate_signals(sys.signals, sys.program, sys.table, work.stack, t, work.signal)
    if sys.online_compensation == 1:
        compensate_gravity(sys, work, q)
    kinematics(sys, work, q, v)
    pathways(sys, work)
    clear_forces(work.frames, work.rows)
    dissipated, power = applied_forces(sys, work, z, dz)
    dissipated += body_forces(sys, work, q, v)
    return dissipated, power


@compiled
def evaluate_accelerations(
    sys: Any,
    work: Any,
    t: float,
    q: np.ndarray,
    v: np.ndarray,
    z: np.ndarray,
    dz: np.ndarray,
    qdd: np.ndarray,
) -> int:
    """`accelerations` for callers in Python; returns -1 or the index of the body that failed."""
    failed, _, _ = accelerations(sys, work, t, q, v, z, dz, qdd, 0.0, 0.0)
    return failed


@part
def constraint(record: Any, lengths: Any, signal: np.ndarray) -> tuple[float, float, float]:
    """Phi, Phi' and Phi'' at zero q'' of a constraint."""
    path = lengths[record.pathway]
    if record.driver < 0:
        return path.value, path.rate, path.bias
    s = signal[record.driver]
    return path.value + s[0], path.rate + s[1], path.bias + s[2]


@part
def driving_power(sys: Any, work: Any) -> float:
    """Power that prescribed joint motions put in; needs a finished solve."""
    power = 0.0
    for c in range(sys.constraints.size):
        driver = sys.constraints[c].driver
        if driver >= 0:
            # Phi = -l + f(t): the multiplier does work -lambda f' on the mechanism
            power -= work.reactions[c].multiplier * work.signal[driver, 1]
    for i in range(sys.bodies.size):
        b = sys.bodies[i]
        for d in range(3):
            if b.driver[d] >= 0:
                f = work.frames[i]
                sx, sy, sz = joint_direction(b, f, d)
                fx, fy, moment = reaction(sys, work, i)
                power += work.signal[b.driver[d], 1] * (sx * fx + sy * fy + sz * moment)
    return power


@part
def reaction(sys: Any, work: Any, i: int) -> tuple[float, float, float]:
    """Force and moment that the tree joint of body i puts on it at the inner station; needs a finished solve."""
    b = sys.bodies[i]
    f = work.frames[i]
    ax, ay, aw = 0.0, 0.0, 0.0
    if b.parent >= 0:
        p = work.frames[b.parent]
        ax, ay, aw = outer_acceleration(f, p, sys.stations[b.outer], work.points[b.outer], work.rows)
    return joint_reaction(b, f, work.slots, work.reactions, ax, ay, aw)


@part
def derivatives(
    sys: Any, work: Any, t: float, y: np.ndarray, dy: np.ndarray, drag: float, pull: float
) -> int:
    """dy/dt of the state y; returns -1 or the index of the body that failed."""
    n = sys.nq
    nz = y.size - 2 * n - 2
    q, v, z = y[:n], y[n : 2 * n], y[2 * n : 2 * n + nz]
    for k in range(n):
        dy[k] = v[k]
    failed, dissipated, power = accelerations(
        sys, work, t, q, v, z, dy[2 * n : 2 * n + nz], dy[n : 2 * n], drag, pull
    )
    dy[2 * n + nz] = dissipated
    dy[2 * n + nz + 1] = power
    return failed


@compiled
def constraint_errors(sys: Any, work: Any, t: float, q: np.ndarray, v: np.ndarray) -> tuple[float, float]:
    """Largest |Phi| and |Phi'|."""
    evaluate_signals(sys.signals, sys.program, sys.table, work.stack, t, work.signal)
    kinematics(sys, work, q, v)
    pathways(sys, work)
    position, velocity = 0.0, 0.0
    for c in range(sys.constraints.size):
        value, rate, _ = constraint(sys.constraints[c], work.lengths, work.signal)
        position = max(position, abs(value))
        velocity = max(velocity, abs(rate))
    return position, velocity


@inner
def project(sys: Any, work: Any, t: float, y: np.ndarray, step: np.ndarray, tolerance: float) -> int:
    """Move q, then v, onto the constraints, by the least change in the metric of the mass matrix.

    Newton with M dq - Phi_q^T mu = 0, Phi_q dq = -Phi until |Phi| <= tolerance, or round-off, or as little as redundant
    constraints let it be (at most 8 times), then once for the velocities (their equations are linear). Returns the
    Newton steps taken, or -1 if they did not converge.
    """
    if sys.constraints.size == 0:
        return 0
    n = sys.nq
    q, v = y[:n], y[n : 2 * n]
    evaluate_signals(sys.signals, sys.program, sys.table, work.stack, t, work.signal)
    taken = 0
    worst = np.inf
    while True:
        kinematics(sys, work, q, v)
        pathways(sys, work)
        before, worst = worst, 0.0
        for c in range(sys.constraints.size):
            value, _, _ = constraint(sys.constraints[c], work.lengths, work.signal)
            work.reactions[c].target = -value
            worst = max(worst, abs(value))
        if settled(worst, before, tolerance, work.points):
            break
        if taken == 8 or not worst < 1e300:
            return -1
        if _correct(sys, work, step) >= 0:
            return -1
        for k in range(n):
            q[k] += step[k]
        taken += 1
    for c in range(sys.constraints.size):
        _, rate, _ = constraint(sys.constraints[c], work.lengths, work.signal)
        work.reactions[c].target = -rate
    if _correct(sys, work, step) >= 0:
        return -1
    for k in range(n):
        v[k] += step[k]
    return taken


@compiled
def close_at_start(sys: Any, work: Any, y: np.ndarray, step: np.ndarray, tolerance: float) -> int:
    """`project` at time 0, for callers in Python."""
    return project(sys, work, 0.0, y, step, tolerance)


@part
def settled(worst: float, before: float, tolerance: float, points: Any) -> bool:
    """Whether a residual of the constraints is as small as asked for, as round-off, or as contradictions let it be."""
    if worst <= tolerance or worst <= _ROUND_OFF * _reach(points):
        return True
    return worst <= _CONTRADICTION and worst > 0.5 * before


@part
def _reach(points: Any) -> float:
    """The largest coordinate [m or rad] of a station: differences of places are no better than its round-off."""
    reach = 0.0
    for k in range(points.size):
        p = points[k]
        reach = max(reach, max(abs(p.x), max(abs(p.y), abs(p.angle))))
    return reach


@part
def _correct(sys: Any, work: Any, step: np.ndarray) -> int:
    """Solve with no forces but those of the constraints."""
    clear_forces(work.frames, work.rows)
    work.f_eta[:] = 0.0
    return solve(sys, work, step)


@compiled
def energies(sys: Any, work: Any, q: np.ndarray, v: np.ndarray, z: np.ndarray) -> tuple[float, float, float]:
    """Kinetic, potential (gravity; zero at the world's origin) and elastic energy [J]; kinematics must be current."""
    kinetic, potential, elastic = 0.0, 0.0, 0.0
    gx, gy = sys.gravity[0], sys.gravity[1]
    for i in range(sys.bodies.size):
        b = sys.bodies[i]
        f = work.frames[i]
        for k in range(b.nf):
            eta, rate = q[b.first_q + k], v[b.first_q + k]
            kinetic += 0.5 * rate * rate
            elastic += 0.5 * sys.omega2[b.mode0 + k] * eta * eta
        sx, sy = f.c * f.mx - f.s * f.my, f.s * f.mx + f.c * f.my
        kinetic += 0.5 * b.mass * (f.vx**2 + f.vy**2) + 0.5 * f.J * f.w**2
        kinetic += f.w * (sx * f.vy - sy * f.vx)
        kinetic += f.dmy * (f.c * f.vy - f.s * f.vx) + f.dmx * (f.c * f.vx + f.s * f.vy)
        if b.nf > 0:
            kinetic += work.rows[b.row0 + 1].rate * f.w
        potential -= gx * (b.mass * f.x + sx) + gy * (b.mass * f.y + sy)
    for k in range(sys.springs.size):
        spring = sys.springs[k]
        path = work.lengths[spring.pathway]
        _, _, _, stored, _ = law(spring, sys.curves, path.value, path.rate)
        elastic += stored
    return kinetic, potential, elastic
