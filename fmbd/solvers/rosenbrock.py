"""The compiled loop of linearly implicit (Rosenbrock) methods, with exact tangents and projection.

    U     stages (s, ny); the rows of k after them are f at the start of the step, its time derivative, and scratch
    S     1 / (h gamma), weight of the step;   (S - J) U = R
With J of the constrained equations, dv' = da: U_q = (U_v + R_q) / S and the linearised equations of motion hold for
dq = U_q, dv = U_v, dq'' = S U_v - R_v. In x = S U_q: dq = x / S, dv = x - R_q, dq'' = S x - S R_q - R_v.

Energy put in and dissipated are integrals along the solution; they are found by Simpson's rule on the dense output, of
the same order, and the step control leaves them alone.

Steps end with a projection onto the constraints in the metric of the step itself, S^2 M + S D + K with the
tangent at its start: in that of the mass alone it would stretch stiff modes by what a soft joint could give.
"""

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from fmbd.planar.compile import compiled, inner, part
from fmbd.planar.equations import constraint, derivatives, settled
from fmbd.planar.kinematics import kinematics
from fmbd.planar.pathways import pathways
from fmbd.planar.signals import evaluate_signals
from fmbd.planar.tangent import factor
from fmbd.planar.tangent_solve import back_substitute, give_states, put_back_states
from fmbd.solvers.steps import (
    BEFORE_BREAK,
    BODY,
    EVALUATIONS,
    FACTORISATIONS,
    FRESH,
    LAST_START,
    LAST_STEP,
    NO_INERTIA,
    NOT_A_NUMBER,
    NOW,
    OFF_CONSTRAINTS,
    PROJECTIONS,
    RUNNING,
    STEP,
    STEP_TOO_SMALL,
    WANTED,
    accept,
    aim,
    copy,
    euler_step,
    first_step,
    interpolate,
    is_finite,
    moved,
    norm,
    pass_breaks,
    plan_next,
    rejection,
    shorten,
    weigh,
)

#: Rows of Memory.k beyond the stages.
SCRATCH = 5


class Rosenbrock(NamedTuple):
    """Coefficients of a linearly implicit method: a, c (s, s), alpha, gammas (s,), dense (3, s)."""

    order: int
    gamma: float
    a: np.ndarray
    c: np.ndarray
    alpha: np.ndarray
    gammas: np.ndarray
    dense: np.ndarray


def rosenbrock(
    order: int,
    gamma: float,
    a: Sequence[Sequence[float]],
    c: Sequence[Sequence[float]],
    alpha: Sequence[float],
    gammas: Sequence[float],
    h: Sequence[Sequence[float]],
) -> Rosenbrock:
    """Pack coefficient rows into rectangular arrays."""
    s = len(alpha)
    full = [np.zeros((s, s)), np.zeros((s, s))]
    for target, rows in zip(full, (a, c), strict=True):
        for i, row in enumerate(rows):
            target[i, : len(row)] = row
    k1, k2, k3 = np.array(h)
    # in the form of steps.interpolate
    dense = np.array((k1, k2 + k3, -k3))
    return Rosenbrock(order, gamma, full[0], full[1], np.array(alpha), np.array(gammas), dense)


@compiled
def advance_rosenbrock(
    sys: Any,
    work: Any,
    base: Any,
    couplings: Any,
    tan: Any,
    method: Any,
    steady: bool,
    mem: Any,
    breaks: np.ndarray,
    options: Any,
    times: np.ndarray,
    out: np.ndarray,
    attempts: int,
) -> tuple[int, int]:
    """As explicit.advance; `base` is the Work of the state at which `tan` is linearised.

    steady: f does not depend on time between breakpoints.
    """
    count, clock = mem.counters, mem.clock
    s = method.alpha.size
    filled, tried = 0, 0
    f0 = mem.k[s]
    while True:
        filled = _write(mem, times, out, filled)
        if filled == times.size or tried == attempts:
            return filled, RUNNING
        tried += 1
        pass_breaks(mem, breaks)
        if count[FRESH] == 1:
            failed = _evaluate(sys, base, clock[NOW], mem.y, f0, mem)
            if failed >= 0:
                count[BODY] = failed
                return filled, NO_INERTIA
            if not is_finite(f0):
                return filled, NOT_A_NUMBER
            count[FRESH] = 0
        if clock[WANTED] == 0.0:
            clock[STEP] = euler_step(f0, mem, options)
            _combine(mem.y, f0, clock[STEP], mem.trial)
            probe = min(clock[NOW] + clock[STEP], clock[BEFORE_BREAK])
            _evaluate(sys, work, probe, mem.trial, mem.k[s + 2], mem)
            clock[WANTED] = first_step(f0, mem.k[s + 2], method.order, mem, options)
        aim(mem, options)
        if not steady:
            _time_derivative(sys, work, mem, s)
        if not _stages(sys, work, base, couplings, tan, method, steady, mem):
            if not shorten(mem, 0.25, options):
                return filled, STEP_TOO_SMALL
            continue
        n = mem.y.size - 2
        err = norm(mem.k[s - 1, :n], mem.y[:n], mem.trial[:n], options)
        if not err <= 1.0:
            if not shorten(mem, rejection(err, method.order), options):
                return filled, STEP_TOO_SMALL
            continue
        end = min(clock[NOW] + clock[STEP], clock[BEFORE_BREAK])
        copy(mem.trial, mem.error)
        taken = _project(sys, work, base, couplings, tan, method, end, mem, options.closed)
        if taken < 0 or moved(mem, options) > 1.0:
            if not shorten(mem, 0.25, options):
                return filled, OFF_CONSTRAINTS
            continue
        count[PROJECTIONS] += taken
        plan_next(mem, err, method.order)
        accept(mem)
        _finish(sys, work, base, method, mem, end)


@inner
def _evaluate(sys: Any, work: Any, t: float, y: np.ndarray, dy: np.ndarray, mem: Any) -> int:
    """dy = f(t, y)."""
    mem.counters[EVALUATIONS] += 1
    return derivatives(sys, work, t, y, dy, 0.0, 0.0)


@inner
def _write(mem: Any, times: np.ndarray, out: np.ndarray, filled: int) -> int:
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
def _combine(y: np.ndarray, k: np.ndarray, weight: float, out: np.ndarray) -> None:
    """out = y + weight k."""
    for i in range(y.size):
        out[i] = y[i] + weight * k[i]


@part
def _time_derivative(sys: Any, work: Any, mem: Any, s: int) -> None:
    """f_t at the start of the step, by a one-sided difference of order 2 over a short stretch of it."""
    f0, ft, near, far = mem.k[s], mem.k[s + 1], mem.k[s + 2], mem.k[s + 3]
    stretch = 1e-3 * mem.clock[STEP]
    _evaluate(sys, work, mem.clock[NOW] + stretch, mem.y, near, mem)
    _evaluate(sys, work, mem.clock[NOW] + 2.0 * stretch, mem.y, far, mem)
    for i in range(ft.size):
        ft[i] = (4.0 * near[i] - 3.0 * f0[i] - far[i]) / (2.0 * stretch)


@part
def _stages(
    sys: Any, work: Any, base: Any, couplings: Any, tan: Any, method: Any, steady: bool, mem: Any
) -> bool:
    """All stages of a step, its end in mem.trial; False if the equations could not be solved."""
    clock, n, s, h = mem.clock, sys.nq, method.alpha.size, mem.clock[STEP]
    S = 1.0 / (h * method.gamma)
    y, k = mem.y, mem.k
    f0, ft, R, shift, x = k[s], k[s + 1], k[s + 2], k[s + 3], k[s + 4]
    nz = y.size - 2 * n - 2
    mem.counters[FACTORISATIONS] += 1
    if factor(sys, couplings, base, tan, y[:n], y[n : 2 * n], 1.0 / S, 1.0, S, 1.0 / S, 2) >= 0:
        return False
    for i in range(s):
        if i == 0:
            copy(f0, R)
        else:
            copy(y, mem.trial)
            for j in range(i):
                _add(mem.trial, method.a[i, j], k[j])
            t = min(clock[NOW] + method.alpha[i] * h, clock[BEFORE_BREAK])
            if _evaluate(sys, work, t, mem.trial, R, mem) >= 0:
                return False
            for j in range(i):
                _add(R, method.c[i, j] / h, k[j])
        if not steady:
            _add(R, h * method.gammas[i], ft)
        for m in range(n):
            shift[m] = -R[m]
            shift[n + m] = -S * R[m] - R[n + m]
        U = k[i]
        give_states(sys, couplings, tan, R[2 * n : 2 * n + nz])
        back_substitute(sys, couplings, base, tan, shift[:n], shift[n : 2 * n], x[n : 2 * n], x[:n])
        put_back_states(
            sys,
            couplings,
            base,
            tan,
            x[:n],
            shift[:n],
            R[2 * n : 2 * n + nz],
            1.0 / S,
            1.0,
            1.0 / S,
            U[2 * n : 2 * n + nz],
        )
        for m in range(n):
            U[m] = x[m] / S
            U[n + m] = x[m] - R[m]
    # the last stage is evaluated at the end of the step but for its own U: stiffly accurate
    _add(mem.trial, 1.0, k[s - 1])
    return True


@part
def _add(out: np.ndarray, weight: float, k: np.ndarray) -> None:
    if weight != 0.0:
        for i in range(out.size):
            out[i] += weight * k[i]


@part
def _finish(sys: Any, work: Any, base: Any, method: Any, mem: Any, end: float) -> None:
    """Interpolant of the step just taken, f at its end, and the energies over it."""
    s, clock, F, y, old = method.alpha.size, mem.clock, mem.F, mem.y, mem.y_old
    f0, f1, half = mem.k[s], mem.k[s + 1], mem.k[s + 2]
    for i in range(y.size):
        F[0, i] = y[i] - old[i]
    for r in range(3):
        weigh(method.dense[r], mem.k[:s], F[1 + r])
    h = clock[LAST_STEP]
    middle = clock[LAST_START] + 0.5 * h
    if _evaluate(sys, base, end, y, f1, mem) >= 0 or not is_finite(f1):
        # the next step begins with a fresh look, which says what is wrong
        mem.counters[FRESH] = 1
    interpolate(mem, middle, mem.trial)
    _evaluate(sys, work, middle, mem.trial, half, mem)
    for i in range(y.size - 2, y.size):
        rise = h * (f0[i] + f1[i] + 4.0 * half[i]) / 6.0
        y[i] = old[i] + rise
        F[0, i], F[1, i], F[2, i] = rise, h * f0[i] - rise, 2.0 * rise - h * (f0[i] + f1[i])
        F[3, i] = 0.0
    copy(f1, f0)


@inner
def _project(
    sys: Any,
    work: Any,
    base: Any,
    couplings: Any,
    tan: Any,
    method: Any,
    t: float,
    mem: Any,
    tolerance: float,
) -> int:
    """Move mem.trial onto the constraints, place and velocity; returns the steps taken, or -1 if it could not be."""
    nc, n = sys.constraints.size, sys.nq
    if nc == 0:
        return 0
    S = 1.0 / (mem.clock[STEP] * method.gamma)
    x = mem.k[method.alpha.size + 4]
    q, v = mem.trial[:n], mem.trial[n : 2 * n]
    evaluate_signals(sys.signals, sys.program, sys.table, work.stack, t, work.signal)
    before, before_rate = np.inf, np.inf
    for taken in range(12):
        kinematics(sys, work, q, v)
        pathways(sys, work)
        worst, worst_rate = 0.0, 0.0
        for c in range(nc):
            value, rate, _ = constraint(sys.constraints[c], work.lengths, work.signal)
            worst, worst_rate = max(worst, abs(value)), max(worst_rate, abs(rate))
        there = settled(worst, before, tolerance, work.points)
        if there and settled(worst_rate, before_rate, 10.0 * tolerance, work.points):
            return taken
        if not worst + worst_rate < 1e300 or (taken > 1 and worst > before and worst_rate > before_rate):
            return -1
        before, before_rate = worst, worst_rate if there else np.inf
        if not there:
            _correct(sys, work, base, couplings, tan, True, -S * S, x)
            for i in range(n):
                q[i] += x[i] / S
        _correct(sys, work, base, couplings, tan, False, -S, x)
        for i in range(n):
            v[i] += x[i]
    return -1


@part
def _correct(
    sys: Any, work: Any, base: Any, couplings: Any, tan: Any, place: bool, weight: float, x: np.ndarray
) -> None:
    """x that takes Phi (place) or Phi' back, with the tangent of the step."""
    n = sys.nq
    give_states(sys, couplings, tan, x[2 * n :])
    for c in range(sys.constraints.size):
        value, rate, _ = constraint(sys.constraints[c], work.lengths, work.signal)
        # links begin with the constraints
        tan.rhs[c] = weight * (value if place else rate)
    back_substitute(sys, couplings, base, tan, x[n : 2 * n], x[n : 2 * n], x[n : 2 * n], x[:n])
