"""The compiled loop of linearly implicit (Rosenbrock) methods, with exact tangents and projection.

    U     stages (s, ny); the rows of k after them are f at the start of the step, its time derivative, and scratch
    S     1 / (h gamma), weight of the step;   (S - J) U = R, see implicit.py

Energy put in and dissipated are integrals along the solution; they are found by Simpson's rule on the dense output, of
the same order, and the step control leaves them alone.
"""

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from fmbd.planar.compile import compiled, part
from fmbd.solvers.implicit import add, begin, close_step, evaluate, factor_shifted, solve_shifted, write
from fmbd.solvers.steps import (
    BEFORE_BREAK,
    FRESH,
    LAST_START,
    LAST_STEP,
    NOW,
    OFF_CONSTRAINTS,
    RUNNING,
    STEP,
    STEP_TOO_SMALL,
    accept,
    copy,
    interpolate,
    is_finite,
    norm,
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
    clock, s = mem.clock, method.alpha.size
    filled, tried = 0, 0
    f0 = mem.k[s]
    while True:
        filled = write(mem, times, out, filled)
        if filled == times.size or tried == attempts:
            return filled, RUNNING
        tried += 1
        status = begin(sys, work, base, method.order, f0, mem.k[s + 2], mem, breaks, options)
        if status != RUNNING:
            return filled, status
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
        S = 1.0 / (clock[STEP] * method.gamma)
        if not close_step(sys, work, base, couplings, tan, S, end, mem.k[s + 4], mem, options, 1.0):
            if not shorten(mem, 0.25, options):
                return filled, OFF_CONSTRAINTS
            continue
        plan_next(mem, err, method.order)
        accept(mem)
        _finish(sys, work, base, method, mem, end)


@part
def _time_derivative(sys: Any, work: Any, mem: Any, s: int) -> None:
    """f_t at the start of the step, by a one-sided difference of order 2 over a short stretch of it."""
    f0, ft, near, far = mem.k[s], mem.k[s + 1], mem.k[s + 2], mem.k[s + 3]
    stretch = 1e-3 * mem.clock[STEP]
    evaluate(sys, work, mem.clock[NOW] + stretch, mem.y, near, mem)
    evaluate(sys, work, mem.clock[NOW] + 2.0 * stretch, mem.y, far, mem)
    for i in range(ft.size):
        ft[i] = (4.0 * near[i] - 3.0 * f0[i] - far[i]) / (2.0 * stretch)


@part
def _stages(
    sys: Any, work: Any, base: Any, couplings: Any, tan: Any, method: Any, steady: bool, mem: Any
) -> bool:
    """All stages of a step, its end in mem.trial; False if the equations could not be solved."""
    clock, s, h = mem.clock, method.alpha.size, mem.clock[STEP]
    S = 1.0 / (h * method.gamma)
    y, k = mem.y, mem.k
    f0, ft, R, shift, x = k[s], k[s + 1], k[s + 2], k[s + 3], k[s + 4]
    if not factor_shifted(sys, base, couplings, tan, S, y, mem):
        return False
    for i in range(s):
        if i == 0:
            copy(f0, R)
        else:
            copy(y, mem.trial)
            for j in range(i):
                add(mem.trial, method.a[i, j], k[j])
            t = min(clock[NOW] + method.alpha[i] * h, clock[BEFORE_BREAK])
            if evaluate(sys, work, t, mem.trial, R, mem) >= 0:
                return False
            for j in range(i):
                add(R, method.c[i, j] / h, k[j])
        if not steady:
            add(R, h * method.gammas[i], ft)
        solve_shifted(sys, base, couplings, tan, S, R, shift, x, k[i])
    # the last stage is evaluated at the end of the step but for its own U: stiffly accurate
    add(mem.trial, 1.0, k[s - 1])
    return True


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
    if evaluate(sys, base, end, y, f1, mem) >= 0 or not is_finite(f1):
        # the next step begins with a fresh look, which says what is wrong
        mem.counters[FRESH] = 1
    interpolate(mem, middle, mem.trial)
    evaluate(sys, work, middle, mem.trial, half, mem)
    for i in range(y.size - 2, y.size):
        rise = h * (f0[i] + f1[i] + 4.0 * half[i]) / 6.0
        y[i] = old[i] + rise
        F[0, i], F[1, i], F[2, i] = rise, h * f0[i] - rise, 2.0 * rise - h * (f0[i] + f1[i])
        F[3, i] = 0.0
    copy(f1, f0)
