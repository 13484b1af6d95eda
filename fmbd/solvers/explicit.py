"""The compiled loop of the explicit methods: adaptive steps, projection, dense output, landing on breakpoints.

    y     state [q, v, z, dissipated energy, work], modal coordinates
    k     stages (s + 1 + m, ny); k[s] = f at the end of the step
    F     rows of the interpolant of the last step (3 + rows of d, ny)
    err   error norm: root mean square of the estimate over atol + rtol |y|; a step is accepted if err <= 1
After Hairer, Norsett, Wanner, Solving Ordinary Differential Equations I, sections II.4 to II.6.

The method says at which point it wants f next (`_point`), `advance` evaluates the equations there, the method uses the
value (`_use`): so the mechanics are called from one place, whatever the method is about to do (`PHASE`).
"""

from math import sqrt
from typing import Any, NamedTuple

import numpy as np

from fmbd.planar.compile import compiled, inner, part
from fmbd.planar.equations import derivatives, project
from fmbd.planar.signals import EARLY

RUNNING, NO_INERTIA, OFF_CONSTRAINTS, STEP_TOO_SMALL, NOT_A_NUMBER = range(5)
#: What the value of f will serve for.
READY, AT_START, EULER, STAGES, CLOSING, DENSE = range(6)
#: Indices of Memory.clock [s]: now, wanted step, this step, its end, last instant before the next breakpoint, the point
#: at which f is wanted, start and length of the last accepted step.
NOW, WANTED, STEP, END, BEFORE_BREAK, POINT, LAST_START, LAST_STEP, LAST_ERROR = range(9)
#: Indices of Memory.counters.
(
    ACCEPTED,
    REJECTED,
    EVALUATIONS,
    PROJECTIONS,
    BREAK,
    FRESH,
    INTERPOLANT,
    BODY,
    AFTER_REJECTION,
    PHASE,
    ROW,
) = range(11)
_SHORTEST = 1e-13


class Options(NamedTuple):
    """Tolerances and switches of a run; drag and pull are Baumgarte's 2 delta omega and omega^2."""

    rtol: float
    atol: float
    max_step: float
    projecting: bool
    closed: float  # |Phi| that the projection accepts
    drag: float
    pull: float


class Memory(NamedTuple):
    """What a run carries from block to block."""

    y: np.ndarray
    y_old: np.ndarray
    trial: np.ndarray
    error: np.ndarray
    k: np.ndarray
    F: np.ndarray
    correction: np.ndarray
    clock: np.ndarray
    counters: np.ndarray


def memory(tableau: Any, y0: np.ndarray, nq: int) -> Memory:
    """Memory of a run that starts at y0 at time 0."""
    ny = y0.size
    k = np.zeros((tableau.c.size, ny))
    F = np.zeros((3 + tableau.d.shape[0], ny))
    count = np.zeros(11, np.int64)
    count[FRESH], count[PHASE] = 1, READY
    return Memory(y0.copy(), y0.copy(), y0.copy(), np.zeros(ny), k, F, np.zeros(nq), np.zeros(9), count)


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
            taken = project(sys, work, mem.clock[POINT], mem.trial, mem.correction, options.closed)
            if taken < 0:
                # too far off the constraints for Newton: a shorter step comes closer
                if not _reject(mem, 0.25, options):
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
            if not _is_finite(row):
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
            _copy(mem.y, out[filled])
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
    """Start a step from mem.y; after a breakpoint f is evaluated anew, with the inputs that follow it."""
    clock, count = mem.clock, mem.counters
    while breaks[count[BREAK]] <= clock[NOW]:
        count[BREAK] += 1
        count[FRESH] = 1
    # inside a step the inputs are those before the next jump
    clock[END] = breaks[count[BREAK]]
    clock[BEFORE_BREAK] = clock[END] - 4.0 * EARLY * max(1.0, clock[END])
    if count[FRESH] == 1:
        count[PHASE] = AT_START
    else:
        _copy(mem.k[tableau.b.size], mem.k[0])
        _aim(mem, options)


@part
def _aim(mem: Any, options: Any) -> None:
    """Choose this step's length, so that it lands on a breakpoint that is near."""
    clock, count = mem.clock, mem.counters
    h = min(clock[WANTED], options.max_step)
    # clock[END] is the breakpoint, as yet
    left = clock[END] - clock[NOW]
    clock[STEP] = left if 1.01 * h >= left else h
    count[PHASE], count[ROW] = STAGES, 1


@part
def _point(tableau: Any, mem: Any) -> None:
    """Put the state at which f is wanted into mem.trial, its time into clock[POINT]; its row is count[ROW]."""
    clock, count = mem.clock, mem.counters
    phase, row = count[PHASE], count[ROW]
    if phase == AT_START:
        _copy(mem.y, mem.trial)
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
    s = tableau.b.size
    if phase == AT_START:
        count[FRESH] = 0
        if clock[WANTED] > 0.0:
            _aim(mem, options)
        else:
            clock[STEP] = _euler_step(mem, options)
            count[PHASE] = EULER
    elif phase == EULER:
        clock[WANTED] = _first_step(tableau, mem, options)
        _aim(mem, options)
    elif phase == STAGES:
        count[ROW] += 1
        if count[ROW] == s:
            return _judge(tableau, mem, options)
    elif phase == CLOSING:
        clock[LAST_START], clock[LAST_STEP] = clock[NOW], clock[STEP]
        landed = clock[STEP] == clock[END] - clock[NOW]
        clock[NOW] = clock[END] if landed else clock[NOW] + clock[STEP]
        _copy(mem.y, mem.y_old)
        _copy(mem.trial, mem.y)
        count[ACCEPTED] += 1
        count[AFTER_REJECTION] = 0
        count[INTERPOLANT] = 0
        count[PHASE] = READY
    else:
        count[ROW] += 1
        if count[ROW] == tableau.c.size:
            _interpolant(tableau, mem)
            count[PHASE] = READY
    return True


@part
def _judge(tableau: Any, mem: Any, options: Any) -> bool:
    """All stages are there: accept or reject the step, and choose the next (proportional-integral control)."""
    clock, count = mem.clock, mem.counters
    h = clock[STEP]
    _combine(tableau.b, mem.k, tableau.b.size, h, mem.y, mem.trial)
    err = _error(tableau, mem, h, options)
    if not err <= 1.0:
        shrink = 0.9 * err ** (-1.0 / tableau.order) if err < 1e300 else 0.1
        return _reject(mem, max(0.1, shrink), options)
    err = max(err, 1e-10)
    memory_exponent = 0.2 / tableau.order
    grow = 0.9 * err ** (-0.6 / tableau.order) * max(clock[LAST_ERROR], 1e-4) ** memory_exponent
    grow = min(6.0, max(0.2, grow))
    clock[WANTED] = h * (min(1.0, grow) if count[AFTER_REJECTION] == 1 else grow)
    clock[LAST_ERROR] = err
    count[PHASE] = CLOSING
    return True


@part
def _reject(mem: Any, factor: float, options: Any) -> bool:
    """Try the step again, shorter by `factor`; False if that would be too short."""
    clock, count = mem.clock, mem.counters
    count[REJECTED] += 1
    count[AFTER_REJECTION] = 1
    clock[WANTED] = factor * clock[STEP]
    _aim(mem, options)
    return clock[WANTED] > _SHORTEST * max(abs(clock[NOW]), 1e-3)


@part
def _is_finite(row: np.ndarray) -> bool:
    """Whether all entries are numbers."""
    for i in range(row.size):
        if not abs(row[i]) < np.inf:
            return False
    return True


@part
def _copy(source: np.ndarray, target: np.ndarray) -> None:
    """target[:] = source, without the copy of the source that Numba would make first."""
    for i in range(source.size):
        target[i] = source[i]


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
    _weigh(tableau.errors[0], mem.k, mem.error)
    high = h * _norm(mem.error, mem.y, mem.trial, options)
    if tableau.errors.shape[0] == 1 or high == 0.0:
        return high
    _weigh(tableau.errors[1], mem.k, mem.error)
    low = h * _norm(mem.error, mem.y, mem.trial, options)
    return high * high / sqrt(high * high + 0.01 * low * low)


@part
def _norm(error: np.ndarray, y0: np.ndarray, y1: np.ndarray, options: Any) -> float:
    """Root mean square of error / (atol + rtol max(|y0|, |y1|))."""
    n = error.size
    total = 0.0
    for k in range(n):
        scaled = error[k] / (options.atol + options.rtol * max(abs(y0[k]), abs(y1[k])))
        total += scaled * scaled
    return sqrt(total / n)


@part
def _weigh(weights: np.ndarray, k: np.ndarray, out: np.ndarray) -> None:
    """out = sum_j weights[j] k[j]."""
    for i in range(out.size):
        out[i] = 0.0
    for j in range(weights.size):
        if weights[j] != 0.0:
            for i in range(out.size):
                out[i] += weights[j] * k[j, i]


@part
def _euler_step(mem: Any, options: Any) -> float:
    """Length of the explicit Euler step that feels out the first step: a hundredth of |y| / |f|."""
    d0 = _norm(mem.y, mem.y, mem.y, options)
    d1 = _norm(mem.k[0], mem.y, mem.y, options)
    h = 1e-6 if d0 < 1e-5 or d1 < 1e-5 else 0.01 * d0 / d1
    return min(h, min(options.max_step, mem.clock[END] - mem.clock[NOW]))


@part
def _first_step(tableau: Any, mem: Any, options: Any) -> float:
    """Hairer's guess of the first step from the size of f and of its change over the Euler step."""
    h0 = mem.clock[STEP]
    d1 = _norm(mem.k[0], mem.y, mem.y, options)
    for i in range(mem.y.size):
        mem.error[i] = mem.k[1, i] - mem.k[0, i]
    d2 = _norm(mem.error, mem.y, mem.y, options) / h0
    steepest = max(d1, d2)
    h1 = max(1e-6, 1e-3 * h0) if steepest <= 1e-15 else (0.01 / steepest) ** (1.0 / tableau.order)
    return min(100.0 * h0, h1)


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
        _weigh(tableau.d[r], k, row)
        for i in range(row.size):
            row[i] *= h
    mem.counters[INTERPOLANT] = 1


@part
def interpolate(mem: Any, t: float, out: np.ndarray) -> None:
    """out = y(t) inside the last step."""
    x = (t - mem.clock[LAST_START]) / mem.clock[LAST_STEP]
    rows = mem.F.shape[0]
    for i in range(out.size):
        value = 0.0
        for r in range(rows - 1, -1, -1):
            value = (value + mem.F[r, i]) * (x if r % 2 == 0 else 1.0 - x)
        out[i] = mem.y_old[i] + value
