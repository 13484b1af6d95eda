"""Elimination at a joint of the linearised equations, and what it leaves of a body for the one that carries it.

Symbols as in tangent.py.
"""

from typing import Any

from fmbd.planar.compile import part


@part
def eliminate_joint(b: Any, f: Any, tb: Any, place: Any, tan: Any, bq: Any) -> bool:
    """Eliminate the joint's free coordinates; H, g, h are then about the outer station. False if nothing holds one."""
    if b.sliding == 0:
        return b.coordinate[2] < 0 or _eliminate_angle(b, tb, place, tan)
    _sliding_columns(b, tb, place, tan)
    _sliding_rows(b, f, tb, place, tan, bq)
    return _eliminate_coordinates(b, tb, place, tan)


@part
def _eliminate_angle(b: Any, tb: Any, place: Any, tan: Any) -> bool:
    """The one coordinate of a joint that only turns: theta of the body is sign x + theta of the outer station."""
    H = tb.H
    pivot = H[2, 0] + tb.own[2]
    if not abs(pivot) > 0.0:
        return False
    tb.per_D[2] = 1.0 / pivot
    for j in range(len(tan.width)):
        tb.U[2, j] = b.sign * H[2, j]
    for i in range(3):
        tb.ratio[2, i] = b.sign * H[i, 0] * tb.per_D[2]
    for k in range(place.slot0 + place.closed, place.slot0 + place.nslot):
        s = tan.shares[k]
        s.column[2] = b.sign * s.g[2]
        s.row[2] = b.sign * s.h[0] * tb.per_D[2]
    _deflate(2, tb, place, tan)
    return True


@part
def _sliding_columns(b: Any, tb: Any, place: Any, tan: Any) -> None:
    """Wrench (in tb.ratio for a while) and links' rows per unit of each coordinate; H, h take that outside."""
    H, reverse = tb.H, b.sign < 0.0
    for i in range(3):
        swung = H[i, 0] * 0.0
        for j in range(len(tan.width) - 1):
            swung += H[i, 1 + j] * tb.swing[j]
        for d in range(2):
            tb.ratio[d, i] = H[i, 0] * 0.0
            for j in range(len(tan.width) - 1):
                tb.ratio[d, i] += H[i, 1 + j] * tb.along[d, j]
        tb.ratio[2, i] = b.sign * (H[i, 0] + swung) if reverse else b.sign * H[i, 0]
        H[i, 0] += swung
    for k in range(place.slot0 + place.closed, place.slot0 + place.nslot):
        s = tan.shares[k]
        swung = s.h[0] * 0.0
        for j in range(len(tan.width) - 1):
            swung += s.h[1 + j] * tb.swing[j]
        for d in range(2):
            s.row[d] = s.h[0] * 0.0
            for j in range(len(tan.width) - 1):
                s.row[d] += s.h[1 + j] * tb.along[d, j]
        s.row[2] = b.sign * (s.h[0] + swung) if reverse else b.sign * s.h[0]
        s.h[0] += swung


@part
def _sliding_rows(b: Any, f: Any, tb: Any, place: Any, tan: Any, bq: Any) -> None:
    """U and V of the coordinates; wrenches move to the outer station."""
    H, U, V = tb.H, tb.U, tb.V
    x, y, fx, fy = tb.arm[0], tb.arm[1], tb.force[0], tb.force[1]
    first, last, reverse = place.slot0 + place.closed, place.slot0 + place.nslot, b.sign < 0.0
    lean = -bq * (x * fx + y * fy)
    # the angle of a joint whose axes stay behind, before the moment moves
    if not reverse:
        for j in range(len(tan.width)):
            U[2, j] = H[2, j]
        for d in range(3):
            V[2, d] = tb.ratio[d, 2]
        for k in range(first, last):
            tan.shares[k].column[2] = tan.shares[k].g[2]
    for j in range(len(tan.width)):
        H[2, j] += x * H[1, j] - y * H[0, j]
    H[2, 0] += lean
    for d in range(3):
        tb.ratio[d, 2] += x * tb.ratio[d, 1] - y * tb.ratio[d, 0]
    for k in range(first, last):
        s = tan.shares[k]
        s.g[2] += x * s.g[1] - y * s.g[0]
    if reverse:
        tb.ratio[2, 2] += b.sign * lean
    for d in range(2):
        px, py = b.sign * (f.jc if d == 0 else -f.js), b.sign * (f.js if d == 0 else f.jc)
        turn = bq * (px * fy - py * fx)
        tb.ratio[d, 2] += turn
        for j in range(len(tan.width)):
            U[d, j] = px * H[0, j] + py * H[1, j]
        U[d, 0] += turn
        for j in range(3):
            V[d, j] = px * tb.ratio[j, 0] + py * tb.ratio[j, 1]
        if reverse:
            V[d, 2] += b.sign * turn
        for k in range(first, last):
            s = tan.shares[k]
            s.column[d] = px * s.g[0] + py * s.g[1]
    if reverse:
        for j in range(len(tan.width)):
            U[2, j] = -H[2, j]
        for d in range(3):
            V[2, d] = -tb.ratio[d, 2]
        for k in range(first, last):
            tan.shares[k].column[2] = -tan.shares[k].g[2]


@part
def _eliminate_coordinates(b: Any, tb: Any, place: Any, tan: Any) -> bool:
    """The coordinates of a sliding joint, one after the other."""
    U, V = tb.U, tb.V
    first, last = place.slot0 + place.closed, place.slot0 + place.nslot
    for d in range(3):
        if b.coordinate[d] < 0:
            continue
        pivot = V[d, d] + tb.own[d]
        if not abs(pivot) > 0.0:
            return False
        tb.per_D[d] = 1.0 / pivot
        for i in range(3):
            tb.ratio[d, i] *= tb.per_D[d]
        for k in range(first, last):
            tan.shares[k].row[d] *= tb.per_D[d]
        for e in range(d + 1, 3):
            if b.coordinate[e] < 0:
                continue
            share = V[e, d] * tb.per_D[d]
            tb.Q[d, e] = share
            for j in range(len(tan.width)):
                U[e, j] -= share * U[d, j]
            for j in range(d + 1, 3):
                V[e, j] -= share * V[d, j]
            for k in range(first, last):
                tan.shares[k].column[e] -= share * tan.shares[k].column[d]
            for i in range(3):
                tb.ratio[e, i] -= tb.ratio[d, i] * V[d, e]
            for k in range(first, last):
                tan.shares[k].row[e] -= tan.shares[k].row[d] * V[d, e]
        _deflate(d, tb, place, tan)
    return True


@part
def _deflate(d: int, tb: Any, place: Any, tan: Any) -> None:
    """Subtract the row of coordinate d from the wrench and from the links."""
    for i in range(3):
        for j in range(len(tan.width)):
            tb.H[i, j] -= tb.ratio[d, i] * tb.U[d, j]
    for m in range(place.closed, place.nslot):
        s = tan.shares[place.slot0 + m]
        for i in range(3):
            s.g[i] -= tb.ratio[d, i] * s.column[d]
        for j in range(len(tan.width)):
            s.h[j] -= s.row[d] * tb.U[d, j]
        at = place.block0 + m * place.nslot
        for j in range(place.closed, place.nslot):
            tan.block[at + j] -= s.row[d] * tan.shares[place.slot0 + j].column[d]


@part
def load_parent(
    b: Any, tb: Any, parent: Any, f: Any, tp: Any, station: Any, cp: Any, tan: Any, bq: Any, place: Any
) -> None:
    """Add what is left at the joint to the parent, through the station of the parent that carries it."""
    up = cp.places[b.parent]
    r, turn, H = tan.relative[b.outer], tan.turn[b.outer], tb.H
    x, y, fx, fy = r[0], r[1], tb.force[0], tb.force[1]
    ahead = bq * (f.c * fx + f.s * fy)
    w = up.row0 + station.row_w - parent.row0
    s_row = up.row0 + station.row_s - parent.row0
    at_w = up.matrix0 + (station.row_w - parent.row0) * up.nr
    at_s = up.matrix0 + (station.row_s - parent.row0) * up.nr
    wi, si = station.row_w - parent.row0, station.row_s - parent.row0
    for j in range(len(tan.width)):
        lateral = f.c * H[1, j] - f.s * H[0, j]
        if station.row_w >= 0:
            tan.PX[w, j] += lateral
        if station.row_s >= 0:
            tan.PX[s_row, j] += H[2, j]
        tp.H[0, j] += H[0, j]
        tp.H[1, j] += H[1, j]
        tp.H[2, j] += H[2, j] + x * H[1, j] - y * H[0, j]
    swept0, swept1, swept2 = H[0, 0] * 0.0, H[0, 0] * 0.0, H[0, 0] * 0.0
    lifted0, lifted1, lifted2 = H[0, 0] * 0.0, H[0, 0] * 0.0, H[0, 0] * 0.0
    for j in range(len(tan.width) - 1):
        swept0 += H[0, 1 + j] * turn[j]
        swept1 += H[1, 1 + j] * turn[j]
        swept2 += H[2, 1 + j] * turn[j]
    tp.H[0, 0] += swept0
    tp.H[1, 0] += swept1
    tp.H[2, 0] += swept2 + x * swept1 - y * swept0 - bq * (x * fx + y * fy)
    if station.row_w >= 0:
        for j in range(len(tan.width) - 1):
            lifted0 += H[0, 1 + j] * tp.lift[j]
            lifted1 += H[1, 1 + j] * tp.lift[j]
            lifted2 += H[2, 1 + j] * tp.lift[j]
        tan.HY[w, 0] += lifted0
        tan.HY[w, 1] += lifted1
        tan.HY[w, 2] += lifted2 + x * lifted1 - y * lifted0 - ahead
        tan.PX[w, 0] += f.c * swept1 - f.s * swept0 - ahead
        tan.P[at_w + wi] += f.c * lifted1 - f.s * lifted0
    if station.row_s >= 0:
        tan.HY[s_row, 0] += H[0, 0]
        tan.HY[s_row, 1] += H[1, 0]
        tan.HY[s_row, 2] += H[2, 0] + x * H[1, 0] - y * H[0, 0]
        tan.PX[s_row, 0] += swept2
        tan.P[at_s + si] += H[2, 0]
        if station.row_w >= 0:
            tan.P[at_w + si] += f.c * H[1, 0] - f.s * H[0, 0]
            tan.P[at_s + wi] += lifted2
    for k in range(place.slot0 + place.closed, place.slot0 + place.nslot):
        s = tan.shares[k]
        other = cp.shares[k].parent
        t, row0 = tan.shares[other], tan.share_row0[other]
        t.g[0] += s.g[0]
        t.g[1] += s.g[1]
        t.g[2] += s.g[2] + x * s.g[1] - y * s.g[0]
        swept = s.h[0]
        for j in range(len(tan.width) - 1):
            t.h[1 + j] += s.h[1 + j]
            swept += s.h[1 + j] * turn[j]
        t.h[0] += swept
        if station.row_w >= 0:
            tan.share_g[row0 + wi] += f.c * s.g[1] - f.s * s.g[0]
            for j in range(len(tan.width) - 1):
                tan.share_h[row0 + wi] += s.h[1 + j] * tp.lift[j]
        if station.row_s >= 0:
            tan.share_g[row0 + si] += s.g[2]
            tan.share_h[row0 + si] += s.h[0]


@part
def hand_down(place: Any, cp: Any, tan: Any, first: int, base: int, stride: int) -> None:
    """Add the block of the open links to that of the parent or the ground."""
    n = place.nslot
    for m in range(place.closed, n):
        row = base + (cp.shares[place.slot0 + m].parent - first) * stride - first
        for j in range(place.closed, n):
            tan.block[row + cp.shares[place.slot0 + j].parent] += tan.block[place.block0 + m * n + j]
