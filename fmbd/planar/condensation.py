"""Eliminate the elastic coordinates of one flexible body, and put them back.

With D = I (the modal basis), eta'' = f_eta + R^T (g - H_row a - Hyy y) and y = R eta'':
    y = free - N H_row a,   N = (I + W Hyy)^-1 W,   W = R R^T
Symbols as in recursion.py. A slot is one more column of forces: slot_y on the rows, (gx, gy, gz) on the frame.
"""

from typing import Any

import numpy as np

from fmbd.planar.compile import part, part_sums


@part
def compliance(b: Any, gram: np.ndarray, Hyy: np.ndarray, N: np.ndarray, a: np.ndarray) -> None:
    """N = (I + W Hyy)^-1 W by elimination with row pivoting, in the scratch matrix a."""
    n = b.nrow
    for r in range(n):
        for j in range(n):
            total = 1.0 if r == j else 0.0
            for k in range(n):
                total += gram[b.gram0 + r * n + k] * Hyy[b.gram0 + k * n + j]
            a[r, j] = total
            a[r, n + j] = gram[b.gram0 + r * n + j]
    for k in range(n):
        best = k
        for r in range(k + 1, n):
            if abs(a[r, k]) > abs(a[best, k]):
                best = r
        if best != k:
            for j in range(k, 2 * n):
                a[k, j], a[best, j] = a[best, j], a[k, j]
        for r in range(n):
            if r != k and a[r, k] != 0.0:
                ratio = a[r, k] / a[k, k]
                for j in range(k, 2 * n):
                    a[r, j] -= ratio * a[k, j]
    for r in range(n):
        for j in range(n):
            N[b.gram0 + r * n + j] = a[r, n + j] / a[r, r]


@part_sums
def free_rows(b: Any, R: np.ndarray, f_eta: np.ndarray, rows: Any) -> None:
    """R f_eta: the row accelerations that the modal forces alone would give."""
    for r in range(b.nrow):
        start = b.matrix0 + r * b.nf
        total = 0.0
        for k in range(b.nf):
            total += R[start + k] * f_eta[b.mode0 + k]
        rows[b.row0 + r].free = total


@part
def eliminate_modes(
    b: Any,
    f: Any,
    rows: Any,
    Hyy: np.ndarray,
    N: np.ndarray,
    slots: Any,
    slot_y: np.ndarray,
    block: np.ndarray,
) -> None:
    """Condense the rows of a flexible body into its H, g and slots; rows[].free becomes y at zero a.

    Of a body with nothing on its rows only the first two, s and p, couple with its frame.
    """
    n = b.nrow
    moving = n if b.coupled == 1 else 2
    for r in range(n):
        row = rows[b.row0 + r]
        row.push = row.g
        if b.coupled == 1:
            for j in range(n):
                row.push -= Hyy[b.gram0 + r * n + j] * rows[b.row0 + j].free
    _add_compliant(b, N, rows)
    for r in range(n):
        row = rows[b.row0 + r]
        nx, ny, nz = 0.0, 0.0, 0.0
        for j in range(moving):
            weight = N[b.gram0 + r * n + j]
            other = rows[b.row0 + j]
            nx += weight * other.Hx
            ny += weight * other.Hy
            nz += weight * other.Hz
        if r < moving:
            f.Hxx -= row.Hx * nx
            f.Hxy -= row.Hx * ny
            f.Hxz -= row.Hx * nz
            f.Hyy -= row.Hy * ny
            f.Hyz -= row.Hy * nz
            f.Hzz -= row.Hz * nz
            f.gx -= row.Hx * row.free
            f.gy -= row.Hy * row.free
            f.gz -= row.Hz * row.free
        for m in range(b.nslot):
            s = slots[b.slot0 + m]
            own = slot_y[s.row0 + r]
            if own == 0.0:
                continue
            s.gx -= nx * own
            s.gy -= ny * own
            s.gz -= nz * own
            s.rhs -= row.free * own
            for m2 in range(b.nslot):
                start = slots[b.slot0 + m2].row0
                total = 0.0
                for j in range(n):
                    total += N[b.gram0 + r * n + j] * slot_y[start + j]
                block[b.block0 + m * b.nslot + m2] += own * total


@part
def _add_compliant(b: Any, N: np.ndarray, rows: Any) -> None:
    """free += N push, for all rows of a body."""
    for r in range(b.nrow):
        total = 0.0
        for j in range(b.nrow):
            total += N[b.gram0 + r * b.nrow + j] * rows[b.row0 + j].push
        rows[b.row0 + r].free += total


@part
def put_back_rows(
    b: Any,
    f: Any,
    rows: Any,
    Hyy: np.ndarray,
    N: np.ndarray,
    slots: Any,
    slot_y: np.ndarray,
    reactions: Any,
) -> None:
    """y of a flexible body from its frame's acceleration and the multipliers; rows[].g becomes the force on eta''."""
    n = b.nrow
    for r in range(n):
        row = rows[b.row0 + r]
        row.push = 0.0
        if r < 2 or b.coupled == 1:
            row.push = -(row.Hx * f.ax + row.Hy * f.ay + row.Hz * f.aw)
        for m in range(b.slot0, b.slot0 + b.nslot):
            row.push += slot_y[slots[m].row0 + r] * reactions[slots[m].constraint].multiplier
        row.g += row.push
    _add_compliant(b, N, rows)
    for r in range(n):
        row = rows[b.row0 + r]
        row.y = row.free
        if b.coupled == 1:
            for j in range(n):
                row.g -= Hyy[b.gram0 + r * n + j] * rows[b.row0 + j].free


@part_sums
def put_back_modes(b: Any, R: np.ndarray, f_eta: np.ndarray, rows: Any, qdd: np.ndarray) -> None:
    """eta'' = f_eta + R^T g."""
    for k in range(b.nf):
        qdd[b.first_q + k] = f_eta[b.mode0 + k]
    for r in range(b.nrow):
        force = rows[b.row0 + r].g
        start = b.matrix0 + r * b.nf
        for k in range(b.nf):
            qdd[b.first_q + k] += R[start + k] * force
