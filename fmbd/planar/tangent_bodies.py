"""Elimination within a body of the linearised equations: links that touch it, the station that holds it, its rows.

Symbols as in tangent.py.
"""

from typing import Any

from fmbd.planar.compile import part
from fmbd.planar.linearise_forces import hold_force


@part
def take_end(end: Any, e: int, sys: Any, cp: Any, work: Any, tan: Any, bq: Any, bv: Any, ba: Any) -> None:
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
def shift_to_joint(b: Any, f: Any, station: Any, tb: Any, place: Any, tan: Any, bq: Any) -> None:
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
def _swap_rows(k: int, place: Any, tan: Any) -> None:
    """Bring the largest pivot of column k of A to row k, right-hand sides with it."""
    n, at, row0 = place.nr, place.matrix0, place.row0
    A, best = tan.A, k
    for i in range(k + 1, n):
        if abs(A[at + i * n + k]) > abs(A[at + best * n + k]):
            best = i
    tan.swapped[row0 + k] = row0 + best
    if best == k:
        return
    for j in range(n):
        A[at + k * n + j], A[at + best * n + j] = A[at + best * n + j], A[at + k * n + j]
    YX = tan.YX
    for j in range(len(tan.width)):
        YX[row0 + k, j], YX[row0 + best, j] = YX[row0 + best, j], YX[row0 + k, j]
    for m in range(place.slot0, place.slot0 + place.nslot):
        y, i = tan.share_y, tan.share_row0[m]
        y[i + k], y[i + best] = y[i + best], y[i + k]


@part
def eliminate_rows(b: Any, tb: Any, place: Any, tan: Any) -> bool:
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
        _swap_rows(k, place, tan)
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
