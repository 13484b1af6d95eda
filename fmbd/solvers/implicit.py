"""What implicit methods share: begin, solutions of (S - J) U = R, the projection in the step's own metric, output.

    J     derivative of f at the state of `base`, a Work; S - J is factored in `tan`
    S     1 / (h gamma), weight of the step
With J of the constrained equations, dv' = da: U_q = (U_v + R_q) / S and the linearised equations of motion hold for
dq = U_q, dv = U_v, dq'' = S U_v - R_v. In x = S U_q: dq = x / S, dv = x - R_q, dq'' = S x - S R_q - R_v.
S is complex where a method has complex stages.

Steps end with a projection onto the constraints in the metric of the step itself, S^2 M + S D + K with its
tangent: in that of the mass alone it would stretch stiff modes by what a soft joint could give.
"""

from typing import Any

import numpy as np

from fmbd.planar.compile import inner, part
from fmbd.planar.equations import constraint, derivatives, settled
from fmbd.planar.kinematics import kinematics
from fmbd.planar.pathways import pathways
from fmbd.planar.signals import evaluate_signals
from fmbd.planar.tangent import factor
from fmbd.planar.tangent_solve import back_substitute
from fmbd.planar.tangent_states import give_states, put_back_states
from fmbd.solvers.steps import (
    BEFORE_BREAK,
    BODY,
    EVALUATIONS,
    FACTORISATIONS,
    FRESH,
    INTERPOLANT,
    NO_INERTIA,
    NOT_A_NUMBER,
    NOW,
    PROJECTIONS,
    RUNNING,
    STEP,
    WANTED,
    aim,
    copy,
    euler_step,
    first_step,
    interpolate,
    is_finite,
    moved,
    pass_breaks,
)


@inner
def evaluate(sys: Any, work: Any, t: float, y: np.ndarray, dy: np.ndarray, mem: Any) -> int:
    """dy = f(t, y)."""
    mem.counters[EVALUATIONS] += 1
    return derivatives(sys, work, t, y, dy, 0.0, 0.0)


@inner
def begin(
    sys: Any,
    work: Any,
    base: Any,
    order: int,
    f0: np.ndarray,
    f1: np.ndarray,
    mem: Any,
    breaks: np.ndarray,
    options: Any,
) -> int:
    """Length of the next step, and f0 = f at its start, by `base`, where the last step has not left it; a status.

    order: of the error estimate; f1 is scratch.
    """
    clock, count = mem.clock, mem.counters
    pass_breaks(mem, breaks)
    if count[FRESH] == 1:
        failed = evaluate(sys, base, clock[NOW], mem.y, f0, mem)
        if failed >= 0:
            count[BODY] = failed
            return NO_INERTIA
        if not is_finite(f0):
            return NOT_A_NUMBER
        count[FRESH], count[INTERPOLANT] = 0, 0
    if clock[WANTED] == 0.0:
        clock[STEP] = euler_step(f0, mem, options)
        combine(mem.y, f0, clock[STEP], mem.trial)
        probe = min(clock[NOW] + clock[STEP], clock[BEFORE_BREAK])
        evaluate(sys, work, probe, mem.trial, f1, mem)
        clock[WANTED] = first_step(f0, f1, order, mem, options)
    aim(mem, options)
    return RUNNING


@inner
def write(mem: Any, times: np.ndarray, out: np.ndarray, filled: int) -> int:
    """Write the output times that have been reached."""
    now = mem.clock[NOW]
    while filled < times.size and times[filled] <= now:
        if times[filled] == now:
            copy(mem.y, out[filled])
        else:
            interpolate(mem, times[filled], out[filled])
        filled += 1
    return filled


@part
def combine(y: np.ndarray, k: np.ndarray, weight: float, out: np.ndarray) -> None:
    """out = y + weight k."""
    for i in range(y.size):
        out[i] = y[i] + weight * k[i]


@part
def add(out: np.ndarray, weight: float, k: np.ndarray) -> None:
    """out += weight k."""
    if weight != 0.0:
        for i in range(out.size):
            out[i] += weight * k[i]


@part
def factor_shifted(sys: Any, base: Any, couplings: Any, tan: Any, S: Any, y: np.ndarray, mem: Any) -> bool:
    """Factor S - J at y, the state of `base`; False if something has no inertia."""
    n = sys.nq
    mem.counters[FACTORISATIONS] += 1
    q, v = y[:n], y[n : 2 * n]
    return factor(sys, couplings, base, tan, q, v, 1.0 / S, 1.0, S, 1.0 / S, 2) < 0


@inner
def solve_shifted(
    sys: Any,
    base: Any,
    couplings: Any,
    tan: Any,
    S: Any,
    R: np.ndarray,
    shift: np.ndarray,
    x: np.ndarray,
    U: np.ndarray,
) -> None:
    """U of (S - J) U = R, energies apart; `shift` and `x` are scratch, and x is zero from its entry nq on."""
    n = sys.nq
    states = R[2 * n : R.size - 2]
    for m in range(n):
        shift[m] = -R[m]
        shift[n + m] = -S * R[m] - R[n + m]
    v0 = shift[:n]
    give_states(sys, couplings, tan, states)
    back_substitute(sys, couplings, base, tan, v0, shift[n : 2 * n], x[n : 2 * n], x[:n])
    put_back_states(
        sys,
        couplings,
        base,
        tan,
        x[:n],
        v0,
        states,
        1.0 / S,
        1.0,
        1.0 / S,
        U[2 * n : U.size - 2],
    )
    for m in range(n):
        U[m] = x[m] / S
        U[n + m] = x[m] - R[m]


@inner
def close_step(
    sys: Any,
    work: Any,
    base: Any,
    couplings: Any,
    tan: Any,
    gain: float,
    t: float,
    x: np.ndarray,
    mem: Any,
    options: Any,
    most: float,
) -> bool:
    """Move the end of a step, at time t, in mem.trial onto the constraints, place and velocity; False if it cannot be.

    gain: weight of the unknown of `tan` in the derivative by which `tan` takes the constraints (S for the second).
    x: as in solve_shifted. most: how far, in tolerances: by more than the step's error, it is the other branch of a
    fold, which is not the way on.
    """
    nc, n = sys.constraints.size, sys.nq
    if nc == 0:
        return True
    q, v = mem.trial[:n], mem.trial[n : 2 * n]
    copy(mem.trial, mem.error)
    evaluate_signals(sys.signals, sys.program, sys.table, work.stack, t, work.signal)
    before, before_rate = np.inf, np.inf
    for taken in range(12):
        kinematics(sys, work, q, v)
        pathways(sys, work)
        worst, worst_rate = 0.0, 0.0
        for c in range(nc):
            value, rate, _ = constraint(sys.constraints[c], work.lengths, work.signal)
            worst, worst_rate = max(worst, abs(value)), max(worst_rate, abs(rate))
        there = settled(worst, before, options.closed, work.points)
        if there and settled(worst_rate, before_rate, 10.0 * options.closed, work.points):
            if moved(mem, options) > most:
                return False
            mem.counters[PROJECTIONS] += taken
            return True
        if not worst + worst_rate < 1e300 or (taken > 1 and worst > before and worst_rate > before_rate):
            return False
        # moving places changes rates, too
        before, before_rate = worst, worst_rate if there else np.inf
        if not there:
            _correct(sys, work, base, couplings, tan, True, gain, x, q)
        _correct(sys, work, base, couplings, tan, False, gain, x, v)
    return False


@part
def _correct(
    sys: Any,
    work: Any,
    base: Any,
    couplings: Any,
    tan: Any,
    place: bool,
    gain: float,
    x: np.ndarray,
    out: np.ndarray,
) -> None:
    """Take Phi (place) or Phi' back by moving `out`, with the tangent of the step."""
    n = sys.nq
    give_states(sys, couplings, tan, x[2 * n :])
    for c in range(sys.constraints.size):
        value, rate, _ = constraint(sys.constraints[c], work.lengths, work.signal)
        # links begin with the constraints
        tan.rhs[c] = -(value if place else rate)
    back_substitute(sys, couplings, base, tan, x[n : 2 * n], x[n : 2 * n], x[n : 2 * n], x[:n])
    for i in range(n):
        out[i] += gain * x[i]
