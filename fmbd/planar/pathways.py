"""Pathways: scalar functions l(q) of the configuration, the geometry of every spring, motor and constraint.

    e          unit vector along a term; D = p_b - p_a
    (n, ma, mb)  dl = n . (dp_b - dp_a) + ma dangle_a + mb dangle_b
    value, rate, bias   l, l', and l'' at zero q''
A unit force along the pathway puts the wrench (n, mb) on b and (-n, ma) on a.
"""

from math import cos, hypot, sin
from typing import Any

from fmbd.planar.arrays import ALONG_X, ANGLE, DISTANCE, WORLD_X, WORLD_Y
from fmbd.planar.compile import part


@part
def pathways(sys: Any, work: Any) -> None:
    """Value, rate and bias of all pathways from the frames of the stations."""
    for k in range(sys.pathways.size):
        path = sys.pathways[k]
        out = work.lengths[k]
        value, rate, bias = path.offset, 0.0, 0.0
        for j in range(path.term0, path.term0 + path.nterm):
            term = sys.terms[j]
            length, speed, push = _term(term, work.geometry[j], work.points[term.a], work.points[term.b])
            value += term.coefficient * length
            rate += term.coefficient * speed
            bias += term.coefficient * push
        out.value, out.rate, out.bias = value, rate, bias


@part
def _term(term: Any, out: Any, a: Any, b: Any) -> tuple[float, float, float]:
    """Elementary length of one term, its rate and bias; its wrenches go to `out`."""
    out.nx, out.ny, out.ma, out.mb = 0.0, 0.0, 0.0, 0.0
    if term.kind == ANGLE:
        out.ma, out.mb = -1.0, 1.0
        return b.angle - a.angle, b.w - a.w, b.bw - a.bw
    dx, dy = b.x - a.x, b.y - a.y
    vx, vy = b.vx - a.vx, b.vy - a.vy
    bx, by = b.bx - a.bx, b.by - a.by
    if term.kind == WORLD_X:
        out.nx = 1.0
        return dx, vx, bx
    if term.kind == WORLD_Y:
        out.ny = 1.0
        return dy, vy, by
    if term.kind == DISTANCE:
        length = hypot(dx, dy)
        if length == 0.0:
            out.nx = 1.0
            return 0.0, 0.0, 0.0
        ex, ey = dx / length, dy / length
        out.nx, out.ny = ex, ey
        speed = ex * vx + ey * vy
        return length, speed, ex * bx + ey * by + (vx * vx + vy * vy - speed * speed) / length
    ca, sa = cos(a.angle), sin(a.angle)
    ex = term.axis_c * ca - term.axis_s * sa
    ey = term.axis_c * sa + term.axis_s * ca
    if term.kind != ALONG_X:
        ex, ey = -ey, ex
    # e turns with a: e' = w (-ey, ex)
    length = ex * dx + ey * dy
    turned = ex * dy - ey * dx
    out.nx, out.ny, out.ma = ex, ey, turned
    speed = ex * vx + ey * vy + a.w * turned
    push = ex * bx + ey * by + a.bw * turned + 2.0 * a.w * (ex * vy - ey * vx) - a.w * a.w * length
    return length, speed, push


@part
def put_wrench(station: Any, at: Any, frames: Any, rows: Any, fx: float, fy: float, moment: float) -> None:
    """Add a force and a moment at a station to the applied wrench of its body and to its rows."""
    if station.body < 0:
        return
    frame = frames[station.body]
    frame.gx += fx
    frame.gy += fy
    frame.gz += (at.x - frame.x) * fy - (at.y - frame.y) * fx + moment
    if station.row_w >= 0:
        rows[station.row_w].g += frame.c * fy - frame.s * fx
    if station.row_s >= 0:
        rows[station.row_s].g += moment
    if station.row_u >= 0:
        rows[station.row_u].g += frame.c * fx + frame.s * fy


@part
def put_force(
    path: Any, terms: Any, geometry: Any, stations: Any, points: Any, frames: Any, rows: Any, force: float
) -> None:
    """Add a force (or torque) that acts along a pathway, positive where it lengthens it."""
    for j in range(path.term0, path.term0 + path.nterm):
        term = terms[j]
        g = geometry[j]
        f = term.coefficient * force
        put_wrench(stations[term.b], points[term.b], frames, rows, f * g.nx, f * g.ny, f * g.mb)
        put_wrench(stations[term.a], points[term.a], frames, rows, -f * g.nx, -f * g.ny, f * g.ma)
