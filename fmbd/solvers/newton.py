"""The end of an implicit step by Newton's method on the equations of motion, and errors passed through its tangent.

The unknown x is the change of q'' at the end, with dq = bq x and dv = bv x; of a first-order state it is the change dz,
that of its rate is dz / bv. Mem.trial and the row FINISH of Mem.k are the iterate, `work` keeps its multipliers.
"""

from math import sqrt
from typing import Any

import numpy as np

from fmbd.planar.compile import inner, part
from fmbd.planar.equations import constraint, settled
from fmbd.planar.residual import residual
from fmbd.planar.tangent import factor
from fmbd.planar.tangent_solve import back_substitute
from fmbd.planar.tangent_states import give_states, put_back_states
from fmbd.solvers.steps import (
    EVALUATIONS,
    FACTORISATIONS,
    OFF_CONSTRAINTS,
    RUNNING,
    STEP_TOO_SMALL,
)

#: Rows of Memory.k that are used here: rates at the end of the step, residual, unknown.
FINISH, RESIDUAL, UNKNOWN = range(3)
# what the iteration may leave, of the tolerance; and the most iterations
_EXACT = 1e-3
_MOST = 10


@inner
def newton(
    sys: Any,
    work: Any,
    couplings: Any,
    tan: Any,
    stabilised: bool,
    t: float,
    bq: float,
    bv: float,
    mem: Any,
    options: Any,
) -> int:
    """The end of the step at time t, constraints by rate (stabilised) or place, from the prediction in mem.trial.

    Ends when what is left to move, as the contraction foretells it, is a small part of the tolerance, or round-off.
    Returns RUNNING, or why there is no solution.
    """
    n, nc = sys.nq, sys.constraints.size
    nz = mem.trial.size - 2 * n - 2
    f1, R, X = mem.k[FINISH], mem.k[RESIDUAL], mem.k[UNKNOWN]
    q, v, z = mem.trial[:n], mem.trial[n : 2 * n], mem.trial[2 * n : 2 * n + nz]
    rz, x, nothing, dz = R[2 * n : 2 * n + nz], X[:n], X[n : 2 * n], X[2 * n : 2 * n + nz]
    level, tolerance = (1, 10.0 * options.closed) if stabilised else (0, options.closed)
    for i in range(nc):
        tan.scale[i] = sys.constraints[i].freedom * (bv if stabilised else bq)
    size, left, worst = np.inf, np.inf, np.inf
    for taken in range(_MOST + 1):
        mem.counters[EVALUATIONS] += 1
        k = f1.size - 2
        f1[k], f1[k + 1] = residual(sys, work, t, q, v, z, rz, f1[n : 2 * n], R[:n])
        before, worst = worst, 0.0
        for i in range(nc):
            place, rate, _ = constraint(sys.constraints[i], work.lengths, work.signal)
            worst = max(worst, abs(rate if stabilised else place))
        if left <= _EXACT and settled(worst, before, tolerance, work.points):
            return RUNNING
        if taken == _MOST:
            break
        for i in range(nz):
            rz[i] -= f1[2 * n + i]
        # the first tangent serves twice, which mostly is enough
        if taken != 1:
            mem.counters[FACTORISATIONS] += 1
            if factor(sys, couplings, work, tan, q, v, bq, bv, 1.0, bv, level) >= 0:
                break
        give_states(sys, couplings, tan, rz)
        for i in range(nc):
            place, rate, _ = constraint(sys.constraints[i], work.lengths, work.signal)
            # links begin with the constraints
            tan.rhs[i] = -(rate if stabilised else place)
        back_substitute(sys, couplings, work, tan, nothing, nothing, R[:n], x)
        put_back_states(sys, couplings, work, tan, x, nothing, rz, bq, bv, bv, dz)
        for i in range(nc):
            work.reactions[i].multiplier += tan.unknown[i]
        last, size = size, _move(n, nz, bq, bv, mem, options)
        left = size * min(1.0, size / last) if taken > 0 else size
        if not size < 1e300:
            break
        if taken > 1 and size > 0.5 * last:
            # no longer nearer: by round-off, or not at all
            if size > 1.0:
                break
            left = 0.0
    return OFF_CONSTRAINTS if left <= _EXACT else STEP_TOO_SMALL


@part
def _move(n: int, nz: int, bq: float, bv: float, mem: Any, options: Any) -> float:
    """Add the unknown to the end of the step; returns how much that is, in tolerances."""
    y, trial, f1, X = mem.y, mem.trial, mem.k[FINISH], mem.k[UNKNOWN]
    total = 0.0
    for i in range(n):
        f1[n + i] += X[i]
        trial[i] += bq * X[i]
        trial[n + i] += bv * X[i]
        place = bq * X[i] / (options.atol + options.rtol * max(abs(y[i]), abs(trial[i])))
        rate = bv * X[i] / (options.atol + options.rtol * max(abs(y[n + i]), abs(trial[n + i])))
        total += place * place + rate * rate
    for i in range(2 * n, 2 * n + nz):
        f1[i] += X[i] / bv
        trial[i] += X[i]
        state = X[i] / (options.atol + options.rtol * max(abs(y[i]), abs(trial[i])))
        total += state * state
    return sqrt(total / max(1, 2 * n + nz))


@inner
def smooth(
    sys: Any,
    work: Any,
    couplings: Any,
    tan: Any,
    bq: float,
    bv: float,
    weight: float,
    mem: Any,
    error: np.ndarray,
) -> None:
    """Pass an error through the tangent, S^-1 M: without what stiff vibrations and reactions only seem to add."""
    n, R, X = sys.nq, mem.k[RESIDUAL], mem.k[UNKNOWN]
    nz = mem.y.size - 2 * n - 2
    rz, x, nothing, dz = R[2 * n : 2 * n + nz], X[:n], X[n : 2 * n], X[2 * n : 2 * n + nz]
    for i in range(n):
        R[i] = -error[i] / weight
    give_states(sys, couplings, tan, rz)
    back_substitute(sys, couplings, work, tan, nothing, R[:n], nothing, x)
    put_back_states(sys, couplings, work, tan, x, nothing, rz, bq, bv, bv, dz)
    for i in range(n):
        error[i] = weight * x[i]
