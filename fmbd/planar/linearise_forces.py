"""What forces contribute to the linearised equations: along pathways, through links, and as loads.

Symbols as in linearise.py, and
    k, d, m   by how much a force along a pathway falls per unit of its l, l', l''
    column    of a link: its wrenches on its ends (see tangent_arrays.py)
    row       of a link: its weights of the angles, places and motions of its ends
"""

from typing import Any

import numpy as np

from fmbd.planar.arrays import ANGLE, DISTANCE, WORLD_X, WORLD_Y
from fmbd.planar.compile import part
from fmbd.planar.laws import law
from fmbd.planar.linearise_bodies import station_acceleration
from fmbd.planar.tangent_arrays import COMMAND, LEAN_FORCE, LEAN_MOMENT, MULTIPLIER


@part
def pathway_forces(sys: Any, cp: Any, work: Any, tan: Any, bq: Any, bv: Any, per_z: Any, level: int) -> None:
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
def link_ends(sys: Any, cp: Any, work: Any, tan: Any) -> None:
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
        ax, ay, alpha = station_acceleration(term.a, sys, work, tan)
        bx, by, _ = station_acceleration(term.b, sys, work, tan)
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
def hold_load(load: Any, sys: Any, places: Any, work: Any, tan: Any, bq: Any) -> None:
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
def hold_distributed_load(load: Any, work: Any, tan: Any, bodies: Any, places: Any, bq: Any) -> None:
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
