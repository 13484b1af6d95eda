"""Step control that all adaptive methods share: state of a run, error norm, next step, breakpoints, interpolation.

    y     state [q, v, z, dissipated energy, work], modal coordinates
    k     what a method computes in its stages (rows, ny)
    F     rows of the interpolant of the last step (rows, ny)
    err   error norm: root mean square of the estimate over atol + rtol |y|; a step is accepted if err <= 1
After Hairer, Norsett, Wanner, Solving Ordinary Differential Equations I, sections II.4 to II.6.
"""

from math import sqrt
from typing import Any, NamedTuple

import numpy as np

from fmbd.planar.compile import inner, part
from fmbd.planar.signals import EARLY

RUNNING, NO_INERTIA, OFF_CONSTRAINTS, STEP_TOO_SMALL, NOT_A_NUMBER = range(5)
#: Indices of Memory.clock [s]: now, wanted step, this step, its end, last instant before the next breakpoint, the point
#: at which f is wanted, start and length of the last accepted step, its error; of implicit steps: the part of its last
#: correction that Newton's method left, the step for which S - J is factored.
(
    NOW,
    WANTED,
    STEP,
    END,
    BEFORE_BREAK,
    POINT,
    LAST_START,
    LAST_STEP,
    LAST_ERROR,
    CONTRACTION,
    FACTORED,
) = range(11)
#: Indices of Memory.counters.
(
    ACCEPTED,
    REJECTED,
    EVALUATIONS,
    PROJECTIONS,
    FACTORISATIONS,
    BREAK,
    FRESH,
    INTERPOLANT,
    BODY,
    AFTER_REJECTION,
    PHASE,
    ROW,
) = range(12)
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


def memory(y0: np.ndarray, nq: int, rows: int, interpolant_rows: int) -> Memory:
    """Memory of a run that starts at y0 at time 0."""
    ny = y0.size
    count = np.zeros(12, np.int64)
    count[FRESH] = 1
    return Memory(
        y0.copy(),
        y0.copy(),
        y0.copy(),
        np.zeros(ny),
        np.zeros((rows, ny)),
        np.zeros((interpolant_rows, ny)),
        np.zeros(nq),
        np.zeros(11),
        count,
    )


@part
def pass_breaks(mem: Any, breaks: np.ndarray) -> None:
    """Find the next breakpoint; after one, f is evaluated anew (FRESH), with the inputs that follow it."""
    clock, count = mem.clock, mem.counters
    while breaks[count[BREAK]] <= clock[NOW]:
        count[BREAK] += 1
        count[FRESH] = 1
    # inside a step the inputs are those before the next jump
    clock[END] = breaks[count[BREAK]]
    clock[BEFORE_BREAK] = clock[END] - 4.0 * EARLY * max(1.0, clock[END])


@part
def aim(mem: Any, options: Any) -> None:
    """Choose this step's length, so that it lands on a breakpoint that is near."""
    clock = mem.clock
    h = min(clock[WANTED], options.max_step)
    left = clock[END] - clock[NOW]
    clock[STEP] = left if 1.01 * h >= left else h


@part
def shorten(mem: Any, factor: float, options: Any) -> bool:
    """Try the step again, shorter by `factor`; False if that would be too short."""
    clock, count = mem.clock, mem.counters
    count[REJECTED] += 1
    count[AFTER_REJECTION] = 1
    clock[WANTED] = factor * clock[STEP]
    aim(mem, options)
    return clock[WANTED] > _SHORTEST * max(abs(clock[NOW]), 1e-3)


@part
def rejection(err: float, order: int) -> float:
    """How much shorter a step that missed by `err` is tried again."""
    shrink = 0.9 * err ** (-1.0 / order) if err < 1e300 else 0.1
    return max(0.1, shrink)


@part
def plan_next(mem: Any, err: float, order: int) -> None:
    """Choose the next step after one that met the tolerance (proportional-integral control)."""
    clock, count = mem.clock, mem.counters
    err = max(err, 1e-10)
    grow = 0.9 * err ** (-0.6 / order) * max(clock[LAST_ERROR], 1e-4) ** (0.2 / order)
    grow = min(6.0, max(0.2, grow))
    clock[WANTED] = clock[STEP] * (min(1.0, grow) if count[AFTER_REJECTION] == 1 else grow)
    clock[LAST_ERROR] = err


@part
def accept(mem: Any) -> None:
    """mem.trial becomes the state."""
    clock, count = mem.clock, mem.counters
    clock[LAST_START], clock[LAST_STEP] = clock[NOW], clock[STEP]
    landed = clock[STEP] == clock[END] - clock[NOW]
    clock[NOW] = clock[END] if landed else clock[NOW] + clock[STEP]
    copy(mem.y, mem.y_old)
    copy(mem.trial, mem.y)
    count[ACCEPTED] += 1
    count[AFTER_REJECTION] = 0
    count[INTERPOLANT] = 0


@part
def is_finite(row: np.ndarray) -> bool:
    """Whether all entries are numbers."""
    for i in range(row.size):
        if not abs(row[i]) < np.inf:
            return False
    return True


@part
def copy(source: np.ndarray, target: np.ndarray) -> None:
    """target[:] = source, without the copy of the source that Numba would make first."""
    for i in range(source.size):
        target[i] = source[i]


@part
def norm(error: np.ndarray, y0: np.ndarray, y1: np.ndarray, options: Any) -> float:
    """Root mean square of error / (atol + rtol max(|y0|, |y1|))."""
    n = error.size
    total = 0.0
    for k in range(n):
        scaled = error[k] / (options.atol + options.rtol * max(abs(y0[k]), abs(y1[k])))
        total += scaled * scaled
    return sqrt(total / n)


@part
def moved(mem: Any, options: Any) -> float:
    """Error norm of what the projection did to mem.trial; mem.error is a copy from before."""
    for i in range(mem.error.size):
        mem.error[i] = mem.trial[i] - mem.error[i]
    return norm(mem.error, mem.y, mem.trial, options)


@part
def euler_step(f0: np.ndarray, mem: Any, options: Any) -> float:
    """Length of the explicit Euler step that feels out the first step: a hundredth of |y| / |f|."""
    d0 = norm(mem.y, mem.y, mem.y, options)
    d1 = norm(f0, mem.y, mem.y, options)
    h = 1e-6 if d0 < 1e-5 or d1 < 1e-5 else 0.01 * d0 / d1
    return min(h, min(options.max_step, mem.clock[END] - mem.clock[NOW]))


@part
def first_step(f0: np.ndarray, f1: np.ndarray, order: int, mem: Any, options: Any) -> float:
    """Hairer's guess of the first step from the size of f and of its change over the Euler step."""
    h0 = mem.clock[STEP]
    d1 = norm(f0, mem.y, mem.y, options)
    for i in range(mem.y.size):
        mem.error[i] = f1[i] - f0[i]
    d2 = norm(mem.error, mem.y, mem.y, options) / h0
    steepest = max(d1, d2)
    h1 = max(1e-6, 1e-3 * h0) if steepest <= 1e-15 else (0.01 / steepest) ** (1.0 / order)
    return min(100.0 * h0, h1)


@part
def weigh(weights: np.ndarray, k: np.ndarray, out: np.ndarray) -> None:
    """out = sum_j weights[j] k[j]."""
    for i in range(out.size):
        out[i] = 0.0
    for j in range(weights.size):
        if weights[j] != 0.0:
            for i in range(out.size):
                out[i] += weights[j] * k[j, i]


@inner
def interpolate(mem: Any, t: float, out: np.ndarray) -> None:
    """out = y(t) inside the last step: y_old + x (F0 + (1-x) (F1 + x (F2 + (1-x) (F3 + ...))))."""
    x = (t - mem.clock[LAST_START]) / mem.clock[LAST_STEP]
    rows = mem.F.shape[0]
    for i in range(out.size):
        value = 0.0
        for r in range(rows - 1, -1, -1):
            value = (value + mem.F[r, i]) * (x if r % 2 == 0 else 1.0 - x)
        out[i] = mem.y_old[i] + value
