"""The linearised equations, factored once and solved for many right-hand sides, in O(bodies + modes).

    dID(x; v0, a0) = r      the variation of the equations of motion, one number per coordinate
Elimination towards the ground, body by body, as in recursion.py: the rows of a flexible body, the links that close
at it, its joint's coordinates. Nothing is symmetric here: what a body asks for depends on its motion X, what it is
given is a wrench. Symbols as in linearise.py, and
    A, YX, share_y   y = A^-1 (y0 - N phi0) + YX X + share_y . unknown,   A = I + N P
    U, V             row of a joint's coordinate after elimination: of X, of its other coordinates
    Q, ratio         what eliminating it subtracts from the joint's other rows and from the wrench
"""

from typing import Any

import numpy as np

from fmbd.planar.compile import compiled, inner, part
from fmbd.planar.linearise import hold_force, linearise
from fmbd.planar.tangent_solve import back_substitute, give_states, put_back_states

# of the pivot of a constraint, against that of a free body
_ROUND_OFF = 1e-14


@inner
def factor(
    sys: Any,
    cp: Any,
    work: Any,
    tan: Any,
    q: np.ndarray,
    v: np.ndarray,
    bq: Any,
    bv: Any,
    ba: Any,
    per_z: Any,
    level: int,
) -> int:
    """Linearise at the state of `work` (see linearise) and eliminate.

    Returns -1, or the index of a body whose joint nothing holds.
    """
    linearise(sys, cp, work, tan, q, v, bq, bv, ba, per_z, level)
    _clear_shares(cp, tan)
    for i in range(sys.bodies.size - 1, -1, -1):
        b, f, tb, place = sys.bodies[i], work.frames[i], tan.bodies[i], cp.places[i]
        for e in range(place.end0, place.end0 + place.nend):
            _take_end(cp.ends[e], e, sys, cp, work, tan, bq, bv, ba)
        _shift_to_joint(b, f, sys.stations[b.inner], tb, place, tan, bq)
        if b.nf > 0 and not _eliminate_rows(b, tb, place, tan):
            return i
        n = place.nslot
        _close(tb, True, cp, tan, place.slot0, n, place.closed, place.block0, n, n)
        if not _eliminate_joint(b, f, tb, place, tan, bq):
            return i
        if b.parent >= 0:
            parent = sys.bodies[b.parent]
            _load_parent(
                b,
                tb,
                parent,
                work.frames[b.parent],
                tan.bodies[b.parent],
                sys.stations[b.outer],
                cp,
                tan,
                bq,
                place,
            )
            up = cp.places[b.parent]
            _hand_down(place, cp, tan, up.slot0, up.block0, up.nslot)
        else:
            _hand_down(place, cp, tan, cp.ground_share0, cp.ground_base, cp.ground_stride)
    n = cp.shares.size - cp.ground_share0
    if n > 0:
        base, stride, band = cp.ground_base, cp.ground_stride, cp.ground_band
        _close(tan.bodies[0], False, cp, tan, cp.ground_share0, n, n, base, stride, band)
    return -1


@part
def _clear_shares(cp: Any, tan: Any) -> None:
    for k in range(cp.shares.size):
        s = tan.shares[k]
        for j in range(3):
            s.g[j] = 0.0
        for j in range(len(tan.width)):
            s.h[j] = 0.0
    for k in range(tan.block.size):
        tan.block[k] = 0.0
    for k in range(tan.share_g.size):
        tan.share_g[k] = 0.0
        tan.share_h[k] = 0.0
    # a link's own coefficient belongs to the place where it closes
    for i in range(cp.places.size):
        place = cp.places[i]
        for m in range(place.closed):
            tan.block[place.block0 + m * place.nslot + m] = tan.diagonal[cp.shares[place.slot0 + m].link]
    n = cp.shares.size - cp.ground_share0
    for m in range(n):
        tan.block[cp.ground_base + m * cp.ground_stride + m] = tan.diagonal[
            cp.shares[cp.ground_share0 + m].link
        ]


@part
def _take_end(end: Any, e: int, sys: Any, cp: Any, work: Any, tan: Any, bq: Any, bv: Any, ba: Any) -> None:
    """A link's wrench on a station, its row there, and the arm of the force that it carries."""
    station = sys.stations[end.station]
    b, link = sys.bodies[station.body], cp.links[end.link]
    f, tb, r, turn = (
        work.frames[station.body],
        tan.bodies[station.body],
        tan.relative[end.station],
        tan.turn[end.station],
    )
    s, row0 = tan.shares[end.slot], cp.shares[end.slot].row0 - b.row0
    column, row = tan.columns[e], tan.rows[e]
    fx, fy, moment = column[0], column[1], column[2]
    s.g[0] -= fx
    s.g[1] -= fy
    s.g[2] -= r[0] * fy - r[1] * fx + moment
    theta = bq * row[0] + bv * row[1] + ba * row[2]
    swept = theta
    for j in range(len(tan.width) - 1):
        s.h[1 + j] += row[3 + j]
        swept += row[3 + j] * turn[j]
    s.h[0] += swept
    if station.row_w >= 0:
        tan.share_g[row0 + station.row_w] -= f.c * fy - f.s * fx
        for j in range(len(tan.width) - 1):
            tan.share_h[row0 + station.row_w] += row[3 + j] * tb.lift[j]
    if station.row_s >= 0:
        tan.share_g[row0 + station.row_s] -= moment
        tan.share_h[row0 + station.row_s] += theta
    if link.kind <= 1:
        force = work.reactions[link.index].multiplier if link.kind == 0 else tan.tension[link.index]
        hold_force(
            station, end.station, sys.bodies, cp.places, work.frames, tan, bq, force * fx, force * fy, 0.0
        )


@part
def _shift_to_joint(b: Any, f: Any, station: Any, tb: Any, place: Any, tan: Any, bq: Any) -> None:
    """From the body's frame to the inner station: what it asks for, and of what motion."""
    r, turn, H = tan.relative[b.inner], tan.turn[b.inner], tb.H
    fx, fy = tb.force[0], tb.force[1]
    moving = b.nf > 0 and (station.row_w >= 0 or station.row_s >= 0)
    x, y = r[0], r[1]
    for j in range(len(tan.width)):
        H[2, j] -= x * H[1, j] - y * H[0, j]
    H[2, 0] += bq * (x * fx + y * fy)
    for k in range(place.row0, place.row0 + place.nr):
        tan.HY[k, 2] -= x * tan.HY[k, 1] - y * tan.HY[k, 0]
    for k in range(place.slot0, place.slot0 + place.nslot):
        s = tan.shares[k]
        s.g[2] -= x * s.g[1] - y * s.g[0]
    w = place.row0 + station.row_w - b.row0
    turning = place.row0 + station.row_s - b.row0
    ahead = bq * (f.c * fx + f.s * fy)
    if station.row_w >= 0:
        tan.HY[w, 2] += ahead
    if moving:
        # the joint's wrench acts on the rows that hold the body
        if station.row_w >= 0:
            _give_rows(w, 0, -f.s, f.c, H, place, tan)
            tan.PX[w, 0] += ahead
        if station.row_s >= 0:
            _give_rows(turning, 1, 0.0, 0.0, H, place, tan)
    back = H[0, 0] * 0.0
    for i in range(3):
        back = H[i, 0]
        for j in range(len(tan.width) - 1):
            back -= H[i, 1 + j] * turn[j]
        H[i, 0] = back
        if station.row_s >= 0:
            tan.HY[turning, i] -= back
        if station.row_w >= 0:
            for j in range(len(tan.width) - 1):
                tan.HY[w, i] -= H[i, 1 + j] * tb.lift[j]
    for k in range(place.nr):
        row = tan.PX[place.row0 + k]
        back = row[0]
        for j in range(len(tan.width) - 1):
            back -= row[1 + j] * turn[j]
        row[0] = back
        if station.row_s >= 0:
            tan.P[place.matrix0 + k * place.nr + station.row_s - b.row0] -= back
        if station.row_w >= 0:
            for j in range(len(tan.width) - 1):
                tan.P[place.matrix0 + k * place.nr + station.row_w - b.row0] -= row[1 + j] * tb.lift[j]
    for k in range(place.slot0, place.slot0 + place.nslot):
        s = tan.shares[k]
        back = s.h[0]
        for j in range(len(tan.width) - 1):
            back -= s.h[1 + j] * turn[j]
        s.h[0] = back
        row0 = tan.share_row0[k]
        if station.row_s >= 0:
            tan.share_h[row0 + station.row_s - b.row0] -= back
        if station.row_w >= 0:
            for j in range(len(tan.width) - 1):
                tan.share_h[row0 + station.row_w - b.row0] -= s.h[1 + j] * tb.lift[j]


@part
def _give_rows(row: int, turn: int, ex: float, ey: float, H: Any, place: Any, tan: Any) -> None:
    """Forces on one of the rows that hold the body, by its joint's wrench: along (ex, ey), or (turn) its moment."""
    at = place.matrix0 + (row - place.row0) * place.nr
    for j in range(len(tan.width)):
        tan.PX[row, j] -= H[2, j] if turn == 1 else ex * H[0, j] + ey * H[1, j]
    for k in range(place.nr):
        HY = tan.HY[place.row0 + k]
        tan.P[at + k] -= HY[2] if turn == 1 else ex * HY[0] + ey * HY[1]
    for k in range(place.slot0, place.slot0 + place.nslot):
        g = tan.shares[k].g
        tan.share_g[tan.share_row0[k] + row - place.row0] -= g[2] if turn == 1 else ex * g[0] + ey * g[1]


@part
def _eliminate_rows(b: Any, tb: Any, place: Any, tan: Any) -> bool:
    """Solve for the rows; their part of wrench and links goes to H, g, h and the block."""
    n, at = place.nr, place.matrix0
    N, A, P = tan.N, tan.A, tan.P
    for i in range(n):
        for j in range(n):
            A[at + i * n + j] = N[at] * 0.0
        A[at + i * n + i] = 1.0
        for k in range(n):
            for j in range(n):
                A[at + i * n + j] += N[at + i * n + k] * P[at + k * n + j]
        for j in range(len(tan.width)):
            tan.YX[place.row0 + i, j] = 0.0
        for k in range(n):
            for j in range(len(tan.width)):
                tan.YX[place.row0 + i, j] -= N[at + i * n + k] * tan.PX[place.row0 + k, j]
        for m in range(place.nslot):
            row0 = tan.share_row0[place.slot0 + m]
            total = N[at] * 0.0
            for k in range(n):
                total -= N[at + i * n + k] * tan.share_g[row0 + k]
            tan.share_y[row0 + i] = total
    # A = L U, in place; the right-hand sides go along
    for k in range(n):
        pivot = A[at + k * n + k]
        if not abs(pivot) > 0.0:
            return False
        for i in range(k + 1, n):
            ratio = A[at + i * n + k] / pivot
            A[at + i * n + k] = ratio
            if ratio == 0.0:
                continue
            for j in range(k + 1, n):
                A[at + i * n + j] -= ratio * A[at + k * n + j]
            for j in range(len(tan.width)):
                tan.YX[place.row0 + i, j] -= ratio * tan.YX[place.row0 + k, j]
            for m in range(place.nslot):
                row0 = tan.share_row0[place.slot0 + m]
                tan.share_y[row0 + i] -= ratio * tan.share_y[row0 + k]
    for i in range(n - 1, -1, -1):
        for k in range(i + 1, n):
            ratio = A[at + i * n + k]
            if ratio == 0.0:
                continue
            for j in range(len(tan.width)):
                tan.YX[place.row0 + i, j] -= ratio * tan.YX[place.row0 + k, j]
            for m in range(place.nslot):
                row0 = tan.share_row0[place.slot0 + m]
                tan.share_y[row0 + i] -= ratio * tan.share_y[row0 + k]
        pivot = A[at + i * n + i]
        for j in range(len(tan.width)):
            tan.YX[place.row0 + i, j] /= pivot
        for m in range(place.nslot):
            tan.share_y[tan.share_row0[place.slot0 + m] + i] /= pivot
    for k in range(n):
        for i in range(3):
            for j in range(len(tan.width)):
                tb.H[i, j] += tan.HY[place.row0 + k, i] * tan.YX[place.row0 + k, j]
    for m in range(place.nslot):
        s, row0 = tan.shares[place.slot0 + m], tan.share_row0[place.slot0 + m]
        for k in range(n):
            for i in range(3):
                s.g[i] += tan.HY[place.row0 + k, i] * tan.share_y[row0 + k]
            for j in range(len(tan.width)):
                s.h[j] += tan.share_h[row0 + k] * tan.YX[place.row0 + k, j]
        for j in range(place.nslot):
            other = tan.share_row0[place.slot0 + j]
            total = N[at] * 0.0
            for k in range(n):
                total += tan.share_h[row0 + k] * tan.share_y[other + k]
            tan.block[place.block0 + m * place.nslot + j] += total
    return True


@part
def _close(
    tb: Any,
    on_body: bool,
    cp: Any,
    tan: Any,
    slot0: int,
    n: int,
    closed: int,
    base: int,
    stride: int,
    band: int,
) -> None:
    """Eliminate the links that close here: block . unknown + h . X = rhs; the block as in planar.loops."""
    block = tan.block
    for c in range(closed):
        s = tan.shares[slot0 + c]
        row = base + c * stride
        last = min(n, c + 1 + band)
        s.per_D = 0.0
        link = cp.shares[slot0 + c].link
        if tan.redundant[link] == 1 or not abs(block[row + c]) > _ROUND_OFF * tan.scale[link]:
            continue
        s.per_D = 1.0 / block[row + c]
        if on_body:
            for i in range(3):
                ratio = s.g[i] * s.per_D
                for j in range(len(tan.width)):
                    tb.H[i, j] -= ratio * s.h[j]
        for m in range(c + 1, last):
            t = tan.shares[slot0 + m]
            if on_body and block[row + m] != 0.0:
                ratio = block[row + m] * s.per_D
                for i in range(3):
                    t.g[i] -= s.g[i] * ratio
            ratio = block[base + m * stride + c] * s.per_D
            block[base + m * stride + c] = ratio
            if ratio == 0.0:
                continue
            if on_body:
                for j in range(len(tan.width)):
                    t.h[j] -= ratio * s.h[j]
            for j in range(c + 1, last):
                block[base + m * stride + j] -= ratio * block[row + j]


@part
def _eliminate_joint(b: Any, f: Any, tb: Any, place: Any, tan: Any, bq: Any) -> bool:
    """Eliminate the joint's free coordinates; H, g and h are then about the outer station."""
    H, U, V = tb.H, tb.U, tb.V
    fx, fy = tb.force[0], tb.force[1]
    first, last = place.slot0 + place.closed, place.slot0 + place.nslot
    if b.sliding == 0:
        if b.coordinate[2] >= 0:
            # one coordinate: theta of the body is sign x + theta of the outer station
            pivot = H[2, 0] + tb.own[2]
            if not abs(pivot) > 0.0:
                return False
            tb.per_D[2] = 1.0 / pivot
            for j in range(len(tan.width)):
                U[2, j] = b.sign * H[2, j]
            for i in range(3):
                tb.ratio[2, i] = b.sign * H[i, 0] * tb.per_D[2]
            for k in range(first, last):
                s = tan.shares[k]
                s.column[2] = b.sign * s.g[2]
                s.row[2] = b.sign * s.h[0] * tb.per_D[2]
            _deflate(2, tb, place, tan)
        return True
    for d in range(3):
        for j in range(3):
            V[d, j] = 0.0
    x, y = tb.arm[0], tb.arm[1]
    reverse = b.sign < 0.0
    lean = -bq * (x * fx + y * fy)
    # columns of the wrench at the inner station per unit of each coordinate, in tb.ratio for a while
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
    for k in range(first, last):
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
    # rows of the coordinates: the angle of a joint whose axes stay behind, before the moment moves
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
        tb.ratio[d, 2] += bq * (px * fy - py * fx)
        turn = bq * (px * fy - py * fx)
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
def _load_parent(
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
def _hand_down(place: Any, cp: Any, tan: Any, first: int, base: int, stride: int) -> None:
    """Add the block of the open links to that of the parent or the ground."""
    n = place.nslot
    for m in range(place.closed, n):
        row = base + (cp.shares[place.slot0 + m].parent - first) * stride - first
        for j in range(place.closed, n):
            tan.block[row + cp.shares[place.slot0 + j].parent] += tan.block[place.block0 + m * n + j]


@compiled
def solve_linearised(
    sys: Any,
    cp: Any,
    work: Any,
    tan: Any,
    q: np.ndarray,
    v: np.ndarray,
    weights: np.ndarray,
    v0: np.ndarray,
    a0: np.ndarray,
    r: np.ndarray,
    rz: np.ndarray,
    x: np.ndarray,
    dz: np.ndarray,
) -> int:
    """Factor and solve once, for callers in Python: x (nq,) and dz (nz,) with weights (bq, bv, ba, per_z)."""
    bq, bv, ba, per_z = weights[0], weights[1], weights[2], weights[3]
    failed = factor(sys, cp, work, tan, q, v, bq, bv, ba, per_z, 2)
    give_states(sys, cp, tan, rz)
    dz[:] = 0.0
    back_substitute(sys, cp, work, tan, v0, a0, r, x)
    put_back_states(sys, cp, work, tan, x, v0, rz, bq, bv, per_z, dz)
    return failed
