"""The given parts of a motion that the linearised equations vary: what they ask of bodies, rows and links, outwards.

X0 = (w0, alpha0, u0, a0)   what the given parts v0, a0 of dv and dq'' add to the motion of a frame; rate0, acc0 of rows
W, phi                      wrench and row forces that they ask for
y0                          rows of a body by what is given for its modes
"""

from typing import Any

import numpy as np

from fmbd.planar.compile import index, part, part_sums


@part_sums
def given_rows(
    b: Any,
    R: np.ndarray,
    damping: np.ndarray,
    place: Any,
    tan: Any,
    v0: np.ndarray,
    a0: np.ndarray,
    r: np.ndarray,
) -> None:
    """Rows of v0 and a0, and y0 = R diag(1/D) (r - a0 - d v0)."""
    spin = tan.free[b.mode0] * 0.0
    drift0, drift1 = spin, spin
    first, mode0 = index(b.first_q), index(b.mode0)
    for k in range(index(b.nf)):
        m = mode0 + k
        free = r[first + k] - a0[first + k] - damping[m] * v0[first + k]
        tan.free[m] = free
        spin += tan.eta[0, m] * v0[first + k]
        drift0 += tan.eta[0, m] * free * tan.per_D[m]
        drift1 += tan.eta[1, m] * free * tan.per_D[m]
    for i in range(b.nrow):
        rate, acc, total = spin * 0.0, spin * 0.0, spin * 0.0
        start = index(b.matrix0 + i * b.nf)
        for k in range(index(b.nf)):
            rate += R[start + k] * v0[first + k]
            acc += R[start + k] * a0[first + k]
            total += R[start + k] * tan.free[mode0 + k] * tan.per_D[mode0 + k]
        tan.rate0[place.row0 + i], tan.acc0[place.row0 + i], tan.y0[place.row0 + i] = rate, acc, total
        tan.phi[place.row0 + i] = 0.0
    last = place.row0 + b.nrow
    tan.rate0[last], tan.y0[last], tan.y0[last + 1] = spin, drift0, drift1
    tan.phi[last], tan.phi[last + 1] = 0.0, 0.0


@part
def given_motion(b: Any, sys: Any, work: Any, tan: Any, cp: Any, v0: np.ndarray, a0: np.ndarray) -> None:
    """X0 of a body from that of its parent."""
    inner = sys.stations[b.inner]
    i = inner.body
    f, tb, X0 = work.frames[i], tan.bodies[i], tan.bodies[i].X0
    for j in range(6):
        X0[j] = 0.0
    if b.parent >= 0:
        outer, p = sys.stations[b.outer], work.frames[b.parent]
        shift = cp.places[b.parent].row0 - sys.bodies[b.parent].row0
        P0 = tan.bodies[b.parent].X0
        ux, uy, ax, ay = given_at_station(outer, shift, p, tan.relative[b.outer], tan, P0)
        X0[0], X0[1] = P0[0], P0[1]
        X0[2], X0[3], X0[4], X0[5] = P0[2] + ux, P0[3] + uy, P0[4] + ax, P0[5] + ay
        if outer.row_s >= 0:
            X0[0] += tan.rate0[shift + outer.row_s]
            X0[1] += tan.acc0[shift + outer.row_s]
    w0, alpha0 = X0[0], X0[1]
    if b.coordinate[2] >= 0:
        X0[0] += b.sign * v0[b.coordinate[2]]
        X0[1] += b.sign * a0[b.coordinate[2]]
    if b.sliding == 1:
        arm = tb.arm
        first = work.points[b.outer].w
        if b.sign < 0.0:
            w0, alpha0, first = X0[0], X0[1], work.points[b.inner].w
        X0[2] -= w0 * arm[1]
        X0[3] += w0 * arm[0]
        X0[4] += -alpha0 * arm[1] - 2.0 * w0 * arm[3]
        X0[5] += alpha0 * arm[0] + 2.0 * w0 * arm[2]
        for d in range(2):
            if b.coordinate[d] >= 0:
                x = b.sign * (f.jc if d == 0 else -f.js)
                y = b.sign * (f.js if d == 0 else f.jc)
                rate, acc = v0[b.coordinate[d]], a0[b.coordinate[d]]
                X0[2] += x * rate
                X0[3] += y * rate
                X0[4] += x * acc - 2.0 * first * y * rate
                X0[5] += y * acc + 2.0 * first * x * rate
    shift = cp.places[i].row0 - b.row0
    if inner.row_s >= 0:
        X0[0] -= tan.rate0[shift + inner.row_s]
        X0[1] -= tan.acc0[shift + inner.row_s]
    ux, uy, ax, ay = given_at_station(inner, shift, f, tan.relative[b.inner], tan, X0)
    X0[2] -= ux
    X0[3] -= uy
    X0[4] -= ax
    X0[5] -= ay


@part
def given_wrench(b: Any, f: Any, tb: Any, place: Any, tan: Any) -> None:
    """Wrench and row forces that the given motion asks of a body on its own."""
    w0, alpha0, ax, ay = tb.X0[0], tb.X0[1], tb.X0[4], tb.X0[5]
    S, W = tb.S, tb.W
    W[0] = b.mass * ax - alpha0 * S[1] - 2.0 * w0 * S[3]
    W[1] = b.mass * ay + alpha0 * S[0] + 2.0 * w0 * S[2]
    W[2] = S[0] * ay - S[1] * ax + S[4] * alpha0 + 2.0 * w0 * S[5]
    if b.nf > 0:
        r, last = place.row0, place.row0 + b.nrow
        W[0] += -f.s * tan.acc0[r] - 2.0 * f.w * f.c * tan.rate0[r]
        W[1] += f.c * tan.acc0[r] - 2.0 * f.w * f.s * tan.rate0[r]
        W[2] += tan.acc0[r + 1] + 2.0 * f.w * tan.rate0[last]
        tan.phi[r] += f.c * ay - f.s * ax
        tan.phi[r + 1] += alpha0
        tan.phi[last] -= 2.0 * f.w * w0


@part
def given_inertia(point: Any, sys: Any, work: Any, tan: Any, places: Any) -> None:
    """The same for a point inertia; that of its frame is in S."""
    b, f, tb = sys.bodies[point.body], work.frames[point.body], tan.bodies[point.body]
    row, r = work.rows[point.row], places[point.body].row0 + point.row - b.row0
    tb.W[2] -= 2.0 * point.value * f.w * row.value * tan.rate0[r]
    tan.phi[r] += 2.0 * point.value * f.w * row.value * tb.X0[0]


@part
def given_end(end: Any, e: int, sys: Any, f: Any, tb: Any, place: Any, tan: Any) -> None:
    """What the given motion of a station contributes to a link."""
    station, row, X0 = sys.stations[end.station], tan.rows[e], tb.X0
    shift = place.row0 - sys.bodies[station.body].row0
    w0, alpha0 = X0[0], X0[1]
    ux, uy, ax, ay = given_at_station(station, shift, f, tan.relative[end.station], tan, X0)
    if station.row_s >= 0:
        w0 += tan.rate0[shift + station.row_s]
        alpha0 += tan.acc0[shift + station.row_s]
    value = row[1] * w0 + row[2] * alpha0 + row[3] * (X0[4] + ax) + row[4] * (X0[5] + ay)
    tan.rhs[end.link] -= value + row[7] * (X0[2] + ux) + row[8] * (X0[3] + uy)


@part
def given_at_station(
    station: Any, shift: int, f: Any, at: np.ndarray, tan: Any, X0: np.ndarray
) -> tuple[Any, Any, Any, Any]:
    """(u, a) given to a station beyond that of its body's frame."""
    w0, alpha0 = X0[0], X0[1]
    ux, uy = -w0 * at[1], w0 * at[0]
    ax, ay = -alpha0 * at[1] - 2.0 * w0 * at[3], alpha0 * at[0] + 2.0 * w0 * at[2]
    if station.row_w >= 0:
        rate, acc = tan.rate0[shift + station.row_w], tan.acc0[shift + station.row_w]
        ux -= f.s * rate
        uy += f.c * rate
        ax += -f.s * acc - 2.0 * f.w * f.c * rate
        ay += f.c * acc - 2.0 * f.w * f.s * rate
    return ux, uy, ax, ay
