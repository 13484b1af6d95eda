"""The compiled loop of the explicit methods: adaptive steps, projection, dense output, landing on breakpoints.

Symbols as in steps.py; k[s] = f at the end of the step, further rows serve the dense output. The method says at which
point it wants f next (`_point`), `advance` evaluates the equations there, the method uses the value (`_use`): so the
mechanics are called from one place, whatever the method is about to do (`PHASE`).
"""

from math import sqrt
from typing import Any

import numpy as np

from fmbd.planar.compile import compiled, inner, part
from fmbd.planar.equations import derivatives, project
from fmbd.solvers.steps import (
    BEFORE_BREAK,
    BODY,
    EVALUATIONS,
    FRESH,
    INTERPOLANT,
    LAST_START,
    LAST_STEP,
    NO_INERTIA,
    NOT_A_NUMBER,
    NOW,
    OFF_CONSTRAINTS,
    PHASE,
    POINT,
    PROJECTIONS,
    ROW,
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

#: What the value of f will serve for.
READY, AT_START, EULER, STAGES, CLOSING, DENSE = range(6)


@compiled
def advance(
    sys: Any,
    work: Any,
    tableau: Any,
    mem: Any,
    breaks: np.ndarray,
    options: Any,
    times: np.ndarray,
    out: np.ndarray,
    attempts: int,
) -> tuple[int, int]:
    """Step until all `times` are filled in `out` (len(times), ny), or `attempts` steps were tried.

    The last entry of `breaks` is the end of the run. Returns how many rows were filled, and a status.
    """
    count = mem.counters
    filled, tried = 0, 0
    while True:
        if count[PHASE] == READY:
            filled = _write(tableau, mem, times, out, filled)
            if filled == times.size:
                return filled, RUNNING
        if count[PHASE] == READY:
            if tried == attempts:
                return filled, RUNNING
            tried += 1
            _begin(tableau, mem, breaks, options)
        _point(tableau, mem)
        if count[PHASE] == CLOSING and options.projecting:
            copy(mem.trial, mem.error)
            taken = project(sys, work, mem.clock[POINT], mem.trial, mem.correction, options.closed)
            # too far off for Newton, or moved by more than a step may err: another branch is not the way on
            if taken < 0 or moved(mem, options) > 1.0:
                if not _reject(mem, 0.3, options):
                    return filled, OFF_CONSTRAINTS
                continue
            count[PROJECTIONS] += taken
        count[EVALUATIONS] += 1
        row = mem.k[count[ROW]]
        failed = derivatives(sys, work, mem.clock[POINT], mem.trial, row, options.drag, options.pull)
        if count[PHASE] == AT_START:
            if failed >= 0:
                count[BODY] = failed
                return filled, NO_INERTIA
            if not is_finite(row):
                return filled, NOT_A_NUMBER
        elif failed >= 0 and count[PHASE] != DENSE:
            # a trial far off the solution, not the mechanism, has made the numbers meaningless
            if not _reject(mem, 0.1, options):
                return filled, STEP_TOO_SMALL
            continue
        if not _use(tableau, mem, options):
            return filled, STEP_TOO_SMALL


@inner
def _write(tableau: Any, mem: Any, times: np.ndarray, out: np.ndarray, filled: int) -> int:
    """Write the output times that have been reached; ask for the interpolant (phase DENSE) if it is missing."""
    clock, count = mem.clock, mem.counters
    while filled < times.size and times[filled] <= clock[NOW]:
        if times[filled] == clock[NOW]:
            copy(mem.y, out[filled])
        elif count[INTERPOLANT] == 1:
            interpolate(mem, times[filled], out[filled])
        elif tableau.c.size > tableau.b.size + 1:
            count[PHASE], count[ROW] = DENSE, tableau.b.size + 1
            return filled
        else:
            _interpolant(tableau, mem)
            continue
        filled += 1
    return filled


@inner
def _begin(tableau: Any, mem: Any, breaks: np.ndarray, options: Any) -> None:
    """Start a step from mem.y, with f of the last one's end if no breakpoint lies between."""
    pass_breaks(mem, breaks)
    if mem.counters[FRESH] == 1:
        mem.counters[PHASE] = AT_START
    else:
        copy(mem.k[tableau.b.size], mem.k[0])
        _set_out(mem, options)


@part
def _set_out(mem: Any, options: Any) -> None:
    aim(mem, options)
    mem.counters[PHASE], mem.counters[ROW] = STAGES, 1


@part
def _reject(mem: Any, factor: float, options: Any) -> bool:
    possible = shorten(mem, factor, options)
    mem.counters[PHASE], mem.counters[ROW] = STAGES, 1
    return possible


@part
def _point(tableau: Any, mem: Any) -> None:
    """Put the state at which f is wanted into mem.trial, its time into clock[POINT]; its row is count[ROW]."""
    clock, count = mem.clock, mem.counters
    phase, row = count[PHASE], count[ROW]
    if phase == AT_START:
        copy(mem.y, mem.trial)
        count[ROW] = 0
        clock[POINT] = clock[NOW]
    elif phase == EULER:
        for i in range(mem.y.size):
            mem.trial[i] = mem.y[i] + clock[STEP] * mem.k[0, i]
        count[ROW] = 1
        clock[POINT] = min(clock[NOW] + clock[STEP], clock[BEFORE_BREAK])
    elif phase == STAGES:
        _combine(tableau.a[row], mem.k, row, clock[STEP], mem.y, mem.trial)
        clock[POINT] = min(clock[NOW] + tableau.c[row] * clock[STEP], clock[BEFORE_BREAK])
    elif phase == CLOSING:
        count[ROW] = tableau.b.size
        clock[POINT] = min(clock[NOW] + clock[STEP], clock[BEFORE_BREAK])
    else:
        _combine(tableau.a[row], mem.k, row, clock[LAST_STEP], mem.y_old, mem.trial)
        clock[POINT] = min(clock[LAST_START] + tableau.c[row] * clock[LAST_STEP], clock[BEFORE_BREAK])


@part
def _use(tableau: Any, mem: Any, options: Any) -> bool:
    """Go on with the value of f in k[count[ROW]]; False if the step has become too small."""
    clock, count = mem.clock, mem.counters
    phase = count[PHASE]
    if phase == AT_START:
        count[FRESH] = 0
        if clock[WANTED] > 0.0:
            _set_out(mem, options)
        else:
            clock[STEP] = euler_step(mem.k[0], mem, options)
            count[PHASE] = EULER
    elif phase == EULER:
        clock[WANTED] = first_step(mem.k[0], mem.k[1], tableau.order, mem, options)
        _set_out(mem, options)
    elif phase == STAGES:
        count[ROW] += 1
        if count[ROW] == tableau.b.size:
            _combine(tableau.b, mem.k, tableau.b.size, clock[STEP], mem.y, mem.trial)
            err = _error(tableau, mem, clock[STEP], options)
            if not err <= 1.0:
                return _reject(mem, rejection(err, tableau.order), options)
            plan_next(mem, err, tableau.order)
            count[PHASE] = CLOSING
    elif phase == CLOSING:
        accept(mem)
        count[PHASE] = READY
    else:
        count[ROW] += 1
        if count[ROW] == tableau.c.size:
            _interpolant(tableau, mem)
            count[PHASE] = READY
    return True


@part
def _combine(weights: np.ndarray, k: np.ndarray, n: int, h: float, y: np.ndarray, out: np.ndarray) -> None:
    """out = y + h sum_j weights[j] k[j]."""
    for i in range(y.size):
        out[i] = y[i]
    for j in range(n):
        if weights[j] != 0.0:
            weight = h * weights[j]
            for i in range(y.size):
                out[i] += weight * k[j, i]


@part
def _error(tableau: Any, mem: Any, h: float, options: Any) -> float:
    """Error norm of the step from mem.y to mem.trial; DOP853 blends its estimates of order 5 and 3."""
    weigh(tableau.errors[0], mem.k, mem.error)
    high = h * norm(mem.error, mem.y, mem.trial, options)
    if tableau.errors.shape[0] == 1 or high == 0.0:
        return high
    weigh(tableau.errors[1], mem.k, mem.error)
    low = h * norm(mem.error, mem.y, mem.trial, options)
    return high * high / sqrt(high * high + 0.01 * low * low)


@part
def _interpolant(tableau: Any, mem: Any) -> None:
    """Rows F of the interpolant over the last step."""
    k, F = mem.k, mem.F
    h = mem.clock[LAST_STEP]
    s = tableau.b.size
    for i in range(mem.y.size):
        rise = mem.y[i] - mem.y_old[i]
        F[0, i] = rise
        F[1, i] = h * k[0, i] - rise
        F[2, i] = 2.0 * rise - h * (k[0, i] + k[s, i])
    for r in range(tableau.d.shape[0]):
        row = F[3 + r]
        weigh(tableau.d[r], k, row)
        for i in range(row.size):
            row[i] *= h
    mem.counters[INTERPOLANT] = 1
