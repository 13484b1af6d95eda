"""The linear solve M(q) q'' - Phi_q^T lambda = f, Phi_q q'' = target, in O(bodies + modes).

Articulated-body recursion (Featherstone, Rigid Body Dynamics Algorithms; Brandl, Johanni and Otter for the loops)
with the elastic coordinates eliminated body by body. Towards the ground, each body in turn
  1. has its modes eliminated (condensation.py) and what hangs on them taken in (hanging.py, holding.py)
  2. eliminates the multipliers of the loops that close at it (loops.py)
  3. eliminates its joint's coordinates, one scalar at a time, and hands what is left to its parent.
Then outwards, everything is put back in the reverse order.

    a            linear part of the acceleration of a body's inner station (its bias lies in the forces)
    H, g         articulated inertia and wrench (3 x 3 symmetric, 3): H a = g + reaction
    V, N, free   y of a flexible body's rows per unit of a, per unit of a force on them, and at zero (condensation.py)
    y            R eta'', acceleration of the rows
    U, D, u      per joint direction s: U = H s, D = s.U (kept as 1 / D), u = s.g (for a slot: its own u)
"""

from typing import Any

import numpy as np

from fmbd.planar.compile import part
from fmbd.planar.condensation import eliminate_modes, free_rows, put_back_modes, put_back_rows
from fmbd.planar.hanging import hang_on_rows, put_back_hung
from fmbd.planar.holding import hold_by_rows, let_go_of_rows
from fmbd.planar.kinematics import station_row
from fmbd.planar.loops import add_rank_one, close_loops, constraint_columns, hand_down, open_loops


@part
def solve(sys: Any, work: Any, qdd: np.ndarray) -> int:
    """Fill qdd (nq,) and the multipliers from the forces and targets in `work`.

    Returns -1, or the index of the body whose joint has no inertia to move.
    """
    frames, rows, slots, block = work.frames, work.rows, work.slots, work.block
    slot_y, slot_v, reactions = work.slot_y, work.slot_v, work.reactions
    _clear_slots(slots, slot_y, block)
    for c in range(sys.constraints.size):
        path = sys.pathways[sys.constraints[c].pathway]
        constraint_columns(path, sys.terms, work.geometry, sys.stations, work.points, frames, slots, slot_y)
    for i in range(sys.bodies.size):
        b = sys.bodies[i]
        _start(b, frames[i])
        if b.nf > 0:
            free_rows(b, work.R, work.f_eta, rows)
            N = work.N if b.first_hung >= 0 else work.gram
            eliminate_modes(b, frames[i], rows, work.gram, N, slots, slot_y, slot_v, block)
    for i in range(sys.bodies.size - 1, -1, -1):
        b, f = sys.bodies[i], frames[i]
        if b.rotor == 1 and b.parent < 0 and b.nslot == 0:
            # a rotor on the ground meets nothing but the torques on it
            qdd[b.coordinate[2]] = f.gz / b.J
            continue
        if b.hold >= 0:
            inner = sys.stations[b.inner]
            N = work.N if b.first_hung >= 0 else work.gram
            hold_by_rows(b, f, work.holds[b.hold], inner, rows, N, slots, slot_v, block)
        else:
            _shift_to_joint(b, f, slots)
        n = b.nslot
        close_loops(f, True, slots, block, sys.constraints, reactions, b.slot0, n, b.closed, b.block0, n, n)
        if not _eliminate_joint(b, f, slots, block):
            return i
        if b.parent >= 0:
            parent, p = sys.bodies[b.parent], frames[b.parent]
            if b.hang >= 0:
                hang_on_rows(
                    i,
                    b,
                    f,
                    parent,
                    p,
                    work.hangs[b.hang],
                    sys.stations[b.outer],
                    work.points[b.outer],
                    rows,
                    work.N,
                    slots,
                    slot_v,
                    block,
                    work.hang_w,
                    work.hang_slot,
                )
            else:
                _load_parent(b, f, p, slots)
            hand_down(b, slots, block, parent.slot0, parent.block0, parent.nslot)
        else:
            hand_down(b, slots, block, sys.ground_slot0, sys.ground_base, sys.ground_stride)
    n = slots.size - sys.ground_slot0
    if n > 0:
        slot0, base, stride, band = sys.ground_slot0, sys.ground_base, sys.ground_stride, sys.ground_band
        close_loops(
            frames[0], False, slots, block, sys.constraints, reactions, slot0, n, n, base, stride, band
        )
        open_loops(slots, block, reactions, slot0, n, n, base, stride, band, 0.0, 0.0, 0.0)
    for i in range(sys.bodies.size):
        b, f = sys.bodies[i], frames[i]
        if b.rotor == 1 and b.parent < 0 and b.nslot == 0:
            continue
        ax, ay, aw = 0.0, 0.0, 0.0
        if b.parent >= 0:
            ax, ay, aw = outer_acceleration(
                f, frames[b.parent], sys.stations[b.outer], work.points[b.outer], rows
            )
        if b.hold >= 0:
            fx, fy, moment = joint_reaction(b, f, slots, reactions, ax, ay, aw)
        ax, ay, aw = _put_back_joint(b, f, slots, reactions, ax, ay, aw, qdd)
        n = b.nslot
        open_loops(slots, block, reactions, b.slot0, n, b.closed, b.block0, n, n, ax, ay, aw)
        rx, ry = f.px - f.x, f.py - f.y
        f.ax, f.ay, f.aw = ax + ry * aw, ay - rx * aw, aw
        if b.nf > 0:
            if b.hold >= 0:
                inner = sys.stations[b.inner]
                N = work.N if b.first_hung >= 0 else work.gram
                let_go_of_rows(b, f, work.holds[b.hold], inner, rows, N, slots, reactions, fx, fy, moment)
            j = b.first_hung
            while j >= 0:
                child = sys.bodies[j]
                put_back_hung(
                    child,
                    work.hangs[child.hang],
                    b,
                    f,
                    sys.stations[child.outer],
                    rows,
                    slots,
                    reactions,
                    work.hang_w,
                    work.hang_slot,
                )
                j = child.next_hung
            put_back_rows(b, f, rows, slots, slot_y, slot_v, reactions)
            put_back_modes(b, work.R, work.f_eta, rows, qdd)
    return -1


@part
def _start(b: Any, f: Any) -> None:
    """A body's own inertia about its frame's origin."""
    f.Hxx, f.Hxy, f.Hyy, f.Hzz = b.mass, 0.0, b.mass, f.J
    f.Hxz = -(f.s * f.mx + f.c * f.my)
    f.Hyz = f.c * f.mx - f.s * f.my


@part
def _clear_slots(slots: Any, slot_y: np.ndarray, block: np.ndarray) -> None:
    for k in range(slots.size):
        slot = slots[k]
        slot.gx, slot.gy, slot.gz, slot.rhs = 0.0, 0.0, 0.0, 0.0
    slot_y[:] = 0.0
    block[:] = 0.0


@part
def _shift_to_joint(b: Any, f: Any, slots: Any) -> None:
    """Move H, g and the slots from the frame's origin to the inner station at r: a_frame = a - alpha x r."""
    rx, ry = f.px - f.x, f.py - f.y
    f.Hzz += ry * (2.0 * f.Hxz + ry * f.Hxx) - rx * (2.0 * f.Hyz - rx * f.Hyy + 2.0 * ry * f.Hxy)
    f.Hxz += ry * f.Hxx - rx * f.Hxy
    f.Hyz += ry * f.Hxy - rx * f.Hyy
    f.gz += ry * f.gx - rx * f.gy
    for k in range(b.slot0, b.slot0 + b.nslot):
        s = slots[k]
        s.gz += ry * s.gx - rx * s.gy


@part
def joint_direction(b: Any, f: Any, d: int) -> tuple[float, float, float]:
    """How the inner station moves per unit rate of the joint's x (0), y (1) or angle (2)."""
    if d == 0:
        return b.sign * f.jc, b.sign * f.js, 0.0
    if d == 1:
        return -b.sign * f.js, b.sign * f.jc, 0.0
    if b.sign > 0.0:
        return 0.0, 0.0, 1.0
    # the axes of a reversed joint turn with this body
    return -f.uy, f.ux, -1.0


@part
def _times(f: Any, x: float, y: float, z: float) -> tuple[float, float, float]:
    """H (x, y, z)."""
    return (
        f.Hxx * x + f.Hxy * y + f.Hxz * z,
        f.Hxy * x + f.Hyy * y + f.Hyz * z,
        f.Hxz * x + f.Hyz * y + f.Hzz * z,
    )


@part
def _eliminate_joint(b: Any, f: Any, slots: Any, block: np.ndarray) -> bool:
    """Deflate H, g and the open slots along each free direction; False if one has no inertia."""
    least = 1e-14 * (f.Hxx + f.Hyy + f.Hzz)
    f.scale[0], f.scale[1], f.scale[2] = f.Hxx, f.Hyy, f.Hzz
    for d in range(3):
        if b.coordinate[d] < 0:
            continue
        sx, sy, sz = joint_direction(b, f, d)
        if b.sliding == 0:
            hx, hy, hz, u = b.sign * f.Hxz, b.sign * f.Hyz, b.sign * f.Hzz, b.sign * f.gz
            D = f.Hzz
        else:
            hx, hy, hz = _times(f, sx, sy, sz)
            D = sx * hx + sy * hy + sz * hz
            u = sx * f.gx + sy * f.gy + sz * f.gz
        if not least < D:
            return False
        per_D = 1.0 / D
        f.U[d, 0], f.U[d, 1], f.U[d, 2] = hx, hy, hz
        f.per_D[d], f.u[d] = per_D, u
        add_rank_one(f, -per_D, hx, hy, hz)
        u *= per_D
        f.gx -= hx * u
        f.gy -= hy * u
        f.gz -= hz * u
        for m in range(b.closed, b.nslot):
            s = slots[b.slot0 + m]
            us = sx * s.gx + sy * s.gy + sz * s.gz
            s.u[d] = us
            s.rhs -= us * u
            us *= per_D
            s.gx -= hx * us
            s.gy -= hy * us
            s.gz -= hz * us
            # the block is symmetric: row m against the slots seen so far
            for j in range(b.closed, m + 1):
                value = us * slots[b.slot0 + j].u[d]
                block[b.block0 + m * b.nslot + j] += value
                if j != m:
                    block[b.block0 + j * b.nslot + m] += value
    if b.coordinate[2] >= 0 and (b.sliding == 0 or b.sign > 0.0):
        # nothing is left along a free angle; said exactly, since a light parent would feel the round-off
        f.Hxz, f.Hyz, f.Hzz, f.gz = 0.0, 0.0, 0.0, 0.0
        for m in range(b.slot0 + b.closed, b.slot0 + b.nslot):
            slots[m].gz = 0.0
    return True


@part
def _load_parent(b: Any, f: Any, p: Any, slots: Any) -> None:
    """Add what is left of H, g and the open slots at the joint to the frame p of the parent."""
    rx, ry = f.px - p.x, f.py - p.y
    p.Hxx += f.Hxx
    p.Hxy += f.Hxy
    p.Hyy += f.Hyy
    p.Hxz += f.Hxz - ry * f.Hxx + rx * f.Hxy
    p.Hyz += f.Hyz - ry * f.Hxy + rx * f.Hyy
    p.Hzz += f.Hzz - ry * (2.0 * f.Hxz - ry * f.Hxx) + rx * (2.0 * f.Hyz + rx * f.Hyy - 2.0 * ry * f.Hxy)
    p.gx += f.gx
    p.gy += f.gy
    p.gz += f.gz + rx * f.gy - ry * f.gx
    for m in range(b.slot0 + b.closed, b.slot0 + b.nslot):
        s = slots[m]
        t = slots[s.parent]
        t.gx += s.gx
        t.gy += s.gy
        t.gz += s.gz + rx * s.gy - ry * s.gx


@part
def _row_motion(f: Any, p: Any, at: Any, kind: int) -> tuple[float, float, float]:
    """Motion at the joint of body f of a unit of a row of the station `at` of its parent p, by kind of station_row."""
    if kind == 0:
        return -p.s, p.c, 0.0
    if kind == 1:
        return -(f.py - at.y), f.px - at.x, 1.0
    return p.c, p.s, 0.0


@part
def outer_acceleration(f: Any, p: Any, outer: Any, at: Any, rows: Any) -> tuple[float, float, float]:
    """Linear part of the acceleration that the parent p gives to the joint of body f, through its station `at`."""
    ax = p.ax - (f.py - p.y) * p.aw
    ay = p.ay + (f.px - p.x) * p.aw
    aw = p.aw
    for kind in range(3):
        row = station_row(outer, kind)
        if row >= 0:
            cx, cy, cz = _row_motion(f, p, at, kind)
            ax += cx * rows[row].y
            ay += cy * rows[row].y
            aw += cz * rows[row].y
    return ax, ay, aw


@part
def joint_reaction(
    b: Any, f: Any, slots: Any, reactions: Any, ax: float, ay: float, aw: float
) -> tuple[float, float, float]:
    """Wrench that its tree joint puts on a body at the inner station, which without the joint would accelerate by a."""
    fx = f.Hxx * ax + f.Hxy * ay + f.Hxz * aw - f.gx
    fy = f.Hxy * ax + f.Hyy * ay + f.Hyz * aw - f.gy
    moment = f.Hxz * ax + f.Hyz * ay + f.Hzz * aw - f.gz
    for m in range(b.slot0 + b.closed, b.slot0 + b.nslot):
        s = slots[m]
        multiplier = reactions[s.constraint].multiplier
        fx -= s.gx * multiplier
        fy -= s.gy * multiplier
        moment -= s.gz * multiplier
    return fx, fy, moment


@part
def _put_back_joint(
    b: Any, f: Any, slots: Any, reactions: Any, ax: float, ay: float, aw: float, qdd: np.ndarray
) -> tuple[float, float, float]:
    """Joint accelerations, last eliminated first; returns the acceleration of the inner station."""
    for d in range(2, -1, -1):
        if b.coordinate[d] < 0:
            continue
        sx, sy, sz = joint_direction(b, f, d)
        value = f.u[d] - f.U[d, 0] * ax - f.U[d, 1] * ay - f.U[d, 2] * aw
        for m in range(b.slot0 + b.closed, b.slot0 + b.nslot):
            value += slots[m].u[d] * reactions[slots[m].constraint].multiplier
        value *= f.per_D[d]
        qdd[b.coordinate[d]] = value
        ax += sx * value
        ay += sy * value
        aw += sz * value
    return ax, ay, aw
