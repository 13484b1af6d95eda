"""Eliminate the elastic coordinates of one flexible body, and put them back.

With D = I (the modal basis), eta'' = f_eta + R^T (g - H_row a + p), where p are further forces on the rows and only
the first two rows, s and p of planar.arrays, and the axial one of a beam that shortens are coupled with the frame
(H_row). For y = R eta'' that gives
    y = free + V a + N p,    N = W = R R^T,    V = -W H_row,    free = R f_eta + W g
What hangs on the rows changes free, V and N afterwards, see hanging.py.
Symbols as in recursion.py. A slot is one more column of forces: slot_y on the rows, slot_v the y that they give.
"""

from typing import Any

import numpy as np

from fmbd.planar.compile import index, part, part_sums


@part_sums
def free_rows(b: Any, R: np.ndarray, f_eta: np.ndarray, rows: Any) -> None:
    """R f_eta: the row accelerations that the modal forces alone would give."""
    mode0 = index(b.mode0)
    for r in range(b.nrow):
        start = index(b.matrix0 + r * b.nf)
        total = 0.0
        for k in range(index(b.nf)):
            total += R[start + k] * f_eta[mode0 + k]
        rows[b.row0 + r].free = total


@part
def eliminate_modes(
    b: Any,
    f: Any,
    rows: Any,
    gram: np.ndarray,
    N: np.ndarray,
    slots: Any,
    slot_y: np.ndarray,
    slot_v: np.ndarray,
    block: np.ndarray,
) -> None:
    """Condense a flexible body on its own into its H, g and slots; rows[] hold free and V."""
    n, row0, gram0 = index(b.nrow), index(b.row0), index(b.gram0)
    lateral, turning = rows[b.row0], rows[b.row0 + 1]
    for r in range(n):
        row = rows[row0 + r]
        start = gram0 + r * n
        total = row.free
        for j in range(n):
            total += gram[start + j] * rows[row0 + j].g
        row.free = total
        row.push = 0.0
        row.Vx, row.Vy, row.Vz = gram[start] * f.s, -gram[start] * f.c, -gram[start + 1]
        if b.axial >= 0:
            drawn = gram[start + index(b.axial) - row0]
            row.Vx -= drawn * f.c
            row.Vy -= drawn * f.s
        if b.first_hung >= 0:
            for j in range(n):
                N[start + j] = gram[start + j]
    f.Hxx -= f.s * lateral.Vx
    f.Hxy -= f.s * lateral.Vy
    f.Hyy += f.c * lateral.Vy
    f.Hxz -= f.s * lateral.Vz
    f.Hyz += f.c * lateral.Vz
    f.Hzz += turning.Vz
    f.gx += f.s * lateral.free
    f.gy -= f.c * lateral.free
    f.gz -= turning.free
    if b.axial >= 0:
        axial = rows[b.axial]
        f.Hxx += f.c * axial.Vx
        f.Hxy += f.c * axial.Vy
        f.Hyy += f.s * axial.Vy
        f.Hxz += f.c * axial.Vz
        f.Hyz += f.s * axial.Vz
        f.gx -= f.c * axial.free
        f.gy -= f.s * axial.free
    for m in range(b.nslot):
        s = slots[b.slot0 + m]
        for r in range(n):
            total = 0.0
            for j in range(n):
                total += gram[b.gram0 + r * n + j] * slot_y[s.row0 + j]
            slot_v[s.row0 + r] = total
            s.rhs -= slot_y[s.row0 + r] * rows[b.row0 + r].free
        s.gx += f.s * slot_v[s.row0]
        s.gy -= f.c * slot_v[s.row0]
        s.gz -= slot_v[s.row0 + 1]
        if b.axial >= 0:
            drawn = slot_v[s.row0 + b.axial - b.row0]
            s.gx -= f.c * drawn
            s.gy -= f.s * drawn
        for j in range(m + 1):
            total = 0.0
            for r in range(n):
                total += slot_y[slots[b.slot0 + j].row0 + r] * slot_v[s.row0 + r]
            block[b.block0 + m * b.nslot + j] += total
            if j != m:
                block[b.block0 + j * b.nslot + m] += total


@part
def put_back_rows(
    b: Any, f: Any, rows: Any, slots: Any, slot_y: np.ndarray, slot_v: np.ndarray, reactions: Any
) -> None:
    """y of a flexible body from its frame's acceleration and the multipliers; rows[].g gets what forces eta''.

    rows[].push are the forces on the rows from outside: of a joint that holds the body by them, of what hangs on them.
    """
    for r in range(b.nrow):
        row = rows[b.row0 + r]
        row.y = row.free + row.Vx * f.ax + row.Vy * f.ay + row.Vz * f.aw
        row.g += row.push
        for m in range(b.slot0, b.slot0 + b.nslot):
            multiplier = reactions[slots[m].constraint].multiplier
            row.y += slot_v[slots[m].row0 + r] * multiplier
            row.g += slot_y[slots[m].row0 + r] * multiplier
    rows[b.row0].g -= f.c * f.ay - f.s * f.ax
    rows[b.row0 + 1].g -= f.aw
    if b.axial >= 0:
        rows[b.axial].g -= f.c * f.ax + f.s * f.ay


@part_sums
def put_back_modes(b: Any, R: np.ndarray, f_eta: np.ndarray, rows: Any, qdd: np.ndarray) -> None:
    """eta'' = f_eta + R^T g."""
    first, mode0 = index(b.first_q), index(b.mode0)
    for k in range(index(b.nf)):
        qdd[first + k] = f_eta[mode0 + k]
    for r in range(b.nrow):
        force = rows[b.row0 + r].g
        start = index(b.matrix0 + r * b.nf)
        for k in range(index(b.nf)):
            qdd[first + k] += R[start + k] * force
