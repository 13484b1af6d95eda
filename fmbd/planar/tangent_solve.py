"""Right-hand sides of the factored linearised equations (tangent.py), swept outwards, inwards, and outwards again.

X0 = (w0, alpha0, u0, a0)   what the given parts v0, a0 of dv and dq'' add to the motion of a frame; rate0, acc0 of rows
W, phi                      wrench and row forces that they ask for
y0, rhs                     rows of a body, coordinates and links, before their own unknowns are put in
"""

from typing import Any

import numpy as np

from fmbd.planar.arrays import ANGLE, DISTANCE, WORLD_X, WORLD_Y
from fmbd.planar.compile import inner, part, part_sums


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
            _given_rows(b, sys.rows, sys.modal_damping, place, tan, v0, a0, r)
        _given_motion(b, sys, work, tan, cp, v0, a0)
        _given_wrench(b, f, tb, place, tan)
        for e in range(place.end0, place.end0 + place.nend):
            _given_end(cp.ends[e], e, sys, f, tb, place, tan)
    for k in range(sys.inertias.size):
        _given_inertia(sys.inertias[k], sys, work, tan, cp.places)
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
            _put_back_rows(b, sys.rows, place, cp, tan, X, x)
        _inner_to_frame(b, sys.stations[b.inner], tb, place, tan, X)


@part_sums
def _given_rows(
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
    for k in range(b.nf):
        m = b.mode0 + k
        free = r[b.first_q + k] - a0[b.first_q + k] - damping[m] * v0[b.first_q + k]
        tan.free[m] = free
        spin += tan.eta[0, m] * v0[b.first_q + k]
        drift0 += tan.eta[0, m] * free * tan.per_D[m]
        drift1 += tan.eta[1, m] * free * tan.per_D[m]
    for i in range(b.nrow):
        rate, acc, total = spin * 0.0, spin * 0.0, spin * 0.0
        start = b.matrix0 + i * b.nf
        for k in range(b.nf):
            rate += R[start + k] * v0[b.first_q + k]
            acc += R[start + k] * a0[b.first_q + k]
            total += R[start + k] * tan.free[b.mode0 + k] * tan.per_D[b.mode0 + k]
        tan.rate0[place.row0 + i], tan.acc0[place.row0 + i], tan.y0[place.row0 + i] = rate, acc, total
        tan.phi[place.row0 + i] = 0.0
    last = place.row0 + b.nrow
    tan.rate0[last], tan.y0[last], tan.y0[last + 1] = spin, drift0, drift1
    tan.phi[last], tan.phi[last + 1] = 0.0, 0.0


@part
def _through(
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


@part
def _given_motion(b: Any, sys: Any, work: Any, tan: Any, cp: Any, v0: np.ndarray, a0: np.ndarray) -> None:
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
        ux, uy, ax, ay = _through(outer, shift, p, tan.relative[b.outer], tan, P0)
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
    ux, uy, ax, ay = _through(inner, shift, f, tan.relative[b.inner], tan, X0)
    X0[2] -= ux
    X0[3] -= uy
    X0[4] -= ax
    X0[5] -= ay


@part
def _given_wrench(b: Any, f: Any, tb: Any, place: Any, tan: Any) -> None:
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
def _given_inertia(point: Any, sys: Any, work: Any, tan: Any, places: Any) -> None:
    """The same for a point inertia; that of its frame is in S."""
    b, f, tb = sys.bodies[point.body], work.frames[point.body], tan.bodies[point.body]
    row, r = work.rows[point.row], places[point.body].row0 + point.row - b.row0
    tb.W[2] -= 2.0 * point.value * f.w * row.value * tan.rate0[r]
    tan.phi[r] += 2.0 * point.value * f.w * row.value * tb.X0[0]


@part
def _given_end(end: Any, e: int, sys: Any, f: Any, tb: Any, place: Any, tan: Any) -> None:
    """What the given motion of a station contributes to a link."""
    station, row, X0 = sys.stations[end.station], tan.rows[e], tb.X0
    shift = place.row0 - sys.bodies[station.body].row0
    w0, alpha0 = X0[0], X0[1]
    ux, uy, ax, ay = _through(station, shift, f, tan.relative[end.station], tan, X0)
    if station.row_s >= 0:
        w0 += tan.rate0[shift + station.row_s]
        alpha0 += tan.acc0[shift + station.row_s]
    value = row[1] * w0 + row[2] * alpha0 + row[3] * (X0[4] + ax) + row[4] * (X0[5] + ay)
    tan.rhs[end.link] -= value + row[7] * (X0[2] + ux) + row[8] * (X0[3] + uy)


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
    for k in range(b.nf):
        x[b.first_q + k] = tan.free[b.mode0 + k] - swirl * tan.eta[0, b.mode0 + k]
    for i in range(b.nrow):
        force, start = tan.phi[place.row0 + i], b.matrix0 + i * b.nf
        for k in range(b.nf):
            x[b.first_q + k] -= R[start + k] * force
    for k in range(b.nf):
        x[b.first_q + k] *= tan.per_D[b.mode0 + k]


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


@inner
def give_states(sys: Any, cp: Any, tan: Any, rz: np.ndarray) -> None:
    """Start the right-hand sides of links and joints with those of the first-order states, rz (nz,)."""
    for k in range(cp.links.size):
        tan.rhs[k] = 0.0
    for i in range(sys.bodies.size):
        for d in range(3):
            tan.bodies[i].pull[d] = 0.0
    for m in range(sys.motors.size):
        motor = sys.motors[m]
        effort = tan.effort[m, 0] * 0.0
        if motor.state >= 0:
            effort += tan.effort[m, 1] * rz[motor.state]
        if motor.controller >= 0 and sys.controllers[motor.controller].state >= 0:
            effort += tan.effort[m, 0] * tan.gains[m, 2] * rz[sys.controllers[motor.controller].state]
        local = cp.locals[motor.pathway]
        if local.body >= 0:
            tan.bodies[local.body].pull[local.direction] += local.coefficient * effort
        else:
            tan.rhs[cp.tension_link[motor.pathway]] += effort


@inner
def put_back_states(
    sys: Any,
    cp: Any,
    work: Any,
    tan: Any,
    x: np.ndarray,
    v0: np.ndarray,
    rz: np.ndarray,
    bq: Any,
    bv: Any,
    per_z: Any,
    dz: np.ndarray,
) -> None:
    """Variation dz (nz,) of currents and integrals, after back_substitute."""
    for m in range(sys.motors.size):
        motor = sys.motors[m]
        command = tan.effort[m, 0] * 0.0
        if motor.controller >= 0:
            control = sys.controllers[motor.controller]
            length, rate = _along(control.pathway, sys, cp, work, tan, x, v0, bq, bv)
            command -= tan.gains[m, 0] * length + tan.gains[m, 1] * rate
            if control.state >= 0:
                given = rz[control.state]
                dz[control.state] = (given - tan.gains[m, 3] * length) * per_z
                command += tan.gains[m, 2] * given
        if motor.state >= 0:
            _, rate = _along(motor.pathway, sys, cp, work, tan, x, v0, bq, bv)
            voltage = motor.La * rz[motor.state] + command - motor.Ke * rate
            dz[motor.state] = voltage * per_z / (motor.La + motor.Ra * per_z)


@inner
def _along(
    p: int,
    sys: Any,
    cp: Any,
    work: Any,
    tan: Any,
    x: np.ndarray,
    v0: np.ndarray,
    bq: Any,
    bv: Any,
) -> tuple[Any, Any]:
    """Variation of a pathway's length and rate."""
    local = cp.locals[p]
    if local.body >= 0:
        k = sys.bodies[local.body].coordinate[local.direction]
        return local.coefficient * bq * x[k], local.coefficient * (bv * x[k] + v0[k])
    path = sys.pathways[p]
    length, rate = x[0] * 0.0, x[0] * 0.0
    for j in range(path.term0, path.term0 + path.nterm):
        term, g = sys.terms[j], work.geometry[j]
        a, b = work.points[term.a], work.points[term.b]
        ta, wa, pax, pay, uax, uay = _station_variation(term.a, sys, cp, work, tan, bv)
        tb, wb, pbx, pby, ubx, uby = _station_variation(term.b, sys, cp, work, tan, bv)
        px, py, ux, uy = pbx - pax, pby - pay, ubx - uax, uby - uay
        e = term.coefficient
        if term.kind == ANGLE:
            length += e * bq * (tb - ta)
            rate += e * (wb - wa)
            continue
        length += e * (g.nx * px + g.ny * py)
        rate += e * (g.nx * ux + g.ny * uy)
        dx, dy, vx, vy = b.x - a.x, b.y - a.y, b.vx - a.vx, b.vy - a.vy
        along, across = g.nx * dx + g.ny * dy, g.nx * dy - g.ny * dx
        if term.kind == DISTANCE:
            if along > 0.0:
                rate += e * (g.nx * vy - g.ny * vx) * (g.nx * py - g.ny * px) / along
        elif term.kind != WORLD_X and term.kind != WORLD_Y:
            length += e * bq * ta * across
            rate += e * (wa * across + bq * ta * (g.nx * vy - g.ny * vx))
            rate += e * a.w * (g.nx * py - g.ny * px - bq * ta * along)
    return length, rate


@part
def _station_variation(
    k: int, sys: Any, cp: Any, work: Any, tan: Any, bv: Any
) -> tuple[Any, Any, Any, Any, Any, Any]:
    """theta (of place), rate of the angle, place and velocity of a station, as they vary."""
    station = sys.stations[k]
    if station.body < 0:
        zero = tan.turn[k, 0] * 0.0
        return zero, zero, zero, zero, zero, zero
    b, f, tb = sys.bodies[station.body], work.frames[station.body], tan.bodies[station.body]
    shift = cp.places[station.body].row0 - b.row0
    X, X0, turn, at = tb.X, tb.X0, tan.turn[k], tan.relative[k]
    theta, w0 = X[0], X0[0]
    px, py = X[3] + theta * turn[2], X[4] + theta * turn[3]
    ux, uy = X[5] + theta * turn[4] + X0[2] - w0 * at[1], X[6] + theta * turn[5] + X0[3] + w0 * at[0]
    if station.row_w >= 0:
        y, rate = tan.y[shift + station.row_w], tan.rate0[shift + station.row_w]
        px += tb.lift[2] * y
        py += tb.lift[3] * y
        ux += tb.lift[4] * y - f.s * rate
        uy += tb.lift[5] * y + f.c * rate
    if station.row_s >= 0:
        theta += tan.y[shift + station.row_s]
        w0 += tan.rate0[shift + station.row_s]
    return theta, bv * theta + w0, px, py, ux, uy
