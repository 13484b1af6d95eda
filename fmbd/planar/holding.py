"""A flexible body that is held by one of its own rows: at a station that moves against the body's frame.

The body's frame is where its deflection is zero; a beam carried at its far end is held elsewhere. Its modes are
eliminated as if it were free, which leaves H_f a_f = g_f + A^T F for the frame and the acceleration of the station
    a = A a_f + G (y of its rows),    A = P + G V_h,    F = reaction at the station,
with P the shift from frame to station, G how the station moves with its rows, V_h and N_h those rows of V and N
(condensation.py). Hence a = E F + c:
    E = A H_f^-1 A^T + G N_hh G^T,    c = A H_f^-1 g_f + G y_free
and H = E^-1, g = E^-1 c at the station. Sums of compliances, all positive: a change of the unknown from a_f to a
before the modes are eliminated would give the same by differences of large numbers.
"""

from typing import Any

import numpy as np

from fmbd.planar.compile import part
from fmbd.planar.kinematics import station_row


@part
def hold_by_rows(
    b: Any,
    f: Any,
    hold: Any,
    inner: Any,
    rows: Any,
    N: np.ndarray,
    slots: Any,
    slot_v: np.ndarray,
    block: np.ndarray,
) -> None:
    """Turn H, g and the slots of a body without its modes from its frame to the inner station that holds it."""
    _station_motion(b, f, hold, inner, rows, N)
    inverse, A, E, c, G = hold.inverse, hold.A, hold.E, hold.c, hold.G
    inverse[0, 0], inverse[0, 1], inverse[0, 2] = f.Hxx, f.Hxy, f.Hxz
    inverse[1, 0], inverse[1, 1], inverse[1, 2] = f.Hxy, f.Hyy, f.Hyz
    inverse[2, 0], inverse[2, 1], inverse[2, 2] = f.Hxz, f.Hyz, f.Hzz
    _invert(inverse)
    hold.g[0], hold.g[1], hold.g[2] = f.gx, f.gy, f.gz
    for k in range(3):
        for i in range(3):
            hold.AI[k, i] = A[k, 0] * inverse[0, i] + A[k, 1] * inverse[1, i] + A[k, 2] * inverse[2, i]
    for k in range(3):
        c[k] += hold.AI[k, 0] * f.gx + hold.AI[k, 1] * f.gy + hold.AI[k, 2] * f.gz
        for i in range(3):
            E[k, i] += hold.AI[k, 0] * A[i, 0] + hold.AI[k, 1] * A[i, 1] + hold.AI[k, 2] * A[i, 2]
    _invert(E)
    f.Hxx, f.Hxy, f.Hxz, f.Hyy, f.Hyz, f.Hzz = E[0, 0], E[0, 1], E[0, 2], E[1, 1], E[1, 2], E[2, 2]
    f.gx, f.gy, f.gz = _times(E, c[0], c[1], c[2])
    for k in range(b.slot0, b.slot0 + b.nslot):
        s = slots[k]
        s.frame[0], s.frame[1], s.frame[2] = s.gx, s.gy, s.gz
        for i in range(3):
            s.station[i] = hold.AI[i, 0] * s.gx + hold.AI[i, 1] * s.gy + hold.AI[i, 2] * s.gz
        for kind in range(3):
            row = station_row(inner, kind)
            if row >= 0:
                moved = slot_v[s.row0 + row - b.row0]
                for i in range(3):
                    s.station[i] += G[kind, i] * moved
        s.gx, s.gy, s.gz = _times(E, s.station[0], s.station[1], s.station[2])
        s.rhs += s.gx * c[0] + s.gy * c[1] + s.gz * c[2]
        x, y, z = _times(inverse, s.frame[0], s.frame[1], s.frame[2])
        s.rhs -= x * hold.g[0] + y * hold.g[1] + z * hold.g[2]
    for m in range(b.nslot):
        s = slots[b.slot0 + m]
        x, y, z = _times(inverse, s.frame[0], s.frame[1], s.frame[2])
        for j in range(b.nslot):
            t = slots[b.slot0 + j]
            block[b.block0 + m * b.nslot + j] += x * t.frame[0] + y * t.frame[1] + z * t.frame[2]
            block[b.block0 + m * b.nslot + j] -= (
                s.gx * t.station[0] + s.gy * t.station[1] + s.gz * t.station[2]
            )


@part
def _station_motion(b: Any, f: Any, hold: Any, inner: Any, rows: Any, N: np.ndarray) -> None:
    """A and G; c and E begin with what the rows alone contribute."""
    A, E, c, G = hold.A, hold.E, hold.c, hold.G
    for k in range(3):
        for i in range(3):
            A[k, i] = 1.0 if k == i else 0.0
            E[k, i] = 0.0
        c[k], G[0, k], G[1, k], G[2, k] = 0.0, 0.0, 0.0, 0.0
    A[0, 2], A[1, 2] = f.y - f.py, f.px - f.x
    if inner.row_w >= 0:
        G[0, 0], G[0, 1] = -f.s, f.c
    if inner.row_s >= 0:
        G[1, 2] = 1.0
    if inner.row_u >= 0:
        G[2, 0], G[2, 1] = f.c, f.s
    for kind in range(3):
        at = station_row(inner, kind)
        if at < 0:
            continue
        start = b.gram0 + (at - b.row0) * b.nrow
        row = rows[at]
        for k in range(3):
            A[k, 0] += G[kind, k] * row.Vx
            A[k, 1] += G[kind, k] * row.Vy
            A[k, 2] += G[kind, k] * row.Vz
            c[k] += G[kind, k] * row.free
        for other in range(3):
            beside = station_row(inner, other)
            if beside >= 0:
                for k in range(3):
                    for i in range(3):
                        E[k, i] += G[kind, k] * N[start + beside - b.row0] * G[other, i]


@part
def let_go_of_rows(
    b: Any,
    f: Any,
    hold: Any,
    inner: Any,
    rows: Any,
    N: np.ndarray,
    slots: Any,
    reactions: Any,
    fx: float,
    fy: float,
    moment: float,
) -> None:
    """The frame's acceleration, and the force on the rows, from the reaction at the station that holds the body."""
    A, g = hold.A, hold.g
    x = g[0] + A[0, 0] * fx + A[1, 0] * fy + A[2, 0] * moment
    y = g[1] + A[0, 1] * fx + A[1, 1] * fy + A[2, 1] * moment
    z = g[2] + A[0, 2] * fx + A[1, 2] * fy + A[2, 2] * moment
    for k in range(b.slot0, b.slot0 + b.nslot):
        multiplier = reactions[slots[k].constraint].multiplier
        x += slots[k].frame[0] * multiplier
        y += slots[k].frame[1] * multiplier
        z += slots[k].frame[2] * multiplier
    f.ax, f.ay, f.aw = _times(hold.inverse, x, y, z)
    for kind in range(3):
        at = station_row(inner, kind)
        if at >= 0:
            push = hold.G[kind, 0] * fx + hold.G[kind, 1] * fy + hold.G[kind, 2] * moment
            rows[at].push += push
            start = b.gram0 + (at - b.row0) * b.nrow
            for r in range(b.nrow):
                rows[b.row0 + r].free += N[start + r] * push


@part
def _times(a: np.ndarray, x: float, y: float, z: float) -> tuple[float, float, float]:
    """a (x, y, z)."""
    return (
        a[0, 0] * x + a[0, 1] * y + a[0, 2] * z,
        a[1, 0] * x + a[1, 1] * y + a[1, 2] * z,
        a[2, 0] * x + a[2, 1] * y + a[2, 2] * z,
    )


@part
def _invert(a: np.ndarray) -> None:
    """Invert a symmetric positive definite 3 x 3 matrix in place, by the sweep operator."""
    for k in range(3):
        pivot = a[k, k]
        for i in range(3):
            for j in range(3):
                if i != k and j != k:
                    a[i, j] -= a[i, k] * a[k, j] / pivot
        for i in range(3):
            if i != k:
                a[i, k] /= pivot
                a[k, i] = a[i, k]
        a[k, k] = -1.0 / pivot
    for i in range(3):
        for j in range(3):
            a[i, j] = -a[i, j]
