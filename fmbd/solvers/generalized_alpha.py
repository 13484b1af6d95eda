"""The generalised-alpha method: implicit, order 2, with numerical damping to choose, for stiff and non-smooth models.

Each step solves the equations of motion and the constraints at its end by Newton's method on exact structured tangents.
The spectral radius rho is what is left, per step, of a vibration that the step is much too long for: 1 damps nothing,
0 removes it at once. Use it for loose tolerances, for friction and stops whose jumps defeat methods of high order, at a
fixed step, or to compare with finite-element codes; where motions are smooth, `rodas5p` and `dop853` reach an accuracy
below 1e-4 in less time.

    a        acceleration-like variable, q'' at t + lead h:  (1-am) a1 + am a0 = (1-af) q1'' + af q0''
    q1, v1   q0 + h v0 + h^2 ((1/2-beta) a0 + beta a1),   v0 + h ((1-gamma) a0 + gamma a1)
    bq, bv   change of q1 and v1 per unit of q1'', the unknown of Newton's method: scaled so, short steps lose no digits
             (Bottasso, Dopico and Trainelli, Multibody System Dynamics 19 (2008) 3-20)

stabilised  velocities obey the constraints (index 2), then places are moved onto theirs, with the tangent of the step
index3      places obey the constraints, velocities miss theirs by O(h^2). Reactions ring when the step changes, and
            without bound at rho = 1; steps far below the shortest period drown in round-off. For comparisons.

First-order states move as velocities do; energies by the trapezoidal rule. At a start, a0 = q0'' + lead (q1'' - q0'')
makes a what it is later; it is scaled in the same way when the step changes, which otherwise costs an order.

M. Arnold and O. Bruls, Convergence of the generalized-alpha scheme for constrained mechanical systems, Multibody System
Dynamics 18 (2007) 185-202, doi 10.1007/s11044-007-9084-0. First-order states: O. Bruls and J.-C. Golinval, The
generalized-alpha method in mechatronic applications, ZAMM 86 (2006) 748-758.
"""

from typing import Any, NamedTuple

import numpy as np

from fmbd.planar.compile import compiled, part
from fmbd.solvers.implicit import begin, close_step, evaluate, write
from fmbd.solvers.newton import FINISH, RESIDUAL, UNKNOWN, newton, smooth
from fmbd.solvers.steps import (
    AFTER_REJECTION,
    BEFORE_BREAK,
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
    norm,
    plan_next,
    rejection,
    shorten,
)

#: Rows of Memory.k beside those of newton.py: rates at the start of this step and of the last, a, its given part, and
#: scratch.
START, EARLIER, ALPHA, GIVEN, SCRATCH = range(3, 8)
ROWS = 8
# local errors are of this order
_ORDER = 3


class GeneralizedAlpha(NamedTuple):
    """Coefficients of the method; step [s] is 0 for steps that follow the tolerance."""

    am: float
    af: float
    beta: float
    gamma: float
    lead: float
    step: float
    stabilised: bool


def generalized_alpha(spectral_radius: float, step: float | None, stabilised: bool) -> GeneralizedAlpha:
    """Chung and Hulbert's coefficients: order 2, least damping of slow motions."""
    rho = spectral_radius
    am, af = (2.0 * rho - 1.0) / (rho + 1.0), rho / (rho + 1.0)
    gamma = 0.5 + af - am
    return GeneralizedAlpha(am, af, 0.25 * (gamma + 0.5) ** 2, gamma, am - af, step or 0.0, stabilised)


@compiled
def advance_generalized_alpha(
    sys: Any,
    work: Any,
    couplings: Any,
    tan: Any,
    method: Any,
    mem: Any,
    breaks: np.ndarray,
    options: Any,
    times: np.ndarray,
    out: np.ndarray,
    attempts: int,
) -> tuple[int, int]:
    """As explicit.advance; `work` must be left alone between two calls: it holds the multipliers."""
    count, clock = mem.counters, mem.clock
    filled, tried = 0, 0
    while True:
        filled = write(mem, times, out, filled)
        if filled == times.size or tried == attempts:
            return filled, RUNNING
        tried += 1
        if clock[WANTED] == 0.0:
            clock[WANTED] = method.step
        guessing = clock[WANTED] == 0.0
        status = begin(sys, work, work, _ORDER, mem.k[START], mem.k[FINISH], mem, breaks, options)
        if status != RUNNING:
            return filled, status
        if guessing:
            # the multipliers at the start
            evaluate(sys, work, clock[NOW], mem.y, mem.k[START], mem)
        d, c, bq, bv = _weights(method, count[INTERPOLANT], clock[STEP])
        _predict(sys.nq, method, d, c, bq, bv, mem)
        t = min(clock[NOW] + clock[STEP], clock[BEFORE_BREAK])
        status = newton(sys, work, couplings, tan, method.stabilised, t, bq, bv, mem, options)
        err, shrink = 0.0, 0.25
        if status == RUNNING and method.step == 0.0:
            err = _error(sys, work, couplings, tan, bq, bv, mem, options)
            if not err <= 1.0:
                status, shrink = STEP_TOO_SMALL, rejection(err, _ORDER)
        if status == RUNNING and method.stabilised:
            most = 1.0 if method.step == 0.0 else np.inf
            if not close_step(sys, work, work, couplings, tan, bv, t, mem.k[SCRATCH], mem, options, most):
                status = OFF_CONSTRAINTS
        if status != RUNNING:
            # once more: with rates that obey the equations, without what rings in them
            count[FRESH] = count[AFTER_REJECTION]
            if not shorten(mem, shrink, options):
                return filled, status
            # the multipliers at the start
            evaluate(sys, work, clock[NOW], mem.y, mem.k[RESIDUAL], mem)
            continue
        if method.step == 0.0:
            plan_next(mem, err, _ORDER)
        else:
            clock[WANTED] = method.step
        accept(mem)
        _finish(sys.nq, c, mem)


@part
def _weights(method: Any, going: int, h: float) -> tuple[float, float, float, float]:
    """(d, c) of q1'' in a at start and end of the step, (bq, bv) in q1 and v1; going: 0 at a start."""
    d = method.lead if going == 0 else 0.0
    c = (1.0 - method.af - method.am * d) / (1.0 - method.am)
    bq = h * h * ((0.5 - method.beta) * d + method.beta * c)
    return d, c, bq, h * ((1.0 - method.gamma) * d + method.gamma * c)


@part
def _predict(n: int, method: Any, d: float, c: float, bq: float, bv: float, mem: Any) -> None:
    """mem.trial at unchanged rates of velocities and states; the given part of a."""
    y, trial, h = mem.y, mem.trial, mem.clock[STEP]
    f0, f1, a, given = mem.k[START], mem.k[FINISH], mem.k[ALPHA], mem.k[GIVEN]
    for i in range(n, y.size - 2):
        near = f0[i] * (1.0 - d)
        if mem.counters[INTERPOLANT] == 1:
            near += h / mem.clock[LAST_STEP] * (a[i] - f0[i])
        far = (method.af * f0[i] - method.am * near) / (1.0 - method.am)
        f1[i], given[i] = f0[i], far
        trial[i] = y[i] + h * ((1.0 - method.gamma) * near + method.gamma * far) + bv * f0[i]
        if i < 2 * n:
            rise = (0.5 - method.beta) * near + method.beta * far
            trial[i - n] = y[i - n] + h * (y[i] + h * rise) + bq * f0[i]


@part
def _error(
    sys: Any, work: Any, couplings: Any, tan: Any, bq: float, bv: float, mem: Any, options: Any
) -> float:
    """Norm of the local error: the step against integrals of a curve through the rates at three times."""
    n, h, h0, y, trial, error = sys.nq, mem.clock[STEP], mem.clock[LAST_STEP], mem.y, mem.trial, mem.error
    f0, f1, earlier, rz = mem.k[START], mem.k[FINISH], mem.k[EARLIER], mem.k[RESIDUAL, 2 * n : y.size - 2]
    for i in range(n, y.size - 2):
        error[i] = trial[i] - y[i] - 0.5 * h * (f0[i] + f1[i])
        if mem.counters[INTERPOLANT] == 1:
            error[i] += h * h / (6.0 * (h + h0)) * ((f1[i] - f0[i]) - h / h0 * (f0[i] - earlier[i]))
        if i < 2 * n:
            error[i - n] = trial[i - n] - y[i - n] - h * (y[i] + h * (2.0 * f0[i] + f1[i]) / 6.0)
    for i in range(rz.size):
        rz[i] = 0.0
    smooth(sys, work, couplings, tan, bq, bv, bq, mem, error[:n])
    for i in range(rz.size):
        rz[i] = error[2 * n + i] / bv
    smooth(sys, work, couplings, tan, bq, bv, bv, mem, error[n : 2 * n])
    for i in range(2 * n, y.size - 2):
        error[i] = mem.k[UNKNOWN, i]
    return norm(error[: y.size - 2], y[: y.size - 2], trial[: y.size - 2], options)


@part
def _finish(n: int, c: float, mem: Any) -> None:
    """Rates, a, energies and interpolant (Hermite's) of the step just taken."""
    y, old, h = mem.y, mem.y_old, mem.clock[LAST_STEP]
    f0, f1, F = mem.k[START], mem.k[FINISH], mem.F
    for i in range(n, y.size - 2):
        mem.k[ALPHA, i] = mem.k[GIVEN, i] + c * f1[i]
    for i in range(n):
        f1[i] = y[n + i]
    for i in range(y.size - 2, y.size):
        y[i] = old[i] + 0.5 * h * (f0[i] + f1[i])
    for i in range(y.size):
        F[0, i] = y[i] - old[i]
        F[1, i] = h * f0[i] - F[0, i]
        F[2, i] = F[0, i] - F[1, i] - h * f1[i]
    copy(f0, mem.k[EARLIER])
    copy(f1, f0)
    mem.counters[INTERPOLANT] = 1
