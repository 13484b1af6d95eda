"""The linearised equations of motion at a state: what each body, pathway and load contributes.

The unknown is one number x per coordinate; with three weights (bq, bv, ba) of the integrator it varies
    dq = bq x,    dv = bv x + v0,    dq'' = ba x + a0
so that an acceleration asks for (0, 0, 1), statics for (1, 0, 0), an implicit step for all three. In world axes:

    X = (theta, a, p, u)  of a frame: dangle = bq theta, dw = bv theta, dalpha = ba theta; da, dplace, dvelocity
    y              of a row of a flexible body: R x
    turn, lift     (a, p, u) of a station per unit of its body's theta, per unit of its row of deflection
    swing, along   (a, p, u) of a joint's inner station per unit of theta of its axes, of x along each
    H, HY          wrench that a body asks for, about its frame's origin: dW = H X + HY^T y + (g times links' unknowns)
    PX, P          forces that it asks for on its rows: phi = PX X + P y + (share_g times the links' unknowns)
    N              R diag(1/D) R^T,   D = ba + bv d + bq (omega^2 - w^2)
    g, h           a link's column and row in a body; share_g, share_h the same on its rows
A motion r that turns with a body varies by (bq z x r, bv z x r + bq z x r', ba z x r + 2 bv z x r' + bq z x r'').
The state is that of the last `accelerations` with the same `work`, whose accelerations and multipliers are used.
"""

from typing import Any

import numpy as np

from fmbd.planar.compile import inner
from fmbd.planar.equations import reaction
from fmbd.planar.linearise_bodies import (
    clear_body,
    condense,
    own_inertia,
    point_inertia,
    relative_motion,
    sliding_joint,
    turned,
)
from fmbd.planar.linearise_forces import hold_distributed_load, hold_load, link_ends, pathway_forces


@inner
def linearise(
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
) -> None:
    """Fill `tan` at the state of `work`; constraints by their place (level 0), rate (1) or second derivative (2).

    per_z: dz per unit of the right-hand side of an integral, 1 / (its own weight).
    """
    for i in range(sys.bodies.size):
        b, f, tb, place = sys.bodies[i], work.frames[i], tan.bodies[i], cp.places[i]
        clear_body(tb)
        for k in range(b.station0, b.station0 + b.nstation):
            relative_motion(sys.stations[k], work.points[k], f, work.rows, tan.relative[k])
            r = tan.relative[k]
            turned(bq, bv, ba, r[0], r[1], r[2], r[3], r[4], r[5], tan.turn[k])
        own_inertia(b, f, sys.gravity, work.rows, tb, place, tan, q, v, bq, bv, ba)
        if b.nf > 0:
            condense(b, f, sys, work.R, place, tan, bq, bv, ba)
        if b.rotor == 0:
            tb.force[0], tb.force[1], _ = reaction(sys, work, i)
        if b.sliding == 1:
            sliding_joint(b, sys, work, tan, tb, bq, bv, ba)
    for k in range(sys.inertias.size):
        point_inertia(sys.inertias[k], sys, work, tan, cp.places, bq, bv, ba)
    pathway_forces(sys, cp, work, tan, bq, bv, per_z, level)
    link_ends(sys, cp, work, tan)
    for k in range(sys.loads.size):
        hold_load(sys.loads[k], sys, cp.places, work, tan, bq)
    for k in range(sys.distributed.size):
        hold_distributed_load(sys.distributed[k], work, tan, sys.bodies, cp.places, bq)
