"""Right-hand sides of the factored linearised equations (tangent.py), swept outwards, inwards, and outwards again.

W, phi    wrench and row forces that the given parts of a motion ask for (tangent_given.py)
y0, rhs   rows of a body, coordinates and links, before their own unknowns are put in
"""

from typing import Any

import numpy as np

from fmbd.planar.compile import index, inner, part, part_sums
from fmbd.planar.tangent_given import given_end, given_inertia, given_motion, given_rows, given_wrench


@inner
def back_substitute(
    sys: Any, cp: Any, work: Any, tan: Any, v0: np.ndarray, a0: np.ndarray, r: np.ndarray, x: np.ndarray
) -> None:
    """x (nq,) and the links' unknowns for dID(x; v0, a0) = r, all (nq,), with tan.rhs of links, `pull` of joints.

    `work` is that of the linearisation, untouched since.
    """
    for i in range(sys.bodies.size):
        b, f, tb, place = sys.bodies[i], work.frames[i], tan.bodies[i], cp.places[i]
        if b.nf > 0:
            given_rows(b, work.R, sys.modal_damping, place, tan, v0, a0, r)
        given_motion(b, sys, work, tan, cp, v0, a0)
        given_wrench(b, f, tb, place, tan)
        for e in range(place.end0, place.end0 + place.nend):
            given_end(cp.ends[e], e, sys, f, tb, place, tan)
    for k in range(sys.inertias.size):
        given_inertia(sys.inertias[k], sys, work, tan, cp.places)
    for i in range(sys.bodies.size - 1, -1, -1):
        b, f, tb, place = sys.bodies[i], work.frames[i], tan.bodies[i], cp.places[i]
        at, W = tan.relative[b.inner], tb.W
        W[2] -= at[0] * W[1] - at[1] * W[0]
        if b.nf > 0:
            _rows(b, f, sys.stations[b.inner], W, place, tan)
            _into_links(W, place, cp, tan)
        n = place.nslot
        _close(tb, True, cp, tan, place.slot0, n, place.closed, place.block0, n, n)
        _joint(b, f, tb, place, cp, tan, v0, r)
        if b.parent >= 0:
            at, p, other = tan.relative[b.outer], work.frames[b.parent], tan.bodies[b.parent].W
            other[0] += W[0]
            other[1] += W[1]
            other[2] += W[2] + at[0] * W[1] - at[1] * W[0]
            station, shift = sys.stations[b.outer], cp.places[b.parent].row0 - sys.bodies[b.parent].row0
            if station.row_w >= 0:
                tan.phi[shift + station.row_w] += p.c * W[1] - p.s * W[0]
            if station.row_s >= 0:
                tan.phi[shift + station.row_s] += W[2]
    n = cp.shares.size - cp.ground_share0
    if n > 0:
        base, stride, band = cp.ground_base, cp.ground_stride, cp.ground_band
        _close(tan.bodies[0], False, cp, tan, cp.ground_share0, n, n, base, stride, band)
        _open(tan.bodies[0].X, False, cp, tan, cp.ground_share0, n, n, base, stride, band)
    for i in range(sys.bodies.size):
        b, tb, place = sys.bodies[i], tan.bodies[i], cp.places[i]
        X = tb.X
        _outer_motion(b, sys, cp, tan, X)
        _put_back_joint(b, tb, place, cp, tan, X, x)
        n = place.nslot
        _open(X, True, cp, tan, place.slot0, n, place.closed, place.block0, n, n)
        if b.nf > 0:
            _put_back_rows(b, work.R, place, cp, tan, X, x)
        _inner_to_frame(b, sys.stations[b.inner], tb, place, tan, X)


@part
def _rows(b: Any, f: Any, station: Any, W: Any, place: Any, tan: Any) -> None:
    """y0 with the row forces put in; its part of the wrench."""
    n, at, shift = place.nr, place.matrix0, place.row0 - b.row0
    if station.row_w >= 0:
        tan.phi[shift + station.row_w] -= f.c * W[1] - f.s * W[0]
    if station.row_s >= 0:
        tan.phi[shift + station.row_s] -= W[2]
    y = tan.y0
    for i in range(n):
        for k in range(n):
            y[place.row0 + i] -= tan.N[at + i * n + k] * tan.phi[place.row0 + k]
    for i in range(place.row0, place.row0 + n):
        j = tan.swapped[i]
        y[i], y[j] = y[j], y[i]
    for i in range(1, n):
        for k in range(i):
            y[place.row0 + i] -= tan.A[at + i * n + k] * y[place.row0 + k]
    for i in range(n - 1, -1, -1):
        for k in range(i + 1, n):
            y[place.row0 + i] -= tan.A[at + i * n + k] * y[place.row0 + k]
        y[place.row0 + i] /= tan.A[at + i * n + i]
    for k in range(place.row0, place.row0 + n):
        for i in range(3):
            W[i] += tan.HY[k, i] * y[k]


@part
def _into_links(W: Any, place: Any, cp: Any, tan: Any) -> None:
    for m in range(place.slot0, place.slot0 + place.nslot):
        row0 = tan.share_row0[m]
        for k in range(place.nr):
            tan.rhs[cp.shares[m].link] -= tan.share_h[row0 + k] * tan.y0[place.row0 + k]


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
    """Eliminate the links that close here from wrench and links."""
    for c in range(closed):
        s = tan.shares[slot0 + c]
        if s.per_D == 0.0:
            continue
        value = tan.rhs[cp.shares[slot0 + c].link]
        if on_body:
            for i in range(3):
                tb.W[i] += s.g[i] * s.per_D * value
        for m in range(c + 1, min(n, c + 1 + band)):
            tan.rhs[cp.shares[slot0 + m].link] -= tan.block[base + m * stride + c] * value


@part
def _joint(b: Any, f: Any, tb: Any, place: Any, cp: Any, tan: Any, v0: np.ndarray, r: np.ndarray) -> None:
    """Right-hand sides of a joint's coordinates; W is then about the outer station."""
    W, rhs = tb.W, tb.rhs
    for d in range(3):
        if b.coordinate[d] >= 0:
            rhs[d] = r[b.coordinate[d]] + tb.pull[d] - tb.drag[d] * v0[b.coordinate[d]]
    if b.sliding == 0:
        rhs[2] -= b.sign * W[2]
    else:
        if b.sign > 0.0:
            rhs[2] -= W[2]
        W[2] += tb.arm[0] * W[1] - tb.arm[1] * W[0]
        if b.sign < 0.0:
            rhs[2] += W[2]
        rhs[0] -= b.sign * (f.jc * W[0] + f.js * W[1])
        rhs[1] -= b.sign * (f.jc * W[1] - f.js * W[0])
    for d in range(3):
        if b.coordinate[d] < 0:
            continue
        for e in range(d + 1, 3):
            if b.coordinate[e] >= 0:
                rhs[e] -= tb.Q[d, e] * rhs[d]
        for i in range(3):
            W[i] += tb.ratio[d, i] * rhs[d]
        for m in range(place.slot0 + place.closed, place.slot0 + place.nslot):
            tan.rhs[cp.shares[m].link] -= tan.shares[m].row[d] * rhs[d]


@part
def _open(
    X: Any,
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
    """Unknowns of the links that close here, last eliminated first."""
    for c in range(closed - 1, -1, -1):
        s, link = tan.shares[slot0 + c], cp.shares[slot0 + c].link
        value = tan.rhs[link]
        if on_body:
            for j in range(len(tan.width)):
                value -= s.h[j] * X[j]
        for m in range(c + 1, min(n, c + 1 + band)):
            value -= tan.block[base + c * stride + m] * tan.unknown[cp.shares[slot0 + m].link]
        tan.unknown[link] = value * s.per_D


@part
def _outer_motion(b: Any, sys: Any, cp: Any, tan: Any, X: Any) -> None:
    """X of the station that carries a body."""
    if b.parent < 0:
        for j in range(len(tan.width)):
            X[j] = 0.0
        return
    tp, station = tan.bodies[b.parent], sys.stations[b.outer]
    shift = cp.places[b.parent].row0 - sys.bodies[b.parent].row0
    X[0] = tp.X[0]
    for j in range(len(tan.width) - 1):
        X[1 + j] = tp.X[1 + j] + tp.X[0] * tan.turn[b.outer, j]
    if station.row_w >= 0:
        for j in range(len(tan.width) - 1):
            X[1 + j] += tp.lift[j] * tan.y[shift + station.row_w]
    if station.row_s >= 0:
        X[0] += tan.y[shift + station.row_s]


@part
def _put_back_joint(b: Any, tb: Any, place: Any, cp: Any, tan: Any, X: Any, x: np.ndarray) -> None:
    """The joint's coordinates, last eliminated first; X moves to the inner station."""
    theta = X[0]
    for d in range(2, -1, -1):
        if b.coordinate[d] < 0:
            continue
        value = tb.rhs[d]
        for j in range(1, len(tan.width)):
            value -= tb.U[d, j] * X[j]
        value -= tb.U[d, 0] * theta
        if b.sliding == 1:
            for e in range(d + 1, 3):
                if b.coordinate[e] >= 0:
                    value -= tb.V[d, e] * x[b.coordinate[e]]
        for m in range(place.slot0 + place.closed, place.slot0 + place.nslot):
            value -= tan.shares[m].column[d] * tan.unknown[cp.shares[m].link]
        x[b.coordinate[d]] = value * tb.per_D[d]
    if b.coordinate[2] >= 0:
        X[0] += b.sign * x[b.coordinate[2]]
    if b.sliding == 1:
        swung = theta if b.sign > 0.0 else X[0]
        for j in range(len(tan.width) - 1):
            X[1 + j] += swung * tb.swing[j]
        for d in range(2):
            if b.coordinate[d] >= 0:
                for j in range(len(tan.width) - 1):
                    X[1 + j] += x[b.coordinate[d]] * tb.along[d, j]


@part_sums
def _put_back_rows(b: Any, R: np.ndarray, place: Any, cp: Any, tan: Any, X: Any, x: np.ndarray) -> None:
    """Rows and modes of a flexible body."""
    n, at = place.nr, place.matrix0
    for i in range(n):
        value = tan.y0[place.row0 + i]
        for j in range(len(tan.width)):
            value += tan.YX[place.row0 + i, j] * X[j]
        tan.y[place.row0 + i] = value
    for m in range(place.slot0, place.slot0 + place.nslot):
        unknown, row0 = tan.unknown[cp.shares[m].link], tan.share_row0[m]
        for i in range(n):
            tan.y[place.row0 + i] += tan.share_y[row0 + i] * unknown
            tan.phi[place.row0 + i] += tan.share_g[row0 + i] * unknown
    for i in range(n):
        value = tan.phi[place.row0 + i]
        for j in range(len(tan.width)):
            value += tan.PX[place.row0 + i, j] * X[j]
        for k in range(n):
            value += tan.P[at + i * n + k] * tan.y[place.row0 + k]
        tan.phi[place.row0 + i] = value
    swirl = tan.phi[place.row0 + b.nrow]
    first, mode0 = index(b.first_q), index(b.mode0)
    for k in range(index(b.nf)):
        x[first + k] = tan.free[mode0 + k] - swirl * tan.eta[0, mode0 + k]
    for i in range(b.nrow):
        force, start = tan.phi[place.row0 + i], index(b.matrix0 + i * b.nf)
        for k in range(index(b.nf)):
            x[first + k] -= R[start + k] * force
    for k in range(index(b.nf)):
        x[first + k] *= tan.per_D[mode0 + k]


@part
def _inner_to_frame(b: Any, station: Any, tb: Any, place: Any, tan: Any, X: Any) -> None:
    """X of the body's frame from that of its inner station."""
    shift = place.row0 - b.row0
    if station.row_s >= 0:
        X[0] -= tan.y[shift + station.row_s]
    for j in range(len(tan.width) - 1):
        X[1 + j] -= X[0] * tan.turn[b.inner, j]
    if station.row_w >= 0:
        for j in range(len(tan.width) - 1):
            X[1 + j] -= tb.lift[j] * tan.y[shift + station.row_w]
