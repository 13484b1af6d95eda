"""Joint torques that hold the rigid mechanism against gravity in the present configuration.

The beams are taken as straight, the joint coordinates as they are; with Q the generalised gravity force on the
joint coordinates, the torques tau and the multipliers solve, in the least-squares sense,
    sum_m tau_m J_m^T + sum_c lambda_c Phi_c^T = -Q
(for the five-bar: G = g_a - Phi_a^T Phi_p^-T g_p on the active joints). Of all torques that do, the least are taken:
tau^T tau is smallest, whichever joints are cut.

    A      rows J_m, Phi_c, Q; the rows Phi_c become orthonormal, the others lose what lies along these
    V      mixes the motors so that the rows V J are at right angles: one-sided Jacobi rotations, which make the
           singular value decomposition of J
Source: Golub, Van Loan, Matrix Computations, section 8.6.
"""

from math import copysign, sqrt
from typing import Any

import numpy as np

from fmbd.planar.compile import inner, part
from fmbd.planar.kinematics import kinematics
from fmbd.planar.pathways import pathways
from fmbd.planar.recursion import joint_direction

#: A row of which others, or the constraints, leave less than this share of the longest row counts as dependent.
DEPENDENT = 1e-9


@inner
def compensate_gravity(sys: Any, work: Any, q: np.ndarray) -> None:
    """Fill work.compensation (motors,) with joint torques; overwrites the kinematics in `work`."""
    for k in range(sys.nq):
        work.rigid_q[k] = q[k]
    for i in range(sys.bodies.size):
        b = sys.bodies[i]
        for k in range(b.first_q, b.first_q + b.nf):
            work.rigid_q[k] = 0.0
        if b.seam == 1 and b.coordinate[0] >= 0:
            work.rigid_q[b.coordinate[0]] = 0.0
    kinematics(sys, work, work.rigid_q, work.rigid_v)
    pathways(sys, work)
    m = sys.motors.size
    n = m + sys.held.size
    A = work.holding
    for c in range(n):
        work.wrench[:] = 0.0
        index = sys.motors[c].joint_pathway if c < m else sys.constraints[sys.held[c - m]].pathway
        _add_pathway(sys.pathways[index], sys.terms, work.geometry, sys.stations, work.points, work.wrench)
        _project(sys.bodies, work.frames, work.wrench, A[c])
    work.wrench[:] = 0.0
    gx, gy = sys.gravity[0], sys.gravity[1]
    for i in range(sys.bodies.size):
        b, f = sys.bodies[i], work.frames[i]
        x = b.mass * f.x + f.c * b.mx - f.s * b.my
        y = b.mass * f.y + f.s * b.mx + f.c * b.my
        work.wrench[i, 0], work.wrench[i, 1], work.wrench[i, 2] = b.mass * gx, b.mass * gy, x * gy - y * gx
    _project(sys.bodies, work.frames, work.wrench, A[n])
    _least_torques(A, m, work.mix, work.drives)


@part
def _add_pathway(
    path: Any, terms: Any, geometry: Any, stations: Any, points: Any, wrench: np.ndarray
) -> None:
    """Wrenches of a unit force along a pathway, about the world's origin."""
    for j in range(path.term0, path.term0 + path.nterm):
        term, g = terms[j], geometry[j]
        for end in range(2):
            station = term.b if end == 0 else term.a
            sign = term.coefficient if end == 0 else -term.coefficient
            body = stations[station].body
            if body < 0:
                continue
            at = points[station]
            wrench[body, 0] += sign * g.nx
            wrench[body, 1] += sign * g.ny
            wrench[body, 2] += sign * (at.x * g.ny - at.y * g.nx)
            wrench[body, 2] += term.coefficient * (g.mb if end == 0 else g.ma)


@part
def _project(bodies: Any, frames: Any, wrench: np.ndarray, out: np.ndarray) -> None:
    """Generalised forces on the joint coordinates (rotors left out) from the wrenches on all bodies."""
    row = 0
    for i in range(bodies.size - 1, -1, -1):
        b, f = bodies[i], frames[i]
        fx, fy, moment = wrench[i, 0], wrench[i, 1], wrench[i, 2]
        if b.parent >= 0:
            wrench[b.parent, 0] += fx
            wrench[b.parent, 1] += fy
            wrench[b.parent, 2] += moment
        if b.rotor == 1 or b.seam == 1:
            continue
        for d in range(3):
            if b.coordinate[d] >= 0:
                sx, sy, sz = joint_direction(b, f, d)
                out[row] = sx * fx + sy * fy + sz * (moment - f.px * fy + f.py * fx)
                row += 1


@part
def _least_torques(A: np.ndarray, m: int, V: np.ndarray, drives: Any) -> None:
    """Solve for the torques of m motors; overwrites A and V."""
    n = A.shape[0] - 1
    longest = 0.0
    for c in range(n):
        longest = max(longest, sqrt(_dot(A[c], A[c])))
    _take_out(A, m, n, DEPENDENT * longest)
    _mix(A, m, V)
    for k in range(m):
        drives[k].compensation = 0.0
    for j in range(m):
        size = _dot(A[j], A[j])
        if size > (DEPENDENT * longest) ** 2:
            share = _dot(A[j], A[n]) / size
            for k in range(m):
                drives[k].compensation -= V[j, k] * share


@part
def _take_out(A: np.ndarray, first: int, last: int, shortest: float) -> None:
    """Make rows first to last orthonormal (zero if others leave too little), the other rows orthogonal to them."""
    for c in range(first, last):
        for _ in range(2):  # once more for round-off
            for e in range(first, c):
                _add(-_dot(A[e], A[c]), A[e], A[c])
        size = sqrt(_dot(A[c], A[c]))
        scale = 1.0 / size if size > shortest else 0.0
        for k in range(A.shape[1]):
            A[c, k] *= scale
    for c in range(A.shape[0]):
        if c < first or c >= last:
            for e in range(first, last):
                _add(-_dot(A[e], A[c]), A[e], A[c])


@part
def _mix(A: np.ndarray, n: int, V: np.ndarray) -> None:
    """Turn the first n rows of A by pairs, and the unit rows V with them, until they are at right angles."""
    for i in range(n):
        for k in range(n):
            V[i, k] = 1.0 if i == k else 0.0
    turning = True
    sweeps = 0
    while turning and sweeps < 30:
        turning = False
        sweeps += 1
        for i in range(n):
            for j in range(i + 1, n):
                ii, ij, jj = _dot(A[i], A[i]), _dot(A[i], A[j]), _dot(A[j], A[j])
                if abs(ij) <= 1e-14 * sqrt(ii * jj):
                    continue
                turning = True
                half = (jj - ii) / (2.0 * ij)
                tangent = copysign(1.0, half) / (abs(half) + sqrt(1.0 + half * half))
                c = 1.0 / sqrt(1.0 + tangent * tangent)
                _turn(c, c * tangent, A[i], A[j])
                _turn(c, c * tangent, V[i], V[j])


@part
def _turn(c: float, s: float, x: np.ndarray, y: np.ndarray) -> None:
    """x, y <- c x - s y, s x + c y."""
    for k in range(x.size):
        x[k], y[k] = c * x[k] - s * y[k], s * x[k] + c * y[k]


@part
def _dot(x: np.ndarray, y: np.ndarray) -> float:
    total = 0.0
    for k in range(x.size):
        total += x[k] * y[k]
    return total


@part
def _add(factor: float, x: np.ndarray, y: np.ndarray) -> None:
    """y += factor x."""
    for k in range(x.size):
        y[k] += factor * x[k]
