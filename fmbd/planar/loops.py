"""Multipliers of closed loops inside the recursion: one scalar at a time, at the body where the loop closes.

A slot holds one column of Phi_q^T as an articulated body sees it; `block` is the Schur complement of a body's slots.
Eliminated in order, put back in the reverse order. A pivot that vanishes marks a dependent (redundant) constraint, or
one that nothing can give way to (a beam pulled along its axis); its multiplier is set to zero.
"""

from typing import Any

import numpy as np

from fmbd.planar.compile import part

# A pivot this small against that of a free body is round-off.
DEPENDENT = 1e-11


@part
def constraint_columns(
    path: Any,
    terms: Any,
    geometry: Any,
    stations: Any,
    points: Any,
    frames: Any,
    slots: Any,
    slot_y: np.ndarray,
) -> None:
    """Put the wrenches of a unit multiplier of a constraint into the slots of the bodies that it touches."""
    for j in range(path.term0, path.term0 + path.nterm):
        term = terms[j]
        g = geometry[j]
        f = term.coefficient
        if term.slot_b >= 0:
            slot = slots[term.slot_b]
            _column(slot, stations[term.b], points[term.b], frames, slot_y, f * g.nx, f * g.ny, f * g.mb)
        if term.slot_a >= 0:
            slot = slots[term.slot_a]
            _column(slot, stations[term.a], points[term.a], frames, slot_y, -f * g.nx, -f * g.ny, f * g.ma)


@part
def _column(
    slot: Any, station: Any, at: Any, frames: Any, slot_y: np.ndarray, fx: float, fy: float, moment: float
) -> None:
    frame = frames[station.body]
    slot.gx += fx
    slot.gy += fy
    slot.gz += (at.x - frame.x) * fy - (at.y - frame.y) * fx + moment
    # the first of a slot's rows is the first row of its body
    if station.row_w >= 0:
        slot_y[slot.row0 + station.row_w - slot.first_row] += frame.c * fy - frame.s * fx
    if station.row_s >= 0:
        slot_y[slot.row0 + station.row_s - slot.first_row] += moment
    if station.row_u >= 0:
        slot_y[slot.row0 + station.row_u - slot.first_row] += frame.c * fx + frame.s * fy


@part
def close_loops(
    f: Any,
    on_body: bool,
    slots: Any,
    block: np.ndarray,
    constraints: Any,
    reactions: Any,
    slot0: int,
    n: int,
    closed: int,
    base: int,
    stride: int,
    band: int,
) -> None:
    """Eliminate the first `closed` of n slots: block lambda + g.a = rhs; f is the body they close at.

    Entry (m, j) of the block is block[base + m stride + j]; it is zero beyond `band` from the diagonal.
    """
    for c in range(closed):
        s = slots[slot0 + c]
        s.rhs += reactions[s.constraint].target
    for c in range(closed):
        s = slots[slot0 + c]
        row = base + c * stride
        pivot = block[row + c]
        s.pivot = pivot if pivot > DEPENDENT * constraints[s.constraint].freedom else 0.0
        reactions[s.constraint].redundant = 1 if s.pivot == 0.0 else 0
        if s.pivot == 0.0:
            continue
        if on_body:
            add_rank_one(f, 1.0 / pivot, s.gx, s.gy, s.gz)
            f.gx += s.gx * s.rhs / pivot
            f.gy += s.gy * s.rhs / pivot
            f.gz += s.gz * s.rhs / pivot
        last = min(n, c + 1 + band)
        for m in range(c + 1, last):
            ratio = block[row + m] / pivot
            if ratio == 0.0:
                continue
            t = slots[slot0 + m]
            t.gx -= ratio * s.gx
            t.gy -= ratio * s.gy
            t.gz -= ratio * s.gz
            t.rhs -= ratio * s.rhs
            for j in range(c + 1, last):
                block[base + m * stride + j] -= ratio * block[row + j]


@part
def open_loops(
    slots: Any,
    block: np.ndarray,
    reactions: Any,
    slot0: int,
    n: int,
    closed: int,
    base: int,
    stride: int,
    band: int,
    ax: float,
    ay: float,
    aw: float,
) -> None:
    """Multipliers of the loops that close here, last eliminated first."""
    for c in range(closed - 1, -1, -1):
        s = slots[slot0 + c]
        value = 0.0
        if s.pivot > 0.0:
            value = s.rhs - s.gx * ax - s.gy * ay - s.gz * aw
            for m in range(c + 1, min(n, c + 1 + band)):
                value -= block[base + c * stride + m] * reactions[slots[slot0 + m].constraint].multiplier
            value /= s.pivot
        reactions[s.constraint].multiplier = value


@part
def add_rank_one(f: Any, weight: float, x: float, y: float, z: float) -> None:
    """H += weight (x, y, z)^T (x, y, z)."""
    f.Hxx += weight * x * x
    f.Hxy += weight * x * y
    f.Hxz += weight * x * z
    f.Hyy += weight * y * y
    f.Hyz += weight * y * z
    f.Hzz += weight * z * z


@part
def hand_down(b: Any, slots: Any, block: np.ndarray, first: int, base: int, stride: int) -> None:
    """Add right-hand sides and Schur complement of the open slots to those of the parent or the ground."""
    n = b.nslot
    for m in range(b.closed, n):
        s = slots[b.slot0 + m]
        slots[s.parent].rhs += s.rhs
        for j in range(b.closed, n):
            k = base + (s.parent - first) * stride + slots[b.slot0 + j].parent - first
            block[k] += block[b.block0 + m * n + j]
