"""A body that hangs on rows of a flexible one: its articulated inertia taken in, one scalar at a time.

What is left of the child at the joint, H = sum_k d_k l_k l_k^T and g = sum_k gamma_k l_k, resists the acceleration
l_k . a_c of the joint with the force phi_k = gamma_k - d_k l_k . a_c along l_k. The parent's rows give way to it:
    l_k . a_c = x . a + c + p phi_k,    w = N B^T l_k,  p = (B^T l_k) . w,  x = A^T l_k + V^T B^T l_k
with A and B the motion of the joint per unit of the parent's frame and rows. Hence phi_k = (gamma_k - d_k (c + x . a))
/ (1 + d_k p), and H, g, V, free, N of the parent follow by rank-one changes. H of the parent only grows: a heavy body
on a light beam would otherwise be the difference of large numbers.
"""

from typing import Any

import numpy as np

from fmbd.planar.compile import index, part
from fmbd.planar.kinematics import station_row
from fmbd.planar.loops import add_rank_one

# A pivot of H this small against its diagonal before the joint was eliminated is round-off of zero.
_ROUND_OFF = 1e-13


@part
def hang_on_rows(
    i: int,
    b: Any,
    f: Any,
    parent: Any,
    p: Any,
    hang: Any,
    outer: Any,
    at: Any,
    rows: Any,
    N: np.ndarray,
    slots: Any,
    slot_v: np.ndarray,
    block: np.ndarray,
    hang_w: np.ndarray,
    hang_slot: np.ndarray,
) -> None:
    """Take the child b, body i, into the frame p, rows and slots of its parent."""
    L, g = hang.L, hang.g
    L[0, 0], L[1, 0], L[2, 0] = f.Hxx, f.Hxy, f.Hxz
    L[1, 1], L[2, 1], L[2, 2] = f.Hyy, f.Hyz, f.Hzz
    g[0], g[1], g[2] = f.gx, f.gy, f.gz
    for m in range(parent.slot0, parent.slot0 + parent.nslot):
        slots[m].hung[0], slots[m].hung[1], slots[m].hung[2] = 0.0, 0.0, 0.0
    for m in range(b.slot0 + b.closed, b.slot0 + b.nslot):
        hung = slots[slots[m].parent].hung
        hung[0], hung[1], hung[2] = slots[m].gx, slots[m].gy, slots[m].gz
    for k in range(3):
        hang.d[k] = _next_pivot(L, f.scale, k)
        for j in range(k + 1, 3):
            g[j] -= L[j, k] * g[k]
        for m in range(b.slot0 + b.closed, b.slot0 + b.nslot):
            hung = slots[slots[m].parent].hung
            for j in range(k + 1, 3):
                hung[j] -= L[j, k] * hung[k]
        hang.idle[k] = 1 if hang.d[k] == 0.0 and g[k] == 0.0 and parent.nslot == 0 else 0
    rx, ry = f.px - p.x, f.py - p.y
    # N is not needed after the last of what hangs on the parent
    more = parent.hold >= 0 or i != parent.first_hung
    for k in range(3):
        if hang.idle[k] == 1:
            continue
        lx = 1.0 if k == 0 else 0.0
        ly = 1.0 if k == 1 else (L[1, 0] if k == 0 else 0.0)
        lz = 1.0 if k == 2 else L[2, k]
        hang.b[k, 0] = p.c * ly - p.s * lx if outer.row_w >= 0 else 0.0
        hang.b[k, 1] = (f.px - at.x) * ly - (f.py - at.y) * lx + lz if outer.row_s >= 0 else 0.0
        hang.b[k, 2] = p.c * lx + p.s * ly if outer.row_u >= 0 else 0.0
        hang.x[k, 0], hang.x[k, 1], hang.x[k, 2] = lx, ly, rx * ly - ry * lx + lz
        last = k == 2 or (hang.idle[2] == 1 and (k == 1 or hang.idle[1] == 1))
        keep = more or not last
        _take_in(b, parent, p, hang, k, outer, rows, N, slots, slot_v, block, hang_w, hang_slot, keep)


@part
def _next_pivot(L: np.ndarray, scale: np.ndarray, k: int) -> float:
    """d_k of H = L D L^T, whose lower triangle is in L; column k becomes that of L."""
    d = L[k, k]
    if not d > _ROUND_OFF * scale[k]:
        for j in range(k + 1, 3):
            L[j, k] = 0.0
        return 0.0
    for j in range(k + 1, 3):
        for i in range(k + 1, j + 1):
            L[j, i] -= L[j, k] * L[i, k] / d
    for j in range(k + 1, 3):
        L[j, k] /= d
    return d


@part
def _take_in(
    b: Any,
    parent: Any,
    p: Any,
    hang: Any,
    k: int,
    outer: Any,
    rows: Any,
    N: np.ndarray,
    slots: Any,
    slot_v: np.ndarray,
    block: np.ndarray,
    hang_w: np.ndarray,
    hang_slot: np.ndarray,
    keep: bool,
) -> None:
    """One scalar d_k along l_k; N is left as it was unless it is to be kept."""
    n = index(parent.nrow)
    d, gamma = hang.d[k], hang.g[k]
    w0, row0, gram0 = index(b.hang_w0 + k * parent.nrow), index(parent.row0), index(parent.gram0)
    x, y, z = hang.x[k, 0], hang.x[k, 1], hang.x[k, 2]
    c, give = 0.0, 0.0
    for kind in range(3):
        at = station_row(outer, kind)
        if at >= 0:
            weight = hang.b[k, kind]
            row = rows[at]
            x += weight * row.Vx
            y += weight * row.Vy
            z += weight * row.Vz
            c += weight * row.free
            column = index(parent.gram0 + (at - parent.row0) * parent.nrow)
            for other in range(kind + 1):
                beside = station_row(outer, other)
                if beside >= 0:
                    twice = 1.0 if other == kind else 2.0
                    give += twice * weight * hang.b[k, other] * N[column + index(beside) - row0]
    across, slope, along = hang.b[k, 0], hang.b[k, 1], hang.b[k, 2]
    at_w, at_s, at_u = (
        _column(outer.row_w, parent),
        _column(outer.row_s, parent),
        _column(outer.row_u, parent),
    )
    for r in range(n):
        # a row that the station does not have weighs nothing
        hang_w[w0 + r] = across * N[at_w + r] + slope * N[at_s + r] + along * N[at_u + r]
    share = 1.0 / (1.0 + d * give)
    phi = (gamma - d * c) * share
    hang.x[k, 0], hang.x[k, 1], hang.x[k, 2] = x, y, z
    hang.inertance[k], hang.phi[k] = d * share, phi
    add_rank_one(p, d * share, x, y, z)
    p.gx += x * phi
    p.gy += y * phi
    p.gz += z * phi
    accelerated = (c + give * gamma) * share
    _take_in_slots(
        b, parent, hang, k, outer, slots, slot_v, block, hang_w, hang_slot, phi, accelerated, give, share
    )
    for r in range(n):
        row = rows[row0 + r]
        w = hang_w[w0 + r]
        row.free += w * phi
        w *= d * share
        row.Vx -= w * x
        row.Vy -= w * y
        row.Vz -= w * z
        if keep:
            start = gram0 + r * n
            for j in range(n):
                N[start + j] -= w * hang_w[w0 + j]


@part
def _column(row: int, parent: Any) -> Any:
    """Where the column of a row begins in N; that of the first row for a row that is not there."""
    return index(parent.gram0 + max(row - parent.row0, 0) * parent.nrow)


@part
def _take_in_slots(
    b: Any,
    parent: Any,
    hang: Any,
    k: int,
    outer: Any,
    slots: Any,
    slot_v: np.ndarray,
    block: np.ndarray,
    hang_w: np.ndarray,
    hang_slot: np.ndarray,
    phi: float,
    accelerated: float,
    give: float,
    share: float,
) -> None:
    """The same for each column of Phi_q^T: gamma and c are its own, in slots[].hung[k] and slots[].moved."""
    d, n = hang.d[k], parent.nrow
    w0 = b.hang_w0 + k * n
    for m in range(parent.nslot):
        s = slots[parent.slot0 + m]
        s.moved = 0.0
        for kind in range(3):
            row = station_row(outer, kind)
            if row >= 0:
                s.moved += hang.b[k, kind] * slot_v[s.row0 + row - parent.row0]
        for j in range(m + 1):
            t = slots[parent.slot0 + j]
            value = give * s.hung[k] * t.hung[k] + s.hung[k] * t.moved + s.moved * t.hung[k]
            value = share * (value - d * s.moved * t.moved)
            block[parent.block0 + m * parent.nslot + j] += value
            if j != m:
                block[parent.block0 + j * parent.nslot + m] += value
    for m in range(parent.nslot):
        s = slots[parent.slot0 + m]
        own = (s.hung[k] - d * s.moved) * share
        hang_slot[b.hang_s0 + k * parent.nslot + m] = own
        s.gx += hang.x[k, 0] * own
        s.gy += hang.x[k, 1] * own
        s.gz += hang.x[k, 2] * own
        s.rhs -= s.hung[k] * accelerated + s.moved * phi
        for r in range(n):
            slot_v[s.row0 + r] += hang_w[w0 + r] * own


@part
def put_back_hung(
    b: Any,
    hang: Any,
    parent: Any,
    p: Any,
    outer: Any,
    rows: Any,
    slots: Any,
    reactions: Any,
    hang_w: np.ndarray,
    hang_slot: np.ndarray,
) -> None:
    """The forces of the child b on the rows of its parent, last taken in first, into rows[].push."""
    n = parent.nrow
    for k in range(2, -1, -1):
        if hang.idle[k] == 1:
            continue
        yielding = hang.x[k, 0] * p.ax + hang.x[k, 1] * p.ay + hang.x[k, 2] * p.aw
        for r in range(n):
            yielding += hang_w[b.hang_w0 + k * n + r] * rows[parent.row0 + r].push
        phi = hang.phi[k] - hang.inertance[k] * yielding
        for m in range(parent.nslot):
            multiplier = reactions[slots[parent.slot0 + m].constraint].multiplier
            phi += hang_slot[b.hang_s0 + k * parent.nslot + m] * multiplier
        for kind in range(3):
            row = station_row(outer, kind)
            if row >= 0:
                rows[row].push += hang.b[k, kind] * phi
