"""The compiled loop of the explicit methods: adaptive steps, projection, dense output, landing on breakpoints.

    y     state [q, v, z, dissipated energy, work], modal coordinates
    k     stages (s + 1 + m, ny); k[s] = f at the end of the step
    F     rows of the interpolant of the last step (3 + rows of d, ny)
    err   error norm: root mean square of the estimate over atol + rtol |y|; a step is accepted if err <= 1
After Hairer, Norsett, Wanner, Solving Ordinary Differential Equations I, sections II.4 to II.6.
"""

from math import sqrt
from typing import Any, NamedTuple

import numpy as np

from fmbd.planar.compile import compiled
from fmbd.planar.equations import derivatives, project, weighted_norm

RUNNING, NO_INERTIA, OFF_CONSTRAINTS, STEP_TOO_SMALL = range(4)
# indices of Memory.clock and Memory.count
TIME, STEP, START, LAST_STEP = range(4)
(
    ACCEPTED,
    REJECTED,
    EVALUATIONS,
    PROJECTIONS,
    BREAK,
    FRESH,
    DENSE,
    BODY,
    AFTER_REJECTION,
) = range(9)


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
    count: np.ndarray


def memory(tableau: Any, y0: np.ndarray, nq: int) -> Memory:
    """Memory of a run that starts at y0 at time 0."""
    ny = y0.size
    k = np.zeros((tableau.c.size, ny))
    F = np.zeros((3 + tableau.d.shape[0], ny))
    count = np.zeros(9, np.int64)
    count[FRESH] = 1
    return Memory(y0.copy(), y0.copy(), np.zeros(ny), np.zeros(ny), k, F, np.zeros(nq), np.zeros(4), count)


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
    clock, count = mem.clock, mem.count
    filled = 0
    tried = 0
    while filled < times.size:
        if times[filled] <= clock[TIME]:
            if times[filled] == clock[TIME]:
                copy(mem.y, out[filled])
            else:
                if count[DENSE] == 0:
                    failed = _prepare_dense(sys, work, tableau, mem, options)
                    if failed >= 0:
                        return filled, NO_INERTIA
                interpolate(mem, times[filled], out[filled])
            filled += 1
            continue
        if tried == attempts:
            break
        tried += 1
        status = _step(sys, work, tableau, mem, breaks, options)
        if status != RUNNING:
            return filled, status
    return filled, RUNNING


@compiled
def copy(source: np.ndarray, target: np.ndarray) -> None:
    """target[:] = source, without the copy of the source that Numba would make first."""
    for i in range(source.size):
        target[i] = source[i]


@compiled
def _rate(sys: Any, work: Any, mem: Any, t: float, y: np.ndarray, out: np.ndarray, options: Any) -> bool:
    """out = f(t, y); False if a joint has no inertia."""
    mem.count[EVALUATIONS] += 1
    failed = derivatives(sys, work, t, y, out, options.drag, options.pull)
    if failed >= 0:
        mem.count[BODY] = failed
        return False
    return True


@compiled
def _step(sys: Any, work: Any, tableau: Any, mem: Any, breaks: np.ndarray, options: Any) -> int:
    """One attempt; on success mem.y, the clock and k[s] are those of the step's end."""
    clock, count, k = mem.clock, mem.count, mem.k
    s = tableau.b.size
    t = clock[TIME]
    while breaks[count[BREAK]] <= t:
        count[BREAK] += 1
        count[FRESH] = 1
    end = breaks[count[BREAK]]
    # inside a step the inputs are those before the next jump
    before_end = np.nextafter(end, -np.inf)
    if count[FRESH] == 1:
        if not _rate(sys, work, mem, t, mem.y, k[0], options):
            return NO_INERTIA
        count[FRESH] = 0
        if clock[STEP] == 0.0:
            clock[STEP] = _first_step(sys, work, tableau, mem, options)
    elif count[AFTER_REJECTION] == 0:
        copy(k[s], k[0])
    h = min(clock[STEP], options.max_step)
    landing = t + 1.01 * h >= end
    if landing:
        h = end - t
    for j in range(1, s):
        _combine(tableau.a[j], k, j, h, mem.y, mem.trial)
        if not _rate(sys, work, mem, min(t + tableau.c[j] * h, before_end), mem.trial, k[j], options):
            return NO_INERTIA
    _combine(tableau.b, k, s, h, mem.y, mem.trial)
    err = _error(tableau, mem, h, options)
    if not err <= 1.0:
        count[REJECTED] += 1
        count[AFTER_REJECTION] = 1
        shrink = 0.9 * err ** (-1.0 / tableau.order) if err < 1e300 else 0.1
        clock[STEP] = h * max(0.1, shrink)
        if clock[STEP] < 1e-13 * max(abs(t), 1e-3):
            return STEP_TOO_SMALL
        return RUNNING
    new_time = end if landing else t + h
    before = min(new_time, before_end)
    if options.projecting:
        taken = project(sys, work, before, mem.trial, mem.correction, options.closed)
        if taken < 0:
            # too far off the constraints for Newton: a shorter step comes closer
            count[REJECTED] += 1
            count[AFTER_REJECTION] = 1
            clock[STEP] = 0.25 * h
            return OFF_CONSTRAINTS if clock[STEP] < 1e-13 * max(abs(t), 1e-3) else RUNNING
        count[PROJECTIONS] += taken
    if not _rate(sys, work, mem, before, mem.trial, k[s], options):
        return NO_INERTIA
    grow = min(10.0, 0.9 * err ** (-1.0 / tableau.order)) if err > 0.0 else 10.0
    clock[STEP] = h * (min(1.0, grow) if count[AFTER_REJECTION] == 1 else max(0.2, grow))
    count[AFTER_REJECTION] = 0
    count[ACCEPTED] += 1
    count[DENSE] = 0
    clock[START], clock[LAST_STEP], clock[TIME] = t, h, new_time
    copy(mem.y, mem.y_old)
    copy(mem.trial, mem.y)
    return RUNNING


@compiled
def _combine(weights: np.ndarray, k: np.ndarray, n: int, h: float, y: np.ndarray, out: np.ndarray) -> None:
    """out = y + h sum_j weights[j] k[j]."""
    for i in range(y.size):
        out[i] = 0.0
    for j in range(n):
        if weights[j] != 0.0:
            for i in range(y.size):
                out[i] += weights[j] * k[j, i]
    for i in range(y.size):
        out[i] = y[i] + h * out[i]


@compiled
def _error(tableau: Any, mem: Any, h: float, options: Any) -> float:
    """Error norm of the step from mem.y to mem.trial; DOP853 blends its estimates of order 5 and 3."""
    n = mem.y.size - 2
    mem.error[:] = 0.0
    _weigh(tableau.errors[0], mem.k, mem.error)
    high = h * weighted_norm(mem.error, mem.y, mem.trial, options.rtol, options.atol, n)
    if tableau.errors.shape[0] == 1 or high == 0.0:
        return high
    mem.error[:] = 0.0
    _weigh(tableau.errors[1], mem.k, mem.error)
    low = h * weighted_norm(mem.error, mem.y, mem.trial, options.rtol, options.atol, n)
    return high * high / sqrt(high * high + 0.01 * low * low)


@compiled
def _weigh(weights: np.ndarray, k: np.ndarray, out: np.ndarray) -> None:
    """out += sum_j weights[j] k[j]."""
    for j in range(weights.size):
        if weights[j] != 0.0:
            for i in range(out.size):
                out[i] += weights[j] * k[j, i]


@compiled
def _first_step(sys: Any, work: Any, tableau: Any, mem: Any, options: Any) -> float:
    """Hairer's guess of the first step from the size of f and of its change over an Euler step."""
    n = mem.y.size - 2
    t = mem.clock[TIME]
    copy(mem.y, mem.error)
    d0 = weighted_norm(mem.error, mem.y, mem.y, options.rtol, options.atol, n)
    copy(mem.k[0], mem.error)
    d1 = weighted_norm(mem.error, mem.y, mem.y, options.rtol, options.atol, n)
    h0 = 1e-6 if d0 < 1e-5 or d1 < 1e-5 else 0.01 * d0 / d1
    h0 = min(h0, options.max_step)
    for i in range(mem.y.size):
        mem.trial[i] = mem.y[i] + h0 * mem.k[0, i]
    if not _rate(sys, work, mem, t + h0, mem.trial, mem.k[1], options):
        return h0
    for i in range(mem.y.size):
        mem.error[i] = mem.k[1, i] - mem.k[0, i]
    d2 = weighted_norm(mem.error, mem.y, mem.y, options.rtol, options.atol, n) / h0
    steepest = max(d1, d2)
    h1 = max(1e-6, 1e-3 * h0) if steepest <= 1e-15 else (0.01 / steepest) ** (1.0 / tableau.order)
    return min(100.0 * h0, h1)


@compiled
def _prepare_dense(sys: Any, work: Any, tableau: Any, mem: Any, options: Any) -> int:
    """Rows F of the interpolant over the last step; returns -1 or a body without inertia."""
    s = tableau.b.size
    k, F = mem.k, mem.F
    h = mem.clock[LAST_STEP]
    end = np.nextafter(mem.clock[TIME], -np.inf)
    for j in range(s + 1, tableau.c.size):
        _combine(tableau.a[j], k, j, h, mem.y_old, mem.trial)
        t = min(mem.clock[START] + tableau.c[j] * h, end)
        if not _rate(sys, work, mem, t, mem.trial, k[j], options):
            return mem.count[BODY]
    for i in range(mem.y.size):
        rise = mem.y[i] - mem.y_old[i]
        F[0, i] = rise
        F[1, i] = h * k[0, i] - rise
        F[2, i] = 2.0 * rise - h * (k[0, i] + k[s, i])
    for r in range(tableau.d.shape[0]):
        row = F[3 + r]
        row[:] = 0.0
        _weigh(tableau.d[r], k, row)
        for i in range(row.size):
            row[i] *= h
    mem.count[DENSE] = 1
    return -1


@compiled
def interpolate(mem: Any, t: float, out: np.ndarray) -> None:
    """out = y(t) inside the last step."""
    x = (t - mem.clock[START]) / mem.clock[LAST_STEP]
    rows = mem.F.shape[0]
    for i in range(out.size):
        value = 0.0
        for r in range(rows - 1, -1, -1):
            value = (value + mem.F[r, i]) * (x if r % 2 == 0 else 1.0 - x)
        out[i] = mem.y_old[i] + value
