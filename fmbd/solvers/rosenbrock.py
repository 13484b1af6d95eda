"""The compiled loop of linearly implicit (Rosenbrock) methods, with exact tangents and projection.

    U     stages (s, ny); the rows of k after them are f at the start of the step, its time derivative, and scratch
    S     1 / (h gamma), weight of the step;   (S - J) U = R
With J of the constrained equations, dv' = da: U_q = (U_v + R_q) / S and the linearised equations of motion hold for
dq = U_q, dv = U_v, dq'' = S U_v - R_v. In x = S U_q: dq = x / S, dv = x - R_q, dq'' = S x - S R_q - R_v.

Energy put in and dissipated are integrals along the solution; they are found by Lobatto's rule of four points on the
dense output, and the step control leaves them alone.
"""

from collections.abc import Sequence
from math import sqrt
from typing import Any, NamedTuple

import numpy as np

from fmbd.planar.compile import compiled, inner, part
from fmbd.planar.equations import derivatives, project
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
    norm,
    pass_breaks,
    plan_next,
    rejection,
    shorten,
    weigh,
)

_NODE = 0.5 - 0.5 / sqrt(5.0)


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
    return Rosenbrock(order, gamma, *full, np.array(alpha), np.array(gammas), np.array((k1, k2 + k3, -k3)))


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
            _evaluate(sys, work, clock[NOW] + clock[STEP], mem.trial, mem.k[s + 2], mem)
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
        taken = project(sys, work, end, mem.trial, mem.correction, options.closed)
        if taken < 0:
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
    f0, f1, near, far = mem.k[s], mem.k[s + 1], mem.k[s + 2], mem.k[s + 3]
    for i in range(y.size):
        F[0, i] = y[i] - old[i]
    for r in range(3):
        weigh(method.dense[r], mem.k[:s], F[1 + r])
    h = clock[LAST_STEP]
    t0, last = clock[LAST_START], clock[BEFORE_BREAK]
    _evaluate(sys, base, end, y, f1, mem)
    for i in range(2):
        t = t0 + (_NODE if i == 0 else 1.0 - _NODE) * h
        interpolate(mem, t, mem.trial)
        _evaluate(sys, work, min(t, last), mem.trial, near if i == 0 else far, mem)
    for i in range(y.size - 2, y.size):
        rise = h * (f0[i] + f1[i] + 5.0 * (near[i] + far[i])) / 12.0
        y[i] = old[i] + rise
        F[0, i], F[1, i], F[2, i] = rise, h * f0[i] - rise, 2.0 * rise - h * (f0[i] + f1[i])
        F[3, i] = 0.0
    copy(f1, f0)
