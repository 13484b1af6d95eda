"""The compiled loop of implicit collocation methods: simplified Newton, one factorisation for each eigenvalue of A^-1.

    Z     y at the stages less y at the start of the step (s, ny):   Z = h A f(y + Z)
    f     at the stages, later the Newton corrections of Z; the rows of k after them are f0 and scratch
    S     mu / h, mu an eigenvalue of A^-1 = V diag(mu) V^-1

Newton's (A^-1 / h - J) dZ = f(y + Z) - A^-1 Z / h falls apart into (S - J) U = V^-1 (f - S Z), dZ = V U, for each mu.
J is taken at the first guess of the stage nearest the middle of the step: so the other stages differ least from it.
Step control and stopping after Hairer and Wanner, Solving Ordinary Differential Equations II, section IV.8.
"""

from typing import Any, NamedTuple

import numpy as np

from fmbd.planar.compile import compiled, inner, part
from fmbd.solvers.implicit import add, begin, close_step, evaluate, factor_shifted, solve_shifted, write
from fmbd.solvers.steps import (
    ACCEPTED,
    AFTER_REJECTION,
    BEFORE_BREAK,
    CONTRACTION,
    FACTORED,
    FRESH,
    INTERPOLANT,
    LAST_STEP,
    NOW,
    OFF_CONSTRAINTS,
    RUNNING,
    STEP,
    STEP_TOO_SMALL,
    WANTED,
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

#: Rows of Memory.k beyond the 2 s of the stages.
SCRATCH = 3
_ITERATIONS = 10
#: A Newton iteration that contracts faster than this keeps its factorisation, and the step its length if it could
#: grow by less than the second number.
_SERVES = 1e-2
_NOT_WORTH = 1.2


class Shifted(NamedTuple):
    """S - J, factored, and rows for its right-hand side and solution (ny,); all of one scalar type."""

    tan: Any
    R: np.ndarray
    shift: np.ndarray
    x: np.ndarray
    U: np.ndarray


@compiled
def advance_collocation(
    sys: Any,
    work: Any,
    base: Any,
    couplings: Any,
    real: Any,
    pairs: Any,
    method: Any,
    mem: Any,
    breaks: np.ndarray,
    options: Any,
    times: np.ndarray,
    out: np.ndarray,
    attempts: int,
) -> tuple[int, int]:
    """As explicit.advance; `base` is the Work of the state at which `real` and `pairs`, Shifted, are linearised."""
    count, clock = mem.counters, mem.clock
    s = method.c.size
    f0, scratch = mem.k[2 * s], mem.k[2 * s + 1]
    filled, tried = 0, 0
    while True:
        filled = write(mem, times, out, filled)
        if filled == times.size or tried == attempts:
            return filled, RUNNING
        tried += 1
        status = begin(sys, work, work, s + 1, f0, scratch, mem, breaks, options)
        if status != RUNNING:
            return filled, status
        _guess(method, mem)
        shrink = _newton(sys, work, base, couplings, real, pairs, method, mem, options)
        if shrink < 1.0:
            clock[FACTORED] = 0.0
            if not shorten(mem, shrink, options):
                return filled, STEP_TOO_SMALL
            continue
        err = _error(sys, work, base, couplings, real, method, mem, options)
        if not err <= 1.0:
            if not shorten(mem, rejection(err, s + 1), options):
                return filled, STEP_TOO_SMALL
            continue
        end = min(clock[NOW] + clock[STEP], clock[BEFORE_BREAK])
        S = method.mu / clock[STEP]
        if not close_step(sys, work, base, couplings, real.tan, S, end, real.x, mem, options, 1.0):
            if not shorten(mem, 0.25, options):
                return filled, OFF_CONSTRAINTS
            continue
        plan_next(mem, err, s + 1)
        if clock[FACTORED] > 0.0 and clock[STEP] <= clock[WANTED] <= _NOT_WORTH * clock[STEP]:
            clock[WANTED] = clock[STEP]
        accept(mem)
        _finish(method, mem)
        if evaluate(sys, work, end, mem.y, f0, mem) >= 0 or not is_finite(f0):
            # the next step begins with a fresh look, which says what is wrong
            count[FRESH] = 1


@part
def _guess(method: Any, mem: Any) -> None:
    """Z by extrapolation of the last step; at a start and after a breakpoint, nothing is known."""
    smooth = mem.counters[INTERPOLANT] == 1
    if not smooth:
        mem.clock[CONTRACTION], mem.clock[FACTORED] = 1.0, 0.0
    for i in range(method.c.size):
        Z = mem.k[i]
        copy(mem.y, Z)
        if smooth:
            interpolate(mem, mem.clock[NOW] + method.c[i] * mem.clock[STEP], Z)
        add(Z, -1.0, mem.y)


@part
def _newton(
    sys: Any, work: Any, base: Any, couplings: Any, real: Any, pairs: Any, method: Any, mem: Any, options: Any
) -> float:
    """Z, and the end of the step in mem.trial; returns 1, or by how much to shorten a step without solution."""
    clock, k, y = mem.clock, mem.k, mem.y
    s, h = method.c.size, mem.clock[STEP]
    enough = max(1e-15 / options.rtol, min(0.03, options.rtol ** ((s - 1) / (s + 1))))
    last, rate, remaining = 0.0, 0.0, clock[CONTRACTION] ** 0.8
    if clock[FACTORED] == h:
        remaining = max(remaining, _SERVES)
    for taken in range(_ITERATIONS):
        stale = taken == 0 and clock[FACTORED] != h
        for i in range(s):
            t = min(clock[NOW] + method.c[i] * h, clock[BEFORE_BREAK])
            copy(y, mem.trial)
            add(mem.trial, 1.0, k[i])
            if stale and i == s // 2:
                failed = evaluate(sys, base, t, mem.trial, k[s + i], mem)
                if failed >= 0 or not _factor(sys, base, couplings, real, pairs, method, mem):
                    return 0.25
            elif evaluate(sys, work, t, mem.trial, k[s + i], mem) >= 0:
                return 0.25
        size = _correct(sys, base, couplings, real, pairs, method, mem, options)
        if not size < np.inf:
            return 0.25
        if taken > 0:
            now = size / last
            rate = now if taken == 1 else np.sqrt(now * rate)
            if rate >= 0.99:
                return 0.5
            remaining = max(1e-16, rate / (1.0 - rate))
            left = _ITERATIONS - 1 - taken
            expected = remaining * size * rate**left
            if expected > enough:
                return max(0.1, 0.8 * (enough / expected) ** (1.0 / (4 + left)))
        if remaining * size <= enough:
            clock[CONTRACTION] = remaining
            clock[FACTORED] = h if rate < _SERVES else 0.0
            copy(y, mem.trial)
            add(mem.trial, 1.0, k[s - 1])
            return 1.0
        last = size
    return 0.5


@part
def _factor(sys: Any, base: Any, couplings: Any, real: Any, pairs: Any, method: Any, mem: Any) -> bool:
    h = mem.clock[STEP]
    if not factor_shifted(sys, base, couplings, real.tan, method.mu / h, mem.trial, mem):
        return False
    for j in range(len(pairs)):
        if not factor_shifted(sys, base, couplings, pairs[j].tan, method.mus[j] / h, mem.trial, mem):
            return False
    return True


@part
def _correct(
    sys: Any, base: Any, couplings: Any, real: Any, pairs: Any, method: Any, mem: Any, options: Any
) -> float:
    """Add Newton's correction to Z; returns its norm."""
    k, y, s, h, n = mem.k, mem.y, method.c.size, mem.clock[STEP], mem.y.size - 2
    _reduce(method.left, method.mu / h, k, real.R)
    _solve(sys, base, couplings, real, method.mu / h)
    for j in range(len(pairs)):
        _reduce(method.lefts[j], method.mus[j] / h, k, pairs[j].R)
        _solve(sys, base, couplings, pairs[j], method.mus[j] / h)
    total = 0.0
    for i in range(s):
        dZ = k[s + i, :n]
        for m in range(n):
            dZ[m] = method.right[i] * real.U[m]
        for j in range(len(pairs)):
            weight, U = method.rights[j, i], pairs[j].U
            for m in range(n):
                dZ[m] += weight.real * U[m].real - weight.imag * U[m].imag
        total += norm(dZ, y[:n], y[:n], options) ** 2
        add(k[i, :n], 1.0, dZ)
    return np.sqrt(total / s)


@part
def _reduce(left: np.ndarray, S: Any, k: np.ndarray, R: np.ndarray) -> None:
    """R = row of V^-1 times (f - S Z)."""
    s = left.size
    for m in range(R.size):
        R[m] = 0.0
    for i in range(s):
        for m in range(R.size):
            R[m] += left[i] * (k[s + i, m] - S * k[i, m])


@inner
def _solve(sys: Any, base: Any, couplings: Any, system: Any, S: Any) -> None:
    solve_shifted(sys, base, couplings, system.tan, S, system.R, system.shift, system.x, system.U)


@part
def _error(
    sys: Any, work: Any, base: Any, couplings: Any, real: Any, method: Any, mem: Any, options: Any
) -> float:
    """Norm of the difference from a method of order s, through (S - J)^-1, which spares stiff parts.

    Again with f at the state so estimated, where a step follows nothing smooth and would be rejected.
    """
    k, y, s, h, n = mem.k, mem.y, method.c.size, mem.clock[STEP], mem.y.size - 2
    f0, difference, moved = k[2 * s], k[2 * s + 1], k[2 * s + 2]
    weigh(method.error, k[:s], difference)
    for m in range(n):
        difference[m] /= h
        real.R[m] = f0[m] + difference[m]
    _solve(sys, base, couplings, real, method.mu / h)
    err = norm(real.U[:n], y[:n], mem.trial[:n], options)
    if err < 1.0 or (mem.counters[ACCEPTED] > 0 and mem.counters[AFTER_REJECTION] == 0):
        return err
    copy(y, moved)
    add(moved[:n], 1.0, real.U[:n])
    if evaluate(sys, work, mem.clock[NOW], moved, real.R, mem) >= 0:
        return err
    add(real.R, 1.0, difference)
    _solve(sys, base, couplings, real, method.mu / h)
    return norm(real.U[:n], y[:n], mem.trial[:n], options)


@part
def _finish(method: Any, mem: Any) -> None:
    """Energies over the step just taken, and the collocation polynomial, its end moved to the projected one."""
    k, y, old, s = mem.k, mem.y, mem.y_old, method.c.size
    h, n = mem.clock[LAST_STEP], y.size - 2
    for m in range(n):
        k[s - 1, m] = y[m] - old[m]
    for m in range(n, n + 2):
        # nothing depends on the energies, so that they need no iteration
        for i in range(s):
            k[i, m] = 0.0
            for j in range(s):
                k[i, m] += h * method.A[i, j] * k[s + j, m]
        y[m] = old[m] + k[s - 1, m]
    for r in range(s):
        weigh(method.interpolation[r], k[:s], mem.F[r])
    mem.counters[INTERPOLANT] = 1
