"""Force laws: what acts along a pathway, a scalar function of its length l and rate l', with its derivatives.

s, v      stretch l - rest, rate l'
f         force, positive where it lengthens the pathway
k, d      -df/dl and -df/dl': stiffness and damping of the tangent
E, P      energy stored, power dissipated (never negative): f v = -dE/dt - P

A spring is a linear one and a damper, f = -k s - d v, to which its kind adds

STOP, BACKLASH  p = (lower, upper, stiffness c, damping b, transition w): nothing between lower and upper. x is the
                depth behind either; u(x), the depth taken up, is 0 until x = -w/2, x from w/2 on, and between these
                u' = 3 xi^2 - 2 xi^3, xi = x/w + 1/2, so that u has two continuous derivatives.
                A stop pushes back with c u max(0, 1 + b x'), backlash with c u + b u' x'.
FRICTION        p = (Coulomb C, static S, Stribeck speed vs, transition speed vt):
                f = -(C + (S - C) exp(-(v / vs)^2)) tanh(v / vt)
TABLE           f = -T(s), a piecewise cubic that goes on straight at both ends

Sources: K. H. Hunt, F. R. E. Crossley, Coefficient of restitution interpreted as damping in vibroimpact, Journal of
Applied Mechanics 42 (2), 1975, pp. 440-445; B. Armstrong-Helouvry, P. Dupont, C. Canudas de Wit, A survey of models,
analysis tools and compensation methods for the control of machines with friction, Automatica 30 (7), 1994.
"""

from math import exp, tanh
from typing import Any

import numpy as np

from fmbd.planar.compile import compiled, inner, part
from fmbd.planar.tables import piece

LINEAR, STOP, BACKLASH, FRICTION, TABLE = range(5)

Law = tuple[float, float, float, float, float]


@part
def law(spring: Any, curves: np.ndarray, length: float, rate: float) -> Law:
    """f, k, d, E, P of a spring at a length [m or rad] and its rate."""
    s = length - spring.rest
    f, k, d = -spring.k * s - spring.d * rate, spring.k, spring.d
    E, P = 0.5 * spring.k * s * s, spring.d * rate * rate
    if spring.kind == LINEAR:
        return f, k, d, E, P
    f1, k1, d1, E1, P1 = _nonlinear(spring, curves, s, rate)
    return f + f1, k + k1, d + d1, E + E1, P + P1


@inner
def _nonlinear(spring: Any, curves: np.ndarray, s: float, v: float) -> Law:
    """What the kind of a spring adds; a function of its own, so that linear springs stay as quick as they are."""
    if spring.kind == FRICTION:
        return _friction(spring.p, v)
    if spring.kind == TABLE:
        return _curve(curves, spring.start, spring.count, s)
    return _beyond_gap(spring.p, spring.kind == STOP, s, v)


@part
def _beyond_gap(p: np.ndarray, pushing: bool, s: float, v: float) -> Law:
    side, x = 1.0, s - p[1]
    if p[0] - s > x:
        side, x = -1.0, p[0] - s
    c, b, w = p[2], p[3], p[4]
    if x <= -0.5 * w:
        return 0.0, 0.0, 0.0, 0.0, 0.0
    v *= side
    xi, more = min(x / w + 0.5, 1.0), max(x - 0.5 * w, 0.0)
    u = w * xi * xi * xi * (1.0 - 0.5 * xi) + more
    slope, bend = xi * xi * (3.0 - 2.0 * xi), 6.0 * xi * (1.0 - xi) / w
    E = c * (w * w * xi**4 * (0.25 - 0.1 * xi) + 0.5 * more * (w + more))
    if not pushing:
        return -side * (c * u + b * slope * v), c * slope + b * bend * v, b * slope, E, b * slope * v * v
    push = 1.0 + b * v
    if push <= 0.0:
        return 0.0, 0.0, 0.0, E, -c * u * v
    return -side * c * u * push, c * slope * push, c * u * b, E, c * u * b * v * v


@part
def _friction(p: np.ndarray, v: float) -> Law:
    grip = tanh(v / p[3])
    rise = (p[1] - p[0]) * exp(-((v / p[2]) ** 2))
    level = p[0] + rise
    d = level * (1.0 - grip * grip) / p[3] - 2.0 * rise * v / p[2] ** 2 * grip
    return -level * grip, 0.0, d, 0.0, level * grip * v


@part
def _curve(curves: np.ndarray, start: int, count: int, s: float) -> Law:
    k = piece(curves, start, start + count, s)
    x, c0, c1, c2, c3 = s - curves[k, 0], curves[k, 1], curves[k, 2], curves[k, 3], curves[k, 4]
    T = c0 + x * (c1 + x * (c2 + x * c3))
    stiffness = c1 + x * (2.0 * c2 + x * 3.0 * c3)
    E = curves[k, 5] + x * (c0 + x * (c1 / 2.0 + x * (c2 / 3.0 + x * c3 / 4.0)))
    return -T, stiffness, 0.0, E, 0.0


@compiled
def evaluate_law(
    springs: Any, curves: np.ndarray, k: int, lengths: np.ndarray, rates: np.ndarray, out: np.ndarray
) -> None:
    """Fill out (n, 5) with `law` of spring k at lengths and rates (n,)."""
    for i in range(lengths.size):
        f, stiffness, damping, energy, power = law(springs[k], curves, lengths[i], rates[i])
        out[i, 0], out[i, 1], out[i, 2], out[i, 3], out[i, 4] = f, stiffness, damping, energy, power
