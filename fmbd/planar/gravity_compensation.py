"""Joint torques that hold the rigid mechanism against gravity in the present configuration.

The beams are taken as straight, the joint coordinates as they are; with Q the generalised gravity force on the
joint coordinates, the torques tau and the multipliers solve, in the least-squares sense,
    sum_m tau_m J_m^T + sum_c lambda_c Phi_c^T = -Q
(for the five-bar: G = g_a - Phi_a^T Phi_p^-T g_p on the active joints).
"""

from typing import Any

import numpy as np

from fmbd.planar.compile import inner, part
from fmbd.planar.kinematics import kinematics
from fmbd.planar.pathways import pathways
from fmbd.planar.recursion import joint_direction


@inner
def compensate_gravity(sys: Any, work: Any, q: np.ndarray) -> None:
    """Fill work.compensation (motors,) with joint torques; overwrites the kinematics in `work`."""
    for k in range(sys.nq):
        work.rigid_q[k] = q[k]
    for i in range(sys.bodies.size):
        b = sys.bodies[i]
        for k in range(b.first_q, b.first_q + b.nf):
            work.rigid_q[k] = 0.0
    kinematics(sys, work, work.rigid_q, work.rigid_v)
    pathways(sys, work)
    n = sys.motors.size + sys.held.size
    A = work.holding
    for c in range(n):
        work.wrench[:] = 0.0
        index = (
            sys.motors[c].joint_pathway
            if c < sys.motors.size
            else sys.constraints[sys.held[c - sys.motors.size]].pathway
        )
        _add_pathway(sys.pathways[index], sys.terms, work.geometry, sys.stations, work.points, work.wrench)
        _project(sys.bodies, work.frames, work.wrench, A[:, c])
    work.wrench[:] = 0.0
    gx, gy = sys.gravity[0], sys.gravity[1]
    for i in range(sys.bodies.size):
        b, f = sys.bodies[i], work.frames[i]
        x = b.mass * f.x + f.c * b.mx - f.s * b.my
        y = b.mass * f.y + f.s * b.mx + f.c * b.my
        work.wrench[i, 0], work.wrench[i, 1], work.wrench[i, 2] = b.mass * gx, b.mass * gy, x * gy - y * gx
    _project(sys.bodies, work.frames, work.wrench, A[:, n])
    _least_squares(A, n, work.normal)
    for m in range(sys.motors.size):
        work.drives[m].compensation = -work.normal[m, n]


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
        if b.rotor == 1:
            continue
        for d in range(3):
            if b.coordinate[d] >= 0:
                sx, sy, sz = joint_direction(b, f, d)
                out[row] = sx * fx + sy * fy + sz * (moment - f.px * fy + f.py * fx)
                row += 1


@part
def _least_squares(A: np.ndarray, n: int, normal: np.ndarray) -> None:
    """Solve A[:, :n] x = A[:, n] by normal equations; x is left in normal[:, n], 0 for dependent columns."""
    for r in range(n):
        for c in range(n + 1):
            total = 0.0
            for k in range(A.shape[0]):
                total += A[k, r] * A[k, c]
            normal[r, c] = total
    for k in range(n):
        scale = 0.0
        for j in range(A.shape[0]):
            scale += A[j, k] * A[j, k]
        if normal[k, k] <= 1e-13 * scale or scale == 0.0:
            normal[k, :] = 0.0
            continue
        pivot = normal[k, k]
        for c in range(n + 1):
            normal[k, c] /= pivot
        for r in range(n):
            if r != k:
                ratio = normal[r, k]
                for c in range(n + 1):
                    normal[r, c] -= ratio * normal[k, c]
