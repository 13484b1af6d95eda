"""How far a motion is from obeying the equations of motion: inverse dynamics, in O(bodies + modes).

    r = f + Phi_q^T lambda - M q''      at q, q', q'' and lambda that need not belong together
Outwards: the linear part a of each frame's acceleration, from q''. Inwards: the wrench that a body's motion asks of
its joint (Newton and Euler), which is taken from the body that carries it.
Symbols as in recursion.py. `work` is left as `accelerations` leaves it at a motion that does obey, so that the
equations can be linearised there: the wrench in a joint is found in g, with no inertia beside it.
"""

from typing import Any

import numpy as np

from fmbd.planar.compile import compiled, index, inner, part, part_sums
from fmbd.planar.equations import driving_power, forces_of_state
from fmbd.planar.pathways import put_force
from fmbd.planar.recursion import joint_direction, outer_acceleration


@inner
def residual(
    sys: Any,
    work: Any,
    t: float,
    q: np.ndarray,
    v: np.ndarray,
    z: np.ndarray,
    dz: np.ndarray,
    qdd: np.ndarray,
    r: np.ndarray,
) -> tuple[float, float]:
    """r (nq,) and z' (nz,) at time t for q'' = qdd (nq,) and the multipliers in `work`.

    Returns the power dissipated and the power put in [W].
    """
    dissipated, power = forces_of_state(sys, work, t, q, v, z, dz)
    for c in range(sys.constraints.size):
        path = sys.pathways[sys.constraints[c].pathway]
        multiplier = work.reactions[c].multiplier
        put_force(
            path, sys.terms, work.geometry, sys.stations, work.points, work.frames, work.rows, multiplier
        )
    for i in range(sys.bodies.size):
        _accelerate(sys.bodies[i], i, sys, work, qdd)
    for i in range(sys.bodies.size - 1, -1, -1):
        b, f = sys.bodies[i], work.frames[i]
        _ask_of_joint(b, f, sys.stations[b.inner], work.rows)
        for d in range(3):
            if b.coordinate[d] >= 0:
                sx, sy, sz = joint_direction(b, f, d)
                r[b.coordinate[d]] = sx * f.gx + sy * f.gy + sz * f.gz
        if b.nf > 0:
            _modal_residual(b, work.R, work.f_eta, work.rows, qdd, r)
        if b.parent >= 0:
            _take_from_parent(
                f, work.frames[b.parent], sys.stations[b.outer], work.points[b.outer], work.rows
            )
    for k in range(work.slots.size):
        slot = work.slots[k]
        slot.gx, slot.gy, slot.gz = 0.0, 0.0, 0.0
    return dissipated, power + driving_power(sys, work)


@part
def _accelerate(b: Any, i: int, sys: Any, work: Any, qdd: np.ndarray) -> None:
    """a of a body's frame and y of its rows."""
    f, rows, inner = work.frames[i], work.rows, sys.stations[b.inner]
    ax, ay, aw = 0.0, 0.0, 0.0
    if b.parent >= 0:
        ax, ay, aw = outer_acceleration(
            f, work.frames[b.parent], sys.stations[b.outer], work.points[b.outer], rows
        )
    for d in range(3):
        if b.coordinate[d] >= 0:
            sx, sy, sz = joint_direction(b, f, d)
            value = qdd[b.coordinate[d]]
            ax += sx * value
            ay += sy * value
            aw += sz * value
    if b.nf > 0:
        _row_accelerations(b, work.R, rows, qdd)
    if inner.row_s >= 0:
        aw -= rows[inner.row_s].y
    if inner.row_w >= 0:
        ax += f.s * rows[inner.row_w].y
        ay -= f.c * rows[inner.row_w].y
    if inner.row_u >= 0:
        ax -= f.c * rows[inner.row_u].y
        ay -= f.s * rows[inner.row_u].y
    rx, ry = f.px - f.x, f.py - f.y
    f.ax, f.ay, f.aw = ax + ry * aw, ay - rx * aw, aw


@part_sums
def _row_accelerations(b: Any, R: np.ndarray, rows: Any, qdd: np.ndarray) -> None:
    first = index(b.first_q)
    for i in range(b.nrow):
        start = index(b.matrix0 + i * b.nf)
        total = 0.0
        for k in range(index(b.nf)):
            total += R[start + k] * qdd[first + k]
        rows[b.row0 + i].y = total


@part
def _ask_of_joint(b: Any, f: Any, inner: Any, rows: Any) -> None:
    """g becomes minus the wrench that the body's motion asks of its joint, at the inner station."""
    if b.nf > 0:
        lateral, turning = rows[b.row0], rows[b.row0 + 1]
        f.gx += f.s * lateral.y
        f.gy -= f.c * lateral.y
        f.gz -= turning.y
        lateral.g -= f.c * f.ay - f.s * f.ax
        turning.g -= f.aw
        if b.axial >= 0:
            axial = rows[b.axial]
            f.gx -= f.c * axial.y
            f.gy -= f.s * axial.y
            axial.g -= f.c * f.ax + f.s * f.ay
    sx, sy = f.c * f.mx - f.s * f.my, f.s * f.mx + f.c * f.my
    f.gx -= b.mass * f.ax - sy * f.aw
    f.gy -= b.mass * f.ay + sx * f.aw
    f.gz -= sx * f.ay - sy * f.ax + f.J * f.aw
    f.gz -= (f.px - f.x) * f.gy - (f.py - f.y) * f.gx
    if inner.row_w >= 0:
        rows[inner.row_w].g -= f.c * f.gy - f.s * f.gx
    if inner.row_s >= 0:
        rows[inner.row_s].g -= f.gz
    if inner.row_u >= 0:
        rows[inner.row_u].g -= f.c * f.gx + f.s * f.gy
    f.Hxx, f.Hxy, f.Hxz, f.Hyy, f.Hyz, f.Hzz = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0


@part_sums
def _modal_residual(
    b: Any, R: np.ndarray, f_eta: np.ndarray, rows: Any, qdd: np.ndarray, r: np.ndarray
) -> None:
    """f_eta + R^T g - eta''."""
    first, mode0 = index(b.first_q), index(b.mode0)
    for k in range(index(b.nf)):
        r[first + k] = f_eta[mode0 + k] - qdd[first + k]
    for i in range(b.nrow):
        force, start = rows[b.row0 + i].g, index(b.matrix0 + i * b.nf)
        for k in range(index(b.nf)):
            r[first + k] += R[start + k] * force


@part
def _take_from_parent(f: Any, p: Any, outer: Any, at: Any, rows: Any) -> None:
    """What a body asks of its joint acts on its parent p, too, and on the rows of the station that carries it."""
    p.gx += f.gx
    p.gy += f.gy
    p.gz += f.gz + (f.px - p.x) * f.gy - (f.py - p.y) * f.gx
    if outer.row_w >= 0:
        rows[outer.row_w].g += p.c * f.gy - p.s * f.gx
    if outer.row_s >= 0:
        rows[outer.row_s].g += f.gz + (f.px - at.x) * f.gy - (f.py - at.y) * f.gx
    if outer.row_u >= 0:
        rows[outer.row_u].g += p.c * f.gx + p.s * f.gy


@compiled
def evaluate_residual(
    sys: Any,
    work: Any,
    t: float,
    q: np.ndarray,
    v: np.ndarray,
    z: np.ndarray,
    dz: np.ndarray,
    qdd: np.ndarray,
    r: np.ndarray,
) -> None:
    """`residual` for callers in Python."""
    residual(sys, work, t, q, v, z, dz, qdd, r)
