"""First-order states in the linearised equations: currents of motors and integrals of controllers.

rz, dz          right-hand side and variation of the states (nz,)
length, rate    variation of a pathway's length and rate
theta, w, p, u  of a station: variation of angle (theta is per bq), angular velocity, place and velocity
"""

from typing import Any

import numpy as np

from fmbd.planar.arrays import ANGLE, DISTANCE, WORLD_X, WORLD_Y
from fmbd.planar.compile import inner, part
from fmbd.planar.tangent_given import given_at_station


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
    X, X0, turn = tb.X, tb.X0, tan.turn[k]
    given_ux, given_uy, _, _ = given_at_station(station, shift, f, tan.relative[k], tan, X0)
    theta, w0 = X[0], X0[0]
    px, py = X[3] + theta * turn[2], X[4] + theta * turn[3]
    ux, uy = X[5] + theta * turn[4] + X0[2] + given_ux, X[6] + theta * turn[5] + X0[3] + given_uy
    if station.row_w >= 0:
        y = tan.y[shift + station.row_w]
        px += tb.lift[2] * y
        py += tb.lift[3] * y
        ux += tb.lift[4] * y
        uy += tb.lift[5] * y
    if station.row_s >= 0:
        theta += tan.y[shift + station.row_s]
        w0 += tan.rate0[shift + station.row_s]
    return theta, bv * theta + w0, px, py, ux, uy
