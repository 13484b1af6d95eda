"""What each body contributes to the linearised equations: its inertia, its rows, the motion of its stations.

Symbols as in linearise.py, and
    s, p, eta, eta'   first moment and inertia about the frame's origin, modal coordinates and rates where linearised
"""

from typing import Any

import numpy as np

from fmbd.planar.compile import index, part, part_sums


@part
def clear_body(tb: Any) -> None:
    for i in range(3):
        for j in range(7):
            tb.H[i, j] = 0.0
        tb.own[i], tb.drag[i], tb.pull[i] = 0.0, 0.0, 0.0
    tb.force[0], tb.force[1] = 0.0, 0.0


@part
def relative_motion(station: Any, p: Any, f: Any, rows: Any, out: np.ndarray) -> None:
    """r, r', r'' of a station from the frame of its body."""
    x, y = p.x - f.x, p.y - f.y
    out[0], out[1], out[2], out[3] = x, y, p.vx - f.vx, p.vy - f.vy
    out[4], out[5] = p.bx - f.bx - f.aw * y, p.by - f.by + f.aw * x
    if station.row_w >= 0:
        out[4] -= f.s * rows[station.row_w].y
        out[5] += f.c * rows[station.row_w].y


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
def station_acceleration(k: int, sys: Any, work: Any, tan: Any) -> tuple[float, float, float]:
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
def own_inertia(
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
    ddmx, ddmy = f.ddmx, 0.0
    if b.nf > 0:
        ddmy = rows[b.row0].y
        _keep_eta(b, tan, q, v)
        if b.axial >= 0:
            ddmx += rows[b.axial].y
    sx, sy = c * f.mx - s * f.my, s * f.mx + c * f.my
    rx, ry = c * f.dmx - s * f.dmy, s * f.dmx + c * f.dmy
    dx, dy = -w * sy + rx, w * sx + ry
    ddx = -alpha * sy - w * w * sx - 2.0 * w * ry + c * ddmx - s * ddmy
    ddy = alpha * sx - w * w * sy + 2.0 * w * rx + s * ddmx + c * ddmy
    tb.S[0], tb.S[1], tb.S[2], tb.S[3], tb.S[4], tb.S[5] = sx, sy, dx, dy, f.J, f.spin
    H = tb.H
    H[0, 1], H[1, 2], H[2, 1], H[2, 2] = b.mass, b.mass, -sy, sx
    H[0, 0] = -ba * sy - 2.0 * bv * dy - bq * ddy
    H[1, 0] = ba * sx + 2.0 * bv * dx + bq * ddx
    H[2, 0] = f.J * ba + 2.0 * bv * f.spin - bq * (sx * ax + sy * ay)
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


@part
def _keep_eta(b: Any, tan: Any, q: np.ndarray, v: np.ndarray) -> None:
    """Copy eta and eta' of a body."""
    first, mode0 = index(b.first_q), index(b.mode0)
    for k in range(index(b.nf)):
        tan.eta[0, mode0 + k], tan.eta[1, mode0 + k] = q[first + k], v[first + k]


@part_sums
def condense(
    b: Any, f: Any, sys: Any, R: np.ndarray, place: Any, tan: Any, bq: Any, bv: Any, ba: Any
) -> None:
    """N of a flexible body."""
    n, w2 = place.nr, f.w * f.w
    nf, mode0 = index(b.nf), index(b.mode0)
    for k in range(nf):
        D = ba + bv * sys.modal_damping[mode0 + k] + bq * (sys.omega2[mode0 + k] - w2)
        tan.per_D[mode0 + k] = 1.0 / D
    for i in range(b.nrow):
        at = index(b.matrix0 + i * b.nf)
        for j in range(i + 1):
            other = index(b.matrix0 + j * b.nf)
            total = tan.per_D[b.mode0] * 0.0
            for k in range(nf):
                total += R[at + k] * R[other + k] * tan.per_D[mode0 + k]
            tan.N[place.matrix0 + i * n + j] = total
            tan.N[place.matrix0 + j * n + i] = total
    for i in range(2):
        for j in range(b.nrow):
            other = index(b.matrix0 + j * b.nf)
            total = tan.per_D[b.mode0] * 0.0
            for k in range(nf):
                total += R[other + k] * tan.eta[i, mode0 + k] * tan.per_D[mode0 + k]
            tan.N[place.matrix0 + (b.nrow + i) * n + j] = total
            tan.N[place.matrix0 + j * n + b.nrow + i] = total
        for j in range(i + 1):
            total = tan.per_D[b.mode0] * 0.0
            for k in range(nf):
                total += tan.eta[i, mode0 + k] * tan.eta[j, mode0 + k] * tan.per_D[mode0 + k]
            tan.N[place.matrix0 + (b.nrow + i) * n + b.nrow + j] = total
            tan.N[place.matrix0 + (b.nrow + j) * n + b.nrow + i] = total


@part
def sliding_joint(b: Any, sys: Any, work: Any, tan: Any, tb: Any, bq: Any, bv: Any, ba: Any) -> None:
    """Motion of the inner station of a sliding joint from the outer one, and along the joint's axes."""
    f, a, c = work.frames[sys.stations[b.inner].body], work.points[b.outer], work.points[b.inner]
    ax, ay, alpha_a = station_acceleration(b.outer, sys, work, tan)
    cx, cy, alpha_c = station_acceleration(b.inner, sys, work, tan)
    arm = tb.arm
    arm[0], arm[1], arm[2], arm[3] = c.x - a.x, c.y - a.y, c.vx - a.vx, c.vy - a.vy
    arm[4], arm[5] = cx - ax, cy - ay
    turned(bq, bv, ba, arm[0], arm[1], arm[2], arm[3], arm[4], arm[5], tb.swing)
    w = a.w if b.sign > 0.0 else c.w
    alpha = alpha_a if b.sign > 0.0 else alpha_c
    _carried(bq, bv, ba, b.sign * f.jc, b.sign * f.js, w, alpha, tb.along[0])
    _carried(bq, bv, ba, -b.sign * f.js, b.sign * f.jc, w, alpha, tb.along[1])


@part
def point_inertia(point: Any, sys: Any, work: Any, tan: Any, places: Any, bq: Any, bv: Any, ba: Any) -> None:
    """The part of R R^T = I that is not in eta . eta of the inertia."""
    b, f, place = sys.bodies[point.body], work.frames[point.body], places[point.body]
    row = work.rows[point.row]
    r, n = point.row - b.row0, place.nr
    alpha = f.bw + f.aw
    inertia, value, rate = point.value, row.value, row.rate
    tan.HY[place.row0 + r, 2] -= 2.0 * inertia * (value * alpha * bq + f.w * (bq * rate + bv * value))
    tan.PX[place.row0 + r, 0] += 2.0 * inertia * f.w * bv * value
    tan.P[place.matrix0 + r * n + r] += inertia * f.w * f.w * bq
