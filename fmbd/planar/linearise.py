"""The linearised equations of motion at a state: what each body, pathway and load contributes.

The unknown is one number x per coordinate; with three weights (bq, bv, ba) of the integrator it varies
    dq = bq x,    dv = bv x + v0,    dq'' = ba x + a0
so that an acceleration asks for (0, 0, 1), statics for (1, 0, 0), an implicit step for all three. In world axes:

    X = (theta, a, p, u)  of a frame: dangle = bq theta, dw = bv theta, dalpha = ba theta; da, dplace, dvelocity
    y              of a row of a flexible body: R x
    turn, lift     (a, p, u) of a station per unit of its body's theta, per unit of its row of deflection
    swing, along   (a, p, u) of a joint's inner station per unit of theta of its axes, of x along each
    H, HY          wrench that a body asks for, about its frame's origin: dW = H X + HY^T y + (g times links' unknowns)
    PX, P          forces that it asks for on its rows: phi = PX X + P y + (share_g times the links' unknowns)
    N              R diag(1/D) R^T,   D = ba + bv d + bq (omega^2 - w^2)
    g, h           a link's column and row in a body; share_g, share_h the same on its rows
A motion r that turns with a body varies by (bq z x r, bv z x r + bq z x r', ba z x r + 2 bv z x r' + bq z x r'').
The state is that of the last `accelerations` with the same `work`, whose accelerations and multipliers are used.
"""

from typing import Any

import numpy as np

from fmbd.planar.arrays import ANGLE, DISTANCE, WORLD_X, WORLD_Y
from fmbd.planar.compile import inner, part, part_sums
from fmbd.planar.equations import reaction
from fmbd.planar.laws import law
from fmbd.planar.tangent_arrays import COMMAND, LEAN_FORCE, LEAN_MOMENT, MULTIPLIER


@inner
def linearise(
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
) -> None:
    """Fill `tan` at the state of `work`; constraints by their place (level 0), rate (1) or second derivative (2).

    per_z: dz per unit of the right-hand side of an integral, 1 / (its own weight).
    """
    for i in range(sys.bodies.size):
        b, f, tb, place = sys.bodies[i], work.frames[i], tan.bodies[i], cp.places[i]
        _clear(tb)
        for k in range(b.station0, b.station0 + b.nstation):
            _relative_motion(sys.stations[k], work.points[k], f, work.rows, tan.relative[k])
            r = tan.relative[k]
            turned(bq, bv, ba, r[0], r[1], r[2], r[3], r[4], r[5], tan.turn[k])
        _own_inertia(b, f, sys.gravity, work.rows, tb, place, tan, q, v, bq, bv, ba)
        if b.nf > 0:
            _condense(b, f, sys, place, tan, q, v, bq, bv, ba)
        if b.rotor == 0:
            tb.force[0], tb.force[1], _ = reaction(sys, work, i)
        if b.sliding == 1:
            _sliding(b, sys, work, tan, tb, bq, bv, ba)
    for k in range(sys.inertias.size):
        _point_inertia(sys.inertias[k], sys, work, tan, cp.places, bq, bv, ba)
    _pathway_forces(sys, cp, work, tan, bq, bv, per_z, level)
    _links(sys, cp, work, tan)
    for k in range(sys.loads.size):
        _load(sys.loads[k], sys, cp.places, work, tan, bq)
    for k in range(sys.distributed.size):
        _distributed(sys.distributed[k], work, tan, sys.bodies, cp.places, bq)


@part
def turned(
    bq: Any, bv: Any, ba: Any, x: Any, y: Any, dx: Any, dy: Any, ddx: Any, ddy: Any, out: np.ndarray
) -> None:
    """(a, p, u) of a motion r = (x, y) as it turns by one unit."""
    out[0], out[1] = -ba * y - 2.0 * bv * dy - bq * ddy, ba * x + 2.0 * bv * dx + bq * ddx
    out[2], out[3] = -bq * y, bq * x
    out[4], out[5] = -bv * y - bq * dy, bv * x + bq * dx


@part
def _carried(bq: Any, bv: Any, ba: Any, x: Any, y: Any, w: Any, alpha: Any, out: np.ndarray) -> None:
    """(a, p, u) along a direction (x, y) that turns with a frame."""
    ahead, aside = ba - bq * w * w, 2.0 * bv * w + bq * alpha
    out[0], out[1] = ahead * x - aside * y, ahead * y + aside * x
    out[2], out[3] = bq * x, bq * y
    out[4], out[5] = bv * x - bq * w * y, bv * y + bq * w * x


@part
def _clear(tb: Any) -> None:
    for i in range(3):
        for j in range(7):
            tb.H[i, j] = 0.0
        tb.own[i], tb.drag[i], tb.pull[i] = 0.0, 0.0, 0.0
    tb.force[0], tb.force[1] = 0.0, 0.0


@part
def _relative_motion(station: Any, p: Any, f: Any, rows: Any, out: np.ndarray) -> None:
    """r, r', r'' of a station from the frame of its body."""
    x, y = p.x - f.x, p.y - f.y
    out[0], out[1], out[2], out[3] = x, y, p.vx - f.vx, p.vy - f.vy
    out[4], out[5] = p.bx - f.bx - f.aw * y, p.by - f.by + f.aw * x
    if station.row_w >= 0:
        out[4] -= f.s * rows[station.row_w].y
        out[5] += f.c * rows[station.row_w].y


@part
def _station_acceleration(k: int, sys: Any, work: Any, tan: Any) -> tuple[float, float, float]:
    """Acceleration of a station, and of its angle."""
    station = sys.stations[k]
    if station.body < 0:
        return 0.0, 0.0, 0.0
    f, r = work.frames[station.body], tan.relative[k]
    alpha = work.points[k].bw + f.aw
    if station.row_s >= 0:
        alpha += work.rows[station.row_s].y
    return f.bx + f.ax + r[4], f.by + f.ay + r[5], alpha


@part
def _own_inertia(
    b: Any,
    f: Any,
    gravity: np.ndarray,
    rows: Any,
    tb: Any,
    place: Any,
    tan: Any,
    q: np.ndarray,
    v: np.ndarray,
    bq: Any,
    bv: Any,
    ba: Any,
) -> None:
    """H of the body itself; HY, PX, P of its rows, by s, p, eta and eta'."""
    w, alpha, c, s = f.w, f.bw + f.aw, f.c, f.s
    ax, ay = f.bx + f.ax - gravity[0], f.by + f.ay - gravity[1]
    inertia, spin, my, flow, growth = b.J, 0.0, b.my, 0.0, 0.0
    if b.nf > 0:
        my += rows[b.row0].value
        flow, growth = rows[b.row0].rate, rows[b.row0].y
        for k in range(b.nf):
            eta, rate = q[b.first_q + k], v[b.first_q + k]
            tan.eta[0, b.mode0 + k], tan.eta[1, b.mode0 + k] = eta, rate
            inertia += eta * eta
            spin += eta * rate
    sx, sy = c * b.mx - s * my, s * b.mx + c * my
    dx, dy = -w * sy - flow * s, w * sx + flow * c
    ddx = -alpha * sy - w * w * sx - 2.0 * w * flow * c - growth * s
    ddy = alpha * sx - w * w * sy - 2.0 * w * flow * s + growth * c
    tb.S[0], tb.S[1], tb.S[2], tb.S[3], tb.S[4], tb.S[5] = sx, sy, dx, dy, inertia, spin
    H = tb.H
    H[0, 1], H[1, 2], H[2, 1], H[2, 2] = b.mass, b.mass, -sy, sx
    H[0, 0] = -ba * sy - 2.0 * bv * dy - bq * ddy
    H[1, 0] = ba * sx + 2.0 * bv * dx + bq * ddx
    H[2, 0] = inertia * ba + 2.0 * bv * spin - bq * (sx * ax + sy * ay)
    if b.nf > 0:
        _carried(bq, bv, ba, -s, c, w, alpha, tb.lift)
        for r in range(place.row0, place.row0 + place.nr):
            for j in range(len(tan.width)):
                tan.PX[r, j] = 0.0
            for j in range(3):
                tan.HY[r, j] = 0.0
        for k in range(place.matrix0, place.matrix0 + place.nr**2):
            tan.P[k] = 0.0
        r, last = place.row0, place.row0 + place.nr - 2
        lean = -bq * (c * ax + s * ay)
        tan.HY[r, 0], tan.HY[r, 1], tan.HY[r, 2] = tb.lift[0], tb.lift[1], lean
        tan.HY[r + 1, 2] = ba
        tan.HY[last, 2], tan.HY[last + 1, 2] = 2.0 * (bq * alpha + bv * w), 2.0 * bq * w
        tan.PX[r, 0], tan.PX[r, 1], tan.PX[r, 2] = lean, -s, c
        tan.PX[r + 1, 0] = ba
        tan.PX[last, 0] = -2.0 * bv * w


@part_sums
def _condense(
    b: Any, f: Any, sys: Any, place: Any, tan: Any, q: np.ndarray, v: np.ndarray, bq: Any, bv: Any, ba: Any
) -> None:
    """N of a flexible body."""
    R, n, w2 = sys.rows, place.nr, f.w * f.w
    for k in range(b.nf):
        D = ba + bv * sys.modal_damping[b.mode0 + k] + bq * (sys.omega2[b.mode0 + k] - w2)
        tan.per_D[b.mode0 + k] = 1.0 / D
    for i in range(b.nrow):
        for j in range(i + 1):
            total = tan.per_D[b.mode0] * 0.0
            for k in range(b.nf):
                total += R[b.matrix0 + i * b.nf + k] * R[b.matrix0 + j * b.nf + k] * tan.per_D[b.mode0 + k]
            tan.N[place.matrix0 + i * n + j] = total
            tan.N[place.matrix0 + j * n + i] = total
    for i in range(2):
        for j in range(b.nrow):
            total = tan.per_D[b.mode0] * 0.0
            for k in range(b.nf):
                total += R[b.matrix0 + j * b.nf + k] * tan.eta[i, b.mode0 + k] * tan.per_D[b.mode0 + k]
            tan.N[place.matrix0 + (b.nrow + i) * n + j] = total
            tan.N[place.matrix0 + j * n + b.nrow + i] = total
        for j in range(i + 1):
            total = tan.per_D[b.mode0] * 0.0
            for k in range(b.nf):
                total += tan.eta[i, b.mode0 + k] * tan.eta[j, b.mode0 + k] * tan.per_D[b.mode0 + k]
            tan.N[place.matrix0 + (b.nrow + i) * n + b.nrow + j] = total
            tan.N[place.matrix0 + (b.nrow + j) * n + b.nrow + i] = total


@part
def _sliding(b: Any, sys: Any, work: Any, tan: Any, tb: Any, bq: Any, bv: Any, ba: Any) -> None:
    """Motion of the inner station of a sliding joint from the outer one, and along the joint's axes."""
    f, a, c = work.frames[sys.stations[b.inner].body], work.points[b.outer], work.points[b.inner]
    ax, ay, alpha_a = _station_acceleration(b.outer, sys, work, tan)
    cx, cy, alpha_c = _station_acceleration(b.inner, sys, work, tan)
    arm = tb.arm
    arm[0], arm[1], arm[2], arm[3] = c.x - a.x, c.y - a.y, c.vx - a.vx, c.vy - a.vy
    arm[4], arm[5] = cx - ax, cy - ay
    turned(bq, bv, ba, arm[0], arm[1], arm[2], arm[3], arm[4], arm[5], tb.swing)
    w = a.w if b.sign > 0.0 else c.w
    alpha = alpha_a if b.sign > 0.0 else alpha_c
    _carried(bq, bv, ba, b.sign * f.jc, b.sign * f.js, w, alpha, tb.along[0])
    _carried(bq, bv, ba, -b.sign * f.js, b.sign * f.jc, w, alpha, tb.along[1])


@part
def _point_inertia(point: Any, sys: Any, work: Any, tan: Any, places: Any, bq: Any, bv: Any, ba: Any) -> None:
    """The part of R R^T = I that is not in eta . eta of the inertia."""
    b, f, place, H = (
        sys.bodies[point.body],
        work.frames[point.body],
        places[point.body],
        tan.bodies[point.body].H,
    )
    row = work.rows[point.row]
    r, n = point.row - b.row0, place.nr
    alpha = f.bw + f.aw
    inertia, value, rate = point.value, row.value, row.rate
    H[2, 0] -= inertia * (value * value * ba + 2.0 * bv * value * rate)
    tan.bodies[point.body].S[4] -= inertia * value * value
    tan.bodies[point.body].S[5] -= inertia * value * rate
    tan.HY[place.row0 + r, 2] -= 2.0 * inertia * (value * alpha * bq + f.w * (bq * rate + bv * value))
    tan.PX[place.row0 + r, 0] += 2.0 * inertia * f.w * bv * value
    tan.P[place.matrix0 + r * n + r] += inertia * f.w * f.w * bq


@part
def _pathway_forces(sys: Any, cp: Any, work: Any, tan: Any, bq: Any, bv: Any, per_z: Any, level: int) -> None:
    """What acts along each pathway, and how it changes with it: in the joints, or as weights of links."""
    for p in range(sys.pathways.size):
        tan.tension[p] = 0.0
    for k in range(cp.links.size):
        kind = cp.links[k].kind
        for i in range(2):
            for j in range(3):
                tan.weights[k, i, j] = 0.0
        tan.diagonal[k] = 1.0
        tan.redundant[k] = 0
        if kind == MULTIPLIER:
            c = cp.links[k].index
            tan.diagonal[k] = 0.0
            tan.weights[k, 0, level] = 1.0
            tan.tension[sys.constraints[c].pathway] += work.reactions[c].multiplier
            tan.redundant[k] = work.reactions[c].redundant
    for k in range(sys.springs.size):
        spring = sys.springs[k]
        path = work.lengths[spring.pathway]
        force, stiffness, damping, _, _ = law(spring, sys.curves, path.value, path.rate)
        _along(spring.pathway, force, stiffness, damping, sys, cp, work, tan, bq, bv)
    for m in range(sys.motors.size):
        motor, drive = sys.motors[m], work.drives[m]
        gain = 1.0 + 0.0 * per_z
        tan.effort[m, 1] = 0.0
        if motor.electric == 1 and motor.state < 0:
            gain *= motor.Km / motor.Ra
        elif motor.electric == 1:
            gain *= motor.Km * per_z / (motor.La + motor.Ra * per_z)
            tan.effort[m, 1] = gain * motor.La
        tan.effort[m, 0] = gain
        back = gain * motor.Ke if motor.electric == 1 else 0.0 * gain
        _along(motor.pathway, drive.effort, 0.0, back, sys, cp, work, tan, bq, bv)
        for j in range(4):
            tan.gains[m, j] = 0.0
        if motor.controller < 0:
            continue
        control = sys.controllers[motor.controller]
        if control.low < drive.input and drive.input < control.high:
            tan.gains[m, 0], tan.gains[m, 1] = control.kp, control.kd
            if control.state >= 0:
                tan.gains[m, 0] += control.ki * per_z
                tan.gains[m, 2], tan.gains[m, 3] = control.ki * per_z, 1.0
        elif control.state >= 0:
            error = control.shift - work.lengths[control.pathway].value
            if control.target >= 0:
                error += control.scale * work.signal[control.target, 0]
            outward = error * control.ki if drive.input == control.high else -error * control.ki
            tan.gains[m, 3] = 0.0 if outward > 0.0 else 1.0
        k, d = gain * tan.gains[m, 0], gain * tan.gains[m, 1]
        if cp.command_link[m] >= 0:
            tan.weights[cp.command_link[m], 1, 0], tan.weights[cp.command_link[m], 1, 1] = k, d
        else:
            own, other = cp.locals[motor.pathway], cp.locals[control.pathway]
            both = own.coefficient * other.coefficient
            tan.bodies[own.body].own[own.direction] += both * (bq * k + bv * d)
            tan.bodies[own.body].drag[own.direction] += both * d


@part
def _along(
    p: int, force: float, k: Any, d: Any, sys: Any, cp: Any, work: Any, tan: Any, bq: Any, bv: Any
) -> None:
    """A force along pathway p that falls by k, d per unit of its length and rate."""
    local = cp.locals[p]
    if local.body < 0:
        tan.tension[p] += force
        tan.weights[cp.tension_link[p], 0, 0] += k
        tan.weights[cp.tension_link[p], 0, 1] += d
        return
    tb, e = tan.bodies[local.body], local.coefficient
    tb.own[local.direction] += e * e * (bq * k + bv * d)
    tb.drag[local.direction] += e * e * d
    if local.direction < 2:
        f, sign = work.frames[local.body], sys.bodies[local.body].sign
        x = f.jc if local.direction == 0 else -f.js
        y = f.js if local.direction == 0 else f.jc
        tb.force[0] += sign * e * force * x
        tb.force[1] += sign * e * force * y


@part
def _links(sys: Any, cp: Any, work: Any, tan: Any) -> None:
    """Columns and rows of all links at their ends."""
    for e in range(cp.ends.size):
        for j in range(3):
            tan.columns[e, j] = 0.0
        for j in range(9):
            tan.rows[e, j] = 0.0
    for k in range(cp.links.size):
        link = cp.links[k]
        for n in range(link.piece0, link.piece0 + link.npiece):
            piece = cp.pieces[n]
            if link.kind <= COMMAND:
                _piece(piece, tan.weights[k, piece.measured], sys, work, tan)
            else:
                weights = tan.weights[max(cp.tension_link[link.index], 0), 0]
                _lean(link.kind, piece, tan.tension[link.index], weights, sys, work, tan)


@part
def _piece(piece: Any, weights: np.ndarray, sys: Any, work: Any, tan: Any) -> None:
    """A term of a pathway: the wrenches of a unit force along it, and how its l, l', l'' vary."""
    term = sys.terms[piece.term]
    g, a, b, e = work.geometry[piece.term], work.points[term.a], work.points[term.b], term.coefficient
    if piece.measured == 0:
        _add_column(tan, piece.end_b, e * g.nx, e * g.ny, e * g.mb)
        _add_column(tan, piece.end_a, -e * g.nx, -e * g.ny, e * g.ma)
    k, d, m = e * weights[0], e * weights[1], e * weights[2]
    if term.kind == ANGLE:
        _add_turn(tan, piece.end_b, k, d, m)
        _add_turn(tan, piece.end_a, -k, -d, -m)
        return
    nx, ny = g.nx, g.ny
    px, py, ux, uy = k * nx, k * ny, d * nx, d * ny
    if term.kind != WORLD_X and term.kind != WORLD_Y:
        dx, dy, vx, vy = b.x - a.x, b.y - a.y, b.vx - a.vx, b.vy - a.vy
        ax, ay, alpha = _station_acceleration(term.a, sys, work, tan)
        bx, by, _ = _station_acceleration(term.b, sys, work, tan)
        ax, ay = bx - ax, by - ay
        if term.kind == DISTANCE:
            length = nx * dx + ny * dy
            if length > 0.0:
                speed = nx * vx + ny * vy
                cx, cy = (vx - speed * nx) / length, (vy - speed * ny) / length
                ahead = nx * ax + ny * ay
                px += d * cx + m * (
                    (ax - ahead * nx) / length - (cx * cx + cy * cy) * nx - 2.0 * speed / length * cx
                )
                py += d * cy + m * (
                    (ay - ahead * ny) / length - (cx * cx + cy * cy) * ny - 2.0 * speed / length * cy
                )
                ux += 2.0 * m * cx
                uy += 2.0 * m * cy
        else:
            w = a.w
            along, across = nx * dx + ny * dy, nx * dy - ny * dx
            v_along, v_across = nx * vx + ny * vy, nx * vy - ny * vx
            px += -ny * (d * w + m * alpha) - m * w * w * nx
            py += nx * (d * w + m * alpha) - m * w * w * ny
            ux -= 2.0 * m * w * ny
            uy += 2.0 * m * w * nx
            by_q = k * across + d * (v_across - w * along)
            by_q += m * (nx * ay - ny * ax - alpha * along - 2.0 * w * v_along - w * w * across)
            by_v = d * across + 2.0 * m * (v_across - w * along)
            _add_turn(tan, piece.end_a, by_q, by_v, m * across)
    _add_row(tan, piece.end_b, px, py, ux, uy, m * nx, m * ny)
    _add_row(tan, piece.end_a, -px, -py, -ux, -uy, -m * nx, -m * ny)


@part
def _lean(kind: int, piece: Any, tension: float, weights: np.ndarray, sys: Any, work: Any, tan: Any) -> None:
    """A pathway's force as its direction changes: with the line it acts along, or the axes of its first point."""
    term = sys.terms[piece.term]
    g, a, b = work.geometry[piece.term], work.points[term.a], work.points[term.b]
    force = term.coefficient * tension
    dx, dy = b.x - a.x, b.y - a.y
    along = g.nx * dx + g.ny * dy
    if kind == LEAN_MOMENT:
        _add_column(tan, piece.end_a, 0.0, 0.0, 1.0)
        _add_row(tan, piece.end_b, force * g.ny, -force * g.nx, 0.0, 0.0, 0.0, 0.0)
        _add_row(tan, piece.end_a, -force * g.ny, force * g.nx, 0.0, 0.0, 0.0, 0.0)
        _add_turn(tan, piece.end_a, force * along, 0.0, 0.0)
        return
    _add_column(tan, piece.end_b, -g.ny, g.nx, 0.0)
    _add_column(tan, piece.end_a, g.ny, -g.nx, 0.0)
    if kind == LEAN_FORCE:
        _add_turn(tan, piece.end_a, -force, 0.0, 0.0)
    else:
        # a spring of no length that wants none pulls back from all sides
        stiffness = -force / along if along > 0.0 else term.coefficient**2 * weights[0]
        _add_row(tan, piece.end_b, -stiffness * g.ny, stiffness * g.nx, 0.0, 0.0, 0.0, 0.0)
        _add_row(tan, piece.end_a, stiffness * g.ny, -stiffness * g.nx, 0.0, 0.0, 0.0, 0.0)


@part
def _add_column(tan: Any, end: int, fx: float, fy: float, moment: float) -> None:
    if end >= 0:
        tan.columns[end, 0] += fx
        tan.columns[end, 1] += fy
        tan.columns[end, 2] += moment


@part
def _add_turn(tan: Any, end: int, by_q: Any, by_v: Any, by_a: Any) -> None:
    if end >= 0:
        tan.rows[end, 0] += by_q
        tan.rows[end, 1] += by_v
        tan.rows[end, 2] += by_a


@part
def _add_row(tan: Any, end: int, px: Any, py: Any, ux: Any, uy: Any, ax: Any, ay: Any) -> None:
    if end >= 0:
        row = tan.rows[end]
        row[3] += ax
        row[4] += ay
        row[5] += px
        row[6] += py
        row[7] += ux
        row[8] += uy


@part
def _load(load: Any, sys: Any, places: Any, work: Any, tan: Any, bq: Any) -> None:
    """A force at a station: its arm moves with the body, a following one turns with the station."""
    station = sys.stations[load.station]
    if station.body < 0:
        return
    fx = work.signal[load.fx, 0] if load.fx >= 0 else 0.0
    fy = work.signal[load.fy, 0] if load.fy >= 0 else 0.0
    turning = 0.0
    if load.following == 1:
        at = work.points[load.station]
        c, s = np.cos(at.angle), np.sin(at.angle)
        fx, fy = c * fx - s * fy, s * fx + c * fy
        turning = 1.0
    hold_force(station, load.station, sys.bodies, places, work.frames, tan, bq, fx, fy, turning)


@part
def hold_force(
    station: Any,
    k: int,
    bodies: Any,
    places: Any,
    frames: Any,
    tan: Any,
    bq: Any,
    fx: float,
    fy: float,
    turning: float,
) -> None:
    """What a body asks for as a force on it at a station moves with the station, and turns with it if `turning`."""
    b, f, tb, place, r = (
        bodies[station.body],
        frames[station.body],
        tan.bodies[station.body],
        places[station.body],
        tan.relative[k],
    )
    gx, gy = turning * bq * fy, -turning * bq * fx
    moment = r[0] * gy - r[1] * gx
    tb.H[0, 0] += gx
    tb.H[1, 0] += gy
    tb.H[2, 0] += moment + bq * (r[0] * fx + r[1] * fy)
    ahead = bq * (f.c * fx + f.s * fy)
    if station.row_w >= 0:
        w = place.row0 + station.row_w - b.row0
        tan.HY[w, 2] += ahead
        tan.PX[w, 0] += ahead + f.c * gy - f.s * gx
        if station.row_s >= 0:
            tan.P[place.matrix0 + (station.row_w - b.row0) * place.nr + station.row_s - b.row0] += (
                f.c * gy - f.s * gx
            )
    if station.row_s >= 0:
        at = place.row0 + station.row_s - b.row0
        tan.HY[at, 0] += gx
        tan.HY[at, 1] += gy
        tan.HY[at, 2] += moment


@part
def _distributed(load: Any, work: Any, tan: Any, bodies: Any, places: Any, bq: Any) -> None:
    """A load on a stretch of a beam: of fixed direction, or turning with the body."""
    f, tb, b, place = (
        work.frames[load.body],
        tan.bodies[load.body],
        bodies[load.body],
        places[load.body],
    )
    qx, qy = work.signal[load.fx, 0], work.signal[load.fy, 0]
    row = place.row0 + load.row - b.row0
    if load.following == 0:
        qx, qy = f.c * qx + f.s * qy, f.c * qy - f.s * qx
        tb.H[2, 0] += bq * (load.moment * qx + work.rows[load.row].value * qy)
        tan.PX[row, 0] += bq * qx
    else:
        tb.H[0, 0] += bq * (f.s * qx + f.c * qy) * load.length
        tb.H[1, 0] -= bq * (f.c * qx - f.s * qy) * load.length
    tan.HY[row, 2] += bq * qx
