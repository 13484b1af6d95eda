"""The linearised equations, factored once and solved for many right-hand sides, in O(bodies + modes).

    dID(x; v0, a0) = r      the variation of the equations of motion, one number per coordinate
Elimination towards the ground, body by body, as in recursion.py: the rows of a flexible body, the links that close
at it, its joint's coordinates. Nothing is symmetric here: what a body asks for depends on its motion X, what it is
given is a wrench. Symbols as in linearise.py, and
    A, YX, share_y   y = A^-1 (y0 - N phi0) + YX X + share_y . unknown,   A = I + N P
    U, V             row of a joint's coordinate after elimination: of X, of its other coordinates
    Q, ratio         what eliminating it subtracts from the joint's other rows and from the wrench
"""

from typing import Any

import numpy as np

from fmbd.planar.compile import compiled, inner, part
from fmbd.planar.linearise import linearise
from fmbd.planar.tangent_bodies import eliminate_rows, shift_to_joint, take_end
from fmbd.planar.tangent_joints import eliminate_joint, hand_down, load_parent
from fmbd.planar.tangent_solve import back_substitute
from fmbd.planar.tangent_states import give_states, put_back_states

# of the pivot of a constraint, against that of a free body
_ROUND_OFF = 1e-14


@inner
def factor(
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
) -> int:
    """Linearise at the state of `work` (see linearise) and eliminate.

    Returns -1, or the index of a body whose joint nothing holds.
    """
    linearise(sys, cp, work, tan, q, v, bq, bv, ba, per_z, level)
    _clear_shares(cp, tan)
    for i in range(sys.bodies.size - 1, -1, -1):
        b, f, tb, place = sys.bodies[i], work.frames[i], tan.bodies[i], cp.places[i]
        for e in range(place.end0, place.end0 + place.nend):
            take_end(cp.ends[e], e, sys, cp, work, tan, bq, bv, ba)
        shift_to_joint(b, f, sys.stations[b.inner], tb, place, tan, bq)
        if b.nf > 0 and not eliminate_rows(b, tb, place, tan):
            return i
        n = place.nslot
        _close(tb, True, cp, tan, place.slot0, n, place.closed, place.block0, n, n)
        if not eliminate_joint(b, f, tb, place, tan, bq):
            return i
        if b.parent >= 0:
            parent = sys.bodies[b.parent]
            load_parent(
                b,
                tb,
                parent,
                work.frames[b.parent],
                tan.bodies[b.parent],
                sys.stations[b.outer],
                cp,
                tan,
                bq,
                place,
            )
            up = cp.places[b.parent]
            hand_down(place, cp, tan, up.slot0, up.block0, up.nslot)
        else:
            hand_down(place, cp, tan, cp.ground_share0, cp.ground_base, cp.ground_stride)
    n = cp.shares.size - cp.ground_share0
    if n > 0:
        base, stride, band = cp.ground_base, cp.ground_stride, cp.ground_band
        _close(tan.bodies[0], False, cp, tan, cp.ground_share0, n, n, base, stride, band)
    return -1


@part
def _clear_shares(cp: Any, tan: Any) -> None:
    for k in range(cp.shares.size):
        s = tan.shares[k]
        for j in range(3):
            s.g[j] = 0.0
        for j in range(len(tan.width)):
            s.h[j] = 0.0
    for k in range(tan.block.size):
        tan.block[k] = 0.0
    for k in range(tan.share_g.size):
        tan.share_g[k] = 0.0
        tan.share_h[k] = 0.0
    # a link's own coefficient belongs to the place where it closes
    for i in range(cp.places.size):
        place = cp.places[i]
        for m in range(place.closed):
            tan.block[place.block0 + m * place.nslot + m] = tan.diagonal[cp.shares[place.slot0 + m].link]
    n = cp.shares.size - cp.ground_share0
    for m in range(n):
        tan.block[cp.ground_base + m * cp.ground_stride + m] = tan.diagonal[
            cp.shares[cp.ground_share0 + m].link
        ]


@part
def _close(
    tb: Any,
    on_body: bool,
    cp: Any,
    tan: Any,
    slot0: int,
    n: int,
    closed: int,
    base: int,
    stride: int,
    band: int,
) -> None:
    """Eliminate the links that close here: block . unknown + h . X = rhs; the block as in planar.loops."""
    block = tan.block
    for c in range(closed):
        s = tan.shares[slot0 + c]
        row = base + c * stride
        last = min(n, c + 1 + band)
        s.per_D = 0.0
        link = cp.shares[slot0 + c].link
        if tan.redundant[link] == 1 or not abs(block[row + c]) > _ROUND_OFF * tan.scale[link]:
            continue
        s.per_D = 1.0 / block[row + c]
        if on_body:
            for i in range(3):
                ratio = s.g[i] * s.per_D
                for j in range(len(tan.width)):
                    tb.H[i, j] -= ratio * s.h[j]
        for m in range(c + 1, last):
            t = tan.shares[slot0 + m]
            if on_body and block[row + m] != 0.0:
                ratio = block[row + m] * s.per_D
                for i in range(3):
                    t.g[i] -= s.g[i] * ratio
            ratio = block[base + m * stride + c] * s.per_D
            block[base + m * stride + c] = ratio
            if ratio == 0.0:
                continue
            if on_body:
                for j in range(len(tan.width)):
                    t.h[j] -= ratio * s.h[j]
            for j in range(c + 1, last):
                block[base + m * stride + j] -= ratio * block[row + j]


@compiled
def solve_linearised(
    sys: Any,
    cp: Any,
    work: Any,
    tan: Any,
    q: np.ndarray,
    v: np.ndarray,
    weights: np.ndarray,
    v0: np.ndarray,
    a0: np.ndarray,
    r: np.ndarray,
    rz: np.ndarray,
    x: np.ndarray,
    dz: np.ndarray,
) -> int:
    """Factor and solve once, for callers in Python: x (nq,) and dz (nz,) with weights (bq, bv, ba, per_z)."""
    bq, bv, ba, per_z = weights[0], weights[1], weights[2], weights[3]
    failed = factor(sys, cp, work, tan, q, v, bq, bv, ba, per_z, 2)
    give_states(sys, cp, tan, rz)
    dz[:] = 0.0
    back_substitute(sys, cp, work, tan, v0, a0, r, x)
    put_back_states(sys, cp, work, tan, x, v0, rz, bq, bv, per_z, dz)
    return failed
