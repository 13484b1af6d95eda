"""Signals: functions of time with their first two derivatives (a driven joint needs all three).

p     parameters of one signal, in the order of its YAML keys
v, d, c   value, first and second time derivative
"""

from math import (
    acos,
    asin,
    atan,
    atan2,
    ceil,
    cos,
    cosh,
    exp,
    floor,
    hypot,
    inf,
    log,
    nan,
    pi,
    sin,
    sinh,
    sqrt,
    tan,
    tanh,
)
from typing import Any

import numpy as np

from fmbd.planar.compile import compiled, part
from fmbd.planar.tables import piece

#: A jump comes this much early, relative to the time and to 1 s.
EARLY = 2e-15
CONSTANT, STEP, RAMP, SMOOTH_STEP, SINE, PULSE, EXPRESSION, TABLE = range(8)
# fmt: off
OPERATIONS = (
    "const", "t", "add", "sub", "mul", "div", "pow", "neg", "sin", "cos", "tan", "asin", "acos", "atan",
    "atan2", "sinh", "cosh", "tanh", "exp", "log", "sqrt", "abs", "min", "max", "hypot", "sign", "floor",
    "ceil", "mod",
)
(
    _CONST, _T, _ADD, _SUB, _MUL, _DIV, _POW, _NEG, _SIN, _COS, _TAN, _ASIN, _ACOS, _ATAN, _ATAN2, _SINH,
    _COSH, _TANH, _EXP, _LOG, _SQRT, _ABS, _MIN, _MAX, _HYPOT, _SIGN, _FLOOR, _CEIL, _MOD,
) = range(len(OPERATIONS))
# fmt: on


@compiled
def evaluate_signals(
    signals: Any, program: np.ndarray, table: np.ndarray, stack: np.ndarray, t: float, values: np.ndarray
) -> None:
    """Fill `values` (signals, 3) with value, rate and second derivative of every signal at time t [s]."""
    for k in range(signals.size):
        g = signals[k]
        out = values[k]
        p = g.p
        out[1] = 0.0
        out[2] = 0.0
        if g.kind == CONSTANT:
            out[0] = p[0]
        elif g.kind == STEP:
            out[0] = p[1] if t < p[0] else p[2]
        elif g.kind == RAMP or g.kind == SMOOTH_STEP:
            _transition(t, p, g.kind == RAMP, out)
        elif g.kind == SINE:
            w = 2.0 * pi * p[1]
            out[0] = p[3] + p[0] * sin(w * t + p[2])
            out[1] = p[0] * w * cos(w * t + p[2])
            out[2] = -p[0] * w * w * sin(w * t + p[2])
        elif g.kind == PULSE:
            # edges are counted as sums of periods: the round-off of the sum must not hide one
            age = t - p[0] + EARLY * max(1.0, abs(t))
            if age >= 0.0 and p[4] > 0.0:
                age -= floor(age / p[4]) * p[4]
            out[0] = p[3] + p[2] if 0.0 <= age < p[1] else p[3]
        elif g.kind == EXPRESSION:
            _run(program, g.start, g.count, t, stack)
            for n in range(3):
                out[n] = stack[0, n]
        else:
            _look_up(table, g.start, g.count, t, out)


@part
def _transition(t: float, p: np.ndarray, linear: bool, out: np.ndarray) -> None:
    """From p[2] to p[3] while t goes from p[0] to p[1]; linear, or the quintic with zero rate and curvature ends."""
    span = p[1] - p[0]
    x = (t - p[0]) / span
    rise = p[3] - p[2]
    if x < 0.0:
        out[0] = p[2]
    elif x >= 1.0:
        out[0] = p[3]
    elif linear:
        out[0] = p[2] + rise * x
        out[1] = rise / span
    else:
        out[0] = p[2] + rise * x * x * x * (10.0 + x * (6.0 * x - 15.0))
        out[1] = rise / span * 30.0 * x * x * (1.0 - x) ** 2
        out[2] = rise / span**2 * 60.0 * x * (1.0 - x) * (1.0 - 2.0 * x)


@part
def _look_up(table: np.ndarray, start: int, count: int, t: float, out: np.ndarray) -> None:
    """Piecewise cubic through knots; held constant outside."""
    last = start + count - 1
    if t < table[start, 0]:
        out[0] = table[start, 1]
        return
    if t >= table[last, 0]:
        out[0] = table[last, 1]
        return
    k = piece(table, start, last, t)
    x = t - table[k, 0]
    c1, c2, c3 = table[k, 2], table[k, 3], table[k, 4]
    out[0] = table[k, 1] + x * (c1 + x * (c2 + x * c3))
    out[1] = c1 + x * (2.0 * c2 + 3.0 * x * c3)
    out[2] = 2.0 * c2 + 6.0 * x * c3


@part
def _run(program: np.ndarray, start: int, count: int, t: float, stack: np.ndarray) -> None:
    """Evaluate a postfix program on (value, rate, second derivative) triples; the result is stack[0]."""
    top = -1
    for line in range(start, start + count):
        op = int(program[line, 0])
        if op == _CONST or op == _T:
            top += 1
            stack[top, 0] = t if op == _T else program[line, 1]
            stack[top, 1] = 1.0 if op == _T else 0.0
            stack[top, 2] = 0.0
        elif _is_binary(op):
            top -= 1
            _binary(op, stack[top], stack[top + 1])
        else:
            _unary(op, stack[top])


@part
def _is_binary(op: int) -> bool:
    return _ADD <= op <= _POW or op == _ATAN2 or _MIN <= op <= _HYPOT or op == _MOD


@part
def _binary(op: int, a: np.ndarray, b: np.ndarray) -> None:
    """a <- a op b, with the rules of differentiation."""
    a0, a1, a2, b0, b1, b2 = a[0], a[1], a[2], b[0], b[1], b[2]
    if op == _ADD:
        v, d, c = a0 + b0, a1 + b1, a2 + b2
    elif op == _SUB:
        v, d, c = a0 - b0, a1 - b1, a2 - b2
    elif op == _MUL:
        v, d, c = a0 * b0, a1 * b0 + a0 * b1, a2 * b0 + 2.0 * a1 * b1 + a0 * b2
    elif op == _DIV or op == _MOD:
        # a % b = a - b floor(a / b), whose floor is constant between jumps
        if b0 == 0.0:
            v, d, c = nan, nan, nan
        elif op == _DIV:
            v = a0 / b0
            d = (a1 - v * b1) / b0
            c = (a2 - 2.0 * d * b1 - v * b2) / b0
        else:
            n = floor(a0 / b0)
            v, d, c = a0 - n * b0, a1 - n * b1, a2 - n * b2
    elif op == _POW:
        v, d, c = _power(a0, a1, a2, b0, b1, b2)
    elif op == _ATAN2:
        r2 = a0 * a0 + b0 * b0
        v = atan2(a0, b0)
        d = (a1 * b0 - a0 * b1) / r2 if r2 > 0.0 else nan
        c = (a2 * b0 - a0 * b2 - 2.0 * d * (a0 * a1 + b0 * b1)) / r2 if r2 > 0.0 else nan
    elif op == _HYPOT:
        v = hypot(a0, b0)
        d = (a0 * a1 + b0 * b1) / v if v > 0.0 else nan
        c = (a1 * a1 + a0 * a2 + b1 * b1 + b0 * b2 - d * d) / v if v > 0.0 else nan
    elif (op == _MIN) == (a0 <= b0):
        v, d, c = a0, a1, a2
    else:
        v, d, c = b0, b1, b2
    a[0], a[1], a[2] = v, d, c


@part
def _power(a0: float, a1: float, a2: float, b0: float, b1: float, b2: float) -> tuple[float, float, float]:
    if b1 == 0.0 and b2 == 0.0:
        if b0 == 0.0:
            return 1.0, 0.0, 0.0
        if b0 == 1.0:
            return a0, a1, a2
        if b0 == 2.0:
            return a0 * a0, 2.0 * a0 * a1, 2.0 * (a1 * a1 + a0 * a2)
        if (a0 < 0.0 and b0 != floor(b0)) or (a0 == 0.0 and b0 < 0.0):
            return nan, nan, nan
        if a0 == 0.0 and b0 < 2.0:
            # t**1.5 at t = 0: the rate is 0, the curvature has no finite value unless the base stands still
            return 0.0, 0.0 if b0 > 1.0 or a1 == 0.0 else inf, 0.0 if a1 == 0.0 else inf
        slope = b0 * a0 ** (b0 - 1.0)
        return a0**b0, slope * a1, b0 * (b0 - 1.0) * a0 ** (b0 - 2.0) * a1 * a1 + slope * a2
    if a0 <= 0.0:
        return nan, nan, nan
    # a^b = exp(b log a)
    g = log(a0)
    g1 = a1 / a0
    g2 = a2 / a0 - g1 * g1
    e1 = b1 * g + b0 * g1
    e2 = b2 * g + 2.0 * b1 * g1 + b0 * g2
    v = a0**b0
    return v, v * e1, v * (e1 * e1 + e2)


@part
def _unary(op: int, a: np.ndarray) -> None:
    """a <- op(a): f, f', f'' of the function, then the chain rule."""
    x = a[0]
    f, g, h = nan, nan, nan
    if op == _NEG:
        f, g, h = -x, -1.0, 0.0
    elif op == _SIN:
        f, g, h = sin(x), cos(x), -sin(x)
    elif op == _COS:
        f, g, h = cos(x), -sin(x), -cos(x)
    elif op == _TAN:
        f = tan(x)
        g = 1.0 + f * f
        h = 2.0 * f * g
    elif op == _ASIN or op == _ACOS:
        if abs(x) < 1.0:
            r = 1.0 / sqrt(1.0 - x * x)
            f, g, h = asin(x), r, x * r**3
            if op == _ACOS:
                f, g, h = acos(x), -g, -h
    elif op == _ATAN:
        g = 1.0 / (1.0 + x * x)
        f, h = atan(x), -2.0 * x * g * g
    elif op == _SINH:
        f, g, h = sinh(x), cosh(x), sinh(x)
    elif op == _COSH:
        f, g, h = cosh(x), sinh(x), cosh(x)
    elif op == _TANH:
        f = tanh(x)
        g = 1.0 - f * f
        h = -2.0 * f * g
    elif op == _EXP:
        f = exp(x)
        g, h = f, f
    elif op == _LOG:
        if x > 0.0:
            f, g, h = log(x), 1.0 / x, -1.0 / (x * x)
    elif op == _SQRT:
        if x > 0.0:
            f = sqrt(x)
            g = 0.5 / f
            h = -0.5 * g / x
        elif x == 0.0:
            f, g, h = 0.0, (inf if a[1] != 0.0 else 0.0), 0.0
    elif op == _ABS:
        f, g, h = abs(x), (1.0 if x >= 0.0 else -1.0), 0.0
    elif op == _SIGN:
        f, g, h = (1.0 if x > 0.0 else -1.0 if x < 0.0 else 0.0), 0.0, 0.0
    elif op == _FLOOR:
        f, g, h = floor(x), 0.0, 0.0
    elif op == _CEIL:
        f, g, h = ceil(x), 0.0, 0.0
    d = a[1]
    a[0], a[1], a[2] = f, g * d, h * d * d + g * a[2]
