"""Where every body and station is, how fast it moves, and its acceleration at zero q'' (the bias).

    (x, y), angle   origin and orientation of a frame in the world
    c, s            cos(angle), sin(angle)
    (vx, vy), w     its twist
    (bx, by), bw    its acceleration when all q'' are zero
    (u)             from the outer to the inner station of a joint: R(joint axis) (jx, jy)
    w, psi          transverse displacement and slope of a beam's station: rows of R times eta
    u               its displacement along the beam, -1/2 eta^T H eta: a row that bends, R = -H eta
All vectors are in world axes. Turning a vector by the rate w: w x (a, b) = (-w b, w a).
"""

from math import cos, sin
from typing import Any

import numpy as np

from fmbd.planar.compile import index, part, part_sums


@part
def kinematics(sys: Any, work: Any, q: np.ndarray, v: np.ndarray) -> None:
    """Fill the frames of all bodies and stations from the coordinates q and rates v, both (nq,)."""
    for i in range(sys.bodies.size):
        b = sys.bodies[i]
        if b.nf > 0:
            _elastic_rows(b, sys.rows, q, v, work.rows)
            if b.nbend > 0:
                _bent_rows(b, sys.bends, sys.shortening, q, v, work.R, work.rows)
                _bent_gram(b, sys.bends, work.R, work.gram)
        outer = work.points[b.outer]
        _joint(b, sys.stations[b.inner], outer, work.frames[i], work.rows, work.signal, q, v)
        for k in range(b.station0, b.station0 + b.nstation):
            _station(sys.stations[k], work.points[k], work.frames[i], work.rows)
        _moments_of_mass(b, work.frames[i], work.rows, q, v)
    for k in range(sys.inertias.size):
        point = sys.inertias[k]
        frame, slope = work.frames[point.body], work.rows[point.row]
        frame.J -= point.value * slope.value * slope.value
        frame.spin -= point.value * slope.value * slope.rate


@part_sums
def _elastic_rows(b: Any, R: np.ndarray, q: np.ndarray, v: np.ndarray, rows: Any) -> None:
    """Rows times modal coordinates, R eta and R eta', of body b."""
    first = index(b.first_q)
    for r in range(b.nrow):
        start = index(b.matrix0 + r * b.nf)
        value = 0.0
        rate = 0.0
        for k in range(index(b.nf)):
            value += R[start + k] * q[first + k]
            rate += R[start + k] * v[first + k]
        rows[b.row0 + r].value = value
        rows[b.row0 + r].rate = rate


@part_sums
def _bent_rows(
    b: Any, bends: Any, H: np.ndarray, q: np.ndarray, v: np.ndarray, R: np.ndarray, rows: Any
) -> None:
    """Rows that bend, R = -H eta: u = 1/2 R eta, u' = R eta', u'' at zero eta'' = -eta'^T H eta'."""
    first, n = index(b.first_q), index(b.bent)
    for k in range(b.bend0, b.bend0 + b.nbend):
        start = index(b.matrix0 + (bends[k].row - b.row0) * b.nf)
        value, rate, bias = 0.0, 0.0, 0.0
        for i in range(n):
            at = index(bends[k].matrix0) + i * n
            total, swing = 0.0, 0.0
            for j in range(n):
                total -= H[at + j] * q[first + j]
                swing -= H[at + j] * v[first + j]
            R[start + i] = total
            value += total * q[first + i]
            rate += total * v[first + i]
            bias += swing * v[first + i]
        row = rows[bends[k].row]
        row.value, row.rate, row.bias = 0.5 * value, rate, bias


@part_sums
def _bent_gram(b: Any, bends: Any, R: np.ndarray, gram: np.ndarray) -> None:
    """R R^T where a row bends."""
    for k in range(b.bend0, b.bend0 + b.nbend):
        r = bends[k].row - b.row0
        own = index(b.matrix0 + r * b.nf)
        for j in range(b.nrow):
            other = index(b.matrix0 + j * b.nf)
            total = 0.0
            for i in range(index(b.bent)):
                total += R[own + i] * R[other + i]
            gram[b.gram0 + r * b.nrow + j] = total
            gram[b.gram0 + j * b.nrow + r] = total


@part_sums
def _moments_of_mass(b: Any, frame: Any, rows: Any, q: np.ndarray, v: np.ndarray) -> None:
    """First moment and moment of inertia of a body as it is deformed, about its frame's origin.

    (mx + U, my + s.eta) and J + eta.eta + 2 X, where U = int u dm and X = int x u dm if it shortens.
    """
    mx, my, dmx, dmy, ddmx, J, spin = b.mx, b.my, 0.0, 0.0, 0.0, b.J, 0.0
    if b.nf > 0:
        first = index(b.first_q)
        square = 0.0
        for k in range(index(b.nf)):
            square += q[first + k] * q[first + k]
            spin += q[first + k] * v[first + k]
        J += square
        my += rows[b.row0].value
        dmy = rows[b.row0].rate
        if b.axial >= 0:
            axial, outward = rows[b.axial], rows[b.axial + 1]
            mx += axial.value
            dmx, ddmx = axial.rate, axial.bias
            J += 2.0 * outward.value
            spin += outward.rate
    frame.mx, frame.my, frame.dmx, frame.dmy, frame.ddmx, frame.J, frame.spin = (
        mx,
        my,
        dmx,
        dmy,
        ddmx,
        J,
        spin,
    )


@part
def _joint(
    b: Any, inner: Any, outer: Any, frame: Any, rows: Any, signal: np.ndarray, q: np.ndarray, v: np.ndarray
) -> None:
    """Frame of a body from the station that holds it and the coordinates of its joint."""
    sign = b.sign
    ja, da, dda = _coordinate(b.coordinate[2], b.driver[2], q, v, signal)
    angle = outer.angle + sign * ja
    w = outer.w + sign * da
    bw = outer.bw + sign * dda
    px, py, vx, vy, bx, by = outer.x, outer.y, outer.vx, outer.vy, outer.bx, outer.by
    if b.sliding == 1:
        jx, dx, ddx = _coordinate(b.coordinate[0], b.driver[0], q, v, signal)
        jy, dy, ddy = _coordinate(b.coordinate[1], b.driver[1], q, v, signal)
        # the joint's axes turn with its first point: the outer station, or the inner one of a reversed joint
        forward = sign > 0.0
        first = outer.angle if forward else angle
        w1 = outer.w if forward else w
        bw1 = outer.bw if forward else bw
        c1, s1 = cos(first), sin(first)
        jc = b.axis_c * c1 - b.axis_s * s1
        js = b.axis_c * s1 + b.axis_s * c1
        ux, uy = jc * jx - js * jy, js * jx + jc * jy
        rx, ry = jc * dx - js * dy, js * dx + jc * dy
        ax, ay = jc * ddx - js * ddy, js * ddx + jc * ddy
        frame.jc, frame.js, frame.ux, frame.uy = jc, js, ux, uy
        px += sign * ux
        py += sign * uy
        vx += sign * (rx - w1 * uy)
        vy += sign * (ry + w1 * ux)
        bx += sign * (ax - bw1 * uy - w1 * w1 * ux - 2.0 * w1 * ry)
        by += sign * (ay + bw1 * ux - w1 * w1 * uy + 2.0 * w1 * rx)
    frame.px, frame.py = px, py
    # a rotor has no mass and no points off its axis: it looks the same at every angle
    c, s = 1.0, 0.0
    if b.rotor == 0:
        theta = angle - inner.angle
        if inner.row_s >= 0:
            theta -= rows[inner.row_s].value
        c, s = cos(theta), sin(theta)
    _frame_from_station(inner, rows, frame, c, s, angle, w, bw, vx, vy, bx, by)


@part
def _coordinate(
    index: int, driver: int, q: np.ndarray, v: np.ndarray, signal: np.ndarray
) -> tuple[float, float, float]:
    """Value, rate and prescribed second derivative of one direction of a joint."""
    if index >= 0:
        return q[index], v[index], 0.0
    if driver >= 0:
        return signal[driver, 0], signal[driver, 1], signal[driver, 2]
    return 0.0, 0.0, 0.0


@part
def _frame_from_station(
    inner: Any,
    rows: Any,
    frame: Any,
    c: float,
    s: float,
    angle: float,
    w: float,
    bw: float,
    vx: float,
    vy: float,
    bx: float,
    by: float,
) -> None:
    """Go back from the station at (frame.px, frame.py) that holds the body to the body's own frame."""
    deflection, rate, slope, slope_rate = _deformation(inner, rows)
    u, du, ddu = _shortening(inner, rows)
    theta = angle - inner.angle - slope
    w -= slope_rate
    x, y = inner.ax + u, inner.ay + deflection
    rx, ry = c * x - s * y, s * x + c * y
    gx, gy = c * du - s * rate, s * du + c * rate
    frame.angle, frame.c, frame.s, frame.w, frame.bw = theta, c, s, w, bw
    frame.x = frame.px - rx
    frame.y = frame.py - ry
    frame.vx = vx + w * ry - gx
    frame.vy = vy - w * rx - gy
    frame.bx = bx + bw * ry + w * w * rx + 2.0 * w * gy - c * ddu
    frame.by = by - bw * rx + w * w * ry - 2.0 * w * gx - s * ddu


@part
def station_row(station: Any, kind: int) -> int:
    """Row that moves a station across the beam (kind 0), turns it (1), or moves it along the beam (2); -1: none."""
    if kind == 0:
        return station.row_w
    return station.row_s if kind == 1 else station.row_u


@part
def _deformation(station: Any, rows: Any) -> tuple[float, float, float, float]:
    """Deflection, its rate, slope, its rate, of a station on a beam; zeros on a rigid body."""
    deflection, rate, slope, slope_rate = 0.0, 0.0, 0.0, 0.0
    if station.row_w >= 0:
        deflection = rows[station.row_w].value
        rate = rows[station.row_w].rate
    if station.row_s >= 0:
        slope = rows[station.row_s].value
        slope_rate = rows[station.row_s].rate
    return deflection, rate, slope, slope_rate


@part
def _shortening(station: Any, rows: Any) -> tuple[float, float, float]:
    """Displacement along the beam, its rate, and its second derivative at zero eta'', of a station."""
    if station.row_u < 0:
        return 0.0, 0.0, 0.0
    row = rows[station.row_u]
    return row.value, row.rate, row.bias


@part
def _station(station: Any, out: Any, frame: Any, rows: Any) -> None:
    """A station from the frame of its body."""
    deflection, rate, slope, slope_rate = _deformation(station, rows)
    u, du, ddu = _shortening(station, rows)
    c, s, w = frame.c, frame.s, frame.w
    x, y = station.ax + u, station.ay + deflection
    rx, ry = c * x - s * y, s * x + c * y
    gx, gy = c * du - s * rate, s * du + c * rate
    out.x = frame.x + rx
    out.y = frame.y + ry
    out.angle = frame.angle + station.angle + slope
    out.vx = frame.vx - w * ry + gx
    out.vy = frame.vy + w * rx + gy
    out.w = w + slope_rate
    out.bx = frame.bx - frame.bw * ry - w * w * rx - 2.0 * w * gy + c * ddu
    out.by = frame.by + frame.bw * rx - w * w * ry + 2.0 * w * gx + s * ddu
    out.bw = frame.bw
